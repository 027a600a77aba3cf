//! How exact a motion on another character is: measured on the result, in numbers that can be held against limits.

mod hinges;
mod limits;
mod measures;
mod spread;

use super::Retargeted;
use crate::kinematics::{self, Pose};
use crate::rig::{Part, Side};
use crate::{Clip, Skeleton};
pub use hinges::{Hinge, Range as HingeRange};
pub use limits::{Broken, CertificateLimits};
pub use spread::Spread;

/// What was measured of a motion on another character.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// Length of the target over that of the source.
    pub scale: f32,
    /// Target joints that turn with the source: name, and name of the source joint that leads it most.
    pub pairs: Vec<(String, String)>,
    /// Target joints that take a share of a limb's twist.
    pub twists: Vec<String>,
    /// Target joints that keep their rest, end sites not among them.
    pub unmapped: Vec<String>,
    /// Source joints that lead none, end sites not among them.
    pub unused: Vec<String>,
    /// Millimetres between target joints and the joints that lead them, the source scaled: over all frames of all of
    /// them. Bodies of other proportions cannot be at the same places: no limit is set.
    pub position: Spread,
    /// The same for each joint.
    pub joints: Vec<JointPosition>,
    /// Degrees between limbs and those of the source, over all frames: upper and lower arms and legs of a person; of an
    /// animal its legs from hip or shoulder to the paw, since bones of other proportions cannot all point alike and
    /// reach the ground; by a map alone all mapped bones.
    pub direction: Spread,
    /// The same for each bone.
    pub limbs: Vec<BoneDirection>,
    /// Degrees between the trunks, from where the legs begin to where the arms (of an animal the forelegs) do.
    pub trunk: Spread,
    /// Degrees between the lines from hip to hip, and those from shoulder to shoulder.
    pub across: Spread,
    /// How often a foot stood in the source.
    pub contacts: usize,
    /// Millimetres over the ground from frame to frame, of feet that stand: of ankle and ball, the one that stood
    /// stiller in the source. Under the feet of one who goes on the spot the ground goes along as the scaled source's
    /// feet do, and this is the difference.
    pub slide: Spread,
    /// Millimetres of a standing foot above where the scaled source's stands; 0 where it is not above.
    pub floating: Spread,
    /// Millimetres of the lowest mapped joint below the ground, or below the lowest of the scaled source where that is in
    /// the ground itself, over all frames but a T-pose at the beginning; 0 where none is below.
    pub penetration: Spread,
    /// Millimetres over the ground between the way of the legs' middle and that of the scaled source.
    pub drift: Spread,
    /// How knees and elbows bend; empty for animals and for what is known by a map alone.
    pub hinges: Vec<Hinge>,
    /// The source goes on the spot, as games have it: its feet stand on a ground that goes along.
    pub on_the_spot: bool,
    /// What limits in millimetres are multiplied by: of an animal the height of its legs at rest in metres, else 1.
    pub size: f64,
}

/// How well one bone points where the source's does.
#[derive(Debug, Clone, PartialEq)]
pub struct BoneDirection {
    /// Which: side and part of a person, else the two joints.
    pub bone: String,
    /// Degrees over all frames.
    pub degrees: Spread,
}

/// How near one joint is to the one that leads it.
#[derive(Debug, Clone, PartialEq)]
pub struct JointPosition {
    /// The target's joint.
    pub joint: String,
    /// The source's.
    pub motion: String,
    /// Millimetres over all frames, the source scaled.
    pub millimetres: Spread,
}

impl Certificate {
    /// Measures a result against the motion that it was made of, which must be the one given to
    /// [`retarget`](super::retarget).
    pub fn of(source: &Clip, moved: &Retargeted) -> Self {
        let target = moved.clip.skeleton();
        let (a, b) = (kinematics::positions(source), kinematics::positions(&moved.clip));
        let frames = a.frames().min(b.frames());
        let name = |skeleton: &Skeleton, joint: usize| {
            skeleton.joints().get(joint).map(|joint| joint.name.clone()).unwrap_or_default()
        };
        let led: Vec<usize> = moved.pairs.iter().map(|pair| pair.0).collect();
        let leads: Vec<usize> = moved.pairs.iter().map(|pair| pair.1).collect();
        let rest = |skeleton: &Skeleton, used: &dyn Fn(usize) -> bool| -> Vec<String> {
            let joints = skeleton.joints().iter().enumerate();
            let free = joints.filter(|(index, joint)| !joint.end_site && !used(*index));
            free.map(|(_, joint)| joint.name.clone()).collect()
        };
        let measured = measures::Measured::of(moved, &a, &b, frames);
        Self {
            scale: moved.scale,
            pairs: (moved.pairs.iter())
                .map(|&(own, other)| (name(target, own), name(source.skeleton(), other)))
                .collect(),
            twists: moved.twists.iter().map(|&joint| name(target, joint)).collect(),
            unmapped: rest(target, &|joint| led.contains(&joint) || moved.twists.contains(&joint)),
            unused: rest(source.skeleton(), &|joint| leads.contains(&joint)),
            position: Spread::of(measured.positions.iter().flatten().copied().collect()),
            joints: (moved.pairs.iter().zip(measured.positions))
                .map(|(&(own, other), millimetres)| JointPosition {
                    joint: name(target, own),
                    motion: name(source.skeleton(), other),
                    millimetres: Spread::of(millimetres),
                })
                .collect(),
            direction: Spread::of(
                measured.directions.iter().flat_map(|bone| bone.1.iter().copied()).collect(),
            ),
            limbs: (measured.directions.into_iter())
                .map(|(bone, degrees)| BoneDirection {
                    bone: bone_name(moved, bone, &|joint| name(target, joint)),
                    degrees: Spread::of(degrees),
                })
                .collect(),
            trunk: Spread::of(measured.trunk),
            across: Spread::of(measured.across),
            contacts: moved.contacts.len(),
            slide: Spread::of(measured.slides),
            floating: Spread::of(measured.floating),
            penetration: Spread::of(measured.depths),
            drift: Spread::of(measured.drifts),
            hinges: hinges::hinges(source, moved),
            on_the_spot: moved.on_the_spot,
            size: (moved.facts.onto.quadruped())
                .map_or(1.0, |_| f64::from(moved.facts.onto.height(&moved.facts.rest))),
        }
    }
}

/// `Left UpperArm`, or the names of the two joints.
fn bone_name(moved: &Retargeted, [begin, end]: [usize; 2], name: &dyn Fn(usize) -> String) -> String {
    let parts = [Part::Clavicle, Part::UpperArm, Part::LowerArm, Part::UpperLeg, Part::LowerLeg];
    let body = moved.facts.onto.humanoid();
    let found = body.and_then(|body| {
        let pairs = Side::BOTH.into_iter().flat_map(|side| parts.map(|part| (side, part)));
        pairs.into_iter().find(|&(side, part)| body.joint(part, side) == Some(begin))
    });
    match found {
        Some((side, part)) => format!("{side:?} {part:?}"),
        None => format!("{} to {}", name(begin), name(end)),
    }
}

/// All joints' world rotations over time, for one pass over a clip.
fn poses(clip: &Clip, mut each: impl FnMut(usize, &Pose)) {
    let mut pose = Pose::new(clip.skeleton());
    for frame in 0..clip.frames() {
        pose.set(clip, frame);
        each(frame, &pose);
    }
}
