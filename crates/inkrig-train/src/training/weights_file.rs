//! Weights as model files, for everything that runs them.

use crate::TrainError;
use crate::corpus::{CorpusStatistics, write};
use inkrig_generate::checkpoint::{
    CheckpointError, Listed, ModelFile, ModelHeader, ModelStatistics, NumberKind, write_model,
};
use inkrig_generate::configuration::TextEncoderKind;
use inkrig_generate::networks::Sizes;
use inkrig_generate::sampling::Semantics;
use inkrig_generate::weights::Tensors;
use std::fs::File;
use std::io::{BufReader, Cursor};
use std::path::Path;

/// Latents of a linear path go on where a weight pushes them: with 7.5 bodies come apart, with 2 crawling ones stand on their heads, with 1
/// words are hard to tell apart.
const TEXT_WEIGHT: f32 = 1.5;

/// What a model in training says of itself.
pub(super) fn header_of(sizes: &Sizes, statistics: &CorpusStatistics) -> ModelHeader {
    ModelHeader {
        statistics: Some(ModelStatistics {
            mean: statistics.mean.clone(),
            std: statistics.deviation.clone(),
            mean_raw: statistics.joint_mean.clone(),
            std_raw: statistics.joint_deviation.clone(),
        }),
        skeleton: Some(statistics.body.clone()),
        text_weight: Some(TEXT_WEIGHT),
        ..ModelHeader::new("in training", sizes.clone(), Semantics::Paper, TextEncoderKind::Verbs)
    }
}

/// Writes what was trained so far, in single precision.
pub(super) fn write_weights(path: &Path, tensors: &Tensors, header: &ModelHeader) -> Result<(), TrainError> {
    let failed = |error| content(path, &error);
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
    write_model(&mut file, header, &listed, next).map_err(failed)?;
    write(path, file.get_ref())
}

/// Reads what an earlier stage or run wrote.
pub(super) fn read_weights(path: &Path) -> Result<(ModelHeader, Tensors), TrainError> {
    let failed = |error| content(path, &error);
    let file = File::open(path).map_err(|cause| TrainError::File { path: path.into(), cause })?;
    let mut file = ModelFile::open(BufReader::new(file)).map_err(failed)?;
    let tensors = file.tensors().map_err(failed)?;
    Ok((file.header().clone(), tensors))
}

/// Tensors of one table, and those of another under the same names in their place.
pub(super) fn merged(base: &Tensors, own: &Tensors) -> Tensors {
    let rows = |tensors: &Tensors| tensors.clone().into_iter().collect::<Vec<_>>();
    rows(base).into_iter().chain(rows(own)).collect()
}

/// Tensors whose names begin so.
pub(super) fn named(weights: &Tensors, begin: &str) -> Tensors {
    let own = weights.iter().filter(|(name, _)| name.starts_with(begin));
    own.map(|(name, tensor)| (name.to_string(), tensor.clone())).collect()
}

fn content(path: &Path, error: &CheckpointError) -> TrainError {
    TrainError::Content { path: path.to_path_buf(), what: error.to_string() }
}
