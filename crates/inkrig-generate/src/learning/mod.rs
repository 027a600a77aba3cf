//! Gradients of weights, by the same arithmetic that runs the networks: what training on a CPU needs.
//!
//! A gradient is one row of numbers in the order of [`crate::weights::Tensors::row`]; an optimiser moves that row, and the network is made
//! of it anew.

mod align;
mod control;
mod decoded;
mod denoiser;
mod distill;
mod estimate;
mod orthogonal;
mod placed;
#[cfg(test)]
mod testing;
mod vae;

pub use align::{AlignBatch, AlignLearner, AlignLosses, AlignObjective};
pub use control::{ControlBatch, ControlLearner, ControlLosses, ControlObjective};
pub use decoded::Wanted;
pub use denoiser::{DenoiserLearner, NoisyVerbs};
pub use distill::{DistillBatch, DistillLearner};
pub use estimate::{EstimateBatch, EstimateLearner, EstimateLosses, EstimateObjective};
pub use orthogonal::orthogonalise;
pub use placed::{Asked, Distances};
pub use vae::{VaeLearner, VaeLosses, VaeObjective};
