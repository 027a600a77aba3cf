use crate::product::{Strided, product};
use crate::sparse_gradient::thin_products;
use crate::{LowRank, MmSinkhorn, Real, SparseProblem, SparseWorkspace, Start, TransportError};

/// A column that has less than this share of its even part is taken as having so much: else the pull of the columns
/// without mass, which is a logarithm, would have no end.
const LEAST_SHARE: f64 = 0.1;

/// The gradient of the objective at a sparse plan, for any entry, in the support or not: where it is least, mass is
/// missing. Of the parts it has, the cost and other linear ones are the caller's to add, as only the caller knows them
/// outside of the support; constants of a row are left out.
///
/// ```text
/// G_ij = 2 alpha ((Dx^2 c)_j - 2 (Dy T Dx)_ij) + lambda log(c_j / q_j)
/// ```
#[derive(Debug)]
pub struct GradientRows<'a, T: Real> {
    workspace: &'a SparseWorkspace<T>,
    control: &'a LowRank<T>,
    source: &'a LowRank<T>,
    /// The part that depends on the column alone.
    column: Vec<T>,
    scale: T,
}

impl<T: Real> SparseWorkspace<T> {
    /// The gradient at the plan of the last solve, or at the one that [`resume`](Self::resume) has put there, brought to
    /// the problem's support and mask first. Costs about half of a solver's iteration.
    ///
    /// # Errors
    /// [`TransportError::NothingToContinue`] when there is no plan of this shape.
    pub fn gradient<'a>(
        &'a mut self,
        problem: &SparseProblem<'a, T>,
    ) -> Result<GradientRows<'a, T>, TransportError> {
        let stay = MmSinkhorn { iterations: 0, start: Start::Continue, ..MmSinkhorn::default() };
        stay.solve_sparse(problem, self)?;
        let params = problem.params;
        if params.alpha > 0.0 {
            crate::parallel::with_threads(self.threads, || thin_products(problem, self));
        }
        let mut squares = vec![T::ZERO; problem.cols()];
        problem.source.square_product(self.isa, self.mass.row(0), &mut self.factors, &mut squares);
        let even = 1.0 / problem.allowed as f64;
        let column = squares.iter().zip(self.mass.row(0)).map(|(square, mass)| {
            let share = (mass.to_f64() / even).max(LEAST_SHARE);
            T::from_f64(2.0 * params.alpha * square.to_f64() + params.lambda * share.ln())
        });
        let mut column: Vec<T> = column.collect();
        problem.mask.into_iter().flat_map(|mask| &mask.columns).for_each(|&j| column[j] = T::HUGE);
        let scale = T::from_f64(-4.0 * params.alpha);
        Ok(GradientRows { workspace: self, control: problem.control, source: problem.source, column, scale })
    }
}

impl<T: Real> GradientRows<'_, T> {
    /// Writes the rows from `first` on, as many rows of M as `out` holds; at a forbidden column they are beyond any other
    /// value. Rows that are not there stay as they are.
    pub fn write(&self, first: usize, out: &mut [T]) {
        let m = self.column.len();
        let SparseWorkspace { entries, transport, left, right, .. } = self.workspace;
        let rows = (out.len() / m).min(entries.rows().saturating_sub(first));
        let out = &mut out[..rows * m];
        if self.scale == T::ZERO {
            out.chunks_exact_mut(m).for_each(|row| row.copy_from_slice(&self.column));
            return;
        }
        let width = self.control.left.cols() + self.source.left.cols();
        let stride = left.stride();
        let a = Strided::rows(&left.all()[first * stride..], stride);
        let b = Strided { data: right.all(), row: 1, col: right.stride() };
        product(rows, m, width, a, b, out, m);
        let (row_excess, column_excess) = (self.control.excess.row(0), self.source.excess.row(0));
        for (i, row) in (first..).zip(out.chunks_exact_mut(m)) {
            for (&j, &t) in entries.row(i).iter().zip(&transport[entries.range(i)]) {
                row[j as usize] += row_excess[i] * column_excess[j as usize] * t;
            }
            row.iter_mut().zip(&self.column).for_each(|(x, &column)| *x = self.scale * *x + column);
        }
    }
}
