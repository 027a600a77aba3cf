//! From words to the vector that the networks take.

use super::{VERBS, actions_in, nearest_verbs};
use crate::GenerateError;
use crate::weights::Tensors;

/// Something that makes a vector of a description.
pub trait TextEncoder: Send + Sync {
    /// Numbers of a vector.
    fn width(&self) -> usize;

    /// The vector of a description such as "a person kicks."; of the empty one for guidance without text.
    ///
    /// # Errors
    /// [`GenerateError::Words`] when nothing in it is known.
    fn encode(&self, text: &str) -> Result<Vec<f32>, GenerateError>;
}

/// Vectors that were learned in training, one for each of [`VERBS`]: part of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct VerbTable {
    width: usize,
    verbs: Vec<f32>,
    nothing: Vec<f32>,
}

impl VerbTable {
    /// The tensor of the verbs' vectors, in the order of [`VERBS`]; a model from before the last were added has fewer rows.
    pub const VERBS: &str = "text.verbs";
    /// The tensor of the empty description's vector.
    pub const NOTHING: &str = "text.nothing";

    /// Takes both tensors out of a model's weights.
    ///
    /// # Errors
    /// [`GenerateError::MissingTensor`] or [`GenerateError::TensorShape`].
    pub fn new(weights: &Tensors, width: usize) -> Result<Self, GenerateError> {
        let missing = || GenerateError::MissingTensor { name: Self::VERBS.into() };
        let rows = weights.get(Self::VERBS).ok_or_else(missing)?.shape().first().copied().unwrap_or(0);
        let verbs = weights.expect(Self::VERBS, &[rows.clamp(1, VERBS.len()), width.max(1)])?.to_vec();
        let nothing = weights.expect(Self::NOTHING, &[width.max(1)])?.to_vec();
        Ok(Self { width: width.max(1), verbs, nothing })
    }

    /// The vector of a verb by its place in [`VERBS`]; that of no text where there is none.
    pub fn row(&self, verb: Option<usize>) -> &[f32] {
        let row = verb.and_then(|verb| self.verbs.chunks_exact(self.width).nth(verb));
        row.unwrap_or(&self.nothing)
    }
}

impl TextEncoder for VerbTable {
    fn width(&self) -> usize {
        self.width
    }

    /// The mean of all actions that are named.
    fn encode(&self, text: &str) -> Result<Vec<f32>, GenerateError> {
        if text.trim().is_empty() {
            return Ok(self.nothing.clone());
        }
        let rows: Vec<&[f32]> = actions_in(text)
            .into_iter()
            .filter_map(|verb| self.verbs.chunks_exact(self.width).nth(verb))
            .collect();
        if rows.is_empty() {
            let letters =
                |word: &str| word.trim_matches(|letter: char| !letter.is_alphabetic()).to_lowercase();
            let words =
                text.split_whitespace().map(letters).filter(|word| !NO_ACTIONS.contains(&word.as_str()));
            let word = words.max_by_key(String::len).unwrap_or_default();
            let text = text.chars().take(80).collect();
            return Err(GenerateError::Words { text, near: nearest_verbs(&word, 3).join(", ") });
        }
        let mut mean = vec![0.0; self.width];
        for row in &rows {
            for (mean, value) in mean.iter_mut().zip(*row) {
                *mean += value / rows.len() as f32;
            }
        }
        Ok(mean)
    }
}

/// Words of descriptions that are not meant as actions.
const NO_ACTIONS: [&str; 10] =
    ["a", "an", "the", "is", "and", "person", "someone", "somebody", "man", "woman"];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weights::Tensor;

    #[test]
    fn verbs_are_rows_and_unknown_words_get_an_offer() {
        let count = VERBS.len();
        let mut weights = Tensors::new();
        let numbers = (0..2 * count).map(|at| at as f32).collect();
        weights.insert(VerbTable::VERBS, Tensor::new(vec![count, 2], numbers).unwrap());
        weights.insert(VerbTable::NOTHING, Tensor::new(vec![2], vec![-1.0, -2.0]).unwrap());
        let table = VerbTable::new(&weights, 2).unwrap();
        let place = |name: &str| VERBS.iter().position(|verb| verb.name == name).unwrap() as f32;
        let row = |name: &str| [2.0 * place(name), 2.0 * place(name) + 1.0];
        assert_eq!(table.encode("a person is kicking").unwrap(), row("kick"));
        assert_eq!(table.encode(" ").unwrap(), [-1.0, -2.0]);
        let [walk, jump] = [row("walk"), row("jump")];
        assert_eq!(
            table.encode("walks and jumps").unwrap(),
            [(walk[0] + jump[0]) / 2.0, (walk[1] + jump[1]) / 2.0]
        );
        let error = table.encode("a person kikcs").unwrap_err().to_string();
        assert!(error.contains("kikcs") && error.contains("kick"), "{error}");
        assert!(VerbTable::new(&weights, 3).is_err() && VerbTable::new(&Tensors::new(), 2).is_err());
    }
}
