//! The first stage: the autoencoder.

use super::course::Course;
use super::reconstruction::{Reconstruction, reconstruction};
use super::run::{OnStep, Place, Report, run};
use super::settings::VaeSettings;
use super::stage::{Loss, Stage, network, seed_of};
use super::weights_file::{header_of, read_weights, write_weights};
use super::windows::{Batch, Windows};
use crate::TrainError;
use crate::corpus::{CorpusStatistics, Manifest, Split};
use burn::tensor::{Device, Tensor, TensorData};
use inkrig_generate::checkpoint::ModelHeader;
use inkrig_generate::networks::{Parts, Sizes, Vae};
use inkrig_generate::schedule::Noise;
use inkrig_generate::trainable::{FrameMask, TrainableVae, VaeLoss, VaeLossWeights};
use inkrig_generate::weights::{Tensors, random};
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
        train: Windows::read(&manifest, Split::Train, &statistics, true, settings.balance)?,
        held_out: Windows::read(&manifest, Split::Val, &statistics, false, 0.0)?,
        header: header_of(&sizes, &stored),
        device: Device::flex().autodiff(),
        settings,
        sizes,
        statistics,
    };
    let weights = match place.from {
        Some(path) => read_weights(path)?.1,
        None => random(&stage.sizes, Parts::VAE, settings.seed),
    };
    let first = TrainableVae::new(&stage.sizes, &weights, settings.dropout, &stage.device);
    let (report, weights) = run(&stage, first.map_err(network)?, place, progress)?;
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
    device: Device,
}

impl VaeStage<'_> {
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
    type Network = TrainableVae;
    type Beside = ();
    /// Windows, and the noise on their latents.
    type Work = (Batch, Vec<f32>);

    const PARTS: &'static [&'static str] = &["features", "places", "divergence"];

    fn course(&self) -> Course {
        self.settings.course()
    }

    fn settings(&self) -> String {
        serde_json::to_string(self.settings).unwrap_or_default()
    }

    fn beside(&self) -> Result<(), TrainError> {
        Ok(())
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

    fn loss(
        &self,
        network: &TrainableVae,
        (): &(),
        (batch, latent_noise): Self::Work,
        step: u64,
    ) -> Result<Loss, TrainError> {
        let (settings, sizes, device) = (self.settings, &self.sizes, &self.device);
        let clips = batch.lengths.len();
        let mask = FrameMask::new(&batch.lengths, batch.frames);
        let shape = [clips, batch.frames, WIDTH];
        let features = Tensor::<3>::from_data(TensorData::new(batch.features, shape), device);
        let shape = [clips, sizes.latent_tokens, sizes.width];
        let noise = Tensor::<3>::from_data(TensorData::new(latent_noise, shape), device);
        let (mean, log_variance) = network.encode(features.clone(), &mask);
        let latent = TrainableVae::sample(mean.clone(), log_variance.clone(), noise, settings.noise_at(step));
        let decoded = network.decode(&latent, &mask);
        let weights = VaeLossWeights {
            places: settings.places,
            divergence: settings.divergence,
            ..VaeLossWeights::default()
        };
        let spread = (mean, log_variance);
        let loss = VaeLoss::new(decoded, features, spread, &mask, &self.statistics, &weights);
        Ok(Loss { total: loss.total, parts: vec![loss.features, loss.places, loss.divergence] })
    }

    fn tensors(&self, vae: &TrainableVae) -> Result<Tensors, TrainError> {
        vae.to_tensors().map_err(network)
    }

    fn measure(&self, weights: &Tensors) -> Result<Vec<(&'static str, f64)>, TrainError> {
        let back = self.reconstruction(weights, self.settings.frames, MEASURED)?;
        Ok(vec![("held_out_mm", back.global_mm), ("held_out_aligned_mm", back.aligned_mm)])
    }

    fn write(&self, path: &Path, weights: &Tensors) -> Result<(), TrainError> {
        write_weights(path, weights, &self.header)
    }
}
