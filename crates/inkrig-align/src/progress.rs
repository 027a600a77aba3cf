//! What a long run says of itself, and how it is stopped.

use crate::AlignError;
use std::ops::ControlFlow;

/// Where a run is. Gradients are the unit: they are nearly all of the time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Level that is being worked on, 1 is the coarsest.
    pub level: usize,
    /// Number of levels.
    pub levels: usize,
    /// Gradients done so far.
    pub done: usize,
    /// Gradients of the whole run.
    pub total: usize,
}

/// Called after every round, on whatever thread works. [`ControlFlow::Break`] ends the run with [`AlignError::Cancelled`].
pub type Observer<'a> = &'a mut (dyn FnMut(Progress) -> ControlFlow<()> + Send);

pub(crate) fn report(
    observer: &mut (dyn FnMut(Progress) -> ControlFlow<()> + Send),
    progress: Progress,
) -> Result<(), AlignError> {
    match observer(progress) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(AlignError::Cancelled),
    }
}
