//! VRMA: a motion of the bones of a person, for any VRM figure (VRMC_vrm_animation 1.0).

use super::{
    CLIP_NAME,
    animation::{NodeMotion, animation},
    document,
    parts::Parts,
    shortest,
};
use crate::{ExportOptions, Finding, FormatError, HUMAN_BONES, HumanBone, Written, gltf::container};
use inkrig_motion::{
    Clip, Skeleton,
    glam::{Quat, Vec3},
    kinematics::Pose,
    rig::{Humanoid, Part, Side},
};
use serde_json::{Map, Value, json};

/// Bones that every VRM has.
const REQUIRED: [&str; 15] = [
    "hips",
    "spine",
    "head",
    "leftUpperLeg",
    "leftLowerLeg",
    "leftFoot",
    "rightUpperLeg",
    "rightLowerLeg",
    "rightFoot",
    "leftUpperArm",
    "leftLowerArm",
    "leftHand",
    "rightUpperArm",
    "rightLowerArm",
    "rightHand",
];

/// Writes a clip as a VRMA file. [`ExportOptions::humanoid`] says which joints are the bones, or where it says none, the
/// joints' names and the body's build; other joints are left out.
///
/// By the rules of the format the figure rests in a T-pose that faces z with the lowest bone on the ground, only
/// the hips have translations, and eyes have none: what a clip has beyond that is left out, with a finding.
///
/// # Errors
/// [`FormatError::Write`] when a bone that every VRM has is not known, a joint stands beyond 1e12 m, or for keys with curves,
/// which are not written.
pub fn write_vrma(clip: &Clip, options: &ExportOptions) -> Result<Written, FormatError> {
    options.check_no_curves("VRMA")?;
    let bones = bones(clip, options)?;
    let rest = TPose::of(clip, &bones);
    let mut parts = Parts::default();
    let animation = animation(
        options.name.as_deref().unwrap_or(CLIP_NAME),
        clip.frame_rate(),
        &motions(clip, &bones),
        &mut parts,
    )?;
    let named = |(node, bone): (usize, &Bone)| (bone.name.to_string(), json!({ "node": node }));
    let human_bones: Map<String, Value> = bones.iter().enumerate().map(named).collect();
    let mut document = document(&rest.nodes(clip, &bones), &[0], &animation, &parts);
    document.insert("extensionsUsed".into(), json!(["VRMC_vrm_animation"]));
    let extension = json!({ "specVersion": "1.0", "humanoid": { "humanBones": human_bones } });
    document.insert("extensions".into(), json!({ "VRMC_vrm_animation": extension }));
    let bytes = container::glb(Value::Object(document).to_string().as_bytes(), &parts.bin)?;
    let hips = bones.first().map(|bone| bone.joint);
    let above = hips.map(|hips| clip.skeleton().ancestors(hips)).unwrap_or_default();
    let lost = |joint: usize| Some(joint) != hips && above.get(joint) != Some(&true);
    let count = clip.translations().iter().filter(|track| lost(track.joint)).count();
    let mut findings = Vec::new();
    if count > 0 {
        let message =
            format!("joints whose translation a VRMA cannot hold: {count}; only the hips keep theirs");
        findings.push(Finding::warning("vrma-translation", message));
    }
    Ok(Written { bytes, findings })
}

/// A bone that is written; its node has the same place as it in the list.
struct Bone {
    name: &'static str,
    joint: usize,
    /// Place of the nearest bone above.
    parent: Option<usize>,
}

fn bones(clip: &Clip, options: &ExportOptions) -> Result<Vec<Bone>, FormatError> {
    let joints = clip.skeleton().joints();
    let hint = "a VRMA needs a person whose bones are known: a VRM or VRMA file says them, else joints are found by names such as Hips and LeftUpLeg";
    let found = if options.humanoid.is_empty() { found_bones(clip.skeleton()) } else { Vec::new() };
    let humanoid = if options.humanoid.is_empty() { &found } else { &options.humanoid };
    let known = |name: &str| humanoid.iter().find(|bone| bone.name == name && bone.joint < joints.len());
    let missing: Vec<&str> = REQUIRED.into_iter().filter(|name| known(name).is_none()).collect();
    if !missing.is_empty() {
        let what = format!("bones that are not known: {}", missing.join(", "));
        return Err(FormatError::Write { what, hint: hint.into() });
    }
    let eye = |name: &str| name == "leftEye" || name == "rightEye";
    let mut bones: Vec<Bone> = (HUMAN_BONES.into_iter().filter(|name| !eye(name)))
        .filter_map(|name| Some(Bone { name, joint: known(name)?.joint, parent: None }))
        .collect();
    bones.sort_by_key(|bone| bone.joint);
    for place in 0..bones.len() {
        let mut above = bones.get(place).and_then(|bone| joints.get(bone.joint)?.parent);
        let mut parent = None;
        while let (Some(joint), None) = (above, parent) {
            parent = bones.iter().position(|bone| bone.joint == joint);
            above = joints.get(joint).and_then(|joint| joint.parent);
        }
        if let Some(bone) = bones.get_mut(place) {
            bone.parent = parent;
        }
    }
    let roots = bones.iter().filter(|bone| bone.parent.is_none()).map(|bone| bone.name);
    match roots.collect::<Vec<_>>().as_slice() {
        ["hips"] => Ok(bones),
        others => {
            let what =
                format!("bones that hang on no other: {}; that is to be the hips alone", others.join(", "));
            Err(FormatError::Write { what, hint: hint.into() })
        }
    }
}

/// The bones of a person that says none itself, as far as its body is found; none of another body.
fn found_bones(skeleton: &Skeleton) -> Vec<HumanBone> {
    let Ok(body) = Humanoid::find(skeleton) else { return Vec::new() };
    let parts = [
        (Part::UpperLeg, ["leftUpperLeg", "rightUpperLeg"]),
        (Part::LowerLeg, ["leftLowerLeg", "rightLowerLeg"]),
        (Part::Foot, ["leftFoot", "rightFoot"]),
        (Part::Toes, ["leftToes", "rightToes"]),
        (Part::Clavicle, ["leftShoulder", "rightShoulder"]),
        (Part::UpperArm, ["leftUpperArm", "rightUpperArm"]),
        (Part::LowerArm, ["leftLowerArm", "rightLowerArm"]),
        (Part::Hand, ["leftHand", "rightHand"]),
    ];
    let mut bones =
        vec![("hips", Some(body.hips)), ("head", body.head), ("neck", body.neck.first().copied())];
    for (part, names) in parts {
        bones.extend(names.into_iter().zip(Side::BOTH.map(|side| body.joint(part, side))));
    }
    // A spine of more than three joints turns as its lowest, its middle and its uppermost do.
    let spine = &body.spine;
    let at = |place: usize| spine.get(place).copied();
    bones.push(("spine", at(0)));
    bones.push(("chest", if spine.len() > 1 { at(spine.len() / 2) } else { None }));
    bones.push(("upperChest", if spine.len() > 2 { at(spine.len() - 1) } else { None }));
    bones.into_iter().filter_map(|(name, joint)| Some(HumanBone { name, joint: joint? })).collect()
}

/// The clip's joint rotations that make a T-pose of its figure.
struct TPose {
    /// World rotation of each bone.
    turns: Vec<Quat>,
}

impl TPose {
    fn of(clip: &Clip, bones: &[Bone]) -> Self {
        let places = clip.skeleton().rest_positions();
        let place = |name: &str| {
            let bone = bones.iter().find(|bone| bone.name == name)?;
            places.get(bone.joint).copied()
        };
        let way = |from: &str, to: &str| Some(place(to)? - place(from)?);
        // Left is x when the figure faces z.
        let lateral = way("rightUpperLeg", "leftUpperLeg").unwrap_or(Vec3::X);
        let facing = Quat::from_rotation_y(lateral.z.atan2(lateral.x));
        let mut turns: Vec<Quat> = Vec::with_capacity(bones.len());
        for bone in bones {
            let above = bone.parent.and_then(|parent| turns.get(parent)).copied().unwrap_or(facing);
            let aimed = aim(bone.name).and_then(|(next, target)| {
                let now = (facing * way(bone.name, next)?).try_normalize()?;
                Some(Quat::from_rotation_arc(now, target) * facing)
            });
            let hand =
                bone.name.ends_with("Hand") || HUMAN_BONES.iter().skip(25).any(|name| *name == bone.name);
            turns.push(aimed.unwrap_or(if hand { above } else { facing }).normalize());
        }
        Self { turns }
    }

    fn nodes(&self, clip: &Clip, bones: &[Bone]) -> Vec<Value> {
        let rest = clip.skeleton().rest_positions();
        let rest = |joint: usize| rest.get(joint).copied().unwrap_or_default();
        let turn = |bone: Option<usize>| {
            bone.and_then(|bone| self.turns.get(bone)).copied().unwrap_or(Quat::IDENTITY)
        };
        let offset = |bone: &Bone| match bone.parent.and_then(|parent| bones.get(parent)) {
            Some(parent) => rest(bone.joint) - rest(parent.joint),
            None => Vec3::ZERO,
        };
        // On the ground: other programs scale the travel by the height of the hips.
        let mut places: Vec<Vec3> = Vec::with_capacity(bones.len());
        for bone in bones {
            let above = bone.parent.and_then(|parent| places.get(parent)).copied().unwrap_or_default();
            places.push(above + turn(bone.parent) * offset(bone));
        }
        let height = -places.iter().map(|place| place.y).fold(0.0, f32::min);
        let joints = clip.skeleton().joints();
        let nodes = bones.iter().enumerate().map(|(place, bone)| {
            let name = joints.get(bone.joint).map_or("", |joint| joint.name.as_str());
            let moved = if bone.parent.is_none() { Vec3::new(0.0, height, 0.0) } else { offset(bone) };
            let turned = (turn(bone.parent).inverse() * turn(Some(place))).normalize();
            let children: Vec<usize> = (0..bones.len())
                .filter(|&child| bones.get(child).is_some_and(|child| child.parent == Some(place)))
                .collect();
            let mut node = json!({
                "name": name,
                "translation": moved.to_array().map(shortest),
                "rotation": turned.to_array().map(shortest),
            });
            if let (false, Value::Object(node)) = (children.is_empty(), &mut node) {
                node.insert("children".into(), json!(children));
            }
            node
        });
        nodes.collect()
    }
}

/// Where a bone points in a T-pose: the bone at its other end, and the direction.
fn aim(bone: &str) -> Option<(&'static str, Vec3)> {
    Some(match bone {
        "leftUpperArm" => ("leftLowerArm", Vec3::X),
        "leftLowerArm" => ("leftHand", Vec3::X),
        "leftHand" => ("leftMiddleProximal", Vec3::X),
        "rightUpperArm" => ("rightLowerArm", Vec3::NEG_X),
        "rightLowerArm" => ("rightHand", Vec3::NEG_X),
        "rightHand" => ("rightMiddleProximal", Vec3::NEG_X),
        "leftUpperLeg" => ("leftLowerLeg", Vec3::NEG_Y),
        "leftLowerLeg" => ("leftFoot", Vec3::NEG_Y),
        "rightUpperLeg" => ("rightLowerLeg", Vec3::NEG_Y),
        "rightLowerLeg" => ("rightFoot", Vec3::NEG_Y),
        _ => return None,
    })
}

fn motions(clip: &Clip, bones: &[Bone]) -> Vec<NodeMotion> {
    let mut pose = Pose::new(clip.skeleton());
    let mut motions: Vec<NodeMotion> = (bones.iter().enumerate())
        .map(|(node, bone)| NodeMotion {
            node,
            rotations: Vec::with_capacity(clip.frames()),
            translations: bone.parent.is_none().then(|| Vec::with_capacity(clip.frames())),
            keys: None,
        })
        .collect();
    for frame in 0..clip.frames() {
        pose.set(clip, frame);
        let turn = |bone: Option<&Bone>| {
            bone.and_then(|bone| pose.rotations.get(bone.joint)).copied().unwrap_or(Quat::IDENTITY)
        };
        for (motion, bone) in motions.iter_mut().zip(bones) {
            let above = turn(bone.parent.and_then(|parent| bones.get(parent)));
            motion.rotations.push((above.inverse() * turn(Some(bone))).normalize());
            if let Some(values) = &mut motion.translations {
                values.push(pose.positions.get(bone.joint).copied().unwrap_or_default());
            }
        }
    }
    motions
}
