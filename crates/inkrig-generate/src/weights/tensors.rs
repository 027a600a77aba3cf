//! Tensors by name.

use crate::GenerateError;
use std::collections::BTreeMap;
use std::ops::Bound;

/// Numbers and their shape, row-major: the last axis is the quickest.
#[derive(Debug, Clone, PartialEq)]
pub struct Tensor {
    shape: Vec<usize>,
    data: Vec<f32>,
}

impl Tensor {
    /// Checks that the numbers fill the shape. A shape without axes holds one number.
    ///
    /// # Errors
    /// [`GenerateError::TensorLength`] with an empty name when they do not.
    pub fn new(shape: Vec<usize>, data: Vec<f32>) -> Result<Self, GenerateError> {
        let expected = shape.iter().try_fold(1_usize, |product, &axis| product.checked_mul(axis));
        if expected == Some(data.len()) {
            return Ok(Self { shape, data });
        }
        let (expected, got) = (expected.unwrap_or(usize::MAX), data.len());
        Err(GenerateError::TensorLength { name: String::new(), shape, expected, got })
    }

    /// For numbers that were counted by the shape.
    pub(super) fn filled(shape: &[usize], data: Vec<f32>) -> Self {
        debug_assert_eq!(shape.iter().product::<usize>(), data.len());
        Self { shape: shape.to_vec(), data }
    }

    /// How long its axes are.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// Its numbers.
    pub fn data(&self) -> &[f32] {
        &self.data
    }

    /// Its numbers, kept.
    pub fn into_data(self) -> Vec<f32> {
        self.data
    }
}

/// The weights of one or more networks. Names are those of the published state dictionary
/// (`vae.encoder.middle_block.norm1.weight`), and so are the layouts: a linear layer's weight is outputs x inputs.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tensors {
    by_name: BTreeMap<String, Tensor>,
    half: bool,
}

impl Tensors {
    /// None.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds one; gives back what had that name before.
    pub fn insert(&mut self, name: impl Into<String>, tensor: Tensor) -> Option<Tensor> {
        self.by_name.insert(name.into(), tensor)
    }

    /// One by its name.
    pub fn get(&self, name: &str) -> Option<&Tensor> {
        self.by_name.get(name)
    }

    /// The numbers of one that has this shape.
    ///
    /// # Errors
    /// [`GenerateError::MissingTensor`] or [`GenerateError::TensorShape`].
    pub fn expect(&self, name: &str, shape: &[usize]) -> Result<&[f32], GenerateError> {
        let missing = || GenerateError::MissingTensor { name: name.into() };
        let tensor = self.get(name).ok_or_else(missing)?;
        if tensor.shape() == shape {
            return Ok(tensor.data());
        }
        let (expected, got) = (shape.to_vec(), tensor.shape().to_vec());
        Err(GenerateError::TensorShape { name: name.into(), expected, got })
    }

    /// All, sorted by name.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Tensor)> {
        self.by_name.iter().map(|(name, tensor)| (name.as_str(), tensor))
    }

    /// Networks made of these multiply with factors of bfloat16, sums in f32, where the processor is faster at them: for training,
    /// which takes that well and takes long.
    pub fn prefer_half_precision(&mut self) {
        self.half = crate::numeric::half::available();
    }

    pub(crate) fn in_half_precision(&self) -> bool {
        self.half
    }

    /// Where the numbers of one begin when all are laid in a row, sorted by name; what a gradient is laid out by.
    pub(crate) fn place(&self, name: &str) -> usize {
        let before = self.by_name.range::<str, _>((Bound::Unbounded, Bound::Excluded(name)));
        before.map(|(_, tensor)| tensor.data.len()).sum()
    }

    /// All numbers in a row, tensors sorted by name.
    pub fn row(&self) -> Vec<f32> {
        self.by_name.values().flat_map(|tensor| tensor.data.iter().copied()).collect()
    }

    /// The same tensors with other numbers, given as [`Self::row`] gives them.
    ///
    /// # Errors
    /// [`GenerateError::Length`] when there are more or fewer.
    pub fn with_row(&self, row: &[f32]) -> Result<Self, GenerateError> {
        if row.len() != self.numbers() {
            let (what, expected) = ("numbers of all weights", self.numbers());
            return Err(GenerateError::Length { what, expected, got: row.len() });
        }
        let mut rest = row;
        let mut take = |count: usize| {
            let (own, others) = rest.split_at(count);
            rest = others;
            own.to_vec()
        };
        let tensors = self.by_name.iter().map(|(name, old)| {
            (name.clone(), Tensor { shape: old.shape.clone(), data: take(old.data.len()) })
        });
        Ok(Self { by_name: tensors.collect(), half: self.half })
    }

    /// How many tensors there are.
    pub fn len(&self) -> usize {
        self.by_name.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.by_name.is_empty()
    }

    /// How many numbers there are in all.
    pub fn numbers(&self) -> usize {
        self.by_name.values().map(|tensor| tensor.data.len()).sum()
    }
}

/// Where the gradients of a layer's weight and bias begin in the row of all.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Slots {
    pub(crate) weight: usize,
    pub(crate) bias: usize,
}

impl Slots {
    pub(crate) fn of(weights: &Tensors, name: &str) -> Self {
        let place = |part: &str| weights.place(&format!("{name}{part}"));
        Self { weight: place(".weight"), bias: place(".bias") }
    }
}

impl FromIterator<(String, Tensor)> for Tensors {
    fn from_iter<I: IntoIterator<Item = (String, Tensor)>>(tensors: I) -> Self {
        Self { by_name: tensors.into_iter().collect(), half: false }
    }
}

impl Extend<(String, Tensor)> for Tensors {
    fn extend<I: IntoIterator<Item = (String, Tensor)>>(&mut self, tensors: I) {
        self.by_name.extend(tensors);
    }
}

impl IntoIterator for Tensors {
    type Item = (String, Tensor);
    type IntoIter = std::collections::btree_map::IntoIter<String, Tensor>;

    fn into_iter(self) -> Self::IntoIter {
        self.by_name.into_iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tensor_is_full_and_found_by_name_and_shape() {
        assert!(Tensor::new(vec![2, 3], vec![0.0; 5]).is_err());
        assert!(Tensor::new(vec![usize::MAX, 3], vec![0.0; 5]).is_err());
        let mut tensors = Tensors::new();
        tensors.insert("a.weight", Tensor::new(vec![2, 3], vec![1.0; 6]).unwrap());
        assert_eq!(tensors.expect("a.weight", &[2, 3]).unwrap(), [1.0; 6]);
        let error = tensors.expect("a.weight", &[3, 2]).unwrap_err().to_string();
        assert!(error.contains("a.weight") && error.contains("[3, 2]"), "{error}");
        assert!(tensors.expect("b", &[1]).is_err());
    }
}
