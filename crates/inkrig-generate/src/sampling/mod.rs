//! From conditions to clips: steps of denoising, with text weighted and guidance where they are asked for.

mod conditions;
mod model;
mod sampler;
mod semantics;

pub use conditions::{Conditions, Request};
pub use model::{Control, Encoders, Networks};
pub use sampler::{Sampled, Sampler, SamplingOptions, StepReport, Steps};
pub use semantics::Semantics;
