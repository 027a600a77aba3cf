//! Where a run stands, in one file that is replaced as a whole.

use super::adamw::Moments;
use crate::TrainError;
use crate::corpus::write;
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::io::Read as _;
use std::path::Path;

/// The file in a run's folder.
pub(crate) const CHECKPOINT: &str = "checkpoint.safetensors";
const HEADER: &str = "inkrig-training";
/// More than the largest network with its moments.
const MOST_BYTES: u64 = 8 << 30;

/// A run at a step.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Checkpoint {
    pub weights: Vec<f32>,
    pub moments: Moments,
    /// Mean of the weights along the way, where one is kept.
    pub average: Option<Vec<f32>>,
    pub state: State,
}

/// What is not a row of numbers.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    /// What the run was told, as JSON: with other settings it is another run.
    pub settings: String,
    /// Seconds of training so far.
    pub seconds: f64,
    /// The best measurement and its step.
    pub best: Option<(f64, u64)>,
    /// Steps that were taken; the same as the optimiser's.
    pub step: u64,
}

impl Checkpoint {
    pub(crate) fn write(&self, path: &Path) -> Result<(), TrainError> {
        let content = |what: String| TrainError::Content { path: path.to_path_buf(), what };
        let state = serde_json::to_string(&self.state).map_err(|error| content(error.to_string()))?;
        let rows =
            [("weights", &self.weights), ("mean", &self.moments.mean), ("square", &self.moments.square)];
        let rows = rows.into_iter().chain(self.average.as_ref().map(|average| ("average", average)));
        let bytes: Vec<(&str, Vec<u8>)> = rows
            .map(|(name, row)| (name, row.iter().flat_map(|number| number.to_le_bytes()).collect()))
            .collect();
        let views = bytes.iter().map(|(name, bytes)| {
            TensorView::new(Dtype::F32, vec![bytes.len() / 4], bytes).map(|view| (*name, view))
        });
        let views = views.collect::<Result<Vec<_>, _>>().map_err(|error| content(error.to_string()))?;
        let metadata = HashMap::from([(HEADER.to_string(), state)]);
        let file =
            safetensors::serialize(views, Some(metadata)).map_err(|error| content(error.to_string()))?;
        write(path, &file)
    }

    /// `None` where there is none yet.
    pub(crate) fn read(path: &Path) -> Result<Option<Self>, TrainError> {
        let failed = |cause| TrainError::File { path: path.to_path_buf(), cause };
        let content = |what: &str| TrainError::Content {
            path: path.to_path_buf(),
            what: format!("{what}: remove it to begin anew, or put an earlier one in its place"),
        };
        let file = match std::fs::File::open(path) {
            Ok(file) => file,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(failed(error)),
        };
        let mut bytes = Vec::new();
        file.take(MOST_BYTES).read_to_end(&mut bytes).map_err(failed)?;
        let broken = |_| content("is damaged");
        let (_, metadata) = SafeTensors::read_metadata(&bytes).map_err(broken)?;
        let tensors = SafeTensors::deserialize(&bytes).map_err(broken)?;
        let state = metadata.metadata().as_ref().and_then(|all| all.get(HEADER));
        let state: State = state
            .and_then(|text| serde_json::from_str(text).ok())
            .ok_or_else(|| content("is no checkpoint of a training run"))?;
        let row = |name: &str| -> Result<Vec<f32>, TrainError> {
            let view = tensors.tensor(name).map_err(broken)?;
            let (numbers, rest) = view.data().as_chunks::<4>();
            let row: Vec<f32> = numbers.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
            if view.dtype() != Dtype::F32 || !rest.is_empty() || row.iter().any(|number| !number.is_finite())
            {
                return Err(content("holds numbers that are none"));
            }
            Ok(row)
        };
        let (weights, mean, square) = (row("weights")?, row("mean")?, row("square")?);
        let average = if tensors.names().contains(&"average") { Some(row("average")?) } else { None };
        let others = [Some(&mean), Some(&square), average.as_ref()];
        if others.into_iter().flatten().any(|row| row.len() != weights.len()) {
            return Err(content("is damaged"));
        }
        Ok(Some(Self { weights, moments: Moments { step: state.step, mean, square }, average, state }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checkpoint_comes_back_and_damage_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(CHECKPOINT);
        assert_eq!(Checkpoint::read(&path).unwrap(), None);
        let mut moments = Moments::new(3);
        moments.step = 7;
        let state = State { step: 7, best: Some((41.5, 5)), ..State::default() };
        let average = Some(vec![0.5, 0.25, 0.0]);
        let checkpoint = Checkpoint { weights: vec![1.0, -2.5, 3e-9], moments, average, state };
        checkpoint.write(&path).unwrap();
        assert_eq!(Checkpoint::read(&path).unwrap(), Some(checkpoint.clone()));
        let plain = Checkpoint { average: None, ..checkpoint.clone() };
        plain.write(&path).unwrap();
        assert_eq!(Checkpoint::read(&path).unwrap(), Some(plain));
        let bytes = std::fs::read(&path).unwrap();
        for length in [0, 10, bytes.len() - 1] {
            std::fs::write(&path, &bytes[..length]).unwrap();
            assert!(Checkpoint::read(&path).unwrap_err().to_string().contains("damaged"), "{length}");
        }
        Checkpoint { weights: vec![1.0, f32::NAN, 0.0], ..checkpoint }.write(&path).unwrap();
        assert!(Checkpoint::read(&path).unwrap_err().to_string().contains("numbers that are none"));
    }
}
