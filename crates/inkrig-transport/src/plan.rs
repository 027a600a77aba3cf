use crate::check::check_length;
use crate::{Mat, MatRef, Real, Support, TransportError};

/// A transport plan: row i says how the mass 1/N of control point i is spread over the source points. Dense from a
/// [`Workspace`](crate::Workspace), sparse from a [`SparseWorkspace`](crate::SparseWorkspace). What is said here as
/// "entries" works for both.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan<T> {
    entries: Entries<T>,
    column_mass: Vec<T>,
}

#[derive(Clone, Debug, PartialEq)]
enum Entries<T> {
    Dense(Mat<T>),
    /// A value for each entry of the support, row after row.
    Sparse(Support, Vec<T>),
}

impl<T: Real> Default for Plan<T> {
    /// A dense plan of 0 x 0.
    fn default() -> Self {
        Self { entries: Entries::Dense(Mat::default()), column_mass: Vec::new() }
    }
}

impl<T: Real> Plan<T> {
    /// Takes a dense N x M plan. Rows should sum to 1/N.
    pub fn from_mat(entries: Mat<T>) -> Self {
        let mut column_mass = vec![T::ZERO; entries.cols()];
        for i in 0..entries.rows() {
            column_mass.iter_mut().zip(entries.row(i)).for_each(|(c, &t)| *c += t);
        }
        Self { entries: Entries::Dense(entries), column_mass }
    }

    /// Takes a sparse plan: a value for each entry of the support, row after row. Rows should sum to 1/N.
    ///
    /// # Errors
    /// [`TransportError::Shape`] unless there are as many values as entries.
    pub fn from_support(support: Support, values: Vec<T>) -> Result<Self, TransportError> {
        check_length("values", values.len(), support.len(), "one value per entry of the support")?;
        let mut column_mass = vec![T::ZERO; support.cols()];
        support.columns().iter().zip(&values).for_each(|(&j, &t)| column_mass[j as usize] += t);
        Ok(Self { entries: Entries::Sparse(support, values), column_mass })
    }

    /// N, control points.
    pub fn rows(&self) -> usize {
        match &self.entries {
            Entries::Dense(mat) => mat.rows(),
            Entries::Sparse(support, _) => support.rows(),
        }
    }

    /// M, source points.
    pub fn cols(&self) -> usize {
        match &self.entries {
            Entries::Dense(mat) => mat.cols(),
            Entries::Sparse(support, _) => support.cols(),
        }
    }

    /// Row `i` of a dense plan: M values that sum to 1/N; empty when there is no such row, and for a sparse plan, whose
    /// rows [`entries`](Self::entries) and [`row_into`](Self::row_into) give.
    pub fn row(&self, i: usize) -> &[T] {
        match &self.entries {
            Entries::Dense(mat) => mat.row(i),
            Entries::Sparse(..) => &[],
        }
    }

    /// The entries kept of row `i`, with their columns in order: all M of a dense plan, those in the support of a sparse
    /// one. None when there is no such row.
    pub fn entries(&self, i: usize) -> impl Iterator<Item = (usize, T)> {
        let (columns, values) = match &self.entries {
            Entries::Dense(mat) => (None, mat.row(i)),
            Entries::Sparse(support, values) => (Some(support.row(i)), &values[support.range(i)]),
        };
        let column = move |k: usize| columns.map_or(k, |columns| columns[k] as usize);
        values.iter().enumerate().map(move |(k, &t)| (column(k), t))
    }

    /// Writes row `i` of either kind, with its zeros; what lies beyond M columns, or all when there is no such row, becomes
    /// 0.
    pub fn row_into(&self, i: usize, out: &mut [T]) {
        out.fill(T::ZERO);
        for (j, t) in self.entries(i) {
            if let Some(out) = out.get_mut(j) {
                *out = t;
            }
        }
    }

    /// The support of a sparse plan.
    pub fn support(&self) -> Option<&Support> {
        match &self.entries {
            Entries::Dense(_) => None,
            Entries::Sparse(support, _) => Some(support),
        }
    }

    /// The source point that gets most of row `i`; the first of equals, 0 when there is no such row.
    pub fn best_source(&self, i: usize) -> usize {
        self.best(i).0
    }

    /// Share of row `i` at its best source, in 1/M..=1: 1 when the match is certain.
    pub fn confidence(&self, i: usize) -> T {
        let sum: T = self.entries(i).map(|(_, t)| t).sum();
        if sum > T::ZERO { self.best(i).1 / sum } else { T::ZERO }
    }

    fn best(&self, i: usize) -> (usize, T) {
        let mut best = (0, T::ZERO);
        for (j, t) in self.entries(i) {
            if t > best.1 {
                best = (j, t);
            }
        }
        best
    }

    /// `T^T 1`: the mass that each of the M source points receives. Sums to 1.
    pub fn column_mass(&self) -> &[T] {
        &self.column_mass
    }

    /// The plan as a picture of `width` x `height` values in 0..=1, row after row: control points downward, source points
    /// to the right, each pixel the largest entry it covers over the plan's largest. Empty when a side is 0.
    pub fn heat_map(&self, width: usize, height: usize) -> Vec<f32> {
        let (n, m) = (self.rows(), self.cols());
        let mut picture = vec![0.0f32; width * height];
        if picture.is_empty() || n == 0 || m == 0 {
            return picture;
        }
        // The entries a pixel covers; at least one, so that a small plan is enlarged.
        let span = |k: usize, pixels: usize, entries: usize| {
            let from = k * entries / pixels;
            from..((k + 1) * entries / pixels).max(from + 1)
        };
        let mut peak = 0.0f32;
        let mut spread = vec![T::ZERO; if self.support().is_some() { m } else { 0 }];
        for (y, line) in picture.chunks_exact_mut(width).enumerate() {
            for i in span(y, height, n) {
                let row = if spread.is_empty() {
                    self.row(i)
                } else {
                    self.row_into(i, &mut spread);
                    &spread
                };
                for (x, pixel) in line.iter_mut().enumerate() {
                    for t in &row[span(x, width, m)] {
                        *pixel = pixel.max(t.to_f64() as f32);
                    }
                }
            }
            peak = line.iter().fold(peak, |peak, &pixel| peak.max(pixel));
        }
        if peak > 0.0 {
            picture.iter_mut().for_each(|pixel| *pixel /= peak);
        }
        picture
    }

    /// All entries of a dense plan, N x M; 0 x 0 for a sparse plan.
    pub fn dense(&self) -> MatRef<'_, T> {
        match &self.entries {
            Entries::Dense(mat) => mat.view(),
            Entries::Sparse(..) => MatRef::default(),
        }
    }

    /// All N x M entries, by move when the plan is dense.
    pub fn into_mat(self) -> Mat<T> {
        match self.entries {
            Entries::Dense(mat) => mat,
            Entries::Sparse(support, values) => {
                let mut mat = Mat::zeros(support.rows(), support.cols());
                for i in 0..support.rows() {
                    let row = mat.row_mut(i);
                    let entries = support.row(i).iter().zip(&values[support.range(i)]);
                    entries.for_each(|(&j, &t)| row[j as usize] = t);
                }
                mat
            }
        }
    }

    /// Overwrites the plan by a dense one; the allocations are reused.
    pub(crate) fn write<'a>(
        &mut self,
        rows: usize,
        cols: usize,
        row: impl Fn(usize) -> &'a [T],
        column_mass: &[T],
    ) {
        if let Entries::Sparse(..) = self.entries {
            self.entries = Entries::Dense(Mat::default());
        }
        if let Entries::Dense(mat) = &mut self.entries {
            mat.reshape(rows, cols);
            for i in 0..rows {
                mat.row_mut(i).copy_from_slice(row(i));
            }
        }
        self.column_mass.clear();
        self.column_mass.extend_from_slice(column_mass);
    }

    /// Overwrites the plan by a sparse one; the allocations are reused.
    pub(crate) fn write_sparse(&mut self, support: &Support, values: &[T], column_mass: &[T]) {
        if let Entries::Dense(_) = self.entries {
            self.entries = Entries::Sparse(Support::default(), Vec::new());
        }
        if let Entries::Sparse(to, out) = &mut self.entries {
            to.clone_from(support);
            out.clear();
            out.extend_from_slice(values);
        }
        self.column_mass.clear();
        self.column_mass.extend_from_slice(column_mass);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan() -> Plan<f64> {
        Plan::from_mat(Mat::from_vec(2, 3, vec![0.1, 0.4, 0.0, 0.0, 0.25, 0.25]).unwrap())
    }

    #[test]
    fn reads_rows() {
        let plan = plan();
        assert_eq!((plan.best_source(0), plan.best_source(1), plan.best_source(9)), (1, 1, 0));
        assert!((plan.confidence(0) - 0.8).abs() < 1e-15 && (plan.confidence(1) - 0.5).abs() < 1e-15);
        assert_eq!(plan.confidence(9), 0.0);
        assert_eq!(plan.column_mass(), [0.1, 0.65, 0.25]);
    }

    #[test]
    fn heat_map_takes_the_largest_and_enlarges() {
        let plan = plan();
        assert_eq!(plan.heat_map(1, 2), [1.0, 0.625]);
        let large = plan.heat_map(6, 4);
        assert_eq!(large.len(), 24);
        assert_eq!(large[..6], [0.25, 0.25, 1.0, 1.0, 0.0, 0.0]);
        assert!(plan.heat_map(0, 4).is_empty());
    }

    #[test]
    fn a_sparse_plan_reads_as_the_dense_one() {
        let dense = plan();
        let support =
            Support::from_rows(2, 3, |i, out| out.extend(if i == 0 { 0..2 } else { 1..3 })).unwrap();
        let sparse = Plan::from_support(support, vec![0.1, 0.4, 0.25, 0.25]).unwrap();
        assert_eq!((sparse.rows(), sparse.cols(), sparse.column_mass()), (2, 3, dense.column_mass()));
        assert_eq!(sparse.entries(1).collect::<Vec<_>>(), [(1, 0.25), (2, 0.25)]);
        assert_eq!(dense.entries(1).count(), 3);
        for i in 0..3 {
            assert_eq!(sparse.best_source(i), dense.best_source(i));
            assert_eq!(sparse.confidence(i), dense.confidence(i));
            let mut row = [9.0; 3];
            sparse.row_into(i, &mut row);
            assert_eq!(row[..dense.row(i).len()], *dense.row(i));
        }
        assert_eq!(sparse.heat_map(6, 4), dense.heat_map(6, 4));
        assert_eq!((sparse.dense().rows(), sparse.row(0).len(), dense.support()), (0, 0, None));
        assert_eq!(sparse.clone().into_mat(), dense.into_mat());
        assert!(Plan::from_support(sparse.support().unwrap().clone(), vec![0.0; 3]).is_err());
    }
}
