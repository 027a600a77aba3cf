//! Weights as plain data: whatever they come from, a file, a rule or training, they go into the networks this way.

mod tensors;

pub use tensors::{Tensor, Tensors};
