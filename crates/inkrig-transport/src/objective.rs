use crate::product::{Strided, product};
use crate::{MatRef, Problem, Real, TransportError};

/// The objective and its parts; see the [crate] for their definitions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Terms {
    /// `alpha gw + (1 - alpha) w + lambda kl - epsilon entropy`.
    pub objective: f64,
    /// Gromov-Wasserstein term, at least 0.
    pub gw: f64,
    /// Linear term, at least 0; 0 without a cost.
    pub w: f64,
    /// KL of the column mass to uniform, at least 0.
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
    let (control, source) = (problem.control().as_slice(), problem.source().as_slice());
    let (mut half, mut full) = (vec![T::ZERO; n * m], vec![T::ZERO; n * m]);
    let rows = |data, stride| Strided::rows(data, stride);
    product(n, m, n, rows(control, n), rows(plan.as_slice(), m), &mut half, m, false);
    product(n, m, m, rows(&half, m), rows(source, m), &mut full, m, false);
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
    let (mut cross, mut w, mut entropy) = (0.0, 0.0, 0.0);
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
            w += plan(i).iter().zip(cost.row(i)).map(|(&t, &c)| t.to_f64() * c.to_f64()).sum::<f64>();
        }
    }
    let gw =
        square_form(problem.control(), &row_mass) + square_form(problem.source(), &column_mass) - 2.0 * cross;
    let q = 1.0 / m as f64;
    let kl = column_mass.iter().map(|&c| if c > 0.0 { c * (c / q).ln() - c + q } else { q }).sum::<f64>();
    let params = problem.params();
    let objective =
        params.alpha * gw + (1.0 - params.alpha) * w + params.lambda * kl - params.epsilon * entropy;
    Terms { objective, gw, w, kl, entropy }
}

/// `sum_ik d_ik^2 a_i a_k`.
fn square_form<T: Real>(distances: MatRef<'_, T>, mass: &[f64]) -> f64 {
    let row = |i| distances.row(i).iter().zip(mass).map(|(d, a)| d.to_f64() * d.to_f64() * a).sum::<f64>();
    mass.iter().enumerate().map(|(i, a)| a * row(i)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mat, Params};

    #[test]
    fn agrees_with_the_four_index_sum() {
        let (n, m) = (3, 4);
        let y = Mat::from_fn(n, n, |i, j| (i as f64 - j as f64).abs());
        let x = Mat::from_fn(m, m, |i, j| ((i * i) as f64 - (j * j) as f64).abs() * 0.1);
        let c = Mat::from_fn(n, m, |i, j| (i * m + j) as f64 * 0.05);
        let t = Mat::from_fn(n, m, |i, j| ((i * 5 + j * 3) % 7) as f64 / 30.0);
        let params = Params { alpha: 0.7, lambda: 0.2, epsilon: 0.03 };
        let problem = Problem::new(y.view(), x.view(), Some(c.view()), params).unwrap();
        let got = terms(&problem, t.view()).unwrap();
        let mut gw = 0.0;
        for (i, j, k, l) in (0..n * m * n * m).map(|s| (s / (m * n * m), s / (n * m) % m, s / m % n, s % m)) {
            gw += (y.row(i)[k] - x.row(j)[l]).powi(2) * t.row(i)[j] * t.row(k)[l];
        }
        assert!((got.gw - gw).abs() < 1e-13, "{} {gw}", got.gw);
        let sum = 0.7 * got.gw + 0.3 * got.w + 0.2 * got.kl - 0.03 * got.entropy;
        assert!((got.objective - sum).abs() < 1e-15);
        assert!(terms(&problem, Mat::zeros(4, 3).view()).is_err());
    }
}
