//! The second engine: motion made of a word, a key pose and trajectories, by a latent diffusion model.
//!
//! The method is Sketch2Anim (SIGGRAPH 2025). Its networks see motions in the HumanML3D form
//! ([`inkrig_motion::humanml`]). Everything here is plain data in, plain data out; files are read elsewhere.

pub mod blending;
pub mod checkpoint;
pub mod configuration;
mod error;
pub mod guidance;
pub mod learning;
pub mod losses;
pub mod measures;
pub mod networks;
mod numeric;
pub mod readers;
pub mod sampling;
pub mod schedule;
pub mod text;
#[cfg(feature = "train")]
pub mod trainable;
pub mod weights;

pub use checkpoint::CheckpointError;
pub use error::GenerateError;
