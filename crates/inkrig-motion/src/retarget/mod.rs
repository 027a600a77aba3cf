//! One character's motion on another, of other proportions, names and rest pose.
//!
//! Directions are carried over, not angles: in a reference pose that both characters can stand in, every bone of the
//! target is turned to where the source's bone points; from then on it turns along with it. Places are scaled by the
//! height of the legs. Feet that stand in the source stand in the target. People go onto people, animals on four legs
//! onto such animals chain by chain; a map says more.

mod calibrate;
mod certificate;
mod chains;
mod contacts;
mod feet;
mod figure;
mod loose;
mod map;
mod plan;
mod reference;
mod transfer;
mod twist;

use crate::kinematics::{self, Pose};
use crate::rig::{Body, NoBody};
use crate::{Clip, MotionError, Skeleton, lead_in};
pub use certificate::{
    BoneDirection, Broken, Certificate, CertificateLimits, Hinge, HingeRange, JointPosition, Spread,
};
use figure::Figure;
use plan::{Aim, Plan};
use std::sync::Arc;

/// How a motion is carried over.
#[derive(Debug, Clone, PartialEq)]
pub struct RetargetOptions {
    /// Length of the target over that of the source; `None`: the ratio of their hips' heights.
    pub scale: Option<f32>,
    /// Whether feet that stand in the source are kept from sliding.
    pub keep_feet: bool,
    /// A pose in which the target stands, for skeletons whose bones point anywhere while nothing is turned; see
    /// [`standing_pose`]. `None`: the pose in which nothing is turned.
    pub stance: Option<Pose>,
    /// Which joint follows which: pairs of a joint of the motion and one of the character, any number of the latter to
    /// one of the former. What is not in it keeps its rest. `None`: as [`suggest`] finds it.
    pub map: Option<Vec<(usize, usize)>>,
}

impl Default for RetargetOptions {
    fn default() -> Self {
        Self { scale: None, keep_feet: true, stance: None, map: None }
    }
}

/// A motion on another character.
#[derive(Debug, Clone, PartialEq)]
pub struct Retargeted {
    /// The motion of the target's skeleton.
    pub clip: Clip,
    /// Length of the target over that of the source.
    pub scale: f32,
    /// Target joints that turn with the source, each with the source joint that leads it.
    pub pairs: Vec<(usize, usize)>,
    /// Target joints that take a share of a limb's twist.
    pub twists: Vec<usize>,
    /// When each foot stood in the source: leg (left, right; of an animal the hind legs, then the forelegs), first
    /// frame, last frame.
    pub contacts: Vec<(usize, usize, usize)>,
    /// Height of the ground that the target stands on, metres.
    pub ground: f32,
    /// The source goes on the spot, as games have it: its feet stand on a ground that goes along.
    pub on_the_spot: bool,
    facts: Facts,
}

/// What measuring needs to know of how a result was made.
#[derive(Debug, Clone, PartialEq)]
struct Facts {
    from: Figure,
    onto: Figure,
    source_ground: f32,
    standing: contacts::Standing,
    clearance: Vec<[f32; 2]>,
    /// Bones that point as the source's: joints of the target, places of the source.
    bones: Vec<([usize; 2], [plan::Lead; 2])>,
    /// The target's rest pose.
    rest: Pose,
}

/// Why a motion cannot be carried over.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RetargetError {
    /// The moving character is no two-legged body, or its joints have names that are not known.
    #[error("the motion's skeleton: {0}; {help}", help = help(.0, "motion"))]
    Source(NoBody),
    /// The character that shall move is none.
    #[error("the character's skeleton: {0}; {help}", help = help(.0, "character"))]
    Target(NoBody),
    /// The stance is a pose of another skeleton.
    #[error("the stance has {got} joints, and the character {expected}: give a pose of the character")]
    Stance {
        /// Joints of the character.
        expected: usize,
        /// Joints of the stance.
        got: usize,
    },
    /// Legs without length have no scale.
    #[error("the legs of the {0} have no length, so the sizes of both cannot be compared: give a scale")]
    NoLegs(&'static str),
    /// A scale that is no size.
    #[error("a scale of {0} is none: give a number above 0")]
    Scale(f32),
    /// A map that says nothing.
    #[error("the map has no pair of joints")]
    EmptyMap,
    /// A map that names joints which are not there.
    #[error(
        "the map pairs joint {motion} of the motion with joint {character} of the character, which are not there"
    )]
    MapJoint {
        /// Index into the motion's skeleton.
        motion: usize,
        /// Index into the character's.
        character: usize,
    },
    /// A joint that should follow two.
    #[error("the map has joint {0} of the character follow two joints: name it once")]
    MapTwice(usize),
    /// From the motion core.
    #[error(transparent)]
    Motion(#[from] MotionError),
}

fn help(cause: &NoBody, who: &str) -> String {
    match cause {
        NoBody::FourLegs => {
            "people go onto people and four legs onto four legs, unless a map says which joint follows which"
                .into()
        }
        _ => format!(
            "name the {who}'s joints as common programs do, or give a map that says which joint follows which"
        ),
    }
}

/// The pose of a clip in which its character stands most upright; `None` where it stands while nothing is turned, or is
/// neither a person nor an animal on four legs.
pub fn standing_pose(character: &Clip) -> Option<Pose> {
    let figure = Figure::of(Body::find(character.skeleton()).ok()?);
    let found = reference::find(character, &figure);
    (!found.at_rest).then_some(found.pose)
}

/// Which joint of the target would follow which of the source: pairs of a joint of the source and one of the target.
///
/// # Errors
/// As [`retarget`].
pub fn suggest(
    source: &Clip,
    target: &Arc<Skeleton>,
    options: &RetargetOptions,
) -> Result<Vec<(usize, usize)>, RetargetError> {
    let job = Job::of(source, target, options)?;
    Ok(job.plan.pairs().into_iter().map(|(own, other)| (other, own)).collect())
}

/// Carries the motion of one character over to another: of a person to a person, of an animal on four legs to another, of
/// anything to anything by a map. Joints of the target that have no counterpart keep their rest.
///
/// # Errors
/// When one of the two is neither a person nor an animal on four legs, or they are of different kinds, without a map;
/// when it has no legs to measure and no scale is given; when scale, stance or map make no sense.
pub fn retarget(
    source: &Clip,
    target: &Arc<Skeleton>,
    options: &RetargetOptions,
) -> Result<Retargeted, RetargetError> {
    let Job { from, onto, plan, mut reference, rest } = Job::of(source, target, options)?;
    let (positions, rate) = (kinematics::positions(source), source.frame_rate());
    let lead_in = lead_in::rest_pose_frames(source);
    let standing = contacts::find(&positions, &from, reference.ground, reference.leg, rate, lead_in);
    reference.ground = standing.ground(&from, &reference);
    let calibration = calibrate::calibrate((&from, &reference), (target, &onto, rest), &plan, options)?;
    let mut twists = twist::shares(target, &onto, &plan, &target.rest_positions());
    let hung = loose::hang(target, &onto);
    let mut moved =
        transfer::transfer((source, &from), (&hung.skeleton, &onto), &plan, &mut twists, &calibration);
    feet::point_legs(
        &mut moved,
        &hung.skeleton,
        (&from, &reference.pose.positions, &positions),
        (&onto, &calibration.rest.positions),
    );
    let ground = calibration.target_ground;
    let clearance = feet::clearance(&onto, &calibration.rest.positions, ground);
    if options.keep_feet {
        let ground = feet::Ground {
            standing: &standing,
            source: &positions,
            scale: calibration.scale,
            height: ground,
            clearance: &clearance,
            rate,
            led: &plan.links.iter().map(|link| link.target).collect::<Vec<_>>(),
        };
        feet::keep(&mut moved, &hung.skeleton, &from, &onto, &ground);
    }
    let clip = moved.into_clip(target, &hung.skeleton, &hung.loose, rate)?;
    let bones = plan.links.iter().filter_map(|link| match link.aim {
        Aim::Bone { target, from, to } => Some(([link.target, target], [from, to])),
        _ => None,
    });
    Ok(Retargeted {
        clip,
        scale: calibration.scale,
        pairs: plan.pairs(),
        twists: twists.iter().map(|twist| twist.joint).collect(),
        contacts: standing.contacts.clone(),
        ground,
        on_the_spot: standing.treadmill.is_some(),
        facts: Facts {
            bones: bones.collect(),
            source_ground: calibration.source_ground,
            rest: calibration.rest,
            from,
            onto,
            standing,
            clearance,
        },
    })
}

/// Two figures, and which joint leads which.
struct Job {
    from: Figure,
    onto: Figure,
    plan: Plan,
    reference: reference::Reference,
    /// The target's pose that bones are turned from.
    rest: Pose,
}

impl Job {
    fn of(source: &Clip, target: &Arc<Skeleton>, options: &RetargetOptions) -> Result<Self, RetargetError> {
        let (from, onto) = map::figures(source.skeleton(), target, options)?;
        let rest = options.stance.clone().unwrap_or_else(|| Pose::new(target));
        if rest.positions.len() != target.len() || rest.rotations.len() != target.len() {
            return Err(RetargetError::Stance { expected: target.len(), got: rest.positions.len() });
        }
        let reference = reference::find(source, &from);
        let mut plan = Plan::of((&from, &reference.pose), (&onto, &rest)).unwrap_or_default();
        if let Some(pairs) = &options.map {
            map::obey(&mut plan, pairs, target);
        }
        Ok(Self { from, onto, plan, reference, rest })
    }
}
