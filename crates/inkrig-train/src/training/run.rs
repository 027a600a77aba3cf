//! A run of any stage: steps, measurements, checkpoints.

use super::adamw::{AdamW, Moments, clip};
use super::checkpoint::{Checkpoint, State};
use super::course::Course;
use super::flat;
use super::log::{self, Row};
use super::rate::rate;
use super::stage::{Stage, seed_of};
use crate::TrainError;
use inkrig_generate::trainable::dropping;
use inkrig_generate::weights::Tensors;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

/// Where a run works, and with what.
#[derive(Debug, Clone, Copy)]
pub struct Place<'a> {
    /// The corpus.
    pub corpus: &'a Path,
    /// The run's own folder: checkpoint, log, weights. One that is there already is gone on with.
    pub folder: &'a Path,
    /// Weights to begin with, where no checkpoint is there: a model file of an earlier run.
    pub from: Option<&'a Path>,
    /// Copies of the network that work side by side on a part of every batch each; the result depends on their number.
    pub replicas: usize,
}

/// Hears of a step: how many were taken, of how many, and what was measured at it. Can stop the run, which keeps its place.
pub type OnStep<'a> = dyn FnMut(u64, u64, Option<&Row>) -> ControlFlow<()> + 'a;

/// What a run came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Its log, earlier runs included.
    pub rows: Vec<Row>,
    /// The best measurement and its step.
    pub best: Option<(f64, u64)>,
    /// Whether all steps were taken; else it was stopped.
    pub complete: bool,
}

/// Runs a stage to its end or until it is stopped; gives also the last weights, as they were written.
pub(super) fn run<S: Stage>(
    stage: &S,
    first: S::Network,
    place: &Place<'_>,
    progress: &mut OnStep<'_>,
) -> Result<(Report, Tensors), TrainError> {
    let folder = place.folder;
    std::fs::create_dir_all(folder).map_err(|cause| TrainError::File { path: folder.into(), cause })?;
    let mut run = Run::open(stage, first, place)?;
    let course = stage.course();
    let log_path = folder.join("log.jsonl");
    let mut rows = log::read_until(&log_path, run.moments.step)?;
    let began = Instant::now();
    let mut sums = vec![0.0; S::PARTS.len() + 2];
    let mut since = 0_u64;
    let mut complete = false;
    while !complete {
        if run.is_over() {
            complete = true;
        } else {
            let parts = run.step()?;
            sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
            since += 1;
        }
        let step = run.moments.step;
        let mut row = None;
        if since > 0 && (complete || step.is_multiple_of(course.measure_every)) {
            let weights = run.tensors()?;
            let measured = stage.measure(&weights)?;
            let means: Vec<f64> = sums.iter().map(|sum| sum / since as f64).collect();
            let seconds = run.state.seconds + began.elapsed().as_secs_f64();
            let new = row_of::<S>(step, &means, rate_at(&course, step.saturating_sub(1)), seconds, &measured);
            sums.fill(0.0);
            since = 0;
            log::append(&log_path, &new)?;
            if let Some((_, value)) = measured.first().copied()
                && run.state.best.is_none_or(|(best, _)| value < best)
            {
                run.state.best = Some((value, step));
                stage.write(&folder.join("best.safetensors"), &weights)?;
            }
            rows.push(new);
            row = rows.last();
        }
        let stop = !complete && progress(step, course.steps, row).is_break();
        if complete || stop || step.is_multiple_of(course.save_every) {
            run.save(folder, began.elapsed().as_secs_f64())?;
        }
        if stop {
            break;
        }
    }
    let weights = run.tensors()?;
    stage.write(&folder.join("last.safetensors"), &weights)?;
    Ok((Report { rows, best: run.state.best, complete }, weights))
}

fn rate_at(course: &Course, step: u64) -> f64 {
    rate(course.rate, step, course.warm_up, course.steps)
}

/// `means` are the loss, its parts, and the gradient's length.
fn row_of<S: Stage>(
    step: u64,
    means: &[f64],
    rate: f64,
    seconds: f64,
    measured: &[(&'static str, f64)],
) -> Row {
    let parts = S::PARTS.iter().copied().zip(means.iter().skip(1).copied());
    Row {
        step,
        loss: means.first().copied().unwrap_or(0.0),
        gradient: means.last().copied().unwrap_or(0.0),
        rate,
        seconds,
        values: parts.chain(measured.iter().copied()).map(|(name, value)| (name.into(), value)).collect(),
    }
}

/// A run at a step.
struct Run<'a, S: Stage> {
    stage: &'a S,
    course: Course,
    replicas: Vec<Replica<S>>,
    weights: Vec<f32>,
    moments: Moments,
    average: Option<Vec<f32>>,
    state: State,
}

/// A copy of the network. It has tensors of its own: with shared ones burn 0.22.1 has one graph for all, whose locks two threads may
/// take in opposite order (one while it registers an operation, the other while it goes back), and both wait for ever. And it has a
/// pool of one thread, on which its operations stay.
struct Replica<S: Stage> {
    network: S::Network,
    beside: S::Beside,
    pool: rayon::ThreadPool,
}

/// A gradient, and the loss with its parts.
type Gradient = (Vec<f32>, Vec<f64>);

impl<'a, S: Stage> Run<'a, S> {
    fn open(stage: &'a S, first: S::Network, place: &Place<'_>) -> Result<Self, TrainError> {
        let (course, own) = (stage.course(), stage.settings());
        let path = place.folder.join("checkpoint.safetensors");
        let (weights, moments, average, state) = match Checkpoint::read(&path)? {
            Some(checkpoint) if checkpoint.state.settings != own => {
                let what =
                    "belongs to a run with other settings: give another folder, or the settings of that run";
                return Err(TrainError::Content { path, what: what.into() });
            }
            Some(checkpoint) => {
                (checkpoint.weights, checkpoint.moments, checkpoint.average, checkpoint.state)
            }
            None => {
                let weights = flat::numbers(&first)?;
                let moments = Moments::new(weights.len());
                let average = (course.average > 0.0).then(|| weights.clone());
                (weights, moments, average, State { settings: own, ..State::default() })
            }
        };
        let replica = |network: S::Network| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
            let pool = pool.map_err(|error| TrainError::Threads(error.to_string()))?;
            let mut beside = stage.beside()?;
            stage.follow(&mut beside, average.as_ref().unwrap_or(&weights))?;
            Ok(Replica { network: flat::with_numbers(network, &weights)?, beside, pool })
        };
        let replicas = vec![first; place.replicas.max(1)].into_iter().map(replica);
        let replicas = replicas.collect::<Result<_, TrainError>>()?;
        Ok(Self { stage, course, replicas, weights, moments, average, state })
    }

    fn is_over(&self) -> bool {
        let (step, Course { steps, patience, measure_every, .. }) = (self.moments.step, &self.course);
        let since_best = self.state.best.map_or(0, |(_, best)| step.saturating_sub(best));
        step >= *steps || (*patience > 0 && since_best >= patience.saturating_mul(*measure_every))
    }

    /// One step; gives the loss, its parts and the gradient's length.
    fn step(&mut self) -> Result<Vec<f64>, TrainError> {
        let step = self.moments.step;
        let stage = self.stage;
        let work = stage.draw(step, self.replicas.len());
        let seed = seed_of(self.course.seed, step);
        let results: Vec<Result<Gradient, TrainError>> = std::thread::scope(|scope| {
            let threads: Vec<_> = self
                .replicas
                .iter()
                .zip(work)
                .enumerate()
                .map(|(at, (replica, work))| {
                    let seed = seed.wrapping_add((at as u64) << 48);
                    scope.spawn(move || {
                        replica.pool.install(|| dropping(seed, || replica.gradient(stage, work, step)))
                    })
                })
                .collect();
            let failed = || TrainError::Device("a replica of the network broke off".into());
            threads.into_iter().map(|thread| thread.join().unwrap_or_else(|_| Err(failed()))).collect()
        });
        let mut gradient = vec![0.0_f32; self.weights.len()];
        let mut parts = vec![0.0; S::PARTS.len() + 1];
        let share = 1.0 / self.replicas.len() as f32;
        for result in results {
            let (own, own_parts) = result?;
            gradient.iter_mut().zip(&own).for_each(|(sum, part)| *sum += share * part);
            parts.iter_mut().zip(own_parts).for_each(|(sum, part)| *sum += f64::from(share) * part);
        }
        parts.push(clip(&mut gradient, self.course.clip));
        if !parts.iter().all(|part| part.is_finite()) {
            return Err(TrainError::Diverged { step });
        }
        let adam = AdamW { betas: self.course.betas, weight_decay: self.course.weight_decay };
        adam.step(&mut self.weights, &gradient, &mut self.moments, rate_at(&self.course, step));
        if let Some(average) = &mut self.average {
            follow(average, &self.weights, self.course.average, step);
        }
        self.take_over()?;
        Ok(parts)
    }

    /// Gives the replicas the new weights.
    fn take_over(&mut self) -> Result<(), TrainError> {
        let average = self.average.as_ref().unwrap_or(&self.weights);
        for replica in std::mem::take(&mut self.replicas) {
            let Replica { network, mut beside, pool } = replica;
            self.stage.follow(&mut beside, average)?;
            let network = flat::with_numbers(network, &self.weights)?;
            self.replicas.push(Replica { network, beside, pool });
        }
        Ok(())
    }

    /// The weights that are measured and written.
    fn tensors(&self) -> Result<Tensors, TrainError> {
        let none = || TrainError::Device("there is no network".into());
        let network = &self.replicas.first().ok_or_else(none)?.network;
        match &self.average {
            Some(average) => self.stage.tensors(&flat::with_numbers(network.clone(), average)?),
            None => self.stage.tensors(network),
        }
    }

    fn save(&self, folder: &Path, seconds: f64) -> Result<(), TrainError> {
        let state =
            State { seconds: self.state.seconds + seconds, step: self.moments.step, ..self.state.clone() };
        let (weights, moments) = (self.weights.clone(), self.moments.clone());
        let checkpoint = Checkpoint { weights, moments, average: self.average.clone(), state };
        checkpoint.write(&folder.join("checkpoint.safetensors"))
    }
}

impl<S: Stage> Replica<S> {
    fn gradient(&self, stage: &S, work: S::Work, step: u64) -> Result<Gradient, TrainError> {
        let loss = stage.loss(&self.network, &self.beside, work, step)?;
        let number = |tensor: &burn::tensor::Tensor<1>| f64::from(tensor.clone().into_scalar::<f32>());
        let parts = std::iter::once(&loss.total).chain(&loss.parts).map(number).collect();
        let gradients = loss.total.backward();
        Ok((flat::gradient(&self.network, &gradients)?, parts))
    }
}

/// The mean of weights along the way. It begins as a plain mean, so that the weights of the beginning are soon forgotten.
fn follow(average: &mut [f32], weights: &[f32], keep: f64, step: u64) {
    let keep = keep.min((step + 1) as f64 / (step + 10) as f64) as f32;
    average.iter_mut().zip(weights).for_each(|(mean, &weight)| *mean = keep * *mean + (1.0 - keep) * weight);
}
