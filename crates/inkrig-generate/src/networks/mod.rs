//! The networks as they are run: weights laid out once, nothing recorded but what a gradient with respect to the latent
//! needs. All of them are transformers with post-norm blocks; padding never occurs, as masked frames are left out.

mod block;
mod conditions;
mod denoiser;
mod embedding;
mod linear;
mod names;
mod sizes;
mod stack;
mod tokens;
mod vae;
mod vae_gradient;

pub use conditions::{ConditionEncoder, Domain};
pub use denoiser::{Adapter, ControlNet, Corrections, Denoiser, Noisy, Work};
pub use embedding::{guidance_waves, timestep_waves};
pub(crate) use linear::Linear;
pub(crate) use names::POSE;
pub use names::{Parts, TensorSpec, tensors};
pub use sizes::Sizes;
pub use vae::{Decoding, Encoded, Vae};
pub(crate) use vae_gradient::VaeTape;
