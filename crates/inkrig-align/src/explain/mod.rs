//! Why a result is as it is: which part of the clip is used when, and what else would have fitted as well.

mod alternatives;
mod explanation;
mod first_plans;
mod symmetry;

pub use alternatives::{Alternative, alternatives};
pub use explanation::Explanation;
pub(crate) use first_plans::{FirstPlans, mirrored, others};
pub(crate) use symmetry::Reflection;
