use crate::{Real, TransportError};

/// A dense row-major matrix without gaps between rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mat<T> {
    rows: usize,
    cols: usize,
    data: Vec<T>,
}

impl<T: Real> Mat<T> {
    /// `rows` x `cols` zeros.
    pub fn zeros(rows: usize, cols: usize) -> Self {
        Self { rows, cols, data: vec![T::ZERO; rows * cols] }
    }

    /// Takes row-major `data`.
    ///
    /// # Errors
    /// [`TransportError::Length`] unless `data.len() == rows * cols`.
    pub fn from_vec(rows: usize, cols: usize, data: Vec<T>) -> Result<Self, TransportError> {
        check_length(rows, cols, data.len())?;
        Ok(Self { rows, cols, data })
    }

    /// Calls `value(row, column)` for each entry.
    pub fn from_fn(rows: usize, cols: usize, mut value: impl FnMut(usize, usize) -> T) -> Self {
        let mut data = Vec::with_capacity(rows * cols);
        for i in 0..rows {
            data.extend((0..cols).map(|j| value(i, j)));
        }
        Self { rows, cols, data }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Row `i`, of `cols` values; empty when there is no such row.
    pub fn row(&self, i: usize) -> &[T] {
        self.view().row(i)
    }

    /// Row `i`, mutable; empty when there is no such row.
    pub fn row_mut(&mut self, i: usize) -> &mut [T] {
        let range = row_range(self.rows, self.cols, i);
        self.data.get_mut(range).unwrap_or_default()
    }

    /// All values, row after row.
    pub fn as_slice(&self) -> &[T] {
        &self.data
    }

    /// All values, mutable.
    pub fn as_mut_slice(&mut self) -> &mut [T] {
        &mut self.data
    }

    /// The values, by move.
    pub fn into_vec(self) -> Vec<T> {
        self.data
    }

    /// A view of the whole.
    pub fn view(&self) -> MatRef<'_, T> {
        MatRef { rows: self.rows, cols: self.cols, data: &self.data }
    }

    /// Changes the shape and sets every value to zero. The allocation is reused when it is large enough.
    pub fn resize(&mut self, rows: usize, cols: usize) {
        self.rows = rows;
        self.cols = cols;
        self.data.clear();
        self.data.resize(rows * cols, T::ZERO);
    }

    /// Changes the shape and leaves old values in place, for a caller that writes all of them.
    pub(crate) fn reshape(&mut self, rows: usize, cols: usize) {
        self.rows = rows;
        self.cols = cols;
        self.data.resize(rows * cols, T::ZERO);
    }
}

/// A borrowed [`Mat`]: row-major, without gaps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MatRef<'a, T> {
    rows: usize,
    cols: usize,
    data: &'a [T],
}

impl<'a, T: Real> MatRef<'a, T> {
    /// Views row-major `data`.
    ///
    /// # Errors
    /// [`TransportError::Length`] unless `data.len() == rows * cols`.
    pub fn new(data: &'a [T], rows: usize, cols: usize) -> Result<Self, TransportError> {
        check_length(rows, cols, data.len())?;
        Ok(Self { rows, cols, data })
    }

    /// Number of rows.
    pub fn rows(self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn cols(self) -> usize {
        self.cols
    }

    /// Row `i`, of `cols` values; empty when there is no such row.
    pub fn row(self, i: usize) -> &'a [T] {
        self.data.get(row_range(self.rows, self.cols, i)).unwrap_or_default()
    }

    /// All values, row after row.
    pub fn as_slice(self) -> &'a [T] {
        self.data
    }

    /// A copy that owns its values.
    pub fn to_mat(self) -> Mat<T> {
        Mat { rows: self.rows, cols: self.cols, data: self.data.to_vec() }
    }
}

fn check_length(rows: usize, cols: usize, len: usize) -> Result<(), TransportError> {
    if rows.checked_mul(cols) == Some(len) { Ok(()) } else { Err(TransportError::Length { rows, cols, len }) }
}

fn row_range(rows: usize, cols: usize, i: usize) -> std::ops::Range<usize> {
    if i < rows { i * cols..(i + 1) * cols } else { 0..0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_checked_and_rows_found() {
        let mat = Mat::from_vec(2, 3, vec![1.0f32, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
        assert_eq!(mat.row(1), [4.0, 5.0, 6.0]);
        assert!(mat.row(2).is_empty());
        let error = Mat::from_vec(2, 2, vec![0.0f32; 5]).unwrap_err();
        assert_eq!(error, TransportError::Length { rows: 2, cols: 2, len: 5 });
        assert!(MatRef::<f32>::new(&[], usize::MAX, 2).is_err());
    }

    #[test]
    fn resize_keeps_the_allocation() {
        let mut mat = Mat::from_fn(4, 5, |i, j| (i + j) as f64);
        let before = mat.as_slice().as_ptr();
        mat.resize(5, 3);
        assert_eq!((mat.as_slice().as_ptr(), mat.as_slice()), (before, &[0.0; 15][..]));
    }
}
