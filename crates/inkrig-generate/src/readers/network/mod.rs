//! Small networks that look at pictures, for reading and for learning to read: one form serves both, as their gradients
//! are written out here. Tables are height x width x channels, the channels of a place side by side; one picture at a time.
//!
//! Blocks are those of ConvNeXt (Liu et al. 2022): a depthwise convolution, a norm over the channels, and two linear layers with a
//! GELU between, added to what came in. All that is costly are products of matrices.

mod backward;
mod depthwise;
mod forward;
mod patches;
mod plan;
mod weights;

pub use forward::Work;
pub use plan::{Plan, Shape, Value};
pub use weights::Network;

#[cfg(test)]
mod tests;
