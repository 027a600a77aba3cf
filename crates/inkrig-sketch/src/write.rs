//! Curves as text: JSON and CSV to keep, SVG to look at.

use std::fmt::Write;

use crate::Curve;

/// Longer side of a drawing in [`to_svg`], in pixels, and the margin around it.
const SVG_SIDE: f64 = 1000.0;
const SVG_MARGIN: f64 = 20.0;

/// The curve as JSON that [`crate::read_curve`] reads back exactly: `[[x,y],...]`, with t where there is pen time, objects
/// where there is pressure, `{"strokes":[...]}` where there are several strokes.
pub fn to_json(curve: &Curve) -> String {
    let strokes: Vec<String> = curve
        .stroke_ranges()
        .map(|range| {
            let points: Vec<String> = range.map(|index| json_point(curve, index)).collect();
            format!("[{}]", points.join(","))
        })
        .collect();
    match strokes.as_slice() {
        [stroke] => format!("{stroke}\n"),
        strokes => format!("{{\"strokes\":[{}]}}\n", strokes.join(",\n")),
    }
}

/// The curve as CSV with a header: `x,y[,t][,pressure]`. Strokes are not marked: they read back as one.
pub fn to_csv(curve: &Curve) -> String {
    let mut out = String::from("x,y");
    out.push_str(if curve.seconds().is_some() { ",t" } else { "" });
    out.push_str(if curve.pressure().is_some() { ",pressure" } else { "" });
    out.push('\n');
    for (index, [x, y]) in curve.points().iter().enumerate() {
        // Writing to a string does not fail.
        let _ = write!(out, "{x},{y}");
        for value in
            [value_at(curve.seconds(), index), value_at(curve.pressure(), index)].into_iter().flatten()
        {
            let _ = write!(out, ",{value}");
        }
        out.push('\n');
    }
    out
}

/// The curve as a picture: one black line for each stroke, moved and scaled to fit 1000 pixels, y down as SVG has it.
///
/// Its shape reads back; its position, scale, pen time and pressure do not. The text holds numbers only.
pub fn to_svg(curve: &Curve) -> String {
    let bounds = curve.bounds();
    let [width, height] = bounds.size();
    let longer = width.max(height);
    let fit = |value: f64| if longer > 0.0 { value / longer * SVG_SIDE } else { 0.0 };
    let (page_width, page_height) = (fit(width) + 2.0 * SVG_MARGIN, fit(height) + 2.0 * SVG_MARGIN);
    // Single precision is what readers of SVG keep.
    let place = |point: &[f64; 2]| {
        let (x, y) = (fit(point[0] - bounds.min[0]), fit(bounds.max[1] - point[1]));
        ((x + SVG_MARGIN) as f32, (y + SVG_MARGIN) as f32)
    };
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {page_width} {page_height}\" fill=\"none\" \
         stroke=\"black\" stroke-width=\"6\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n"
    );
    for stroke in curve.strokes() {
        let mut points = stroke.iter().map(place);
        if let Some((x, y)) = points.next() {
            let _ = write!(out, "<path d=\"M{x} {y}");
            if stroke.len() == 1 {
                out.push_str("h0");
            }
            for (x, y) in points {
                let _ = write!(out, " L{x} {y}");
            }
            out.push_str("\"/>\n");
        }
    }
    out.push_str("</svg>\n");
    out
}

fn json_point(curve: &Curve, index: usize) -> String {
    let [x, y] = curve.points().get(index).copied().unwrap_or_default();
    let (seconds, pressure) = (value_at(curve.seconds(), index), value_at(curve.pressure(), index));
    match (seconds, pressure) {
        (None, None) => format!("[{x},{y}]"),
        (Some(t), None) => format!("[{x},{y},{t}]"),
        (None, Some(pressure)) => format!("{{\"x\":{x},\"y\":{y},\"pressure\":{pressure}}}"),
        (Some(t), Some(pressure)) => format!("{{\"x\":{x},\"y\":{y},\"t\":{t},\"pressure\":{pressure}}}"),
    }
}

fn value_at(values: Option<&[f64]>, index: usize) -> Option<f64> {
    values.and_then(|values| values.get(index).copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_strokes() -> Curve {
        let curve = Curve::from_strokes([vec![[0.0, 0.0], [0.1, 0.5]], vec![[2.0, -1.0]]]).unwrap();
        curve.with_seconds(vec![0.0, 0.25, 1.0]).unwrap()
    }

    #[test]
    fn the_texts_are_plain() {
        assert_eq!(to_json(&two_strokes()), "{\"strokes\":[[[0,0,0],[0.1,0.5,0.25]],\n[[2,-1,1]]]}\n");
        assert_eq!(to_csv(&two_strokes()), "x,y,t\n0,0,0\n0.1,0.5,0.25\n2,-1,1\n");
        let curve = Curve::new(vec![[1.0, 2.0]]).unwrap().with_pressure(vec![0.5]).unwrap();
        assert_eq!(to_json(&curve), "[{\"x\":1,\"y\":2,\"pressure\":0.5}]\n");
        assert_eq!(to_csv(&curve), "x,y,pressure\n1,2,0.5\n");
    }

    #[test]
    fn the_picture_is_upright_and_fits() {
        let svg = to_svg(&two_strokes());
        assert!(svg.contains("viewBox=\"0 0 1040 790\""), "{svg}");
        assert!(svg.contains("d=\"M20 270 L70 20\""), "{svg}");
        assert!(svg.contains("d=\"M1020 770h0\""), "{svg}");
    }
}
