use inkrig_transport::{Mat, Params, Problem, Real};

/// A small generator of its own, so that fixtures never change with a dependency.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// Uniform in 0..1.
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// About normal.
    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// Matrices of one problem.
pub(crate) struct Fixture<T> {
    pub(crate) control: Mat<T>,
    pub(crate) source: Mat<T>,
    pub(crate) cost: Mat<T>,
}

impl Fixture<f64> {
    /// Random walks: `n` points in 3 dimensions and `m` in 5, distances divided by their mean.
    pub(crate) fn walks(n: usize, m: usize, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut walk = |count: usize, dimensions: usize| {
            let mut at = vec![0.0; dimensions];
            (0..count)
                .map(|_| {
                    at.iter_mut().for_each(|x| *x = 0.97 * *x + random.normal());
                    at.clone()
                })
                .collect::<Vec<_>>()
        };
        let (y, x) = (walk(n, 3), walk(m, 5));
        let guess = walk(n, 5);
        let (control, _) = distances(&y, &y, None);
        let (source, scale) = distances(&x, &x, None);
        let (cost, _) = distances(&guess, &x, Some(scale));
        Self { control, source, cost }
    }

    pub(crate) fn small(&self) -> Fixture<f32> {
        let narrow = |mat: &Mat<f64>| Mat::from_fn(mat.rows(), mat.cols(), |i, j| mat.row(i)[j] as f32);
        Fixture { control: narrow(&self.control), source: narrow(&self.source), cost: narrow(&self.cost) }
    }
}

impl<T: Real> Fixture<T> {
    pub(crate) fn problem(&self, params: Params) -> Problem<'_, T> {
        Problem::new(self.control.view(), self.source.view(), Some(self.cost.view()), params).unwrap()
    }
}

fn distances(a: &[Vec<f64>], b: &[Vec<f64>], scale: Option<f64>) -> (Mat<f64>, f64) {
    let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    let mut mat = Mat::from_fn(a.len(), b.len(), |i, j| distance(&a[i], &b[j]));
    let mean = mat.as_slice().iter().sum::<f64>() / (a.len() * b.len()) as f64;
    let scale = scale.unwrap_or(if mean > 0.0 { 1.0 / mean } else { 1.0 });
    mat.as_mut_slice().iter_mut().for_each(|x| *x *= scale);
    (mat, scale)
}
