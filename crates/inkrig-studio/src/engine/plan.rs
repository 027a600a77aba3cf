//! The plan of a result as a picture over the time of the result and the frames of the clips.

use super::SourceMap;
use inkrig_align::Alignment;
use inkrig_transport::Plan;

const PLAN_MAGIC: u32 = u32::from_le_bytes(*b"IKM1");

/// Which source patches each control patch is made of, and where the middles of patches are.
#[derive(Debug)]
pub struct PlacedPlan {
    plan: Plan<f32>,
    rows: Places,
    columns: Places,
}

/// Where patches are, 0..1 of what is shown.
#[derive(Debug)]
struct Places {
    /// Rising, each with the number of its patch.
    order: Vec<(f64, usize)>,
    /// Half a patch: so far the first and the last reach beyond their middles.
    reach: f64,
}

impl PlacedPlan {
    /// Of a finished alignment. All frames of the clips are shown, those too that are not arranged.
    pub(crate) fn of(alignment: &Alignment, map: &SourceMap, patch: usize) -> Self {
        let samples = alignment.report.control_frames.max(1) as f64;
        let frames = map.frames().max(1) as f64;
        let rows = alignment.plan_rows.iter().map(|&row| (row as f64 + 0.5) / samples);
        let columns = alignment.plan_columns.iter().map(|moment| {
            let frame = map.counted_through(moment.frame).unwrap_or(0);
            (frame as f64 + 0.5) / frames
        });
        Self {
            plan: alignment.plan.clone(),
            rows: Places::new(rows, patch),
            columns: Places::new(columns, patch),
        }
    }

    /// The picture: columns are the time of the result, rows frames of the clips, the first at the top; a byte each, 255 is
    /// the largest entry.
    pub fn encode(&self, width: usize, height: usize) -> Vec<u8> {
        let (across, down) = (self.rows.pixels(width), self.columns.pixels(height));
        let mut values = vec![0.0f32; width * height];
        let mut line = vec![0.0f32; self.plan.cols()];
        for (x, patches) in across.iter().enumerate() {
            for &(_, row) in *patches {
                self.plan.row_into(row, &mut line);
                for (y, patches) in down.iter().enumerate() {
                    let entries = patches.iter().filter_map(|&(_, column)| line.get(column));
                    if let Some(value) = values.get_mut(y * width + x) {
                        *value = entries.fold(*value, |most, &entry| most.max(entry));
                    }
                }
            }
        }
        let peak = values.iter().fold(f32::MIN_POSITIVE, |peak, &value| peak.max(value));
        let mut out = Vec::with_capacity(16 + width * height);
        for value in [PLAN_MAGIC, width as u32, height as u32, 0] {
            out.extend(value.to_le_bytes());
        }
        out.extend(values.iter().map(|value| (value / peak * 255.0).round() as u8));
        out
    }
}

impl Places {
    fn new(places: impl Iterator<Item = f64>, patch: usize) -> Self {
        let mut order: Vec<(f64, usize)> = places.enumerate().map(|(index, place)| (place, index)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let steps = order.windows(2).map(|pair| pair[1].0 - pair[0].0).filter(|step| *step > 0.0);
        let step = steps.fold(f64::INFINITY, f64::min);
        Self { order, reach: if step.is_finite() { (patch / 2 + 1) as f64 * step } else { 1.0 } }
    }

    /// For each pixel of a side the patches whose middles it covers, else the nearest within reach.
    fn pixels(&self, count: usize) -> Vec<&[(f64, usize)]> {
        let before = |place: f64| self.order.partition_point(|(at, _)| *at < place);
        (0..count)
            .map(|pixel| {
                let side = |pixel: usize| pixel as f64 / count as f64;
                let (from, to) = (before(side(pixel)), before(side(pixel + 1)));
                if from < to {
                    return self.order.get(from..to).unwrap_or_default();
                }
                let middle = (pixel as f64 + 0.5) / count as f64;
                let apart = |index: usize| self.order.get(index).map(|(at, _)| ((at - middle).abs(), index));
                let near = [from.checked_sub(1).and_then(apart), apart(from)].into_iter().flatten();
                match near.min_by(|a, b| a.0.total_cmp(&b.0)) {
                    Some((far, index)) if far <= self.reach => {
                        self.order.get(index..=index).unwrap_or_default()
                    }
                    _ => &[],
                }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_transport::Mat;

    fn picture(rows: &[f64], columns: &[f64], (width, height): (usize, usize)) -> Vec<u8> {
        let values = Mat::from_fn(rows.len(), columns.len(), |row, column| f32::from(row == column));
        let places = |of: &[f64]| Places::new(of.iter().copied(), 2);
        let plan = PlacedPlan { plan: Plan::from_mat(values), rows: places(rows), columns: places(columns) };
        let bytes = plan.encode(width, height);
        assert_eq!(bytes[..4], *b"IKM1");
        bytes[16..].to_vec()
    }

    #[test]
    fn patches_are_where_their_middles_are() {
        // Time goes to the right, the clip downward.
        assert_eq!(picture(&[0.25, 0.75], &[0.25, 0.75], (2, 2)), [255, 0, 0, 255]);
        // The first half of the clip is not used; a ring's first patch stands at its end.
        let late = picture(&[0.75, 0.25], &[0.8, 0.9], (2, 4));
        assert_eq!(late, [0, 0, 0, 0, 0, 255, 255, 255]);
    }

    #[test]
    fn pixels_between_middles_show_the_nearest_and_none_far_away() {
        let wide = picture(&[0.125, 0.375], &[0.5], (8, 1));
        assert_eq!(wide[..4], [255, 255, 0, 0]);
        let places = Places::new([0.1, 0.2].into_iter(), 2);
        assert!(places.pixels(10)[9].is_empty());
    }
}
