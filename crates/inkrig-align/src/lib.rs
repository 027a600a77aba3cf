//! The first engine: an animator's own clips, of any skeleton, arranged anew so that they follow a control: a drawn
//! curve, a wave, labels, a sound or another motion.
//!
//! The method is Metric-Aligning Motion Matching (MAMM, SIGGRAPH 2025): patches of the motion are matched to patches
//! of the control so that distances *within* the one agree with distances *within* the other, by fused semi-unbalanced
//! Gromov-Wasserstein transport, coarse to fine. Nothing is trained, no distance between a drawing and a motion is
//! ever needed.

mod alignment;
mod anchor;
pub mod blend;
pub mod coarse_to_fine;
mod comparison;
mod control;
mod error;
mod explain;
mod frame_rate;
mod keys;
mod large;
mod layout;
mod level;
mod live;
pub mod measures;
mod options;
pub mod patches;
pub mod pca;
mod polish;
mod prepared;
mod prepared_clip;
mod progress;
pub mod pyramid;
mod quality;
pub mod reconstruct;
mod report;
mod sampled;
mod scouting;
mod solver;
mod sound_fit;
mod suggest;
#[cfg(test)]
mod testing;
mod weights;

pub use alignment::{Alignment, align};
pub use coarse_to_fine::Frames;
pub use comparison::Comparison;
pub use control::{Control, ControlKind, CurveOptions, Domain, SoundOptions};
pub use error::AlignError;
pub use explain::{Alternative, Explanation, alternatives};
pub use frame_rate::{at_frame_rate, exact_frames};
pub use keys::{Key, KeyRow, Keys, Place, Pose, pose_errors};
pub use layout::{Layout, Run};
pub use live::{
    LiveAlignment, LiveAnswer, LiveEvent, LiveObserver, StreamAlignment, StreamOptions, StreamPiece,
};
pub use options::{Norm, Options, Preset};
pub use progress::{Observer, Progress};
pub use quality::Quality;
pub use report::{AMBIGUOUS, Report, StageRow};
pub use solver::{MOST_FRAMES, MOST_TABLE_FRAMES, Solver, SolverRow};
pub use sound_fit::{Heard, SoundFit};
pub use suggest::{Candidate, MapFrame, Moment, Moments, MotionMap, candidates, keys_on_map, principal_axes};
pub use weights::FrameWeights;
