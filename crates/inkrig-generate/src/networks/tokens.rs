//! What goes into the networks: positional tables, checked lengths.

use super::Sizes;
use crate::GenerateError;
use crate::weights::Tensors;

/// A positional table: `positions` rows as wide as the network.
pub(crate) fn positions(weights: &Tensors, name: &str, sizes: &Sizes) -> Result<Vec<f32>, GenerateError> {
    Ok(weights.expect(name, &[sizes.positions, 1, sizes.width])?.to_vec())
}

/// How many rows of `width` numbers there are: at least one and at most `most`.
pub(crate) fn check_length(
    what: &'static str,
    numbers: usize,
    width: usize,
    most: usize,
) -> Result<usize, GenerateError> {
    let rows = numbers / width.max(1);
    if numbers == 0 || !numbers.is_multiple_of(width.max(1)) || rows > most {
        return Err(GenerateError::Rows { what, numbers, width, most });
    }
    Ok(rows)
}
