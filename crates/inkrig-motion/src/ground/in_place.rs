//! On the spot: travel taken away, sway kept.

use super::placement::{GroundMove, move_over_ground};
use super::{Trajectory, TravelOptions, root_bone};
use crate::{Clip, MotionError};

/// The clip without travel over the ground: it stays where it begins. Sway, height and turning are kept, as are all
/// poses; other roots (props, partners) keep their places relative to the character.
///
/// The way that is taken away is [`Trajectory::path`]; of a clip with a root bone it is that bone's own way.
///
/// # Errors
/// When the result is not a motion (a place beyond what f32 holds).
pub fn in_place(clip: &Clip, options: &TravelOptions) -> Result<Clip, MotionError> {
    let has_bone = root_bone(clip).is_some();
    let smoothing_seconds = if has_bone { 0.0 } else { options.smoothing_seconds };
    let trajectory = Trajectory::of(clip, &TravelOptions { smoothing_seconds, ..*options });
    let Some(&to) = trajectory.path.first() else { return Ok(clip.clone()) };
    let moves: Vec<GroundMove> =
        trajectory.path.iter().map(|&from| GroundMove { turn: 0.0, from, to }).collect();
    move_over_ground(clip, trajectory.joint, &moves)
}
