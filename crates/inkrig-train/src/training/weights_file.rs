//! Weights as a model file, for everything that runs them.

use crate::TrainError;
use crate::corpus::{CorpusStatistics, write};
use inkrig_generate::checkpoint::{
    CheckpointError, Listed, ModelHeader, ModelStatistics, NumberKind, write_model,
};
use inkrig_generate::configuration::TextEncoderKind;
use inkrig_generate::networks::Sizes;
use inkrig_generate::sampling::Semantics;
use inkrig_generate::weights::Tensors;
use std::io::Cursor;
use std::path::Path;

/// Writes what was trained so far, in single precision.
pub(super) fn write_weights(
    path: &Path,
    tensors: &Tensors,
    sizes: &Sizes,
    statistics: &CorpusStatistics,
) -> Result<(), TrainError> {
    let failed =
        |error: CheckpointError| TrainError::Content { path: path.to_path_buf(), what: error.to_string() };
    let header = ModelHeader {
        statistics: Some(ModelStatistics {
            mean: statistics.mean.clone(),
            std: statistics.deviation.clone(),
            mean_raw: statistics.joint_mean.clone(),
            std_raw: statistics.joint_deviation.clone(),
        }),
        skeleton: Some(statistics.body.clone()),
        ..ModelHeader::new("in training", sizes.clone(), Semantics::Paper, TextEncoderKind::Verbs)
    };
    let listed: Vec<Listed> = tensors
        .iter()
        .map(|(name, tensor)| Listed {
            name: name.into(),
            shape: tensor.shape().to_vec(),
            kind: NumberKind::F32,
        })
        .collect();
    let all: Vec<_> = tensors.iter().map(|(_, tensor)| tensor).collect();
    let mut file = Cursor::new(Vec::new());
    let next = |at: usize| {
        let missing = || CheckpointError::Header { what: "a tensor went missing".into() };
        all.get(at).map(|tensor| (*tensor).clone()).ok_or_else(missing)
    };
    write_model(&mut file, &header, &listed, next).map_err(failed)?;
    write(path, file.get_ref())
}
