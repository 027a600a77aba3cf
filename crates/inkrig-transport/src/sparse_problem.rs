use crate::check::check_length;
use crate::{
    LowRank, Mask, MmSinkhorn, Params, Plan, Real, SparseWorkspace, Start, Support, Terms, TransportError,
};

/// A transport problem whose plan has entries on a [`Support`] only, with distances by factors: nothing of it takes
/// N x M memory. The objective is that of [`Problem`](crate::Problem).
#[derive(Clone, Copy, Debug)]
pub struct SparseProblem<'a, T: Real> {
    pub(crate) control: &'a LowRank<T>,
    pub(crate) source: &'a LowRank<T>,
    pub(crate) support: &'a Support,
    pub(crate) cost: Option<&'a [T]>,
    pub(crate) linear: Option<&'a [T]>,
    pub(crate) mask: Option<&'a Mask>,
    pub(crate) allowed: usize,
    pub(crate) params: Params,
}

impl<'a, T: Real> SparseProblem<'a, T> {
    /// * `control`, `source`: distances within N and M points, divided by their mean or maximum.
    /// * `support`: N x M.
    /// * `cost`: a value for each entry of the support, row after row, at least 0, in the unit of `source`; may be absent
    ///   only when `alpha` is 1.
    ///
    /// # Errors
    /// [`TransportError::Shape`], [`TransportError::Parameter`], [`TransportError::MissingCost`],
    /// [`TransportError::Value`] for a cost that is negative, not finite or above 1e6.
    pub fn new(
        control: &'a LowRank<T>,
        source: &'a LowRank<T>,
        support: &'a Support,
        cost: Option<&'a [T]>,
        params: Params,
    ) -> Result<Self, TransportError> {
        let (rows, cols) = (support.rows(), support.cols());
        let (expected_rows, expected_cols) = (control.len(), source.len());
        if (rows, cols) != (expected_rows, expected_cols) {
            let hint = "one row per control point and one column per source point";
            let name = "support";
            return Err(TransportError::Shape { name, rows, cols, expected_rows, expected_cols, hint });
        }
        params.validate()?;
        match cost {
            Some(cost) => {
                check_length("cost", cost.len(), support.len(), "one value per entry of the support")?;
                let limit = T::from_f64(1e6);
                if let Some(at) = cost.iter().position(|&x| !(x >= T::ZERO && x <= limit)) {
                    let ((row, col), value) = (place(support, at), cost[at].to_f64());
                    return Err(TransportError::Value { name: "cost", row, col, value });
                }
            }
            None if params.alpha < 1.0 => return Err(TransportError::MissingCost { alpha: params.alpha }),
            None => {}
        }
        Ok(Self { control, source, support, cost, linear: None, mask: None, allowed: cols, params })
    }

    /// Adds a linear cost, a value for each entry of the support, without a weight; of any sign, at most 1e6. Replaces an
    /// earlier one.
    ///
    /// # Errors
    /// [`TransportError::Shape`], [`TransportError::Bias`].
    pub fn with_linear(self, bias: &'a [T]) -> Result<Self, TransportError> {
        check_length("bias", bias.len(), self.support.len(), "one value per entry of the support")?;
        let limit = T::from_f64(1e6);
        if let Some(at) = bias.iter().position(|&x| !(x >= -limit && x <= limit)) {
            let ((row, col), value) = (place(self.support, at), bias[at].to_f64());
            return Err(TransportError::Bias { name: "bias", row, col, value });
        }
        Ok(Self { linear: Some(bias), ..self })
    }

    /// Limits the plan: see [`Mask`]. A settled row's entry need not be in the support. Replaces an earlier one.
    ///
    /// # Errors
    /// As [`Problem::with_mask`](crate::Problem::with_mask); [`TransportError::NoColumn`] for the first row whose columns
    /// in the support are all forbidden.
    pub fn with_mask(self, mask: &'a Mask) -> Result<Self, TransportError> {
        let allowed = mask.check(self.rows(), self.cols())?;
        let mut open = vec![true; self.cols()];
        mask.columns.iter().for_each(|&j| open[j] = false);
        let mut settled = vec![false; self.rows()];
        mask.rows.iter().for_each(|&(i, _)| settled[i] = true);
        let blocked = |&i: &usize| !settled[i] && !self.support.row(i).iter().any(|&j| open[j as usize]);
        match (0..self.rows()).find(blocked) {
            Some(row) => Err(TransportError::NoColumn { row }),
            None => Ok(Self { mask: Some(mask), allowed, ..self }),
        }
    }

    /// N, the number of control points: rows of the plan.
    pub fn rows(&self) -> usize {
        self.support.rows()
    }

    /// M, the number of source points: columns of the plan.
    pub fn cols(&self) -> usize {
        self.support.cols()
    }

    /// Where the plan may have entries, before a mask.
    pub fn support(&self) -> &'a Support {
        self.support
    }

    /// The weights.
    pub fn params(&self) -> Params {
        self.params
    }

    /// The terms of a plan of this shape; what it has outside of the support, or against the mask, is moved onto it first.
    /// Costs a gradient and its memory.
    ///
    /// # Errors
    /// [`TransportError::NothingToContinue`] when the plan has another shape.
    pub fn terms(&self, plan: &Plan<T>) -> Result<Terms, TransportError> {
        let mut workspace = SparseWorkspace::new(1);
        workspace.resume(plan);
        let look = MmSinkhorn { iterations: 0, trace: 1, start: Start::Continue, ..MmSinkhorn::default() };
        let trace = look.solve_sparse(self, &mut workspace)?;
        Ok(trace.last().unwrap_or_default())
    }
}

/// Row and column of the entry `at`.
fn place(support: &Support, at: usize) -> (usize, usize) {
    let row = support.starts().partition_point(|&start| start <= at).saturating_sub(1);
    (row, support.columns()[at] as usize)
}
