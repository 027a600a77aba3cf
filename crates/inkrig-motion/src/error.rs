//! What can be wrong with a motion that is put together from parts.

/// Why a skeleton, clip or feature table was refused, where, and what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// A skeleton needs at least one joint.
    #[error("a skeleton needs at least one joint")]
    EmptySkeleton,
    /// A joint names a parent that does not stand before it.
    #[error("joint {joint} ({name}) has parent {parent}, but parents must stand before their children")]
    ParentAfterChild {
        /// Index of the joint.
        joint: usize,
        /// Its name.
        name: String,
        /// The parent index that was given.
        parent: usize,
    },
    /// A number is NaN or infinite.
    #[error("{what} is not a finite number (joint {joint}, frame {frame})")]
    NotFinite {
        /// Which quantity.
        what: &'static str,
        /// Index of the joint.
        joint: usize,
        /// Index of the frame; 0 for the rest pose.
        frame: usize,
    },
    /// A rotation has no direction: its quaternion is zero.
    #[error("the rotation of joint {joint} at frame {frame} is a zero quaternion")]
    ZeroRotation {
        /// Index of the joint.
        joint: usize,
        /// Index of the frame.
        frame: usize,
    },
    /// The parts disagree in size.
    #[error("{what}: expected {expected} values, got {got}")]
    Length {
        /// Which part.
        what: &'static str,
        /// How many there should be.
        expected: usize,
        /// How many there are.
        got: usize,
    },
    /// A translation track names a joint that is not there, or names one twice.
    #[error("the translation track of joint {joint} is not usable: {why}")]
    Track {
        /// Index of the joint.
        joint: usize,
        /// What is wrong with it.
        why: &'static str,
    },
    /// A frame rate outside of what motion can have.
    #[error("a frame rate of {0} frames a second is not usable: give one between 0.01 and 100000")]
    FrameRate(f64),
    /// A clip without frames.
    #[error("the clip has no frames")]
    NoFrames,
    /// A range that holds no frame of the clip.
    #[error("frames {start}..{end} hold nothing of a clip with {frames} frames")]
    EmptyRange {
        /// First frame asked for.
        start: usize,
        /// End of the range, exclusive.
        end: usize,
        /// Frames that the clip has.
        frames: usize,
    },
    /// Clips that shall be joined are of different characters.
    #[error("clip {} is of another skeleton than the first: {what}", clip + 1)]
    OtherSkeleton {
        /// Index of the clip.
        clip: usize,
        /// What differs.
        what: String,
    },
    /// A path that cannot be followed.
    #[error("the path cannot be followed: {what}")]
    Path {
        /// What is wrong, and what to do.
        what: String,
    },
    /// A motion that does not go anywhere cannot be led along a path.
    #[error(
        "the motion does not travel: it goes {travelled:.2} m over the ground, and at least {least:.2} m are needed \
         to lead it along a path; take a clip that walks"
    )]
    Still {
        /// Way over the ground without sway, metres.
        travelled: f64,
        /// The least that counts as travel for a character of that size, metres.
        least: f64,
    },
    /// A loop that cannot be made of a clip of this length.
    #[error(
        "a loop of {frames} frames cannot be made of a clip of {got}: at least {needed} are needed, and a loop has 4 or \
         more; ask for another length, or give a longer clip"
    )]
    LoopLength {
        /// Frames that were asked for.
        frames: usize,
        /// Frames that the clip needs.
        needed: usize,
        /// Frames that it has.
        got: usize,
    },
}
