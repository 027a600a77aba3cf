//! Least squares whose unknowns hang together only with near ones: normal equations in a band, by Cholesky.

/// Normal equations. Row `i` of the matrix holds its lower part from column `i - width` to `i`.
#[derive(Debug, Clone)]
pub(super) struct Band {
    size: usize,
    width: usize,
    matrix: Vec<f64>,
    /// Half of the gradient.
    right: Vec<f64>,
    factor: Vec<f64>,
    /// Unknowns that stay 0; none beyond the end.
    held: Vec<bool>,
    free: Vec<(usize, f64)>,
}

impl Band {
    /// For `size` unknowns, of which no two that are more than `width` apart meet in a row.
    pub(super) fn new(size: usize, width: usize) -> Self {
        let all = size * (width + 1);
        let (matrix, factor) = (vec![0.0; all], vec![0.0; all]);
        Self { size, width, matrix, right: vec![0.0; size], factor, held: Vec::new(), free: Vec::new() }
    }

    /// Lets unknowns stay 0, so many for each of these.
    pub(super) fn hold(&mut self, held: &[bool], each: usize) {
        let all = held.iter().flat_map(|held| std::iter::repeat_n(*held, each));
        self.held = if held.contains(&true) { all.collect() } else { Vec::new() };
    }

    pub(super) fn clear(&mut self) {
        self.matrix.fill(0.0);
        self.right.fill(0.0);
    }

    /// Adds a weighted squared residual that is linear in some unknowns, in rising order.
    pub(super) fn add(&mut self, weight: f64, residual: f64, by: &[(usize, f64)]) {
        if self.held.is_empty() {
            return self.gather(weight, residual, by);
        }
        let mut free = std::mem::take(&mut self.free);
        free.clear();
        free.extend(by.iter().filter(|(at, _)| !self.held.get(*at).copied().unwrap_or(false)));
        self.gather(weight, residual, &free);
        self.free = free;
    }

    fn gather(&mut self, weight: f64, residual: f64, by: &[(usize, f64)]) {
        for (number, (row, a)) in by.iter().enumerate() {
            let a = weight * a;
            self.right[*row] += a * residual;
            let begin = row * (self.width + 1) + self.width - row;
            for (column, b) in &by[..=number] {
                self.matrix[begin + column] += a * b;
            }
        }
    }

    /// The step that is best for the linear problem, `damping` times the diagonal added; `None` where numbers do not allow one.
    pub(super) fn step(&mut self, damping: f64) -> Option<Vec<f64>> {
        self.decompose(damping)?;
        let (row_of, width) = (self.width + 1, self.width);
        let mut step: Vec<f64> = self.right.iter().map(|right| -right).collect();
        for row in 0..self.size {
            let first = row.saturating_sub(width);
            let own = &self.factor[row * row_of..(row + 1) * row_of];
            let before = dot(&own[width - (row - first)..width], &step[first..row]);
            step[row] = (step[row] - before) / own[width];
        }
        for row in (0..self.size).rev() {
            let first = row.saturating_sub(width);
            let own = &self.factor[row * row_of..(row + 1) * row_of];
            step[row] /= own[width];
            let now = step[row];
            let above = &own[width - (row - first)..width];
            step[first..row].iter_mut().zip(above).for_each(|(step, own)| *step -= own * now);
        }
        step.iter().all(|step| step.is_finite()).then_some(step)
    }

    fn decompose(&mut self, damping: f64) -> Option<()> {
        let (row_of, width) = (self.width + 1, self.width);
        for row in 0..self.size {
            let (done, rest) = self.factor.split_at_mut(row * row_of);
            let own = &mut rest[..row_of];
            own.copy_from_slice(&self.matrix[row * row_of..(row + 1) * row_of]);
            let first = row.saturating_sub(width);
            for column in first..row {
                let other = &done[column * row_of..(column + 1) * row_of];
                // Both rows from the first column that they have in common.
                let from = first.max(column.saturating_sub(width));
                let (a, b) = (width - (row - from), width - (column - from));
                let length = column - from;
                let sum = dot(&own[a..a + length], &other[b..b + length]);
                let at = width - (row - column);
                own[at] = (own[at] - sum) / other[width];
            }
            let before = &own[width - (row - first)..width];
            let diagonal = own[width] * (1.0 + damping) + 1e-9 - dot(before, before);
            if diagonal.is_nan() || diagonal <= 0.0 {
                return None;
            }
            own[width] = diagonal.sqrt();
        }
        Some(())
    }
}

/// In eight sums, which a processor adds side by side.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (left, right) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = left.remainder().iter().zip(right.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in left.zip(right) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_solve_what_was_added() {
        let (size, width) = (40, 11);
        let mut band = Band::new(size, width);
        // Residuals a x - b with a known solution.
        let known: Vec<f64> = (0..size).map(|at| (at as f64 * 0.7).sin()).collect();
        for row in 0..size - width {
            for turn in 0..3 {
                let by: Vec<(usize, f64)> =
                    (row..=row + width).map(|at| (at, ((at * (turn + 2) + row) as f64).cos())).collect();
                let value: f64 = by.iter().map(|(at, a)| a * known[*at]).sum();
                band.add(1.0 + turn as f64, -value, &by);
            }
        }
        let step = band.step(0.0).unwrap();
        assert!(step.iter().zip(&known).all(|(a, b)| (a - b).abs() < 1e-6), "{step:?}");
        assert!(Band::new(1, 0).step(f64::NAN).is_none());
        let mut band = Band::new(4, 1);
        band.hold(&[false, true], 2);
        band.add(1.0, -3.0, &[(1, 1.0), (2, 1.0)]);
        assert_eq!(
            band.step(0.0).unwrap().iter().map(|at| (at * 1e6).round() / 1e6).collect::<Vec<f64>>(),
            [0.0, 3.0, 0.0, 0.0]
        );
    }
}
