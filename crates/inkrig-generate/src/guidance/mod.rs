//! Guidance at inference: clips that shall meet drawn trajectories are moved towards them while they are denoised.

mod guide;
mod lbfgs;
mod missing;
mod places;
mod settle;
mod target;

pub use guide::{GuidanceOptions, Guide, Guided, GuidedClip, Method, Variable};
pub use lbfgs::{Lbfgs, LbfgsOptions, Objective};
pub(crate) use missing::{away, between, of_pose, of_pose_back, seen_part};
pub(crate) use places::Places;
pub use settle::SettleOptions;
pub use target::{Ask, Mean, Target, View};
