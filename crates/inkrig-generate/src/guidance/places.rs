//! Places of joints from normalised features, and the way back for gradients.

use crate::GenerateError;
use inkrig_motion::humanml::{Blocks, JOINTS, Statistics, WIDTH};

/// Numbers of a frame's places.
const PLACES: usize = 3 * JOINTS;

/// The 22 joints of every frame, metres, with what the gradient needs.
#[derive(Debug, Clone, Default)]
pub(crate) struct Places {
    /// Frames x 66.
    pub(crate) joints: Vec<f64>,
    /// Features as they are, not normalised.
    features: Vec<f64>,
    /// Sine and cosine of the heading of each frame.
    headings: Vec<[f64; 2]>,
}

impl Places {
    /// As [`inkrig_motion::humanml::recover_positions`], which takes no gradients.
    pub(crate) fn recover(
        &mut self,
        normalised: &[f32],
        statistics: &Statistics,
    ) -> Result<(), GenerateError> {
        let (mean, deviation) = (statistics.mean(), statistics.deviation());
        if mean.len() != WIDTH {
            let (what, got) = ("statistics of features", mean.len());
            return Err(GenerateError::Length { what, expected: WIDTH, got });
        }
        self.features.clear();
        self.headings.clear();
        self.joints.clear();
        for row in normalised.chunks_exact(WIDTH) {
            let columns = row.iter().zip(mean).zip(deviation);
            let restored = columns.map(|((x, mean), deviation)| f64::from(x * deviation + mean));
            self.features.extend(restored);
        }
        let (mut half_angle, mut x, mut z) = (0.0, 0.0, 0.0);
        let mut before: Option<&[f64]> = None;
        for row in self.features.chunks_exact(WIDTH) {
            if let Some(before) = before {
                half_angle += before[Blocks::YAW];
            }
            let heading: [f64; 2] = (2.0_f64 * half_angle).sin_cos().into();
            if let Some(before) = before {
                let moved = turn([before[1], before[2]], heading);
                x += moved[0];
                z += moved[1];
            }
            self.headings.push(heading);
            self.joints.extend([x, row[Blocks::HEIGHT], z]);
            for local in row[Blocks::PLACES].chunks_exact(3) {
                let turned = turn([local[0], local[2]], heading);
                self.joints.extend([turned[0] + x, local[1], turned[1] + z]);
            }
            before = Some(row);
        }
        Ok(())
    }

    /// From the gradient of the places, frames x 66, to that of the normalised features, frames x [`WIDTH`].
    pub(crate) fn gradient(&self, of_joints: &[f64], statistics: &Statistics, out: &mut Vec<f32>) {
        let frames = self.headings.len();
        let mut grads = vec![0.0; frames * WIDTH];
        // What later frames ask of the root, and of the heading.
        let (mut root, mut angle) = ([0.0; 2], 0.0);
        for frame in (0..frames).rev() {
            let heading = self.headings[frame];
            let of_joints = &of_joints[frame * PLACES..][..PLACES];
            let row = frame * WIDTH;
            grads[row + Blocks::HEIGHT] = of_joints[1];
            root = [root[0] + of_joints[0], root[1] + of_joints[2]];
            for (joint, of) in of_joints.chunks_exact(3).skip(1).enumerate() {
                let at = row + Blocks::PLACES.start + 3 * joint;
                let grad = [of[0], of[2]];
                let local = [self.features[at], self.features[at + 2]];
                let back = turn_back(grad, heading);
                (grads[at], grads[at + 1], grads[at + 2]) = (back[0], of[1], back[1]);
                angle += by_angle(local, heading, grad);
                root = [root[0] + of[0], root[1] + of[2]];
            }
            if let Some(before) = frame.checked_sub(1) {
                let at = before * WIDTH;
                let moved = [self.features[at + 1], self.features[at + 2]];
                let back = turn_back(root, heading);
                (grads[at + 1], grads[at + 2]) = (back[0], back[1]);
                angle += by_angle(moved, heading, root);
                grads[at + Blocks::YAW] = 2.0 * angle;
            }
        }
        out.clear();
        for row in grads.chunks_exact(WIDTH) {
            let scaled = row.iter().zip(statistics.deviation());
            out.extend(scaled.map(|(grad, deviation)| (grad * f64::from(*deviation)) as f32));
        }
    }
}

/// From the facing frame to the world, x and z.
fn turn([x, z]: [f64; 2], [sin, cos]: [f64; 2]) -> [f64; 2] {
    [x * cos - z * sin, x * sin + z * cos]
}

fn turn_back([x, z]: [f64; 2], [sin, cos]: [f64; 2]) -> [f64; 2] {
    [x * cos + z * sin, z * cos - x * sin]
}

/// How the product of `grad` with the turned vector changes with the angle.
fn by_angle([x, z]: [f64; 2], [sin, cos]: [f64; 2], grad: [f64; 2]) -> f64 {
    grad[0] * (-x * sin - z * cos) + grad[1] * (x * cos - z * sin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::Noise;
    use inkrig_motion::Features;
    use inkrig_motion::humanml::recover_positions;

    fn statistics() -> Statistics {
        let deviation = Noise::new(9).normals(WIDTH).iter().map(|x| 0.1 + x.abs()).collect();
        Statistics::new(Noise::new(8).normals(WIDTH).iter().map(|x| 0.1 * x).collect(), deviation).unwrap()
    }

    #[test]
    fn places_are_those_of_the_form_and_the_gradient_is_a_difference() {
        let statistics = statistics();
        let normalised: Vec<f32> = Noise::new(1).normals(9 * WIDTH).iter().map(|x| 0.3 * x).collect();
        let mut places = Places::default();
        places.recover(&normalised, &statistics).unwrap();
        let mut plain = normalised.clone();
        statistics.restore(&mut plain);
        let expected = recover_positions(&Features::new(plain, WIDTH).unwrap()).unwrap();
        for (got, expected) in places.joints.chunks_exact(3).zip(expected.iter().flatten()) {
            assert!((0..3).all(|axis| (got[axis] - f64::from(expected[axis])).abs() < 1e-5));
        }
        let way: Vec<f64> = Noise::new(2).normals(9 * 66).iter().map(|x| f64::from(*x)).collect();
        let mut grad = Vec::new();
        places.gradient(&way, &statistics, &mut grad);
        let value = |normalised: &[f32]| {
            let mut places = Places::default();
            places.recover(normalised, &statistics).unwrap();
            places.joints.iter().zip(&way).map(|(a, b)| a * b).sum::<f64>()
        };
        for frame in [0, 4, 8] {
            for column in [0, 1, 2, 3, 4, 40, 66, 100] {
                let at = frame * WIDTH + column;
                let (mut more, mut less) = (normalised.clone(), normalised.clone());
                more[at] += 1e-3;
                less[at] -= 1e-3;
                let slope = (value(&more) - value(&less)) / f64::from(more[at] - less[at]);
                let got = f64::from(grad[at]);
                assert!((slope - got).abs() < 1e-3 * (1.0 + got.abs()), "{frame} {column}: {slope} {got}");
            }
        }
    }
}
