//! How a stroke goes into what is drawn.

use crate::StudioError;
use crate::document::{Control, CurveTiming, PenPoint};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// How a stroke goes into what is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum StrokeMode {
    /// It is the drawing.
    Draw,
    /// It is one stroke more.
    Add,
    /// It replaces the stretch of the drawing that it is nearest to.
    Redraw,
    /// It is the wave: points are seconds and values.
    Wave,
}

/// What is followed once a stroke is in it. Times of the stroke count from its own beginning.
///
/// # Errors
/// When there is no drawing to change.
pub fn with_stroke(
    control: Option<&Control>,
    points: &[PenPoint],
    mode: StrokeMode,
    timing: Option<CurveTiming>,
) -> Result<Control, StudioError> {
    if mode == StrokeMode::Wave {
        return Ok(Control::DrawnWave { points: wave(points) });
    }
    let (mut strokes, own, smooth) = match control {
        Some(Control::Curve { strokes, timing, smooth }) => (strokes.clone(), Some(*timing), *smooth),
        _ => (Vec::new(), None, None),
    };
    let timing = timing.or(own).unwrap_or_default();
    match mode {
        StrokeMode::Add => {
            let begin = strokes.last().and_then(|stroke| stroke.last()).and_then(|point| point.2);
            // The time while the pen is up counts for nothing.
            let begin = begin.unwrap_or(0.0);
            strokes.push(points.iter().map(|&(x, y, t, p)| (x, y, t.map(|t| t + begin), p)).collect());
        }
        StrokeMode::Redraw if !strokes.is_empty() => strokes = redrawn(&strokes, points),
        _ => strokes = vec![points.to_vec()],
    }
    Ok(Control::Curve { strokes, timing, smooth })
}

/// A stroke over a drawing: of the drawn stroke that it is nearest to, what lies between the points nearest to its ends is
/// replaced. Over-drawn against the drawing's direction, it is turned around. Where it takes less or more time, what follows
/// is moved.
fn redrawn(strokes: &[Vec<PenPoint>], points: &[PenPoint]) -> Vec<Vec<PenPoint>> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return strokes.to_vec() };
    let nearest = |to: &PenPoint, stroke: &[PenPoint]| {
        let distances = stroke.iter().map(|point| (point.0 - to.0).powi(2) + (point.1 - to.1).powi(2));
        distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::INFINITY))
    };
    let cost = |stroke: &Vec<PenPoint>| nearest(first, stroke).1 + nearest(last, stroke).1;
    let chosen = (0..strokes.len()).min_by(|&a, &b| cost(&strokes[a]).total_cmp(&cost(&strokes[b])));
    let Some(chosen) = chosen else { return strokes.to_vec() };
    let stroke = &strokes[chosen];
    let (begin, end) = (nearest(first, stroke).0, nearest(last, stroke).0);
    let (begin, end, drawn) =
        if begin <= end { (begin, end, points.to_vec()) } else { (end, begin, turned(points)) };
    let old = stroke.get(begin..=end).unwrap_or_default();
    let span = |of: &[PenPoint]| Some(of.last()?.2? - of.first()?.2?);
    let start = old.first().and_then(|point| point.2);
    let own = drawn.first().and_then(|point| point.2).unwrap_or(0.0);
    let shift = span(&drawn).zip(span(old)).map_or(0.0, |(new, old)| new - old);
    let later = |&(x, y, t, p): &PenPoint| (x, y, t.map(|t| t + shift), p);
    let mut out = strokes.to_vec();
    out[chosen] = (stroke.iter().take(begin).copied())
        .chain(drawn.iter().map(|&(x, y, t, p)| (x, y, start.zip(t).map(|(start, t)| start + t - own), p)))
        .chain(stroke.iter().skip(end + 1).map(later))
        .collect();
    for stroke in out.iter_mut().skip(chosen + 1) {
        stroke.iter_mut().for_each(|point| *point = later(point));
    }
    out
}

/// The same stroke from its end to its beginning, at the same speed.
fn turned(points: &[PenPoint]) -> Vec<PenPoint> {
    let end = points.last().and_then(|point| point.2).unwrap_or(0.0);
    points.iter().rev().map(|&(x, y, t, p)| (x, y, t.map(|t| end - t), p)).collect()
}

/// Values by rising time: where the pen goes back, it draws over what is there.
fn wave(points: &[PenPoint]) -> Vec<[f64; 2]> {
    let mut out: Vec<[f64; 2]> = Vec::with_capacity(points.len());
    for &(t, value, _, _) in points {
        while out.last().is_some_and(|last| last[0] >= t) {
            out.pop();
        }
        out.push([t, value]);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from: f64, to: f64, y: f64, seconds: f64) -> Vec<PenPoint> {
        (0..=10)
            .map(|i| f64::from(i) / 10.0)
            .map(|s| (from + s * (to - from), y, Some(s * seconds), Some(0.5)))
            .collect()
    }

    fn strokes(control: &Control) -> &[Vec<PenPoint>] {
        let Control::Curve { strokes, .. } = control else { panic!("no drawing") };
        strokes
    }

    #[test]
    fn a_redrawn_stretch_takes_its_own_time_and_the_rest_follows() {
        let control = with_stroke(None, &line(0.0, 10.0, 0.0, 2.0), StrokeMode::Draw, None).unwrap();
        let control =
            with_stroke(Some(&control), &line(3.0, 6.0, 1.0, 1.0), StrokeMode::Redraw, None).unwrap();
        let [stroke] = strokes(&control) else { panic!("one stroke") };
        assert_eq!(stroke.len(), 3 + 11 + 4);
        assert!(stroke.windows(2).all(|pair| pair[1].2 > pair[0].2), "{stroke:?}");
        assert_eq!((stroke[3].0, stroke[3].1), (3.0, 1.0));
        assert!((stroke[3].2.unwrap() - 0.6).abs() < 1e-12);
        assert!((stroke.last().unwrap().2.unwrap() - 2.4).abs() < 1e-12, "0.6 s became 1 s");
    }

    #[test]
    fn over_drawing_backwards_keeps_the_direction() {
        let control = with_stroke(None, &line(0.0, 10.0, 0.0, 2.0), StrokeMode::Draw, None).unwrap();
        let control =
            with_stroke(Some(&control), &line(6.0, 3.0, 1.0, 1.0), StrokeMode::Redraw, None).unwrap();
        let stroke = &strokes(&control)[0];
        assert!(stroke.windows(2).all(|pair| pair[1].0 > pair[0].0 && pair[1].2 > pair[0].2), "{stroke:?}");
    }

    #[test]
    fn strokes_share_a_clock() {
        let control = with_stroke(None, &line(0.0, 1.0, 0.0, 1.0), StrokeMode::Add, None).unwrap();
        let control = with_stroke(Some(&control), &line(1.0, 2.0, 0.0, 1.0), StrokeMode::Add, None).unwrap();
        assert_eq!(strokes(&control)[1][0].2, Some(1.0));
    }

    #[test]
    fn a_wave_is_drawn_over_where_the_pen_goes_back() {
        let points: Vec<PenPoint> =
            [0.0, 1.0, 2.0, 3.0, 1.5, 2.5].map(|t| (t, 10.0 * t, None, None)).to_vec();
        assert_eq!(wave(&points), [[0.0, 0.0], [1.0, 10.0], [1.5, 15.0], [2.5, 25.0]]);
    }
}
