//! The networks in a form that can be trained, with burn. Only crates that train need this; the same weights go in and
//! out by their published names.

mod layers;
mod mask;
mod named;
mod vae;
mod vae_loss;

pub use mask::FrameMask;
pub use named::to_tensors;
pub use vae::TrainableVae;
pub use vae_loss::{VaeLoss, VaeLossWeights, recovered_places, smooth_l1};
