//! Weights as plain data: whatever they come from, a file, a rule or training, they go into the networks this way.

mod fill;
mod tensors;

pub use fill::{hashed, hashed_tensor, random};
pub(crate) use tensors::Slots;
pub use tensors::{Tensor, Tensors};
