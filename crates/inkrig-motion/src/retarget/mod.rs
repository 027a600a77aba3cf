//! One character's motion on another, of other proportions, names and rest pose.
//!
//! Directions are carried over, not angles: in a reference pose that both characters can stand in, every bone of the
//! target is turned to where the source's bone points; from then on it turns along with it. Places are scaled by the
//! height of the hips. Feet that stand in the source stand in the target.

mod calibrate;
mod certificate;
mod feet;
mod plan;
mod reference;
mod transfer;

use crate::kinematics::Pose;
use crate::rig::{Humanoid, NoBody};
use crate::{Clip, MotionError, Skeleton};
pub use certificate::{Broken, Certificate, CertificateLimits, LimbDirection, Spread};
use plan::Plan;
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
}

impl Default for RetargetOptions {
    fn default() -> Self {
        Self { scale: None, keep_feet: true, stance: None }
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
    /// When each foot stood in the source: side (0 is left), first frame, last frame.
    pub contacts: Vec<(usize, usize, usize)>,
    /// Height of the ground that the target stands on, metres.
    pub ground: f32,
}

/// Why a motion cannot be carried over.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RetargetError {
    /// The moving character is no two-legged body, or its joints have names that are not known.
    #[error("the motion's skeleton: {0}; name its joints as common programs do")]
    Source(NoBody),
    /// The character that shall move is none.
    #[error("the character's skeleton: {0}; name its joints as common programs do")]
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
    /// From the motion core.
    #[error(transparent)]
    Motion(#[from] MotionError),
}

/// The pose of a clip in which its character stands most upright; `None` where it stands while nothing is turned, or is
/// no two-legged body.
pub fn standing_pose(character: &Clip) -> Option<Pose> {
    let body = Humanoid::find(character.skeleton()).ok()?;
    let found = reference::find(character, &body);
    (!found.at_rest).then_some(found.pose)
}

/// Carries the motion of one two-legged character over to another. Joints of the target that have no counterpart keep
/// their rest.
///
/// # Errors
/// When one of the two is not a two-legged body that is known by its joints' names, or has no legs to measure.
pub fn retarget(
    source: &Clip,
    target: &Arc<Skeleton>,
    options: &RetargetOptions,
) -> Result<Retargeted, RetargetError> {
    let from = Humanoid::find(source.skeleton()).map_err(RetargetError::Source)?;
    let onto = Humanoid::find(target).map_err(RetargetError::Target)?;
    let plan = Plan::new(&from, &onto);
    let reference = reference::find(source, &from);
    let calibration = calibrate::calibrate(&reference, (target, &onto), &plan, options)?;
    let mut moved = transfer::transfer((source, &from), (target, &onto), &plan, &calibration);
    let contacts = feet::contacts(source, &from, calibration.source_ground, calibration.leg);
    if options.keep_feet {
        feet::keep(&mut moved, target, &onto, &contacts, source.frame_rate());
    }
    let clip = moved.into_clip(target, onto.hips, source.frame_rate())?;
    let (scale, ground) = (calibration.scale, calibration.target_ground);
    Ok(Retargeted { clip, scale, pairs: plan.pairs(), contacts, ground })
}
