//! How much noise there is at which step, and the steps that take it away.

mod betas;
mod ddim;
mod lcm;
mod noise;

pub use betas::{NoiseSchedule, STEPS};
pub use ddim::Ddim;
pub use lcm::Lcm;
pub(crate) use lcm::boundary;
pub use noise::Noise;
pub(crate) use noise::mix;
