//! The bones of a person in VRM and VRMA files.

use super::document::Document;

/// Which joint is which bone of a person.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct HumanBone {
    /// One of [`HUMAN_BONES`].
    pub name: &'static str,
    /// Index of the joint in the skeleton.
    pub joint: usize,
}

/// The bones of VRM 1.0 by name, parents before children.
#[rustfmt::skip]
pub const HUMAN_BONES: [&str; 55] = [
    "hips", "spine", "chest", "upperChest", "neck", "head", "leftEye", "rightEye", "jaw",
    "leftUpperLeg", "leftLowerLeg", "leftFoot", "leftToes",
    "rightUpperLeg", "rightLowerLeg", "rightFoot", "rightToes",
    "leftShoulder", "leftUpperArm", "leftLowerArm", "leftHand",
    "rightShoulder", "rightUpperArm", "rightLowerArm", "rightHand",
    "leftThumbMetacarpal", "leftThumbProximal", "leftThumbDistal",
    "leftIndexProximal", "leftIndexIntermediate", "leftIndexDistal",
    "leftMiddleProximal", "leftMiddleIntermediate", "leftMiddleDistal",
    "leftRingProximal", "leftRingIntermediate", "leftRingDistal",
    "leftLittleProximal", "leftLittleIntermediate", "leftLittleDistal",
    "rightThumbMetacarpal", "rightThumbProximal", "rightThumbDistal",
    "rightIndexProximal", "rightIndexIntermediate", "rightIndexDistal",
    "rightMiddleProximal", "rightMiddleIntermediate", "rightMiddleDistal",
    "rightRingProximal", "rightRingIntermediate", "rightRingDistal",
    "rightLittleProximal", "rightLittleIntermediate", "rightLittleDistal",
];

/// The nodes of the bones, in the order of [`HUMAN_BONES`]. Names that VRM does not know, and bones without a node,
/// are left out; of a bone given twice the first counts.
pub(super) fn nodes(document: &Document) -> Vec<(&'static str, u32)> {
    let extensions = &document.extensions;
    let mut found: Vec<(&str, u32)> = Vec::new();
    for vrm in [&extensions.vrm1, &extensions.vrm_animation].into_iter().flatten() {
        let bones = vrm.humanoid.as_ref().and_then(|humanoid| humanoid.human_bones.as_ref());
        let bones = bones.map_or(&[][..], |bones| bones.0.as_slice());
        found.extend(bones.iter().filter_map(|(name, bone)| Some((name.as_str(), bone.node?))));
    }
    let old = extensions.vrm0.as_ref().and_then(|vrm| vrm.humanoid.as_ref());
    for bone in old.map_or(&[][..], |humanoid| humanoid.human_bones.0.as_slice()) {
        if let Ok(node) = u32::try_from(bone.node) {
            found.push((name_of_vrm0(&bone.bone), node));
        }
    }
    let node_of = |name: &str| found.iter().find(|(other, _)| *other == name).map(|(_, node)| *node);
    HUMAN_BONES.into_iter().filter_map(|name| Some((name, node_of(name)?))).collect()
}

/// VRM 0.x counts the bones of the thumb from the first one beyond the wrist.
fn name_of_vrm0(name: &str) -> &str {
    match name {
        "leftThumbProximal" => "leftThumbMetacarpal",
        "leftThumbIntermediate" => "leftThumbProximal",
        "rightThumbProximal" => "rightThumbMetacarpal",
        "rightThumbIntermediate" => "rightThumbProximal",
        other => other,
    }
}
