//! The networks in a form that can be trained, with burn. Only crates that train need this; the same weights go in and
//! out by their published names.

mod device;
mod layers;
mod linear_path;
mod mask;
mod named;
mod vae;
mod vae_learner;
mod vae_loss;

pub use device::{TrainingDevice, TrainingDeviceKind};
pub use mask::FrameMask;
pub use named::to_tensors;
pub use vae::TrainableVae;
pub use vae_learner::DeviceVaeLearner;
pub use vae_loss::{VaeLoss, VaeLossWeights, recovered_places, smooth_l1};
