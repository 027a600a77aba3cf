//! What a motion is: [`Skeleton`], [`Clip`], forward kinematics, resampling in time, root motion and
//! frame features. No files, no solver.
//!
//! Conventions of the whole program: metres, seconds, radians, y up, right-handed; rotations are unit
//! quaternions, local to the parent joint; the time axis comes first (a track is frames x joints).
//!
//! ```
//! use inkrig_motion::{Clip, Joint, Skeleton, TranslationTrack, glam::{Quat, Vec3}, kinematics};
//! use std::sync::Arc;
//!
//! let skeleton = Arc::new(Skeleton::new(vec![
//!     Joint::new("hip", None, Vec3::ZERO),
//!     Joint::new("knee", Some(0), Vec3::new(0.0, -0.5, 0.0)),
//! ])?);
//! let clip = Clip::new(skeleton, 30.0, vec![Quat::IDENTITY; 4], vec![TranslationTrack {
//!     joint: 0,
//!     values: vec![Vec3::Y, Vec3::Y + Vec3::Z],
//! }])?;
//! let positions = kinematics::positions(&clip);
//! assert_eq!(positions.frame(1)[1], Vec3::new(0.0, 0.5, 1.0));
//! # Ok::<(), inkrig_motion::MotionError>(())
//! ```

pub mod capsules;
pub mod channels;
mod clip;
pub mod cycle;
mod error;
mod features;
pub mod ground;
pub mod humanml;
pub mod keyframes;
pub mod kinematics;
pub mod lead_in;
mod orientation;
pub mod retarget;
pub mod rig;
pub mod root;
pub mod rotation;
mod skeleton;
mod spans;
mod takes;
pub mod time;
mod two_bone;

pub use clip::{Clip, TranslationTrack};
pub use error::MotionError;
pub use features::{FeatureLayout, FeatureOptions, Features, RotationSpace, VelocityFrame, frame_features};
pub use glam;
pub use skeleton::{Joint, Skeleton};
pub use takes::Takes;
