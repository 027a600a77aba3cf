use crate::Terms;

/// What a solve did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// The objective's terms along the way, oldest first; empty unless asked for.
    pub records: Vec<Record>,
    /// Outer iterations done; each took one gradient.
    pub iterations: usize,
    /// Sweeps over the kernel done in all, [`MmSinkhorn`](crate::MmSinkhorn) only.
    pub sweeps: usize,
    /// The step used, [`MirrorDescent`](crate::MirrorDescent) only.
    pub step: Option<f64>,
    /// L1 distance between the last two plans, when it was watched.
    pub change: Option<f64>,
}

impl Trace {
    /// The terms at the end, when recorded.
    pub fn last(&self) -> Option<Terms> {
        self.records.last().map(|record| record.terms)
    }
}

/// The terms after some iterations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    /// Iterations done, counted from 1; 0 is the start.
    pub iteration: usize,
    /// Terms of the plan at that point.
    pub terms: Terms,
}
