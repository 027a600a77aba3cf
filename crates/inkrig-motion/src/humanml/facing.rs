//! Where the body faces.

use crate::orientation::between;
use glam::{DQuat, DVec3};

/// Joints at one frame in double precision.
pub(super) type Pose = [DVec3; super::JOINTS];

/// Hips and shoulders, left and right.
const HIPS: (usize, usize) = (1, 2);
const SHOULDERS: (usize, usize) = (16, 17);

/// Standard deviation of the Gaussian that smooths the facing direction, frames.
const SIGMA: f64 = 20.0;

/// Which way across the hips is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Across {
    /// From left to right, as the shoulders.
    Plain,
    /// From right to left against the shoulders, as HumanML3D does while it makes features. The direction still
    /// follows the wider shoulders; it is kept so that features agree with those of published data and weights.
    HipsSwapped,
}

/// The direction that a body faces, on the ground: at most of unit length, shorter the more the body leans to its side,
/// zero when shoulders and hips say nothing.
pub(super) fn forward(pose: &Pose, across: Across) -> DVec3 {
    let side = |(left, right): (usize, usize)| pose[right] - pose[left];
    let hips = match across {
        Across::Plain => side(HIPS),
        Across::HipsSwapped => -side(HIPS),
    };
    DVec3::Y.cross((hips + side(SHOULDERS)).normalize_or_zero())
}

/// The root's rotations: each takes the facing direction of a frame, smoothed or not, to +z. The first is the identity.
pub(super) fn root_rotations(poses: &[Pose], smooth: bool) -> Vec<DQuat> {
    let directions: Vec<DVec3> = poses.iter().map(|pose| forward(pose, Across::HipsSwapped)).collect();
    let directions = if smooth { smoothed(&directions) } else { directions };
    let mut turns: Vec<DQuat> = directions.iter().map(|&direction| between(direction, DVec3::Z)).collect();
    if let Some(first) = turns.first_mut() {
        *first = DQuat::IDENTITY;
    }
    turns
}

/// A Gaussian over time, cut off at four standard deviations; beyond its ends the motion stays as it is there.
fn smoothed(directions: &[DVec3]) -> Vec<DVec3> {
    let reach = (4.0 * SIGMA + 0.5) as isize;
    let weights: Vec<f64> =
        (-reach..=reach).map(|offset| (-0.5 * (offset as f64 / SIGMA).powi(2)).exp()).collect();
    let total: f64 = weights.iter().sum();
    let last = directions.len() as isize - 1;
    (0..=last)
        .map(|frame| {
            let near = (-reach..=reach).zip(&weights);
            near.map(|(offset, weight)| {
                directions[(frame + offset).clamp(0, last) as usize] * (weight / total)
            })
            .sum()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_change_stays_under_smoothing() {
        for direction in smoothed(&[DVec3::X; 7]) {
            assert!(direction.distance(DVec3::X) < 1e-12);
        }
    }
}
