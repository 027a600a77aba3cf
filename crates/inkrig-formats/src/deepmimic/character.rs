//! The character: joints with their types, and bodies whose far ends become end sites.

use super::{Scale, error, unreadable};
use crate::{FormatError, Limits, lexer::LARGEST_NUMBER};
use inkrig_motion::{
    Joint,
    glam::{DQuat, DVec3},
};
use serde::Deserialize;

/// A character as its motions need it.
#[derive(Debug, Clone)]
pub(super) struct Character {
    /// Joints of the skeleton; an end site follows its joint.
    pub(super) joints: Vec<Joint>,
    /// What the numbers of a row are, for every joint but end sites.
    pub(super) movers: Vec<Mover>,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mover {
    /// Which joint of the skeleton it is.
    pub(super) joint: usize,
    pub(super) kind: Kind,
    /// Its frame in its parent's.
    pub(super) frame: DQuat,
}

/// How many numbers a joint takes of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A position and a quaternion, ahead of all others.
    Root,
    /// A quaternion.
    Spherical,
    /// An angle about z.
    Revolute,
    /// Nothing.
    Fixed,
}

impl Kind {
    /// Numbers in a row.
    pub(super) fn width(self) -> usize {
        match self {
            Self::Root => 7,
            Self::Spherical => 4,
            Self::Revolute => 1,
            Self::Fixed => 0,
        }
    }
}

impl Character {
    /// Numbers of a row, the duration included.
    pub(super) fn width(&self) -> usize {
        1 + self.movers.iter().map(|mover| mover.kind.width()).sum::<usize>()
    }

    pub(super) fn parse(bytes: &[u8], scale: Scale, limits: &Limits) -> Result<Self, FormatError> {
        let hint = "give the file of the character, with a Skeleton and its Joints";
        let file: File =
            serde_json::from_slice(bytes).map_err(|cause| unreadable("deepmimic-json", &cause, hint))?;
        let listed = file.skeleton.joints;
        if listed.len() > limits.joints / 2 {
            return Err(FormatError::Limit {
                what: format!("the character has {} joints", listed.len()),
                limit: limits.joints / 2,
                place: None,
                hint: "remove joints that do not matter".into(),
            });
        }
        let mut leaf = vec![true; listed.len()];
        for (index, joint) in listed.iter().enumerate() {
            joint.check(index, limits)?;
            if let Some(slot) = joint.parent().and_then(|parent| leaf.get_mut(parent)) {
                *slot = false;
            }
        }
        let (mut joints, mut movers): (Vec<Joint>, Vec<Mover>) = (Vec::new(), Vec::new());
        for (index, joint) in listed.iter().enumerate() {
            let parent = joint.parent().and_then(|parent| movers.get(parent)).map(|mover| mover.joint);
            // The root stands where a motion puts it.
            let offset = if parent.is_some() { scale.metres(joint.attach()) } else { DVec3::ZERO };
            let own = joints.len();
            movers.push(Mover { joint: own, kind: joint.kind(index)?, frame: joint.frame() });
            joints.push(Joint::new(joint.name.as_str(), parent, offset.as_vec3()));
            // Bodies are listed by the number of their joint.
            let is_leaf = leaf.get(index) == Some(&true);
            let body = file.bodies.iter().find(|body| is_leaf && usize::try_from(body.id) == Ok(index));
            if let Some(tip) = body.and_then(Body::tip).filter(|tip| tip.is_finite()) {
                joints.push(Joint::end(format!("{}_end", joint.name), own, scale.metres(tip).as_vec3()));
            }
        }
        Ok(Self { joints, movers })
    }
}

impl Scale {
    pub(super) fn metres(self, v: DVec3) -> DVec3 {
        self.up.clip_from_file(v) * self.metres_per_unit
    }
}

#[derive(Deserialize)]
struct File {
    #[serde(rename = "Skeleton")]
    skeleton: Listed,
    #[serde(rename = "BodyDefs", default)]
    bodies: Vec<Body>,
}

#[derive(Deserialize)]
struct Listed {
    #[serde(rename = "Joints")]
    joints: Vec<JointEntry>,
}

#[derive(Deserialize)]
#[serde(rename_all = "PascalCase")]
struct JointEntry {
    name: String,
    #[serde(rename = "Type")]
    kind: String,
    parent: i64,
    #[serde(default)]
    attach_x: f64,
    #[serde(default)]
    attach_y: f64,
    #[serde(default)]
    attach_z: f64,
    #[serde(default)]
    attach_theta_x: f64,
    #[serde(default)]
    attach_theta_y: f64,
    #[serde(default)]
    attach_theta_z: f64,
}

impl JointEntry {
    fn parent(&self) -> Option<usize> {
        usize::try_from(self.parent).ok()
    }

    fn attach(&self) -> DVec3 {
        DVec3::new(self.attach_x, self.attach_y, self.attach_z)
    }

    fn frame(&self) -> DQuat {
        let about = |axis, angle| DQuat::from_axis_angle(axis, angle);
        about(DVec3::Z, self.attach_theta_z)
            * about(DVec3::Y, self.attach_theta_y)
            * about(DVec3::X, self.attach_theta_x)
    }

    fn check(&self, index: usize, limits: &Limits) -> Result<(), FormatError> {
        if self.name.len() > limits.name_bytes {
            return Err(FormatError::Limit {
                what: format!("a joint's name has {} bytes", self.name.len()),
                limit: limits.name_bytes,
                place: None,
                hint: "give the joint a shorter name".into(),
            });
        }
        let numbers = [self.attach_x, self.attach_y, self.attach_z];
        let angles = [self.attach_theta_x, self.attach_theta_y, self.attach_theta_z];
        if numbers.iter().chain(&angles).any(|number| number.abs() > LARGEST_NUMBER) {
            let what = "a place beyond 1e12".to_string();
            return Err(error("deepmimic-number", Some(&self.name), what, "use metres"));
        }
        let parent_is_before = usize::try_from(self.parent).is_ok_and(|parent| parent < index);
        if parent_is_before || (index == 0 && self.parent < 0) {
            return Ok(());
        }
        let what = format!("joint {index} hangs on joint {}", self.parent);
        let hint = "the first joint is the root with parent -1; all others hang on joints before them";
        Err(error("deepmimic-parent", Some(&self.name), what, hint))
    }

    fn kind(&self, index: usize) -> Result<Kind, FormatError> {
        match self.kind.as_str() {
            _ if index == 0 => Ok(Kind::Root),
            "spherical" => Ok(Kind::Spherical),
            "revolute" => Ok(Kind::Revolute),
            "fixed" => Ok(Kind::Fixed),
            other => {
                let what = format!("the joint type `{}` is not known", crate::finding::shown(other));
                let hint = "known are spherical, revolute and fixed";
                Err(error("deepmimic-type", Some(&self.name), what, hint))
            }
        }
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "PascalCase")]
struct Body {
    #[serde(rename = "ID")]
    id: i64,
    shape: String,
    #[serde(default)]
    attach_x: f64,
    #[serde(default)]
    attach_y: f64,
    #[serde(default)]
    attach_z: f64,
    #[serde(default)]
    param0: f64,
    #[serde(default)]
    param1: f64,
    #[serde(default)]
    param2: f64,
}

impl Body {
    /// The far end of the body as seen from its joint, file units: so that feet and heads have a length. `None` for a
    /// body that sits on its joint.
    fn tip(&self) -> Option<DVec3> {
        let centre = DVec3::new(self.attach_x, self.attach_y, self.attach_z);
        let away = centre.try_normalize()?;
        let half = 0.5 * DVec3::new(self.param0, self.param1, self.param2);
        Some(match self.shape.as_str() {
            // To the middle of the far side of the longest direction.
            "box" if half.x >= half.y && half.x >= half.z => centre + DVec3::X * half.x * away.x.signum(),
            "box" if half.z >= half.y => centre + DVec3::Z * half.z * away.z.signum(),
            "box" => centre + DVec3::Y * half.y * away.y.signum(),
            // A capsule's length is along y of its body; its middle tells the direction.
            "capsule" | "cylinder" => centre + away * (half.y + half.x),
            _ => centre + away * half.x,
        })
    }
}
