//! What files of weights have in common.

use super::{CheckpointError, NumberKind};
use crate::weights::Tensor;

/// Numbers of one tensor that are read: a gigabyte of single precision.
pub(super) const MOST_NUMBERS: usize = 1 << 28;

/// A tensor that a file says it has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    /// Its name in the file.
    pub name: String,
    /// How long its axes are.
    pub shape: Vec<usize>,
    /// What it is made of.
    pub kind: NumberKind,
}

impl Listed {
    /// How many numbers it has.
    pub fn numbers(&self) -> usize {
        self.shape.iter().product()
    }
}

/// A file of named tensors, which are read one at a time.
pub trait TensorSource {
    /// All tensors that are there, each name once.
    fn listed(&self) -> &[Listed];

    /// The tensor at a place of [`Self::listed`], as single precision.
    ///
    /// # Errors
    /// [`CheckpointError`] when it is damaged, larger than a gigabyte, or holds what is no finite number.
    fn read(&mut self, at: usize) -> Result<Tensor, CheckpointError>;
}

/// The last check of every tensor that is read.
pub(super) fn finished(listed: &Listed, data: Vec<f32>) -> Result<Tensor, CheckpointError> {
    if let Some(at) = data.iter().position(|number| !number.is_finite()) {
        let what = format!("number {at} is {}, so the model is broken", data[at]);
        return Err(CheckpointError::tensor(&listed.name, what));
    }
    Ok(Tensor::new(listed.shape.clone(), data)?)
}

/// Whether a tensor is small enough to be read.
pub(super) fn check_size(listed: &Listed) -> Result<(), CheckpointError> {
    let numbers = listed.numbers();
    if numbers <= MOST_NUMBERS {
        return Ok(());
    }
    let what = format!("numbers in the tensor {}", super::error::shown(&listed.name));
    Err(CheckpointError::TooMuch { what, got: numbers as u64, most: MOST_NUMBERS as u64 })
}
