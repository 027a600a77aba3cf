//! What a clip has to offer, before anything is drawn: its moments, the poses worth keying, a map to draw on.
//!
//! Users of the paper's program asked for keyframe candidates, and found the relation between drawing and motion unclear
//! (MAMM Sec. 6). Both are answered from the distances between the clip's patches alone.

mod candidates;
mod embedding;
mod map;
mod moments;
mod on_map;

pub use candidates::{Candidate, candidates};
pub use embedding::principal_axes;
pub use map::{MapFrame, MotionMap};
pub(crate) use moments::places;
pub use moments::{Moment, Moments};
pub use on_map::keys_on_map;
