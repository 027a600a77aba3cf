//! Where the body faces, and rotations between directions.

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

/// The shortest rotation from one direction to another. A half turn goes about y, or about x for vertical ones.
pub(super) fn between(from: DVec3, to: DVec3) -> DQuat {
    let axis = from.cross(to);
    let w = (from.length_squared() * to.length_squared()).sqrt() + from.dot(to);
    let rotation = DQuat::from_xyzw(axis.x, axis.y, axis.z, w);
    if rotation.length_squared() > 1e-16 {
        return rotation.normalize();
    }
    if from == DVec3::ZERO || to == DVec3::ZERO {
        return DQuat::IDENTITY;
    }
    let about = if from.x.abs() + from.z.abs() > 1e-6 * from.y.abs() { DVec3::Y } else { DVec3::X };
    let about = about.reject_from_normalized(from.normalize()).normalize_or(DVec3::X);
    DQuat::from_axis_angle(about, std::f64::consts::PI)
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
    fn the_shortest_rotation_takes_one_direction_to_the_other() {
        let directions =
            [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::new(1.0, 2.0, -3.0).normalize()];
        for from in directions {
            for to in directions {
                assert!((between(from, to) * from).distance(to) < 1e-9, "{from} to {to}");
            }
        }
        assert_eq!(between(DVec3::ZERO, DVec3::X), DQuat::IDENTITY);
    }

    #[test]
    fn what_does_not_change_stays_under_smoothing() {
        for direction in smoothed(&[DVec3::X; 7]) {
            assert!(direction.distance(DVec3::X) < 1e-12);
        }
    }
}
