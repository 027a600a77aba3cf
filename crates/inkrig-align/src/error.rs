//! Why a motion could not be aligned.

use inkrig_motion::MotionError;
use inkrig_sketch::SketchError;
use inkrig_sound::SoundError;
use inkrig_transport::TransportError;

/// What stood in the way, and what to do about it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AlignError {
    /// The clip is shorter than one patch and a little.
    #[error(
        "the clip has {frames} frames at {rate:.0} a second, but patches of {patch} need at least {needed}: give a longer clip or a smaller --patch"
    )]
    ClipTooShort {
        /// Frames at the matching rate.
        frames: usize,
        /// The matching rate, frames a second.
        rate: f64,
        /// Frames of a patch.
        patch: usize,
        /// Frames that are needed.
        needed: usize,
    },
    /// The control is shorter than one patch and a little.
    #[error(
        "the control has {frames} samples, but patches of {patch} need at least {needed}: draw longer, or give --length or a smaller --patch"
    )]
    ControlTooShort {
        /// Samples at the matching rate.
        frames: usize,
        /// Frames of a patch.
        patch: usize,
        /// Samples that are needed.
        needed: usize,
    },
    /// More frames than the solver shall hold.
    #[error(
        "{what} has {frames} frames at the matching rate, more than the {most} that this solver matches at once: cut it with {cut}"
    )]
    TooLong {
        /// The clip or the control.
        what: &'static str,
        /// Its frames at the matching rate.
        frames: usize,
        /// The limit.
        most: usize,
        /// The flag that cuts it.
        cut: &'static str,
    },
    /// Both sides stay too long however coarse the first level is.
    #[error(
        "the first level would be too large, as its patches cannot be made fewer: give a shorter --patch, a shorter --length or fewer clips"
    )]
    NoCoarseLevel,
    /// The result would have more poses than can be held.
    #[error(
        "at {rate} frames a second and {joints} joints the result would be too large: give --source-fps if the clip's rate is wrong, or a shorter --length"
    )]
    TooFine {
        /// The clip's frames a second.
        rate: f64,
        /// Its joints.
        joints: usize,
    },
    /// Nothing in the clip changes.
    #[error("nothing in the clip moves, so there is nothing to arrange: give a clip with motion in it")]
    StillClip,
    /// Nothing in the control changes.
    #[error("the control does not change, so it says nothing of the motion: draw something that moves")]
    StillControl,
    /// An option outside of its range.
    #[error("{name} is {}, but must be {range}", short(*value))]
    Option {
        /// Its name as a flag.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// A sound without anything to hear.
    #[error("the sound is silent throughout, so there is nothing to move to: give another")]
    Silence,
    /// A sound that is longer than what is matched at once.
    #[error(
        "the sound is {seconds:.0} s long, and at most {most:.0} s are matched at once: cut it in a sound editor, or use a part of it"
    )]
    LongSound {
        /// Its length, seconds.
        seconds: f64,
        /// The limit, seconds.
        most: f64,
    },
    /// Samples of a stream that cannot be taken.
    #[error("these samples cannot be taken: {what}")]
    Samples {
        /// Why.
        what: &'static str,
    },
    /// A keyframe that cannot be met.
    #[error("a keyframe cannot be met: {what}")]
    Key {
        /// Why, and what to do.
        what: String,
    },
    /// The person at the keyboard said stop.
    #[error("cancelled")]
    Cancelled,
    /// From the motion core.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// From the drawing.
    #[error(transparent)]
    Sketch(#[from] SketchError),
    /// From the sound.
    #[error(transparent)]
    Sound(#[from] SoundError),
    /// From the transport solver.
    #[error(transparent)]
    Transport(#[from] TransportError),
}

/// A number in few digits, however large or small it is.
fn short(value: f64) -> String {
    if value == 0.0 || (1e-6..1e9).contains(&value.abs()) { value.to_string() } else { format!("{value:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!([short(0.0), short(-0.5), short(1e300)], ["0", "-0.5", "1e300"]);
    }
}
