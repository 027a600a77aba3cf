use crate::padded::Padded;
use crate::{Real, TransportError};

/// Hard limits on a plan: which control points are settled, and which source points may not be used.
///
/// ```
/// use inkrig_transport::{Mask, Mat, MmSinkhorn, Params, Problem, Workspace};
/// let line = Mat::from_fn(4, 4, |i, j| (i as f32 - j as f32).abs() / 3.0);
/// let mask = Mask { rows: vec![(0, 3)], columns: vec![1] };
/// let params = Params { alpha: 1.0, ..Params::default() };
/// let problem = Problem::new(line.view(), line.view(), None, params)?.with_mask(&mask)?;
/// let mut workspace = Workspace::new(1);
/// MmSinkhorn::default().solve(&problem, &mut workspace)?;
/// assert_eq!(workspace.plan().row(0), [0.0, 0.0, 0.0, 0.25]);
/// assert_eq!(workspace.plan().column_mass()[1], 0.0);
/// # Ok::<(), inkrig_transport::TransportError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mask {
    /// Settled rows, in any order: row i of the plan is all of its mass 1/N at column j, and nothing else.
    pub rows: Vec<(usize, usize)>,
    /// Forbidden columns, in any order: they get no mass at all, and the target `q` is uniform over the others.
    pub columns: Vec<usize>,
}

impl Mask {
    /// Holds it against the shape of a problem; returns the number of columns that are left.
    pub(crate) fn check(&self, rows: usize, cols: usize) -> Result<usize, TransportError> {
        let mut open = vec![true; cols];
        for &col in &self.columns {
            *open.get_mut(col).ok_or(TransportError::MaskIndex {
                what: "column",
                index: col,
                count: cols,
            })? = false;
        }
        let mut fixed = vec![None; rows];
        for &(row, col) in &self.rows {
            let at = fixed.get_mut(row).ok_or(TransportError::MaskIndex {
                what: "row",
                index: row,
                count: rows,
            })?;
            let is_open =
                open.get(col).ok_or(TransportError::MaskIndex { what: "column", index: col, count: cols })?;
            if !is_open {
                return Err(TransportError::FixedOnForbidden { row, col });
            }
            match *at {
                Some(first) if first != col => {
                    return Err(TransportError::FixedTwice { row, first, second: col });
                }
                _ => *at = Some(col),
            }
        }
        match open.iter().filter(|&&open| open).count() {
            0 => Err(TransportError::NoColumn { row: 0 }),
            left => Ok(left),
        }
    }

    /// Sets each settled row among `count` rows from `first` on, `stride` apart, to `value` at its column and 0 elsewhere.
    pub(crate) fn settle<T: Real>(
        &self,
        rows: &mut [T],
        stride: usize,
        first: usize,
        count: usize,
        value: T,
    ) {
        for &(i, j) in self.rows.iter().filter(|(i, _)| (first..first + count).contains(i)) {
            let row = &mut rows[(i - first) * stride..][..stride];
            row.fill(T::ZERO);
            row[j] = value;
        }
    }

    /// Makes a start obey: forbidden entries go, what is left of a row is scaled to the row's mass `p`. Rows that obey
    /// stay as they are. Returns whether anything changed.
    pub(crate) fn apply<T: Real>(&self, plan: &mut Padded<T>, allowed: usize) -> bool {
        let (n, cols) = (plan.rows(), plan.cols());
        let p = 1.0 / n as f64;
        let mut changed = !self.rows.is_empty();
        for i in 0..n {
            let row = plan.row_mut(i);
            if self.columns.iter().all(|&j| row[j] == T::ZERO) {
                continue;
            }
            changed = true;
            self.columns.iter().for_each(|&j| row[j] = T::ZERO);
            let sum: f64 = row.iter().map(|t| t.to_f64()).sum();
            if sum > 0.0 {
                let scale = T::from_f64(p / sum);
                row.iter_mut().for_each(|t| *t *= scale);
            } else {
                row.fill(T::from_f64(p / allowed as f64));
                self.columns.iter().for_each(|&j| row[j] = T::ZERO);
            }
        }
        let stride = plan.stride();
        debug_assert!(self.rows.iter().all(|&(_, j)| j < cols));
        self.settle(plan.all_mut(), stride, 0, n, T::from_f64(p));
        changed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contradictions_are_named() {
        let check = |rows: &[(usize, usize)], columns: &[usize]| {
            Mask { rows: rows.to_vec(), columns: columns.to_vec() }.check(3, 4)
        };
        assert_eq!(check(&[], &[]), Ok(4));
        assert_eq!(check(&[(0, 1), (2, 1), (0, 1)], &[3, 3, 0]), Ok(2));
        let says = |rows: &[(usize, usize)], columns: &[usize]| check(rows, columns).unwrap_err().to_string();
        assert!(says(&[(3, 0)], &[]).contains("row 3, the problem has 3"));
        assert!(says(&[(0, 4)], &[]).contains("column 4, the problem has 4"));
        assert!(says(&[], &[9]).contains("column 9"));
        assert!(says(&[(1, 2)], &[2]).contains("row 1 on column 2, which it also forbids"));
        assert!(says(&[(1, 2), (1, 3)], &[]).contains("row 1 on column 2 and on column 3"));
        assert!(says(&[], &[0, 1, 2, 3]).contains("no column is left for row 0"));
    }

    #[test]
    fn a_start_is_made_to_obey() {
        let mut plan = Padded::<f64>::default();
        plan.reset(3, 4, 0.0);
        plan.row_mut(0).copy_from_slice(&[0.1, 0.1, 0.0, 1.0 / 3.0 - 0.2]);
        plan.row_mut(1).copy_from_slice(&[1.0 / 3.0, 0.0, 0.0, 0.0]);
        plan.row_mut(2).copy_from_slice(&[0.0, 0.0, 1.0 / 3.0, 0.0]);
        let mask = Mask { rows: vec![(2, 1)], columns: vec![0] };
        assert!(mask.apply(&mut plan, 3));
        assert_eq!(plan.row(0)[0], 0.0);
        assert!((plan.row(0).iter().sum::<f64>() - 1.0 / 3.0).abs() < 1e-15);
        assert_eq!(plan.row(1), [0.0, 1.0 / 9.0, 1.0 / 9.0, 1.0 / 9.0]);
        assert_eq!(plan.row(2), [0.0, 1.0 / 3.0, 0.0, 0.0]);
        assert!(!Mask { rows: Vec::new(), columns: vec![0] }.apply(&mut plan, 3));
    }
}
