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

/// Places along two smooth curves, divided by their mean distance: growing circles, and another with its own loops in
/// five dimensions.
pub(crate) struct Curves {
    pub(crate) control: Mat<f64>,
    pub(crate) source: Mat<f64>,
}

impl Curves {
    pub(crate) fn new(n: usize, m: usize) -> Self {
        let turn = |i: usize, count: usize| i as f64 / count as f64 * std::f64::consts::TAU;
        let control = Mat::from_fn(n, 2, |i, k| {
            let t = turn(i, n);
            (0.3 + 0.1 * t) * [(5.0 * t).cos(), (5.0 * t).sin()][k]
        });
        let source = Mat::from_fn(m, 5, |j, k| {
            let t = turn(j, m);
            [
                (7.0 * t).sin() * (1.2 + t.cos()),
                (7.0 * t).cos(),
                0.7 * (3.0 * t).sin(),
                0.5 * (2.0 * t).cos(),
                0.2 * (11.0 * t).sin(),
            ][k]
        });
        let scaled = |at: Mat<f64>| {
            let all = among(&at);
            let mean = all.as_slice().iter().sum::<f64>() / (at.rows() * at.rows()) as f64;
            Mat::from_fn(at.rows(), at.cols(), |i, k| at.row(i)[k] / mean)
        };
        Self { control: scaled(control), source: scaled(source) }
    }

    pub(crate) fn control_distances(&self) -> Mat<f64> {
        among(&self.control)
    }

    pub(crate) fn source_distances(&self) -> Mat<f64> {
        among(&self.source)
    }
}

fn among(at: &Mat<f64>) -> Mat<f64> {
    let rows: Vec<Vec<f64>> = (0..at.rows()).map(|i| at.row(i).to_vec()).collect();
    distances(&rows, &rows, Some(1.0)).0
}
