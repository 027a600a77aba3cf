use crate::{Mat, MatRef, Real};

/// A transport plan: row i says how the mass 1/N of control point i is spread over the source points. Dense today; the
/// accessors leave room for a sparse one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan<T> {
    entries: Mat<T>,
    column_mass: Vec<T>,
}

impl<T: Real> Plan<T> {
    /// Takes a dense N x M plan. Rows should sum to 1/N.
    pub fn from_mat(entries: Mat<T>) -> Self {
        let mut column_mass = vec![T::ZERO; entries.cols()];
        for i in 0..entries.rows() {
            column_mass.iter_mut().zip(entries.row(i)).for_each(|(c, &t)| *c += t);
        }
        Self { entries, column_mass }
    }

    /// N, control points.
    pub fn rows(&self) -> usize {
        self.entries.rows()
    }

    /// M, source points.
    pub fn cols(&self) -> usize {
        self.entries.cols()
    }

    /// Row `i`: M values that sum to 1/N; empty when there is no such row.
    pub fn row(&self, i: usize) -> &[T] {
        self.entries.row(i)
    }

    /// The source point that gets most of row `i`; the first of equals, 0 when there is no such row.
    pub fn best_source(&self, i: usize) -> usize {
        let mut best = (0, T::ZERO);
        for (j, &t) in self.row(i).iter().enumerate() {
            if t > best.1 {
                best = (j, t);
            }
        }
        best.0
    }

    /// Share of row `i` at its best source, in 1/M..=1: 1 when the match is certain.
    pub fn confidence(&self, i: usize) -> T {
        let row = self.row(i);
        let sum: T = row.iter().copied().sum();
        if sum > T::ZERO { row[self.best_source(i)] / sum } else { T::ZERO }
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
        for (y, line) in picture.chunks_exact_mut(width).enumerate() {
            for i in span(y, height, n) {
                let row = self.row(i);
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

    /// All entries, N x M.
    pub fn dense(&self) -> MatRef<'_, T> {
        self.entries.view()
    }

    /// All entries, by move.
    pub fn into_mat(self) -> Mat<T> {
        self.entries
    }

    /// Overwrites the plan; the allocations are reused.
    pub(crate) fn write<'a>(
        &mut self,
        rows: usize,
        cols: usize,
        row: impl Fn(usize) -> &'a [T],
        column_mass: &[T],
    ) {
        self.entries.reshape(rows, cols);
        for i in 0..rows {
            self.entries.row_mut(i).copy_from_slice(row(i));
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
}
