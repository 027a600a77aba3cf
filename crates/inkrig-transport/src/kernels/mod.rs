//! The element-wise inner loops. Each is a struct of inputs and outputs with one `run`, written once in plain Rust, and
//! compiled for every instruction level by [`dispatch`].

mod factors;
mod isa_entry;
mod rows;
mod scaling;
mod sparse;
mod tiles;
#[cfg(target_arch = "x86_64")]
pub(crate) mod vector;
mod windows;

pub(crate) use factors::{ColumnDots, LessColumns, LessRows};
pub(crate) use rows::{Gibbs, Mirror, PlanRows, Softmax, SquareProduct, Sweep};
pub(crate) use scaling::Scaling;
pub(crate) use sparse::{Block, EntryDots, Gather, SparseGibbs, SparsePlanRows, SparseSweep};
pub(crate) use tiles::Product;
pub(crate) use windows::{PairDistances, WeightedRows};

use crate::Isa;

/// One inner loop.
pub(crate) trait Kernel {
    type Output;
    /// The loop itself. `FMA` says whether the processor fuses `a * b + c`; always inlined into the function that
    /// carries the instruction level.
    fn run<const FMA: bool>(self) -> Self::Output;
}

/// Runs a kernel at an instruction level, or at the processor's best when that is lower.
pub(crate) fn dispatch<K: Kernel>(isa: Isa, kernel: K) -> K::Output {
    isa_entry::run(isa, kernel)
}
