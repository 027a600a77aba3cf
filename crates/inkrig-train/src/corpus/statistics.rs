//! What the numbers of a corpus are normalised by.

use super::config::read_text;
use crate::TrainError;
use inkrig_motion::MotionError;
use inkrig_motion::humanml::{JOINTS, Statistics};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Its file in the corpus folder.
pub(super) const FILE: &str = "statistics.json";

/// What numbers are normalised by, and the body that everybody has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CorpusStatistics {
    /// Mean of the 263 features over the training split, mirror images included.
    pub mean: Vec<f32>,
    /// Their deviation, one value a block.
    pub deviation: Vec<f32>,
    /// Mean of the 66 joint coordinates.
    pub joint_mean: Vec<f32>,
    /// Their deviation.
    pub joint_deviation: Vec<f32>,
    /// The bone that ends at each joint where nothing is turned, metres.
    pub body: Vec<[f32; 3]>,
}

impl CorpusStatistics {
    /// Reads those of a corpus folder.
    ///
    /// # Errors
    /// When they are not there or are no statistics.
    pub fn read(folder: &Path) -> Result<Self, TrainError> {
        let path = folder.join(FILE);
        let content = |what: String| TrainError::Content { path: path.clone(), what };
        let read: Self =
            serde_json::from_str(&read_text(&path)?).map_err(|error| content(error.to_string()))?;
        read.features().and(read.joints()).map_err(|error| content(error.to_string()))?;
        if read.body.len() != JOINTS {
            return Err(content(format!("has a body of {} joints, not {JOINTS}", read.body.len())));
        }
        Ok(read)
    }

    /// Of the 263 features.
    ///
    /// # Errors
    /// When a number is none.
    pub fn features(&self) -> Result<Statistics, MotionError> {
        Statistics::new(self.mean.clone(), self.deviation.clone())
    }

    /// Of the 66 joint coordinates.
    ///
    /// # Errors
    /// When a number is none.
    pub fn joints(&self) -> Result<Statistics, MotionError> {
        Statistics::new(self.joint_mean.clone(), self.joint_deviation.clone())
    }
}
