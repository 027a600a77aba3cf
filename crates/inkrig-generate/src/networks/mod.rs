//! The networks as they are run: weights laid out once, nothing recorded but what a gradient with respect to the latent
//! needs. All of them are transformers with post-norm blocks; padding never occurs, as masked frames are left out.

mod block;
mod branch;
mod branch_gradient;
mod conditions;
mod control_gradient;
mod denoiser;
mod denoiser_gradient;
mod dropout;
mod embedding;
mod estimate;
mod estimate_gradient;
mod feeding;
mod linear;
mod linear_path;
mod names;
mod sizes;
mod stack;
mod tokens;
mod trunk;
mod vae;
mod vae_gradient;
mod velocity;

pub(crate) use block::WeightGradients;
pub use branch_gradient::{Samples, WaveTable};
pub use conditions::{ConditionEncoder, Domain};
pub use control_gradient::ConditionRows;
pub(crate) use control_gradient::{ControlTape, EncoderTape};
pub use denoiser::{Adapter, ControlNet, Corrections, Denoiser, Noisy, Work};
pub(crate) use denoiser_gradient::DenoiserTape;
pub(crate) use dropout::Dropout;
pub use embedding::{guidance_waves, timestep_waves};
pub(crate) use estimate::{CORRECTIONS, CorrectionTape, MISSED, corrections_at, missed, missed_back};
pub use estimate::{Correction, Estimate, Estimator, told};
pub(crate) use estimate_gradient::EstimatorTape;
pub(crate) use linear::Linear;
pub use linear_path::spectrum;
#[cfg(feature = "train")]
pub(crate) use linear_path::waves;
pub use names::{Parts, TensorSpec, tensors};
pub use sizes::Sizes;
pub(crate) use stack::Residuals;
pub use vae::{Decoding, Encoded, Vae};
pub(crate) use vae_gradient::VaeTape;
