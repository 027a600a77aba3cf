//! From positions to bone rotations and back, and everybody's motion on one body.

use super::facing::{Pose, root_rotations};
use super::{CHAINS, JOINTS, Joints, PARENTS, RAW_DIRECTIONS};
use crate::orientation::between;
use glam::{DQuat, DVec3, Vec3};

/// The bone that ends at each joint where nothing is turned, metres; zero at the pelvis.
pub type Offsets = Joints;

/// Joints whose bones make the length of a leg: the shin and the way from knee to ankle of the right leg.
const LEG: [usize; 2] = [5, 8];

/// The body of a pose: its bone lengths along the directions in which nothing is turned.
pub fn bone_lengths(pose: &Joints) -> Offsets {
    std::array::from_fn(|joint| RAW_DIRECTIONS[joint] * pose[joint].distance(pose[PARENTS[joint]]))
}

/// A motion on another body: bones keep their directions and get the lengths of `target`; the root's path is scaled
/// by the legs' ratio of the first frame. Empty for no frames.
pub fn uniform(frames: &[Joints], target: &Offsets) -> Vec<Joints> {
    let Some(first) = frames.first() else { return Vec::new() };
    let leg = |offsets: &Offsets| -> f64 {
        LEG.iter().map(|&joint| f64::from(offsets[joint].abs().max_element())).sum()
    };
    let own = leg(&bone_lengths(first));
    let scale = if own > 0.0 { leg(target) / own } else { 1.0 };
    let poses: Vec<Pose> = frames.iter().map(double).collect();
    let target = double(target);
    let turns = root_rotations(&poses, false);
    poses
        .iter()
        .zip(turns)
        .map(|(pose, root)| single(&assemble(&local_rotations(pose, root), &target, pose[0] * scale)))
        .collect()
}

/// Local rotations of all joints: the root's is given; every other is what its bone needs beyond those before it in
/// its chain, by the shortest way.
pub(super) fn local_rotations(pose: &Pose, root: DQuat) -> [DQuat; JOINTS] {
    let mut local = [DQuat::IDENTITY; JOINTS];
    local[0] = root;
    for chain in CHAINS {
        let mut accumulated = root;
        for pair in chain.windows(2) {
            let (parent, joint) = (pair[0], pair[1]);
            let bone = (pose[joint] - pose[parent]).normalize_or_zero();
            let world = between(RAW_DIRECTIONS[joint].as_dvec3(), bone);
            local[joint] = accumulated.conjugate() * world;
            accumulated *= local[joint];
        }
    }
    local
}

/// Positions from local rotations.
pub(super) fn assemble(local: &[DQuat; JOINTS], offsets: &Pose, root: DVec3) -> Pose {
    let mut pose = [root; JOINTS];
    for chain in CHAINS {
        let mut accumulated = local[0];
        for pair in chain.windows(2) {
            let (parent, joint) = (pair[0], pair[1]);
            accumulated *= local[joint];
            pose[joint] = pose[parent] + accumulated * offsets[joint];
        }
    }
    pose
}

pub(super) fn double(joints: &Joints) -> Pose {
    joints.map(Vec3::as_dvec3)
}

pub(super) fn single(pose: &Pose) -> Joints {
    pose.map(DVec3::as_vec3)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A person who stands with arms down.
    fn standing() -> Joints {
        let mut pose = [Vec3::new(0.0, 0.9, 0.0); JOINTS];
        for joint in 1..JOINTS {
            let direction = match joint {
                16..=21 => RAW_DIRECTIONS[joint] + 0.1 * Vec3::X,
                _ => RAW_DIRECTIONS[joint],
            };
            pose[joint] = pose[PARENTS[joint]] + 0.2 * direction.normalize();
        }
        pose
    }

    #[test]
    fn ones_own_body_changes_nothing() {
        let pose = standing();
        let same = uniform(&[pose, pose], &bone_lengths(&pose));
        for (a, b) in same[1].iter().zip(&pose) {
            assert!(a.distance(*b) < 1e-6, "{a} {b}");
        }
    }

    #[test]
    fn another_body_keeps_directions_and_gets_its_lengths() {
        let pose = standing();
        let target = bone_lengths(&pose).map(|offset| 2.0 * offset);
        let large = uniform(&[pose], &target);
        for joint in 1..JOINTS {
            let bone = large[0][joint] - large[0][PARENTS[joint]];
            assert!((bone.length() - 0.4).abs() < 1e-6);
            assert!((pose[joint] - pose[PARENTS[joint]]).angle_between(bone) < 1e-3);
        }
        assert!((large[0][0].y - 1.8).abs() < 1e-6);
    }
}
