//! From conditions to clips: steps of denoising, with text weighted and guidance where they are asked for.

mod conditions;
mod examples;
mod misses;
mod model;
mod sampler;
mod semantics;

pub use conditions::{Conditions, Request};
pub use examples::Examples;
pub(crate) use misses::Misses;
pub use model::{Control, Encoders, EstimateControl, Networks};
pub use sampler::{Sampled, Sampler, SamplingOptions, StepReport, Steps};
pub use semantics::Semantics;
