//! A motion as a drawing: its frames along the two directions in which they vary most.

use inkrig_motion::Features;

/// Products after which an axis is found well enough to look at.
const ROUNDS: usize = 40;

/// The place of every frame on the two main axes of all; 0 along an axis that is not there.
pub(crate) fn main_axes(features: &Features) -> Vec<[f64; 2]> {
    let (frames, width) = (features.frames(), features.width());
    let mut mean = vec![0.0_f64; width];
    for frame in 0..frames {
        mean.iter_mut()
            .zip(features.row(frame))
            .for_each(|(sum, value)| *sum += f64::from(*value) / frames as f64);
    }
    let mut rows: Vec<Vec<f64>> = (0..frames)
        .map(|frame| {
            features.row(frame).iter().zip(&mean).map(|(value, mean)| f64::from(*value) - mean).collect()
        })
        .collect();
    let mut places = vec![[0.0; 2]; frames];
    for axis in 0..2 {
        let along = direction(&rows, width);
        for (place, row) in places.iter_mut().zip(&mut rows) {
            place[axis] = dot(row, &along);
            row.iter_mut().zip(&along).for_each(|(value, part)| *value -= place[axis] * part);
        }
    }
    places
}

/// The direction of largest variance, by repeated products.
fn direction(rows: &[Vec<f64>], width: usize) -> Vec<f64> {
    // The longest row is not across it.
    let longest = rows.iter().max_by(|a, b| dot(a, a).total_cmp(&dot(b, b)));
    let mut along = longest.cloned().unwrap_or_else(|| vec![0.0; width]);
    for _ in 0..ROUNDS {
        let length = dot(&along, &along).sqrt();
        if length < 1e-12 {
            return vec![0.0; width];
        }
        along.iter_mut().for_each(|value| *value /= length);
        let mut next = vec![0.0; width];
        for row in rows {
            let part = dot(row, &along);
            next.iter_mut().zip(row).for_each(|(sum, value)| *sum += part * value);
        }
        along = next;
    }
    let length = dot(&along, &along).sqrt().max(f64::MIN_POSITIVE);
    along.iter().map(|value| value / length).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ellipse_in_many_dimensions_is_one() {
        // 3 across 1, turned within five dimensions.
        let row = |frame: u8| {
            let angle = f32::from(frame) * 0.1;
            let (a, b) = (3.0 * angle.cos(), angle.sin());
            [0.6 * a, 0.8 * a, 7.0, 0.28 * b, -0.96 * b]
        };
        let features = Features::new((0..63).flat_map(row).collect(), 5).unwrap();
        let places = main_axes(&features);
        let most = |axis: usize| places.iter().map(|place| place[axis].abs()).fold(0.0, f64::max);
        assert!((most(0) - 3.0).abs() < 0.05 && (most(1) - 1.0).abs() < 0.05, "{} {}", most(0), most(1));
        let still = Features::new(vec![1.0; 20], 2).unwrap();
        assert!(main_axes(&still).iter().all(|place| *place == [0.0, 0.0]));
    }
}
