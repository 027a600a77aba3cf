use crate::check::{check_bias, check_distances, check_shape, check_values};
use crate::{Distances, Mask, MatRef, Real, TransportError};

/// Weights of the objective's terms; "MAMM (SIGGRAPH 2025), Sec. 3.2.4".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Share of the Gromov-Wasserstein term, 0..=1; the rest goes to the linear cost.
    pub alpha: f64,
    /// Weight of KL(column mass || uniform), at least 0. Larger: more of the source is used.
    pub lambda: f64,
    /// Weight of the entropy, greater than 0. Larger: softer rows.
    pub epsilon: f64,
}

impl Default for Params {
    /// The weights for distances divided by their mean: .9, .05, .005.
    fn default() -> Self {
        Self { alpha: 0.9, lambda: 0.05, epsilon: 0.005 }
    }
}

impl Params {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`TransportError::Parameter`], naming the first parameter out of its range.
    pub fn validate(&self) -> Result<(), TransportError> {
        let check = |name, value: f64, good: bool, range| {
            if good && value.is_finite() {
                Ok(())
            } else {
                Err(TransportError::Parameter { name, value, range })
            }
        };
        check("alpha", self.alpha, (0.0..=1.0).contains(&self.alpha), "between 0 and 1")?;
        check("lambda", self.lambda, (0.0..=1e6).contains(&self.lambda), "between 0 and 1e6")?;
        check("epsilon", self.epsilon, (1e-6..=1e6).contains(&self.epsilon), "between 1e-6 and 1e6")
    }
}

/// One transport problem: borrowed matrices and weights, checked. See the [crate] for the objective.
///
/// ```
/// use inkrig_transport::{Mat, Params, Problem};
/// let distances = Mat::from_vec(2, 2, vec![0.0f32, 1.0, 1.0, 0.0])?;
/// let cost = Mat::zeros(2, 2);
/// let problem = Problem::new(distances.view(), distances.view(), Some(cost.view()), Params::default())?;
/// assert_eq!((problem.rows(), problem.cols()), (2, 2));
/// assert!(Problem::new(distances.view(), distances.view(), None, Params::default()).is_err(), "alpha < 1 needs a cost");
/// # Ok::<(), inkrig_transport::TransportError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a, T: Real> {
    control: Distances<'a, T>,
    source: Distances<'a, T>,
    cost: Option<MatRef<'a, T>>,
    linear: Option<MatRef<'a, T>>,
    mask: Option<&'a Mask>,
    /// Source points that may be used.
    allowed: usize,
    params: Params,
}

impl<'a, T: Real> Problem<'a, T> {
    /// * `control`: N x N, distances within the control, divided by their mean or maximum; symmetric, zero diagonal.
    /// * `source`: M x M, likewise for the source.
    /// * `cost`: N x M, at least 0, in the unit of `source`; may be absent only when `alpha` is 1.
    ///
    /// No value may exceed 1e6.
    ///
    /// # Errors
    /// Whatever is wrong first: [`TransportError::Empty`], [`Shape`](TransportError::Shape),
    /// [`Parameter`](TransportError::Parameter), [`MissingCost`](TransportError::MissingCost),
    /// [`Value`](TransportError::Value), [`Distance`](TransportError::Distance). Symmetry is held to 1e-3 of the larger
    /// of 1 and the entry.
    pub fn new(
        control: MatRef<'a, T>,
        source: MatRef<'a, T>,
        cost: Option<MatRef<'a, T>>,
        params: Params,
    ) -> Result<Self, TransportError> {
        let problem = Self::new_unchecked_values(control, source, cost, params)?;
        check_distances("control", control)?;
        check_distances("source", source)?;
        cost.map_or(Ok(()), |cost| check_values("cost", cost))?;
        Ok(problem)
    }

    /// As [`new`](Self::new) without the scan of the values, which reads all three matrices: for a loop whose matrices
    /// come from code that makes them right. Wrong values give a wrong plan, never undefined behaviour.
    ///
    /// # Errors
    /// As [`new`](Self::new), shapes and parameters only.
    pub fn new_unchecked_values(
        control: MatRef<'a, T>,
        source: MatRef<'a, T>,
        cost: Option<MatRef<'a, T>>,
        params: Params,
    ) -> Result<Self, TransportError> {
        Self::with_distances(control.into(), source.into(), cost, params)
    }

    /// As [`new_unchecked_values`](Self::new_unchecked_values), for distances of either kind.
    ///
    /// # Errors
    /// As [`new`](Self::new), shapes and parameters only.
    pub fn with_distances(
        control: Distances<'a, T>,
        source: Distances<'a, T>,
        cost: Option<MatRef<'a, T>>,
        params: Params,
    ) -> Result<Self, TransportError> {
        let (n, m) = (control.len(), source.len());
        for (name, distances) in [("control", control), ("source", source)] {
            if let Distances::Dense(mat) = distances {
                check_shape(name, mat, mat.rows(), mat.rows(), "self-distances are square")?;
            }
        }
        params.validate()?;
        match cost {
            Some(cost) => {
                check_shape("cost", cost, n, m, "one row per control point and one column per source point")?;
            }
            None if params.alpha < 1.0 => return Err(TransportError::MissingCost { alpha: params.alpha }),
            None => {}
        }
        Ok(Self { control, source, cost, linear: None, mask: None, allowed: m, params })
    }

    /// Adds a linear cost of its own, N x M, to the objective: `sum_ij B_ij T_ij`, without a weight. Soft wishes go here:
    /// for pairs that should match, with weights, the caller sums up `alpha` times the squared differences of distances.
    /// Values may be negative; none may exceed 1e6. Replaces an earlier one.
    ///
    /// # Errors
    /// [`TransportError::Shape`]; [`TransportError::Bias`], as the values are read once.
    pub fn with_linear(self, bias: MatRef<'a, T>) -> Result<Self, TransportError> {
        let hint = "one row per control point and one column per source point";
        check_shape("bias", bias, self.rows(), self.cols(), hint)?;
        check_bias("bias", bias)?;
        Ok(Self { linear: Some(bias), ..self })
    }

    /// Limits the plan, exactly and from the start on: see [`Mask`]. Replaces an earlier one.
    ///
    /// # Errors
    /// [`TransportError::MaskIndex`], [`TransportError::FixedTwice`], [`TransportError::FixedOnForbidden`],
    /// [`TransportError::NoColumn`].
    pub fn with_mask(self, mask: &'a Mask) -> Result<Self, TransportError> {
        let allowed = mask.check(self.rows(), self.cols())?;
        Ok(Self { mask: Some(mask), allowed, ..self })
    }

    /// N, the number of control points: rows of the plan.
    pub fn rows(&self) -> usize {
        self.control.len()
    }

    /// M, the number of source points: columns of the plan.
    pub fn cols(&self) -> usize {
        self.source.len()
    }

    /// Distances within the control, of N points.
    pub fn control(&self) -> Distances<'a, T> {
        self.control
    }

    /// Distances within the source, of M points.
    pub fn source(&self) -> Distances<'a, T> {
        self.source
    }

    /// Cost between the two sides, N x M.
    pub fn cost(&self) -> Option<MatRef<'a, T>> {
        self.cost
    }

    /// The linear cost added to the gradient as it is, N x M.
    pub fn linear(&self) -> Option<MatRef<'a, T>> {
        self.linear
    }

    /// The limits on the plan.
    pub fn mask(&self) -> Option<&'a Mask> {
        self.mask
    }

    /// The source points that may be used: M less the forbidden ones. The target mass of each is one part of that many.
    pub fn allowed(&self) -> usize {
        self.allowed
    }

    /// The weights.
    pub fn params(&self) -> Params {
        self.params
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mat;

    fn distances(n: usize) -> Mat<f64> {
        Mat::from_fn(n, n, |i, j| (i as f64 - j as f64).abs())
    }

    #[test]
    fn says_what_is_wrong() {
        let (y, x, c) = (distances(3), distances(4), Mat::<f64>::zeros(3, 4));
        let params = Params::default();
        let new = |y: &Mat<f64>, x: &Mat<f64>, c: Option<&Mat<f64>>, params| {
            Problem::new(y.view(), x.view(), c.map(Mat::view), params).map(|_| ()).unwrap_err().to_string()
        };
        assert!(Problem::new(y.view(), x.view(), Some(c.view()), params).is_ok());
        assert!(Problem::new(y.view(), x.view(), None, Params { alpha: 1.0, ..params }).is_ok());
        assert_eq!(
            new(&y, &x, Some(&Mat::zeros(4, 3)), params),
            "`cost` is 4 x 3, expected 3 x 4; one row per control point and one column per source point"
        );
        assert!(new(&Mat::zeros(0, 0), &x, None, params).starts_with("`control` is empty"));
        assert!(new(&Mat::zeros(2, 3), &x, None, params).contains("expected 2 x 2"));
        assert!(new(&y, &x, None, params).contains("no cost matrix"));
        for (alpha, lambda, epsilon) in [
            (1.1, 0.1, 0.1),
            (f64::NAN, 0.1, 0.1),
            (0.5, -0.1, 0.1),
            (0.5, 0.1, 0.0),
            (0.5, f64::INFINITY, 0.1),
        ] {
            assert!(new(&y, &x, Some(&c), Params { alpha, lambda, epsilon }).contains("it must be between"));
        }
    }

    #[test]
    fn says_where_a_value_is_wrong() {
        let (y, c) = (distances(3), Mat::<f64>::zeros(3, 4));
        let with = |i: usize, j: usize, value| {
            let mut x = distances(4);
            x.row_mut(i)[j] = value;
            Problem::new(y.view(), x.view(), Some(c.view()), Params::default()).map(|_| ()).unwrap_err()
        };
        assert!(matches!(with(2, 1, f64::NAN), TransportError::Value { name: "source", row: 2, col: 1, .. }));
        assert!(matches!(with(0, 3, -1.0), TransportError::Value { row: 0, col: 3, .. }));
        assert!(matches!(with(1, 1, 0.5), TransportError::Distance { row: 1, col: 1, expected: 0.0, .. }));
        assert!(matches!(with(0, 3, 2.5), TransportError::Distance { row: 3, col: 0, .. }));
    }
}
