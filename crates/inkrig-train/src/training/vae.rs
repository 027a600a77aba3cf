//! The first stage: the autoencoder.

use super::checkpoint::CHECKPOINT;
use super::course::Course;
use super::linear_path::{PathOptions, linear_path};
use super::motions::Selection;
use super::reconstruction::{Reconstruction, reconstruction};
use super::run::{OnStep, Place, Report, run};
use super::settings::VaeSettings;
use super::stage::{Stage, Weights, network, seed_of, told};
use super::weights_file::{header_of, named, read_weights, write_weights};
use super::windows::{Batch, Windows};
use crate::TrainError;
use crate::corpus::{CorpusStatistics, Manifest, Split};
use inkrig_generate::checkpoint::ModelHeader;
use inkrig_generate::learning::{VaeLearner, VaeObjective};
use inkrig_generate::networks::{Parts, Sizes, Vae};
use inkrig_generate::schedule::Noise;
use inkrig_generate::weights::{Tensor, Tensors, random};
use inkrig_motion::humanml::{Statistics, WIDTH};
use std::path::Path;

/// Held-out windows that are measured along the way.
const MEASURED: usize = 300;

/// Lengths at which the end is measured.
const LENGTHS: [usize; 3] = [40, 80, 120];

/// Trains the autoencoder, or goes on with it; also gives how well the last weights bring held-out clips back, by length.
///
/// # Errors
/// When the corpus or the checkpoint cannot be read, the checkpoint is of other settings, a loss is no number, or nothing can be written.
pub fn train_vae(
    place: &Place<'_>,
    settings: &VaeSettings,
    progress: &mut OnStep<'_>,
) -> Result<(Report, Vec<Reconstruction>), TrainError> {
    let sizes = settings.network().map_err(TrainError::Device)?;
    let manifest = Manifest::read(place.corpus)?;
    let stored = CorpusStatistics::read(place.corpus)?;
    let statistics = stored.features().map_err(|error| TrainError::Device(error.to_string()))?;
    let stage = VaeStage {
        train: Windows::read(&manifest, Split::Train, &statistics, settings.selection())?,
        held_out: Windows::read(&manifest, Split::Val, &statistics, Selection::PLAIN)?,
        header: header_of(&sizes, &stored),
        settings,
        sizes,
        statistics,
    };
    let first = match place.from {
        Some(path) => named(&read_weights(path)?.1, "vae."),
        None if place.folder.join(CHECKPOINT).exists() => random(&stage.sizes, Parts::VAE, settings.seed),
        None => stage.first()?,
    };
    let (report, weights) = run(&stage, first, place, progress)?;
    let fitting = LENGTHS.into_iter().filter(|&frames| frames <= stage.sizes.most_frames());
    let held_out = fitting.map(|frames| stage.reconstruction(&weights, frames, usize::MAX));
    Ok((report, held_out.collect::<Result<_, _>>()?))
}

struct VaeStage<'a> {
    settings: &'a VaeSettings,
    sizes: Sizes,
    statistics: Statistics,
    header: ModelHeader,
    train: Windows,
    held_out: Windows,
}

impl VaeStage<'_> {
    /// Weights to begin with: where there is a linear path, the blocks have no say at first.
    fn first(&self) -> Result<Tensors, TrainError> {
        let mut weights = random(&self.sizes, Parts::VAE, self.settings.seed);
        if self.sizes.cosines == 0 {
            return Ok(weights);
        }
        let settings = self.settings;
        let options = PathOptions {
            frames: settings.frames,
            other_lengths: settings.other_lengths,
            shortest: settings.shortest,
            longest: settings.longest,
            noise: settings.path_noise,
            seed: settings.seed,
        };
        weights.extend(linear_path(&self.train, &self.statistics, &self.sizes, &options)?);
        for name in ["vae.encoder.norm.weight", "vae.encoder.norm.bias", "vae.final_layer.weight"] {
            if let Some(tensor) = weights.get(name) {
                let zeros = Tensor::new(tensor.shape().to_vec(), vec![0.0; tensor.data().len()]);
                weights.insert(name, zeros.map_err(network)?);
            }
        }
        Ok(weights)
    }

    fn reconstruction(
        &self,
        weights: &Tensors,
        frames: usize,
        most: usize,
    ) -> Result<Reconstruction, TrainError> {
        let vae = Vae::new(&self.sizes, weights).map_err(network)?;
        reconstruction(&vae, &self.held_out, &self.statistics, frames, most)
    }
}

impl Stage for VaeStage<'_> {
    type Replica = VaeLearner;
    /// Windows, and the noise on their latents.
    type Work = (Batch, Vec<f32>);

    const PARTS: &'static [&'static str] = &["features", "places", "divergence"];

    fn course(&self) -> Course {
        self.settings.course()
    }

    fn settings(&self) -> String {
        serde_json::to_string(self.settings).unwrap_or_default()
    }

    fn is_same(&self, settings: &str) -> bool {
        let told = told::<VaeSettings>(settings, &[("dropout", 0.0)], &[("retimed", 0.0)]);
        told.is_some_and(|told| told == *self.settings)
    }

    fn replica(&self) -> Result<VaeLearner, TrainError> {
        let weights = self.course().for_learning(random(&self.sizes, Parts::VAE, 0));
        VaeLearner::new(&self.sizes, &weights).map_err(network)
    }

    fn draw(&self, step: u64, replicas: usize) -> Vec<Self::Work> {
        let mut noise = Noise::new(seed_of(self.settings.seed, step));
        let frames = if noise.uniform() < self.settings.other_lengths {
            let span = (self.settings.longest - self.settings.shortest + 1) as f64;
            self.settings.shortest + (noise.uniform() * span) as usize
        } else {
            self.settings.frames
        };
        let each = self.settings.batch.div_ceil(replicas);
        let part = |_| {
            let batch = self.train.draw(each, frames, &mut noise);
            (batch, noise.normals(each * self.sizes.latent_tokens * self.sizes.width))
        };
        (0..replicas).map(part).collect()
    }

    fn gradient(
        &self,
        learner: &mut VaeLearner,
        weights: Weights<'_>,
        (batch, noise): Self::Work,
        step: u64,
        gradient: &mut Vec<f32>,
    ) -> Result<Vec<f64>, TrainError> {
        let objective = VaeObjective {
            features: 1.0,
            places: self.settings.places,
            divergence: self.settings.divergence,
            noise: self.settings.noise_at(step),
            statistics: &self.statistics,
        };
        let clips = batch.features.chunks_exact(batch.frames * WIDTH).zip(&batch.lengths);
        let features: Vec<f32> =
            clips.flat_map(|(rows, length)| rows.iter().take(length * WIDTH)).copied().collect();
        let clips = (&features[..], &batch.lengths[..]);
        let losses = learner.step(weights.now, clips, &noise, &objective, gradient).map_err(network)?;
        Ok(vec![losses.total, losses.features, losses.places, losses.divergence])
    }

    fn measure(&self, weights: &Tensors) -> Result<Vec<(&'static str, f64)>, TrainError> {
        let back = self.reconstruction(weights, self.settings.frames, MEASURED)?;
        Ok(vec![("held_out_mm", back.global_mm), ("held_out_aligned_mm", back.aligned_mm)])
    }

    fn write(&self, path: &Path, weights: &Tensors) -> Result<(), TrainError> {
        write_weights(path, weights, &self.header)
    }
}
