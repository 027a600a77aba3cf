//! From raw motion to weights: the corpus, training, evaluation.
//!
//! [`corpus`] reads folders of motion of anybody and makes of them what the second engine learns from; `training` (with the feature
//! `train`) is how it learns.

pub mod corpus;
mod error;
#[cfg(feature = "train")]
pub mod training;

pub use error::TrainError;
