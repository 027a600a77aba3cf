//! From raw motion to weights: the corpus, training, evaluation.
//!
//! [`corpus`] reads folders of motion of anybody and makes of them what the second engine learns from; [`training`] is how it learns, and
//! [`evaluation`] says how well it did.

pub mod corpus;
mod error;
pub mod evaluation;
pub mod figures;
pub mod lettering;
pub mod reading;
pub mod training;

pub use error::TrainError;
