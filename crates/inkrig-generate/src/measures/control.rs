//! How exactly controlled joints are where they were asked to be (OmniControl's measures).

use crate::GenerateError;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{JOINTS, Joints};

/// Distances that count as failed, metres.
const FAILED: [f64; 2] = [0.2, 0.5];

/// Errors of one motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlErrors {
    /// Mean distance at places that were asked for, metres ("Avg. Err.").
    pub mean: f64,
    /// Share of those places that are missed by more than 20 and 50 cm.
    pub places_failed: [f64; 2],
    /// Whether any is missed by more than 20 and 50 cm.
    pub failed: [bool; 2],
}

/// Means over motions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ControlSummary {
    /// Of [`ControlErrors::mean`], metres.
    pub mean: f64,
    /// Of the shares of places that are missed.
    pub places_failed: [f64; 2],
    /// The share of motions with a place that is missed.
    pub failed: [f64; 2],
}

/// Compares a motion with what was asked for: `asked` has a place for each joint of each frame that is controlled. Frames beyond the
/// shorter of the two do not count. For the paper's 2D error give projected places, with z = 0.
///
/// # Errors
/// [`GenerateError::Length`] when nothing was asked for.
pub fn control_errors(
    motion: &[Joints],
    asked: &[[Option<Vec3>; JOINTS]],
) -> Result<ControlErrors, GenerateError> {
    let pairs = motion.iter().zip(asked).flat_map(|(joints, asked)| joints.iter().zip(asked));
    let distances: Vec<f64> = pairs
        .filter_map(|(joint, asked)| Some(joint.as_dvec3().distance(asked.as_ref()?.as_dvec3())))
        .collect();
    if distances.is_empty() {
        return Err(GenerateError::Length {
            what: "list of places that were asked for",
            expected: 1,
            got: 0,
        });
    }
    let count = distances.len() as f64;
    let missed = FAILED.map(|most| distances.iter().filter(|distance| **distance > most).count());
    Ok(ControlErrors {
        mean: distances.iter().sum::<f64>() / count,
        places_failed: missed.map(|missed| missed as f64 / count),
        failed: missed.map(|missed| missed > 0),
    })
}

impl ControlSummary {
    /// Zero for none.
    pub fn of(errors: &[ControlErrors]) -> Self {
        let mean = |of: &dyn Fn(&ControlErrors) -> f64| {
            errors.iter().map(of).sum::<f64>() / errors.len().max(1) as f64
        };
        Self {
            mean: mean(&|errors| errors.mean),
            places_failed: [0, 1].map(|at| mean(&|errors| errors.places_failed[at])),
            failed: [0, 1].map(|at| mean(&|errors| f64::from(u8::from(errors.failed[at])))),
        }
    }
}
