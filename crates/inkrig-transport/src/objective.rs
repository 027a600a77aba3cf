use crate::product::{Strided, product};
use crate::{Distances, Mask, MatRef, Params, Problem, Real, TransportError};

/// The objective and its parts; see the [crate] for their definitions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Terms {
    /// `alpha gw + (1 - alpha) w + linear + lambda kl - epsilon entropy`.
    pub objective: f64,
    /// Gromov-Wasserstein term, at least 0.
    pub gw: f64,
    /// Term of the cost between the two sides, at least 0; 0 without a cost.
    pub w: f64,
    /// Term of [`Problem::with_linear`], of any sign; 0 without one.
    pub linear: f64,
    /// KL of the column mass to uniform over the columns allowed, at least 0; infinite with mass on a forbidden one.
    pub kl: f64,
    /// Entropy of the plan, in 0 ..= log(N M).
    pub entropy: f64,
}

/// The terms of any plan, N x M, for a problem. Takes two matrix products and their memory; sums are in `f64`.
///
/// # Errors
/// [`TransportError::Shape`] when the plan has another shape than the problem.
pub fn terms<T: Real>(problem: &Problem<'_, T>, plan: MatRef<'_, T>) -> Result<Terms, TransportError> {
    let (n, m) = (problem.rows(), problem.cols());
    let (rows, cols) = (plan.rows(), plan.cols());
    if (rows, cols) != (n, m) {
        let hint = "a plan has one row per control point and one column per source point";
        return Err(TransportError::Shape {
            name: "plan",
            rows,
            cols,
            expected_rows: n,
            expected_cols: m,
            hint,
        });
    }
    let (mut half, mut full) = (vec![T::ZERO; n * m], vec![T::ZERO; n * m]);
    match problem.control() {
        Distances::Dense(control) => {
            let (a, b) = (Strided::rows(control.as_slice(), n), Strided::rows(plan.as_slice(), m));
            product(n, m, n, a, b, &mut half, m);
        }
        Distances::LowRank(low) => low.times(plan.as_slice(), m, &mut half),
    }
    match problem.source() {
        Distances::Dense(source) => {
            let (a, b) = (Strided::rows(&half, m), Strided::rows(source.as_slice(), m));
            product(n, m, m, a, b, &mut full, m);
        }
        Distances::LowRank(low) => low.times_from_right(&half, &mut full),
    }
    Ok(terms_with_product(problem, |i| plan.row(i), |i| &full[i * m..(i + 1) * m]))
}

/// The same when `Dy T Dx` is there already.
pub(crate) fn terms_with_product<'a, T: Real>(
    problem: &Problem<'_, T>,
    plan: impl Fn(usize) -> &'a [T],
    product: impl Fn(usize) -> &'a [T],
) -> Terms {
    let (n, m) = (problem.rows(), problem.cols());
    let mut row_mass = vec![0.0f64; n];
    let mut column_mass = vec![0.0f64; m];
    let (mut cross, mut w, mut linear, mut entropy) = (0.0, 0.0, 0.0, 0.0);
    for (i, row_mass) in row_mass.iter_mut().enumerate() {
        for (column_mass, (&t, &x)) in column_mass.iter_mut().zip(plan(i).iter().zip(product(i))) {
            let t = t.to_f64();
            *row_mass += t;
            *column_mass += t;
            cross += t * x.to_f64();
            if t > 0.0 {
                entropy -= t * t.ln();
            }
        }
        if let Some(cost) = problem.cost() {
            w += inner(plan(i), cost.row(i));
        }
        if let Some(bias) = problem.linear() {
            linear += inner(plan(i), bias.row(i));
        }
    }
    let gw =
        problem.control().square_form(&row_mass) + problem.source().square_form(&column_mass) - 2.0 * cross;
    let kl = divergence(&mut column_mass, problem.mask(), problem.allowed());
    Terms { objective: 0.0, gw, w, linear, kl, entropy }.weighed(problem.params())
}

impl Terms {
    /// The same with the objective put together.
    pub(crate) fn weighed(self, params: Params) -> Self {
        let Self { gw, w, linear, kl, entropy, .. } = self;
        let costs = params.alpha * gw + (1.0 - params.alpha) * w + linear;
        Self { objective: costs + params.lambda * kl - params.epsilon * entropy, ..self }
    }
}

fn inner<T: Real>(plan: &[T], cost: &[T]) -> f64 {
    plan.iter().zip(cost).map(|(&t, &c)| t.to_f64() * c.to_f64()).sum()
}

/// KL of the column mass, which is destroyed, to uniform over the `allowed` columns.
pub(crate) fn divergence(column_mass: &mut [f64], mask: Option<&Mask>, allowed: usize) -> f64 {
    let q = 1.0 / allowed as f64;
    let forbidden = mask.map_or(&[][..], |mask| &mask.columns);
    if forbidden.iter().any(|&j| column_mass[j] > 0.0) {
        return f64::INFINITY;
    }
    // KL(q || q) = 0.
    forbidden.iter().for_each(|&j| column_mass[j] = q);
    let mut sum = 0.0;
    for &c in column_mass.iter() {
        sum += if c > 0.0 { c * (c / q).ln() - c + q } else { q };
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mat;

    #[test]
    fn agrees_with_the_four_index_sum() {
        let (n, m) = (3, 4);
        let y = Mat::from_fn(n, n, |i, j| (i as f64 - j as f64).abs());
        let x = Mat::from_fn(m, m, |i, j| ((i * i) as f64 - (j * j) as f64).abs() * 0.1);
        let c = Mat::from_fn(n, m, |i, j| (i * m + j) as f64 * 0.05);
        let t = Mat::from_fn(n, m, |i, j| ((i * 5 + j * 3) % 7) as f64 / 30.0);
        let params = Params { alpha: 0.7, lambda: 0.2, epsilon: 0.03 };
        let b = Mat::from_fn(n, m, |i, j| (i as f64 - j as f64) * 0.1);
        let problem = Problem::new(y.view(), x.view(), Some(c.view()), params).unwrap();
        let problem = problem.with_linear(b.view()).unwrap();
        let got = terms(&problem, t.view()).unwrap();
        let mut gw = 0.0;
        for (i, j, k, l) in (0..n * m * n * m).map(|s| (s / (m * n * m), s / (n * m) % m, s / m % n, s % m)) {
            gw += (y.row(i)[k] - x.row(j)[l]).powi(2) * t.row(i)[j] * t.row(k)[l];
        }
        assert!((got.gw - gw).abs() < 1e-13, "{} {gw}", got.gw);
        let linear: f64 = b.as_slice().iter().zip(t.as_slice()).map(|(b, t)| b * t).sum();
        assert!((got.linear - linear).abs() < 1e-15 && linear != 0.0);
        let sum = 0.7 * got.gw + 0.3 * got.w + got.linear + 0.2 * got.kl - 0.03 * got.entropy;
        assert!((got.objective - sum).abs() < 1e-15);
        assert!(terms(&problem, Mat::zeros(4, 3).view()).is_err());
        let mask = Mask { rows: Vec::new(), columns: vec![1] };
        let problem = problem.with_mask(&mask).unwrap();
        assert_eq!(terms(&problem, t.view()).unwrap().kl, f64::INFINITY);
        let uniform = Mat::from_fn(n, m, |_, j| if j == 1 { 0.0 } else { 1.0 / 9.0 });
        assert!(terms(&problem, uniform.view()).unwrap().kl.abs() < 1e-15);
    }
}
