//! The 22 joints, in the order of the SMPL body.

use crate::MotionError;
use glam::Vec3;

/// How many joints the body has.
pub const JOINTS: usize = 22;

/// Positions of all joints at one frame, world axes, metres, y up.
pub type Joints = [Vec3; JOINTS];

/// Names of the joints, in order.
pub const NAMES: [&str; JOINTS] = [
    "pelvis",
    "left_hip",
    "right_hip",
    "spine1",
    "left_knee",
    "right_knee",
    "spine2",
    "left_ankle",
    "right_ankle",
    "spine3",
    "left_foot",
    "right_foot",
    "neck",
    "left_collar",
    "right_collar",
    "head",
    "left_shoulder",
    "right_shoulder",
    "left_elbow",
    "right_elbow",
    "left_wrist",
    "right_wrist",
];

/// The parent of every joint; the pelvis is its own.
pub const PARENTS: [usize; JOINTS] =
    [0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19];

/// The chains that rotations accumulate along. The arms begin at the third spine joint, but their rotations begin
/// at the root again.
pub const CHAINS: [&[usize]; 5] =
    [&[0, 2, 5, 8, 11], &[0, 1, 4, 7, 10], &[0, 3, 6, 9, 12, 15], &[9, 14, 17, 19, 21], &[9, 13, 16, 18, 20]];

/// The direction of the bone that ends at each joint, where no joint is turned; zero at the pelvis.
pub const RAW_DIRECTIONS: Joints = [
    Vec3::ZERO,
    Vec3::X,
    Vec3::NEG_X,
    Vec3::Y,
    Vec3::NEG_Y,
    Vec3::NEG_Y,
    Vec3::Y,
    Vec3::NEG_Y,
    Vec3::NEG_Y,
    Vec3::Y,
    Vec3::Z,
    Vec3::Z,
    Vec3::Y,
    Vec3::X,
    Vec3::NEG_X,
    Vec3::Z,
    Vec3::NEG_Y,
    Vec3::NEG_Y,
    Vec3::NEG_Y,
    Vec3::NEG_Y,
    Vec3::NEG_Y,
    Vec3::NEG_Y,
];

/// Joints of the left side, each with its partner on the right.
const SIDES: [(usize, usize); 8] = [(1, 2), (4, 5), (7, 8), (10, 11), (13, 14), (16, 17), (18, 19), (20, 21)];

/// The same motion by a left-handed person: x turned round, left and right exchanged. Its own inverse.
pub fn mirror(frames: &[Joints]) -> Vec<Joints> {
    let flipped = |joints: &Joints| {
        let mut out = joints.map(|place| Vec3::new(-place.x, place.y, place.z));
        for (left, right) in SIDES {
            out.swap(left, right);
        }
        out
    };
    frames.iter().map(flipped).collect()
}

/// Refuses positions that are no numbers.
pub(super) fn check(frames: &[Joints]) -> Result<(), MotionError> {
    for (frame, joints) in frames.iter().enumerate() {
        if let Some(joint) = joints.iter().position(|place| !place.is_finite()) {
            return Err(MotionError::NotFinite { what: "a position", joint, frame });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_follow_parents_and_reach_every_joint() {
        let mut reached = [false; JOINTS];
        for chain in CHAINS {
            for pair in chain.windows(2) {
                assert_eq!(PARENTS[pair[1]], pair[0]);
                reached[pair[1]] = true;
            }
        }
        assert_eq!(reached.iter().filter(|reached| **reached).count(), JOINTS - 1);
    }

    #[test]
    fn sides_are_named_alike() {
        for (left, right) in SIDES {
            assert_eq!(NAMES[left].strip_prefix("left"), NAMES[right].strip_prefix("right"));
            assert_ne!(NAMES[left], NAMES[right]);
        }
        let frame: Joints = std::array::from_fn(|joint| Vec3::new(joint as f32, 1.0, 2.0));
        let mirrored = mirror(&[frame]);
        assert_eq!(mirrored[0][1], Vec3::new(-2.0, 1.0, 2.0));
        assert_eq!(mirror(&mirrored), [frame]);
    }
}
