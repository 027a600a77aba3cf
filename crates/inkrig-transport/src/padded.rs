use crate::Real;

/// Values in one vector step of the kernels, whatever the processor: so every level sums in the same order.
pub(crate) const LANES: usize = 16;

/// A row-major matrix for the inner loops: rows start on 64 bytes and are padded to an odd number of lane groups. Padding
/// rids the loops of their tails; the odd number keeps rows of a power-of-two width off the same cache sets.
#[derive(Debug, Default)]
pub(crate) struct Padded<T> {
    rows: usize,
    cols: usize,
    stride: usize,
    offset: usize,
    data: Vec<T>,
}

impl<T: Real> Clone for Padded<T> {
    /// Rows of the copy start on 64 bytes too.
    fn clone(&self) -> Self {
        let mut copy = Self::default();
        if self.cols > 0 {
            copy.shape(self.rows, self.cols);
            copy.all_mut().copy_from_slice(self.all());
        }
        copy
    }
}

impl<T: Real> Padded<T> {
    /// Changes the shape and sets every value, padding included, to `value`.
    pub(crate) fn reset(&mut self, rows: usize, cols: usize, value: T) {
        self.shape(rows, cols);
        self.all_mut().fill(value);
    }

    /// Changes the shape. When it stays the same, so do the values; else they are of no meaning.
    pub(crate) fn shape(&mut self, rows: usize, cols: usize) {
        let stride = stride(cols);
        let needed = rows * stride + LANES;
        if self.data.len() < needed {
            self.data.resize(needed, T::ZERO);
        }
        let offset = self.data.as_ptr().align_offset(64);
        self.offset = if offset < LANES { offset } else { 0 };
        (self.rows, self.cols, self.stride) = (rows, cols, stride);
    }

    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    pub(crate) fn cols(&self) -> usize {
        self.cols
    }

    /// Distance from one row to the next; at least `cols`.
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    /// All rows with their padding.
    pub(crate) fn all(&self) -> &[T] {
        &self.data[self.offset..self.offset + self.rows * self.stride]
    }

    /// All rows with their padding.
    pub(crate) fn all_mut(&mut self) -> &mut [T] {
        &mut self.data[self.offset..self.offset + self.rows * self.stride]
    }

    /// The values of row `i`, without padding.
    pub(crate) fn row(&self, i: usize) -> &[T] {
        &self.all()[i * self.stride..][..self.cols]
    }

    /// The values of row `i`, without padding.
    pub(crate) fn row_mut(&mut self, i: usize) -> &mut [T] {
        let (stride, cols) = (self.stride, self.cols);
        &mut self.all_mut()[i * stride..][..cols]
    }
}

/// Length of a padded row of `cols` values.
pub(crate) fn stride(cols: usize) -> usize {
    (cols.div_ceil(LANES) | 1) * LANES
}
