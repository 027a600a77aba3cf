//! From raw motion to weights: the corpus, training, evaluation.
//!
//! [`corpus`] reads folders of motion of anybody and makes of them what the second engine learns from.

pub mod corpus;
mod error;

pub use error::TrainError;
