//! The HumanML3D form of a motion (Guo et al. 2022): 22 joint positions at 20 frames a second, and 263 numbers a frame
//! made of them. The second engine generates motion in this form.
//!
//! The order of work for a motion of anybody: [`from_clip`] finds the joints, [`uniform`] gives it the proportions of one body, [`ground`] puts it on
//! the floor, at the origin, facing +z, [`features`] makes the numbers, [`recover_positions`] goes back.

mod body;
mod bones;
mod camera;
mod clip;
mod facing;
mod features;
mod footing;
mod from_clip;
mod ground;
mod key_points;
mod recover;
mod statistics;

pub use body::{CHAINS, JOINTS, Joints, NAMES, PARENTS, RAW_DIRECTIONS, mirror};
pub use bones::{Offsets, bone_lengths, uniform};
pub use camera::Camera;
pub use clip::{skeleton, to_clip};
pub use features::{Blocks, WIDTH, features};
pub use footing::{Footing, Kept, keep_footing};
pub use from_clip::from_clip;
pub use ground::ground;
pub use key_points::augment;
pub use recover::{RootPath, recover_bones, recover_positions, root_path};
pub use statistics::{Moments, Statistics};

/// Frames a second of the form.
pub const FRAME_RATE: f64 = 20.0;
