//! Joints that are no part of the body: what steers others in the program that a character was made in.

use super::words::split;
use crate::Skeleton;

/// Words in the name of a joint that steers others.
const STEERS: [&str; 6] = ["pole", "target", "ctrl", "control", "effector", "vector"];

/// Which joints only steer others: pole targets, handles of inverse kinematics, by name; and all that hangs on them. A
/// handle without a parent that carries joints of its own is kept: in some characters feet hang on it. All false where
/// nothing else would be left.
pub fn controls(skeleton: &Skeleton) -> Vec<bool> {
    let joints = skeleton.joints();
    let mut carries = vec![false; joints.len()];
    for joint in joints.iter().filter(|joint| !joint.end_site) {
        if let Some(parent) = joint.parent {
            carries[parent] = true;
        }
    }
    let mut found: Vec<bool> = Vec::with_capacity(joints.len());
    for (index, joint) in joints.iter().enumerate() {
        let words = split(&joint.name);
        let said = |word: &str| words.iter().any(|own| own == word);
        let handle = said("ik") && (joint.parent.is_some() || !carries[index]);
        let above = joint.parent.is_some_and(|parent| found[parent]);
        found.push(above || handle || STEERS.into_iter().any(said));
    }
    let left = joints.iter().zip(&found).any(|(joint, control)| !control && !joint.end_site);
    if left { found } else { vec![false; joints.len()] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Joint;
    use glam::Vec3;

    fn found(joints: &[(&str, Option<usize>)]) -> Vec<bool> {
        let joint = |&(name, parent): &(&str, _)| Joint::new(name, parent, Vec3::Y);
        controls(&Skeleton::new(joints.iter().map(joint).collect()).unwrap())
    }

    #[test]
    fn what_steers_is_told_from_what_is_steered() {
        let wolf = [
            ("Body", None),
            ("Back", Some(0)),
            ("PoleTarget.L", Some(0)),
            ("PoleTarget.L_end", Some(2)),
            ("IKFrontLeg.L", None),
            ("FF.L", Some(4)),
        ];
        assert_eq!(found(&wolf), [false, false, true, true, false, false]);
        let mannequin = [
            ("root", None),
            ("pelvis", Some(0)),
            ("ik_hand_root", Some(0)),
            ("hand_gun", Some(2)),
            ("ik_x", None),
        ];
        assert_eq!(found(&mannequin), [false, false, true, true, true]);
        assert_eq!(found(&[("Hips", None), ("Pike", Some(0))]), [false, false]);
        assert_eq!(found(&[("target", None), ("tip", Some(0))]), [false, false], "nothing else is there");
    }
}
