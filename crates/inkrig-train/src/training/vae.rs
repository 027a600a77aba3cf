//! The first stage: the autoencoder.

use super::adamw::{AdamW, Moments, clip};
use super::checkpoint::{Checkpoint, State};
use super::flat;
use super::log::{self, Row};
use super::rate::rate;
use super::reconstruction::{Reconstruction, reconstruction};
use super::settings::VaeSettings;
use super::weights_file::write_weights;
use super::windows::{Batch, Windows};
use crate::TrainError;
use crate::corpus::{CorpusStatistics, Manifest, Split};
use burn::tensor::{Device, Tensor, TensorData};
use inkrig_generate::networks::{Parts, Sizes, Vae};
use inkrig_generate::schedule::Noise;
use inkrig_generate::trainable::{FrameMask, TrainableVae, VaeLoss, VaeLossWeights};
use inkrig_generate::weights::random;
use inkrig_motion::humanml::{Statistics, WIDTH};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

/// Held-out windows that are measured along the way.
const MEASURED: usize = 300;

/// Lengths at which the end is measured.
const LENGTHS: [usize; 3] = [40, 80, 120];

/// Hears of a step: how many were taken, of how many, and what was measured at it.
pub type OnStep<'a> = dyn FnMut(u64, u64, Option<&Row>) -> ControlFlow<()> + 'a;

/// A gradient, and the loss with its parts.
type Gradient = (Vec<f32>, [f64; 4]);

/// What a run came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Its log, earlier runs included.
    pub rows: Vec<Row>,
    /// Of the last weights, on the held-out split, by length.
    pub held_out: Vec<Reconstruction>,
    /// Whether all steps were taken; else it was stopped.
    pub complete: bool,
}

/// Trains, or goes on with, the run in `folder`. `replicas` copies of the network work side by side on a part of every batch each;
/// the result depends on their number. `progress` hears of every step and every new row, and can stop the run, which keeps its place.
///
/// # Errors
/// When the corpus or the checkpoint cannot be read, the checkpoint is of other settings, a loss is no number, or nothing can be written.
pub fn train_vae(
    corpus: &Path,
    folder: &Path,
    settings: &VaeSettings,
    replicas: usize,
    progress: &mut OnStep<'_>,
) -> Result<Report, TrainError> {
    let sizes = settings.network().map_err(TrainError::Device)?;
    let manifest = Manifest::read(corpus)?;
    let stored = CorpusStatistics::read(corpus)?;
    let statistics = stored.features().map_err(|error| TrainError::Device(error.to_string()))?;
    let train = Windows::read(&manifest, Split::Train, &statistics, true, settings.balance)?;
    let held_out = Windows::read(&manifest, Split::Val, &statistics, false, 0.0)?;
    std::fs::create_dir_all(folder).map_err(|cause| TrainError::File { path: folder.into(), cause })?;

    let mut run = Run::open(folder, settings, &sizes, replicas)?;
    let log_path = folder.join("log.jsonl");
    let mut rows = log::read_until(&log_path, run.moments.step)?;
    let began = Instant::now();
    let (mut sums, mut since) = ([0.0; 5], 0_u64);
    let mut stale = 0;
    let mut complete = false;
    while !complete {
        if run.moments.step >= settings.steps || (settings.patience > 0 && stale >= settings.patience) {
            complete = true;
        } else {
            let parts = run.step(&train, &statistics)?;
            sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
            since += 1;
        }
        let step = run.moments.step;
        let mut row = None;
        if since > 0 && (complete || step.is_multiple_of(settings.measure_every)) {
            let vae = run.network()?;
            let back = reconstruction(&vae, &held_out, &statistics, settings.frames, MEASURED)?;
            let mean = |index: usize| sums[index] / since as f64;
            let new = Row {
                step,
                loss: mean(0),
                features: mean(1),
                places: mean(2),
                divergence: mean(3),
                gradient: mean(4),
                rate: run.rate(step.saturating_sub(1)),
                held_out_mm: back.global_mm,
                held_out_aligned_mm: back.aligned_mm,
                seconds: run.state.seconds + began.elapsed().as_secs_f64(),
            };
            (sums, since) = ([0.0; 5], 0);
            log::append(&log_path, &new)?;
            stale += 1;
            if run.state.best.is_none_or(|(best, _)| back.global_mm < best) {
                run.state.best = Some((back.global_mm, step));
                stale = 0;
                write_weights(&folder.join("best.safetensors"), &run.tensors()?, &sizes, &stored)?;
            }
            rows.push(new);
            row = rows.last();
        }
        let stop = !complete && progress(step, settings.steps, row).is_break();
        if complete || stop || step.is_multiple_of(settings.save_every) {
            run.save(folder, began.elapsed().as_secs_f64())?;
        }
        if stop {
            break;
        }
    }
    write_weights(&folder.join("last.safetensors"), &run.tensors()?, &sizes, &stored)?;
    let vae = run.network()?;
    let fitting = LENGTHS.into_iter().filter(|&frames| frames <= sizes.most_frames());
    let held_out = fitting.map(|frames| reconstruction(&vae, &held_out, &statistics, frames, usize::MAX));
    Ok(Report { rows, held_out: held_out.collect::<Result<_, _>>()?, complete })
}

/// A run at a step.
struct Run<'a> {
    settings: &'a VaeSettings,
    sizes: &'a Sizes,
    device: Device,
    networks: Vec<TrainableVae>,
    /// One of a single thread for each copy: the operations of a copy then stay on its thread.
    pools: Vec<rayon::ThreadPool>,
    weights: Vec<f32>,
    moments: Moments,
    state: State,
}

impl<'a> Run<'a> {
    fn open(
        folder: &Path,
        settings: &'a VaeSettings,
        sizes: &'a Sizes,
        replicas: usize,
    ) -> Result<Self, TrainError> {
        let device = Device::flex().autodiff();
        let network = |error: inkrig_generate::GenerateError| TrainError::Device(error.to_string());
        let first =
            TrainableVae::new(sizes, &random(sizes, Parts::VAE, settings.seed), settings.dropout, &device);
        let first = first.map_err(network)?;
        let own = serde_json::to_string(settings).unwrap_or_default();
        let path = folder.join("checkpoint.safetensors");
        let (weights, moments, state) = match Checkpoint::read(&path)? {
            Some(checkpoint) if checkpoint.state.settings != own => {
                let what =
                    "belongs to a run with other settings: give another folder, or the settings of that run";
                return Err(TrainError::Content { path, what: what.into() });
            }
            Some(checkpoint) => (checkpoint.weights, checkpoint.moments, checkpoint.state),
            None => {
                let weights = flat::numbers(&first)?;
                let moments = Moments::new(weights.len());
                (weights, moments, State { settings: own, ..State::default() })
            }
        };
        // Each copy has tensors of its own: with shared ones burn 0.22.1 has one graph for all, whose locks two threads may take in
        // opposite order (one while it registers an operation, the other while it goes back), and both wait for ever.
        let copies = vec![first; replicas.max(1)].into_iter();
        let networks: Vec<TrainableVae> =
            copies.map(|network| flat::with_numbers(network, &weights)).collect::<Result<_, _>>()?;
        let pool = |_| rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let pools = (0..networks.len()).map(pool).collect::<Result<_, _>>();
        let pools = pools.map_err(|error| TrainError::Threads(error.to_string()))?;
        Ok(Self { pools, settings, sizes, device, networks, weights, moments, state })
    }

    fn rate(&self, step: u64) -> f64 {
        rate(self.settings.rate, step, self.settings.warm_up, self.settings.steps)
    }

    /// One step; gives the loss, its parts and the gradient's length.
    fn step(&mut self, train: &Windows, statistics: &Statistics) -> Result<[f64; 5], TrainError> {
        let step = self.moments.step;
        let mut noise = Noise::new(self.settings.seed.wrapping_mul(0x1_0000_0001).wrapping_add(step + 1));
        let frames = if noise.uniform() < self.settings.other_lengths {
            let span = (self.settings.longest - self.settings.shortest + 1) as f64;
            self.settings.shortest + (noise.uniform() * span) as usize
        } else {
            self.settings.frames
        };
        let each = self.settings.batch.div_ceil(self.networks.len());
        let work: Vec<(Batch, Vec<f32>)> = (0..self.networks.len())
            .map(|_| {
                let batch = train.draw(each, frames, &mut noise);
                (batch, noise.normals(each * self.sizes.latent_tokens * self.sizes.width))
            })
            .collect();
        let (settings, sizes, device) = (self.settings, self.sizes, &self.device);
        let results: Vec<Result<Gradient, TrainError>> = std::thread::scope(|scope| {
            let threads: Vec<_> = self
                .networks
                .iter()
                .zip(&self.pools)
                .zip(work)
                .map(|((network, pool), (batch, latent_noise))| {
                    scope.spawn(move || {
                        pool.install(|| {
                            one_gradient(
                                network,
                                batch,
                                latent_noise,
                                settings,
                                sizes,
                                statistics,
                                step,
                                device,
                            )
                        })
                    })
                })
                .collect();
            let failed = || TrainError::Device("a replica of the network broke off".into());
            threads.into_iter().map(|thread| thread.join().unwrap_or_else(|_| Err(failed()))).collect()
        });
        let mut gradient = vec![0.0_f32; self.weights.len()];
        let (mut parts, share) = ([0.0; 5], 1.0 / self.networks.len() as f32);
        for result in results {
            let (own, own_parts) = result?;
            gradient.iter_mut().zip(&own).for_each(|(sum, part)| *sum += share * part);
            parts.iter_mut().zip(own_parts).for_each(|(sum, part)| *sum += f64::from(share) * part);
        }
        parts[4] = clip(&mut gradient, settings.clip);
        if !parts.iter().all(|part| part.is_finite()) {
            return Err(TrainError::Diverged { step });
        }
        let adam = AdamW { betas: settings.betas, weight_decay: settings.weight_decay };
        let rate = self.rate(step);
        adam.step(&mut self.weights, &gradient, &mut self.moments, rate);
        let networks = std::mem::take(&mut self.networks).into_iter();
        self.networks =
            networks.map(|network| flat::with_numbers(network, &self.weights)).collect::<Result<_, _>>()?;
        Ok(parts)
    }

    fn tensors(&self) -> Result<inkrig_generate::weights::Tensors, TrainError> {
        let network =
            self.networks.first().ok_or_else(|| TrainError::Device("there is no network".into()))?;
        network.to_tensors().map_err(|error| TrainError::Device(error.to_string()))
    }

    /// The same network in the form that is run.
    fn network(&self) -> Result<Vae, TrainError> {
        Vae::new(self.sizes, &self.tensors()?).map_err(|error| TrainError::Device(error.to_string()))
    }

    fn save(&self, folder: &Path, seconds: f64) -> Result<(), TrainError> {
        let state =
            State { seconds: self.state.seconds + seconds, step: self.moments.step, ..self.state.clone() };
        let checkpoint = Checkpoint { weights: self.weights.clone(), moments: self.moments.clone(), state };
        checkpoint.write(&folder.join("checkpoint.safetensors"))
    }
}

#[allow(clippy::too_many_arguments, reason = "what one thread needs of a step")]
fn one_gradient(
    network: &TrainableVae,
    batch: Batch,
    latent_noise: Vec<f32>,
    settings: &VaeSettings,
    sizes: &Sizes,
    statistics: &Statistics,
    step: u64,
    device: &Device,
) -> Result<Gradient, TrainError> {
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
    let loss = VaeLoss::new(decoded, features, (mean, log_variance), &mask, statistics, &weights);
    let number = |tensor: &Tensor<1>| f64::from(tensor.clone().into_scalar::<f32>());
    let parts = [&loss.total, &loss.features, &loss.places, &loss.divergence].map(number);
    let gradients = loss.total.backward();
    Ok((flat::gradient(network, &gradients)?, parts))
}
