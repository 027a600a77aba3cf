use crate::check::check_length;
use crate::kernels::{Block, WeightedRows, dispatch};
use crate::parallel::{Chunk, for_blocks, with_threads};
use crate::{Isa, Mask, Mat, MatRef, Plan, Real, TransportError};

/// Which entries of a plan may be other than zero: for each row its columns, in order. Takes 4 bytes an entry.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Support {
    cols: usize,
    /// Where each row begins in `columns`, and the end: rows + 1 numbers, or none when there are no rows.
    starts: Vec<usize>,
    columns: Vec<u32>,
}

impl Support {
    /// All entries of a `rows` x `cols` plan.
    ///
    /// # Errors
    /// As [`from_rows`](Self::from_rows).
    pub fn full(rows: usize, cols: usize) -> Result<Self, TransportError> {
        Self::from_rows(rows, cols, |_, out| out.extend(0..cols))
    }

    /// Asks `fill(i, out)` for the columns of each row, in any order and with repeats as it likes; `out` comes empty.
    ///
    /// # Errors
    /// [`TransportError::Empty`] without rows or columns, [`TransportError::NoColumn`] for a row without any,
    /// [`TransportError::MaskIndex`] for a column that is not there.
    ///
    /// ```
    /// use inkrig_transport::Support;
    /// let support = Support::from_rows(3, 4, |i, out| out.extend([i + 1, i, i]))?;
    /// assert_eq!((support.row(1), support.len()), (&[1, 2][..], 6));
    /// # Ok::<(), inkrig_transport::TransportError>(())
    /// ```
    pub fn from_rows(
        rows: usize,
        cols: usize,
        mut fill: impl FnMut(usize, &mut Vec<usize>),
    ) -> Result<Self, TransportError> {
        // Columns are kept in 32 bits.
        if rows == 0 || cols == 0 || u32::try_from(cols).is_err() {
            return Err(TransportError::Empty { name: "support" });
        }
        let mut support = Self { cols, starts: vec![0], columns: Vec::new() };
        let mut out = Vec::new();
        for row in 0..rows {
            out.clear();
            fill(row, &mut out);
            out.sort_unstable();
            out.dedup();
            match out.last() {
                None => return Err(TransportError::NoColumn { row }),
                Some(&index) if index >= cols => {
                    return Err(TransportError::MaskIndex { what: "column", index, count: cols });
                }
                _ => {}
            }
            support.columns.extend(out.iter().map(|&j| j as u32));
            support.starts.push(support.columns.len());
        }
        Ok(support)
    }

    /// The support that a plan on coarser grids suggests: for each fine row the `best` sources of the three coarse rows
    /// around it, widened by `spread` coarse columns to either side. 12 and 2 are good values.
    ///
    /// # Errors
    /// As [`from_rows`](Self::from_rows); [`TransportError::Empty`] also for an empty plan or `best` of 0.
    pub fn from_coarse<T: Real>(
        plan: &Plan<T>,
        rows: usize,
        cols: usize,
        best: usize,
        spread: usize,
    ) -> Result<Self, TransportError> {
        let (coarse_rows, coarse_cols) = (plan.rows(), plan.cols());
        if coarse_rows == 0 || coarse_cols == 0 || best == 0 {
            return Err(TransportError::Empty { name: "coarse plan" });
        }
        let mut sorted: Vec<(usize, T)> = Vec::new();
        let mut chosen: Vec<usize> = Vec::with_capacity(coarse_rows * best.min(coarse_cols));
        let mut ends = vec![0];
        for i in 0..coarse_rows {
            sorted.clear();
            sorted.extend(plan.entries(i));
            let order =
                |a: &(usize, T), b: &(usize, T)| b.1.to_f64().total_cmp(&a.1.to_f64()).then(a.0.cmp(&b.0));
            if sorted.len() > best {
                sorted.select_nth_unstable_by(best - 1, order);
                sorted.truncate(best);
            }
            let some = sorted.iter().filter(|(_, t)| *t > T::ZERO).map(|(j, _)| *j);
            chosen.extend(some);
            ends.push(chosen.len());
        }
        Self::from_rows(rows, cols, |i, out| {
            let at = (2 * i + 1) * coarse_rows / (2 * rows);
            let (from, to) = (at.saturating_sub(1), (at + 2).min(coarse_rows));
            for &j in &chosen[ends[from]..ends[to]] {
                let (from, to) = (j.saturating_sub(spread), (j + spread + 1).min(coarse_cols));
                // At least one, also when the "fine" grid has fewer columns.
                let first = from * cols / coarse_cols;
                out.extend(first..(to * cols / coarse_cols).max(first + 1).min(cols));
            }
        })
    }

    /// Rows of the plan.
    pub fn rows(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Columns of the plan.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether there are no entries.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// The columns of row `i`, in order; empty when there is no such row.
    pub fn row(&self, i: usize) -> &[u32] {
        &self.columns[self.range(i)]
    }

    /// Where row `i` stands in a list of all entries, row after row; empty when there is no such row.
    pub fn range(&self, i: usize) -> std::ops::Range<usize> {
        if i < self.rows() { self.starts[i]..self.starts[i + 1] } else { 0..0 }
    }

    /// `out = W table`, where `weights` has a value of W for each entry, row after row, and the table as many rows as W has
    /// columns.
    ///
    /// # Errors
    /// [`TransportError::Shape`] when the weights or the table do not fit.
    ///
    /// ```
    /// use inkrig_transport::{Mat, Support};
    /// let support = Support::from_rows(2, 3, |i, out| out.extend([0, i + 1]))?;
    /// let table = Mat::from_vec(3, 1, vec![1.0f32, 10.0, 100.0])?;
    /// let mut out = Mat::default();
    /// support.product(&[0.5, 0.5, 0.0, 1.0], table.view(), 1, &mut out)?;
    /// assert_eq!(out.as_slice(), [5.5, 100.0]);
    /// # Ok::<(), inkrig_transport::TransportError>(())
    /// ```
    pub fn product<T: Real>(
        &self,
        weights: &[T],
        table: MatRef<'_, T>,
        threads: usize,
        out: &mut Mat<T>,
    ) -> Result<(), TransportError> {
        check_length("weights", weights.len(), self.len(), "one value per entry of the support")?;
        let hint = "one row per column of the support";
        check_length("table", table.rows(), self.cols, hint)?;
        let (rows, width) = (self.rows(), table.cols());
        out.reshape(rows, width);
        if width == 0 {
            return Ok(());
        }
        let isa = Isa::current();
        let work = Chunk::new(out.as_mut_slice(), width);
        with_threads(threads, || {
            for_blocks(threads, rows, 32, work, &|first, count, out: Chunk<'_, T>| {
                let at = self.starts[first]..self.starts[first + count];
                let starts = &self.starts[first..=first + count];
                let block = Block { starts, columns: &self.columns[at.clone()] };
                let (weights, table) = (&weights[at], table.as_slice());
                dispatch(isa, WeightedRows { block, weights, table, width, out: out.data });
            });
        });
        Ok(())
    }

    pub(crate) fn starts(&self) -> &[usize] {
        &self.starts
    }

    pub(crate) fn columns(&self) -> &[u32] {
        &self.columns
    }

    /// Becomes `other` without what a mask forbids; reuses the allocations.
    pub(crate) fn restrict(&mut self, other: &Self, mask: Option<&Mask>) {
        let Some(mask) = mask else {
            self.clone_from(other);
            return;
        };
        let mut open = vec![true; other.cols];
        mask.columns.iter().for_each(|&j| open[j] = false);
        let mut settled = vec![None; other.rows()];
        mask.rows.iter().for_each(|&(i, j)| settled[i] = Some(j));
        self.cols = other.cols;
        self.starts.clear();
        self.columns.clear();
        self.starts.push(0);
        for (i, settled) in settled.into_iter().enumerate() {
            match settled {
                Some(j) => self.columns.push(j as u32),
                None => self.columns.extend(other.row(i).iter().filter(|&&j| open[j as usize])),
            }
            self.starts.push(self.columns.len());
        }
    }

    /// Takes the entries of a plan that are not 0, or its support when it has one.
    pub(crate) fn copy_plan<T: Real>(&mut self, plan: &Plan<T>, values: &mut Vec<T>) {
        values.clear();
        self.cols = plan.cols();
        self.starts.clear();
        self.columns.clear();
        self.starts.push(0);
        for i in 0..plan.rows() {
            for (j, t) in plan.entries(i).filter(|(_, t)| *t > T::ZERO) {
                self.columns.push(j as u32);
                values.push(t);
            }
            self.starts.push(self.columns.len());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mat;

    #[test]
    fn a_coarse_plan_is_widened_and_mapped() {
        let plan = Plan::from_mat(Mat::from_fn(3, 5, |i, j| if j == 2 * i { 0.2 } else { 0.01 * j as f64 }));
        let support = Support::from_coarse(&plan, 6, 10, 1, 0).unwrap();
        assert_eq!((support.rows(), support.cols()), (6, 10));
        // Coarse rows 0, 1 (and 2 for the second fine row on) have their best at 0, 2 and 4: two fine columns each.
        assert_eq!(support.row(0), [0, 1, 4, 5]);
        assert_eq!(support.row(2), [0, 1, 4, 5, 8, 9]);
        assert_eq!(support.row(5), [4, 5, 8, 9]);
        let wide = Support::from_coarse(&plan, 6, 10, 1, 1).unwrap();
        assert_eq!(wide.row(0), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(Support::from_coarse(&plan, 2, 2, 5, 0).unwrap().row(0), [0, 1]);
        assert!(Support::from_coarse(&Plan::<f64>::default(), 2, 2, 5, 0).is_err());
    }

    #[test]
    fn bad_rows_are_refused() {
        assert_eq!(
            Support::from_rows(2, 3, |i, out| out.extend(0..1 - i.min(1))),
            Err(TransportError::NoColumn { row: 1 })
        );
        assert!(Support::from_rows(2, 3, |_, out| out.push(3)).unwrap_err().to_string().contains("column 3"));
        assert!(Support::full(0, 3).is_err());
        assert_eq!(Support::full(2, 3).unwrap().row(1), [0, 1, 2]);
        assert!(Support::full(2, 3).unwrap().row(2).is_empty());
    }
}
