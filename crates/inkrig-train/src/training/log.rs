//! What is written down while training, one line a measurement.

use crate::TrainError;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::Path;

/// The file in a run's folder.
pub(crate) const LOG: &str = "log.jsonl";

/// A line of `log.jsonl`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Steps that were taken.
    pub step: u64,
    /// Mean of what was made small, since the last line.
    pub loss: f64,
    /// Mean length of the gradient before it was clipped.
    pub gradient: f64,
    /// Rate of the last step.
    pub rate: f64,
    /// Seconds of training, earlier runs included.
    pub seconds: f64,
    /// The loss' parts by their names, and what was measured on held-out clips, whose names begin with `held_out`.
    #[serde(flatten)]
    pub values: BTreeMap<String, f64>,
}

impl Row {
    /// A part or a measurement by its name.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.values.get(name).copied()
    }
}

/// Adds a line.
pub(super) fn append(path: &Path, row: &Row) -> Result<(), TrainError> {
    let failed = |cause| TrainError::File { path: path.to_path_buf(), cause };
    let mut file = std::fs::OpenOptions::new().create(true).append(true).open(path).map_err(failed)?;
    let line = serde_json::to_string(row).unwrap_or_default();
    writeln!(file, "{line}").map_err(failed)
}

/// All lines; one that was cut off by a crash is none.
pub(super) fn read(path: &Path) -> Result<Vec<Row>, TrainError> {
    let text = crate::corpus::read_text(path)?;
    Ok(text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect())
}

/// All lines up to a step. What stands behind it was taken back when a run was killed, and is taken out of the file.
pub(super) fn read_until(path: &Path, step: u64) -> Result<Vec<Row>, TrainError> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let all = read(path)?;
    let count = all.len();
    let rows: Vec<Row> = all.into_iter().filter(|row| row.step <= step).collect();
    if rows.len() < count {
        let lines = rows.iter().map(|row| serde_json::to_string(row).unwrap_or_default() + "\n");
        crate::corpus::write(path, lines.collect::<String>().as_bytes())?;
    }
    Ok(rows)
}
