use crate::kernels::{PairDistances, dispatch};
use crate::parallel::{Ragged, for_blocks, with_threads};
use crate::{Isa, MatRef, Real, Support, TransportError};

/// Points that are overlapping windows of a table: `len` consecutive rows from a starting row on, read as one long row. Such
/// are the patches of a motion's frames.
#[derive(Clone, Copy, Debug)]
pub struct Windows<'a, T> {
    table: MatRef<'a, T>,
    starts: &'a [usize],
    len: usize,
}

/// Rows of a support for one thread.
const BLOCK: usize = 32;

impl<'a, T: Real> Windows<'a, T> {
    /// Windows of `len` rows from each of `starts` on.
    ///
    /// # Errors
    /// [`TransportError::Empty`] without windows or columns, or for a length of 0; [`TransportError::MaskIndex`] for a window
    /// that goes beyond the table.
    pub fn new(table: MatRef<'a, T>, starts: &'a [usize], len: usize) -> Result<Self, TransportError> {
        let Some(&last) = starts.iter().max() else { return Err(TransportError::Empty { name: "windows" }) };
        if len == 0 || table.cols() == 0 {
            return Err(TransportError::Empty { name: "windows" });
        }
        let index = last.saturating_add(len - 1);
        if index >= table.rows() {
            return Err(TransportError::MaskIndex { what: "row", index, count: table.rows() });
        }
        Ok(Self { table, starts, len })
    }

    /// Number of windows.
    pub fn count(&self) -> usize {
        self.starts.len()
    }

    /// A window as one row of `len` times the table's columns; empty when there is no such window.
    pub fn get(&self, i: usize) -> &'a [T] {
        let Some(start) = self.starts.get(i) else { return &[] };
        let width = self.table.cols();
        &self.table.as_slice()[start * width..(start + self.len) * width]
    }

    /// Writes `scale` times the Euclidean distances from a point, a row as [`get`](Self::get) gives them, to all windows.
    pub fn distances_from(&self, point: &[T], scale: T, out: &mut [T]) {
        let pairs = (0..self.count()).map(|j| (point, self.get(j)));
        dispatch(Isa::current(), PairDistances { pairs, scale, out });
    }

    /// `scale` times the distances between windows of two tables of equal width, for the entries of a support (rows: these
    /// windows; columns: the others'), row after row.
    ///
    /// # Errors
    /// [`TransportError::Shape`] when the support or the other's windows have another shape.
    ///
    /// ```
    /// use inkrig_transport::{Mat, Support, Windows};
    /// let table = Mat::from_vec(4, 1, vec![0.0f32, 3.0, 4.0, 7.0])?;
    /// let windows = Windows::new(table.view(), &[0, 1, 2], 2)?;
    /// let mut out = Vec::new();
    /// windows.distances_at(&windows, &Support::full(3, 3)?, 1.0, 1, &mut out)?;
    /// assert_eq!(out[..3], [0.0, 10.0f32.sqrt(), 32.0f32.sqrt()]);
    /// # Ok::<(), inkrig_transport::TransportError>(())
    /// ```
    pub fn distances_at(
        &self,
        other: &Self,
        support: &Support,
        scale: T,
        threads: usize,
        out: &mut Vec<T>,
    ) -> Result<(), TransportError> {
        let shape = |name, rows, cols, expected_rows, expected_cols, hint| {
            if (rows, cols) == (expected_rows, expected_cols) {
                Ok(())
            } else {
                Err(TransportError::Shape { name, rows, cols, expected_rows, expected_cols, hint })
            }
        };
        let hint = "one row per window of the one side, one column per window of the other";
        shape("support", support.rows(), support.cols(), self.count(), other.count(), hint)?;
        let hint = "windows that are compared have as many rows and columns";
        shape("other", other.len, other.table.cols(), self.len, self.table.cols(), hint)?;
        out.clear();
        out.resize(support.len(), T::ZERO);
        let work = Ragged { data: out, starts: support.starts() };
        let isa = Isa::current();
        with_threads(threads, || {
            for_blocks(threads, support.rows(), BLOCK, work, &|first, count, out: Ragged<'_, T>| {
                let pairs = (first..first + count).flat_map(|i| {
                    let own = self.get(i);
                    support.row(i).iter().map(move |&j| (own, other.get(j as usize)))
                });
                dispatch(isa, PairDistances { pairs, scale, out: out.data });
            });
        });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mat;

    fn table(rows: usize, seed: usize) -> Mat<f64> {
        Mat::from_fn(rows, 7, |i, k| ((i * 13 + k * 5 + seed) % 29) as f64 * 0.1)
    }

    #[test]
    fn distances_are_those_of_the_windows() {
        let (a, b) = (table(90, 0), table(60, 11));
        let (rows, columns): (Vec<usize>, Vec<usize>) = ((0..80).collect(), (5..50).collect());
        let (left, right) =
            (Windows::new(a.view(), &rows, 11).unwrap(), Windows::new(b.view(), &columns, 11).unwrap());
        let support = Support::from_rows(80, 45, |i, out| out.extend([i % 45, (i * 7) % 45])).unwrap();
        let (mut out, mut many) = (Vec::new(), Vec::new());
        left.distances_at(&right, &support, 0.5, 1, &mut out).unwrap();
        left.distances_at(&right, &support, 0.5, 3, &mut many).unwrap();
        assert_eq!(out, many);
        let mut line = vec![0.0; 45];
        for i in 0..80 {
            right.distances_from(left.get(i), 0.5, &mut line);
            for (e, &j) in support.range(i).zip(support.row(i)) {
                let pairs = left.get(i).iter().zip(right.get(j as usize));
                let want = 0.5 * pairs.map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt();
                assert!((out[e] - want).abs() < 1e-12 && line[j as usize] == out[e]);
            }
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let (a, narrow) = (table(20, 0), Mat::<f64>::zeros(20, 3));
        let starts = [0, 9];
        let windows = Windows::new(a.view(), &starts, 11).unwrap();
        assert!(Windows::new(a.view(), &starts, 12).unwrap_err().to_string().contains("row 20"));
        assert!(Windows::new(a.view(), &[], 11).is_err() && Windows::new(a.view(), &starts, 0).is_err());
        let mut out = Vec::new();
        let mut says = |other: &Windows<'_, f64>, support: &Support| {
            windows.distances_at(other, support, 1.0, 1, &mut out).unwrap_err().to_string()
        };
        assert!(says(&windows, &Support::full(2, 3).unwrap()).contains("`support` is 2 x 3"));
        let other = Windows::new(narrow.view(), &starts, 11).unwrap();
        assert!(says(&other, &Support::full(2, 2).unwrap()).contains("`other` is 11 x 3"));
        assert!(windows.get(2).is_empty());
    }
}
