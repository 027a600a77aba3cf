//! Checks of the matrices that come from outside.

use crate::{MatRef, Real, TransportError};

pub(crate) fn check_shape<T: Real>(
    name: &'static str,
    mat: MatRef<'_, T>,
    expected_rows: usize,
    expected_cols: usize,
    hint: &'static str,
) -> Result<(), TransportError> {
    let (rows, cols) = (mat.rows(), mat.cols());
    if rows == 0 || cols == 0 {
        return Err(TransportError::Empty { name });
    }
    if (rows, cols) != (expected_rows, expected_cols) {
        return Err(TransportError::Shape { name, rows, cols, expected_rows, expected_cols, hint });
    }
    Ok(())
}

pub(crate) fn check_values<T: Real>(name: &'static str, mat: MatRef<'_, T>) -> Result<(), TransportError> {
    let limit = T::from_f64(1e6);
    let good = |x: T| x >= T::ZERO && x <= limit;
    match mat.as_slice().iter().position(|&x| !good(x)) {
        None => Ok(()),
        Some(at) => {
            let (row, col) = (at / mat.cols(), at % mat.cols());
            Err(TransportError::Value { name, row, col, value: mat.row(row)[col].to_f64() })
        }
    }
}

pub(crate) fn check_distances<T: Real>(name: &'static str, mat: MatRef<'_, T>) -> Result<(), TransportError> {
    check_values(name, mat)?;
    for row in 0..mat.rows() {
        for col in 0..=row {
            let value = mat.row(row)[col].to_f64();
            let expected = if row == col { 0.0 } else { mat.row(col)[row].to_f64() };
            if (value - expected).abs() > 1e-3 * expected.abs().max(1.0) {
                return Err(TransportError::Distance { name, row, col, value, expected });
            }
        }
    }
    Ok(())
}

/// Values of any sign, finite and no larger than 1e6.
pub(crate) fn check_bias<T: Real>(name: &'static str, mat: MatRef<'_, T>) -> Result<(), TransportError> {
    let limit = T::from_f64(1e6);
    let good = |x: T| x >= -limit && x <= limit;
    match mat.as_slice().iter().position(|&x| !good(x)) {
        None => Ok(()),
        Some(at) => {
            let (row, col) = (at / mat.cols(), at % mat.cols());
            Err(TransportError::Bias { name, row, col, value: mat.row(row)[col].to_f64() })
        }
    }
}

/// A vector's length, said as the shape of a column.
pub(crate) fn check_length(
    name: &'static str,
    len: usize,
    expected: usize,
    hint: &'static str,
) -> Result<(), TransportError> {
    if len == expected {
        return Ok(());
    }
    Err(TransportError::Shape { name, rows: len, cols: 1, expected_rows: expected, expected_cols: 1, hint })
}
