//! How good motions are: the measures of the paper's tables, as plain functions on positions (metres, y up, 20 frames a second)
//! and on embeddings by the text-motion evaluator (Guo et al. 2022).

mod control;
mod eigenvalues;
mod evaluator;
mod frechet;
mod jerk;
mod pose;
mod retrieval;
mod skating;

pub use control::{ControlErrors, ControlSummary, control_errors};
pub use evaluator::{Evaluator, WORDS};
pub use frechet::frechet_distance;
pub use jerk::{REAL_JERK, area_under_jerk, jerk, mean_jerk, peak_jerk};
pub use pose::{pose_error, pose_error_2d};
pub use retrieval::{Retrieval, diversity, retrieval};
pub use skating::{Skating, skating};
