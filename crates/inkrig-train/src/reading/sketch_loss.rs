//! What the reader of sketches is taught by.

use crate::figures::Picture;
use inkrig_generate::readers::sketch::{CELLS, KEY_POINTS, SIDE};

/// How far the truth spreads on a heat map, cells: two pixels, less than a tenth of the torso of a small figure.
const SPREAD: f32 = 0.5;
/// How much presence counts beside places.
const PRESENCE: f32 = 0.2;

/// The loss of one picture, and its gradients with respect to heat maps and presence.
#[derive(Debug, Clone, Default)]
pub(super) struct Loss {
    pub loss: f64,
    pub heat: Vec<f32>,
    pub presence: Vec<f32>,
}

impl Loss {
    /// Cross entropy between each map's shares and a bell at the place, for what is drawn; that of whether it is drawn, for all.
    pub(super) fn of(&mut self, picture: &Picture, heat: &[f32], presence: &[f32]) {
        self.loss = 0.0;
        self.heat.clear();
        self.heat.resize(heat.len(), 0.0);
        self.presence.clear();
        let (cell, share) = ((SIDE / CELLS) as f32, 1.0 / KEY_POINTS as f32);
        let mut most = [f32::NEG_INFINITY; KEY_POINTS];
        for row in heat.chunks_exact(KEY_POINTS) {
            most.iter_mut().zip(row).for_each(|(most, number)| *most = most.max(*number));
        }
        let mut sums = [0.0_f32; KEY_POINTS];
        for (row, out) in heat.chunks_exact(KEY_POINTS).zip(self.heat.chunks_exact_mut(KEY_POINTS)) {
            for (((sum, out), number), most) in sums.iter_mut().zip(out).zip(row).zip(most) {
                *out = (number - most).exp();
                *sum += *out;
            }
        }
        let weights: [f32; KEY_POINTS] =
            std::array::from_fn(|point| if picture.drawn[point] { share * hardness(point) } else { 0.0 });
        for out in self.heat.chunks_exact_mut(KEY_POINTS) {
            for ((out, sum), weight) in out.iter_mut().zip(sums).zip(weights) {
                *out *= weight / sum;
            }
        }
        for point in 0..KEY_POINTS {
            let logit = presence[point];
            let likely = 1.0 / (1.0 + (-logit).exp());
            let truth = f32::from(u8::from(picture.drawn[point]));
            self.presence.push(PRESENCE * share * (likely - truth));
            let plain = logit.max(0.0) - logit * truth + (1.0 + (-logit.abs()).exp()).ln();
            self.loss += f64::from(PRESENCE * share * plain);
            if !picture.drawn[point] {
                continue;
            }
            let bell = Bell::new(picture.places[point].map(|along| along / cell - 0.5));
            let all = most[point] + sums[point].ln();
            bell.each(|at, part| {
                let at = at * KEY_POINTS + point;
                self.heat[at] -= weights[point] * part;
                self.loss += f64::from(weights[point] * part * (all - heat[at]));
            });
        }
    }
}

/// Ends of limbs are hard, and matter.
fn hardness(point: usize) -> f32 {
    if matches!(point, 6..=9 | 14..=17) { 1.5 } else { 1.0 }
}

/// A bell whose numbers add up to 1.
struct Bell {
    rows: [(usize, f32); 9],
    columns: [(usize, f32); 9],
}

impl Bell {
    fn new(middle: [f32; 2]) -> Self {
        let along = |middle: f32| {
            let nearest = middle.clamp(0.0, (CELLS - 1) as f32).round();
            let mut parts: [(usize, f32); 9] = std::array::from_fn(|at| {
                let place = nearest + at as f32 - 4.0;
                let inside = (0.0..CELLS as f32).contains(&place);
                let off = (place - middle.clamp(0.0, (CELLS - 1) as f32)) / SPREAD;
                if inside { (place as usize, (-0.5 * off * off).exp()) } else { (0, 0.0) }
            });
            let sum: f32 = parts.iter().map(|(_, part)| part).sum();
            parts.iter_mut().for_each(|(_, part)| *part /= sum);
            parts
        };
        Self { rows: along(middle[1]), columns: along(middle[0]) }
    }

    fn each(&self, mut part: impl FnMut(usize, f32)) {
        for (row, high) in self.rows {
            for (column, wide) in self.columns {
                if high * wide > 1e-5 {
                    part(row * CELLS + column, high * wide);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_generate::readers::ink::Ink;
    use inkrig_generate::schedule::Noise;

    #[test]
    fn gradients_are_differences() {
        let mut picture = Picture {
            ink: Ink::new(1, 1),
            places: std::array::from_fn(|point| [20.0 + 6.0 * point as f32, 150.0 - 5.5 * point as f32]),
            captured: [[0.0; 2]; KEY_POINTS],
            drawn: [true; KEY_POINTS],
            torso: 30.0,
        };
        picture.drawn[3] = false;
        picture.places[5] = [-3.0, 170.0];
        let heat = Noise::new(1).normals(CELLS * CELLS * KEY_POINTS);
        let presence = Noise::new(2).normals(KEY_POINTS);
        let mut loss = Loss::default();
        loss.of(&picture, &heat, &presence);
        let whole = loss.clone();
        assert!(whole.heat.iter().skip(3).step_by(KEY_POINTS).all(|part| *part == 0.0));
        let mut slope = |heat: &[f32], presence: &[f32]| {
            loss.of(&picture, heat, presence);
            loss.loss
        };
        let hottest = |point: usize| {
            let own = |at: &usize| whole.heat[at * KEY_POINTS + point];
            let cell = (0..CELLS * CELLS).min_by(|a, b| own(a).total_cmp(&own(b))).unwrap_or(0);
            cell * KEY_POINTS + point
        };
        for at in [hottest(0), hottest(5), hottest(9), 700] {
            let nudged = |by: f32| {
                let mut heat = heat.clone();
                heat[at] += by;
                heat
            };
            let difference = (slope(&nudged(0.05), &presence) - slope(&nudged(-0.05), &presence)) / 0.1;
            assert!(
                (difference - f64::from(whole.heat[at])).abs() < 1e-4,
                "{at}: {difference} {}",
                whole.heat[at]
            );
        }
        for at in [0, 3] {
            let nudged = |by: f32| {
                let mut presence = presence.clone();
                presence[at] += by;
                presence
            };
            let difference = (slope(&heat, &nudged(0.05)) - slope(&heat, &nudged(-0.05))) / 0.1;
            assert!((difference - f64::from(whole.presence[at])).abs() < 1e-4);
        }
    }
}
