//! A run of any stage: steps, measurements, checkpoints.

use super::adamw::{AdamW, Moments, clip};
use super::checkpoint::{CHECKPOINT, Checkpoint, State};
use super::course::{Course, Optimiser};
use super::log::{self, LOG, Row};
use super::muon::{self, Matrix};
use super::rate::rate;
use super::stage::{Stage, Weights, network};
use crate::TrainError;
use inkrig_generate::weights::Tensors;
use std::io::ErrorKind;
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

/// Makes the folder of a run, unless it is there already.
pub(crate) fn open_folder(folder: &Path) -> Result<(), TrainError> {
    check_folder(folder)?;
    std::fs::create_dir_all(folder).map_err(|cause| TrainError::File { path: folder.into(), cause })
}

/// Takes a folder that is not there yet, is empty, or is a run's.
///
/// # Errors
/// When it holds other files, or cannot be read.
pub fn check_folder(folder: &Path) -> Result<(), TrainError> {
    let failed = |cause| TrainError::File { path: folder.into(), cause };
    let entries = match std::fs::read_dir(folder) {
        Err(cause) if cause.kind() == ErrorKind::NotFound => return Ok(()),
        entries => entries.map_err(failed)?,
    };
    let mut is_empty = true;
    for entry in entries {
        let name = entry.map_err(failed)?.file_name();
        if [CHECKPOINT, LOG, "best.safetensors", "last.safetensors"].iter().any(|own| name == **own) {
            return Ok(());
        }
        // What a killed run was about to write.
        is_empty &= name.as_encoded_bytes().starts_with(b".");
    }
    if is_empty {
        return Ok(());
    }
    let what = "holds other files: give an empty or a new folder for the run".into();
    Err(TrainError::Content { path: folder.into(), what })
}

/// Runs a stage from these weights to its end or until it is stopped; gives also the last weights, as they were written.
pub(super) fn run<S: Stage>(
    stage: &S,
    first: Tensors,
    place: &Place<'_>,
    progress: &mut OnStep<'_>,
) -> Result<(Report, Tensors), TrainError> {
    let folder = place.folder;
    open_folder(folder)?;
    let mut run = Run::open(stage, first, place)?;
    let course = stage.course();
    let log_path = folder.join(LOG);
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
    replicas: Vec<(S::Replica, Vec<f32>)>,
    /// Names and shapes.
    first: Tensors,
    weights: Vec<f32>,
    /// Those that Muon moves.
    matrices: Vec<Matrix>,
    moments: Moments,
    average: Option<Vec<f32>>,
    state: State,
}

impl<'a, S: Stage> Run<'a, S> {
    fn open(stage: &'a S, first: Tensors, place: &Place<'_>) -> Result<Self, TrainError> {
        let (course, own) = (stage.course(), stage.settings());
        let path = place.folder.join(CHECKPOINT);
        let content = |what: &str| TrainError::Content { path: path.clone(), what: what.into() };
        let (weights, moments, average, state) = match Checkpoint::read(&path)? {
            Some(checkpoint) if !stage.is_same(&checkpoint.state.settings) => {
                return Err(content(
                    "belongs to a run with other settings: give another folder, or the settings of that run",
                ));
            }
            Some(checkpoint) if checkpoint.weights.len() != first.numbers() => {
                return Err(content("holds another number of weights than the network"));
            }
            Some(checkpoint) => {
                (checkpoint.weights, checkpoint.moments, checkpoint.average, checkpoint.state)
            }
            None => {
                let weights = first.row();
                let moments = Moments::new(weights.len());
                let average = (course.average > 0.0).then(|| weights.clone());
                (weights, moments, average, State { settings: own, ..State::default() })
            }
        };
        let replica = |_| Ok((stage.replica()?, Vec::new()));
        let replicas = (0..place.replicas.max(1)).map(replica).collect::<Result<_, TrainError>>()?;
        let matrices = if course.optimiser == Optimiser::Muon { muon::matrices(&first) } else { Vec::new() };
        Ok(Self { stage, course, replicas, first, weights, matrices, moments, average, state })
    }

    fn is_over(&self) -> bool {
        let (step, Course { steps, patience, measure_every, .. }) = (self.moments.step, &self.course);
        let since_best = self.state.best.map_or(0, |(_, best)| step.saturating_sub(best));
        step >= *steps || (*patience > 0 && since_best >= patience.saturating_mul(*measure_every))
    }

    /// One step; gives the loss, its parts and the gradient's length.
    fn step(&mut self) -> Result<Vec<f64>, TrainError> {
        let (step, stage) = (self.moments.step, self.stage);
        let work = stage.draw(step, self.replicas.len());
        let weights =
            Weights { now: &self.weights, average: self.average.as_deref().unwrap_or(&self.weights) };
        let results: Vec<Result<Vec<f64>, TrainError>> = std::thread::scope(|scope| {
            let threads: Vec<_> = self
                .replicas
                .iter_mut()
                .zip(work)
                .map(|((replica, gradient), work)| {
                    scope.spawn(move || stage.gradient(replica, weights, work, step, gradient))
                })
                .collect();
            let failed = || TrainError::Device("a replica of the network broke off".into());
            threads.into_iter().map(|thread| thread.join().unwrap_or_else(|_| Err(failed()))).collect()
        });
        let mut gradient = vec![0.0_f32; self.weights.len()];
        let mut parts = vec![0.0; S::PARTS.len() + 1];
        let share = 1.0 / self.replicas.len() as f32;
        for (result, (_, own)) in results.into_iter().zip(&self.replicas) {
            gradient.iter_mut().zip(own).for_each(|(sum, part)| *sum += share * part);
            parts.iter_mut().zip(result?).for_each(|(sum, part)| *sum += f64::from(share) * part);
        }
        parts.push(clip(&mut gradient, self.course.clip));
        if !parts.iter().all(|part| part.is_finite()) {
            return Err(TrainError::Diverged { step });
        }
        let adam = AdamW { betas: self.course.betas, weight_decay: self.course.weight_decay };
        let rate = rate_at(&self.course, step);
        muon::step(&self.matrices, adam, &mut self.weights, &gradient, &mut self.moments, rate);
        if let Some(average) = &mut self.average {
            follow(average, &self.weights, self.course.average, step);
        }
        Ok(parts)
    }

    /// The weights that are measured and written.
    fn tensors(&self) -> Result<Tensors, TrainError> {
        self.first.with_row(self.average.as_ref().unwrap_or(&self.weights)).map_err(network)
    }

    fn save(&self, folder: &Path, seconds: f64) -> Result<(), TrainError> {
        let state =
            State { seconds: self.state.seconds + seconds, step: self.moments.step, ..self.state.clone() };
        let (weights, moments) = (self.weights.clone(), self.moments.clone());
        let checkpoint = Checkpoint { weights, moments, average: self.average.clone(), state };
        checkpoint.write(&folder.join(CHECKPOINT))
    }
}

/// The mean of weights along the way. It begins as a plain mean, so that the weights of the beginning are soon forgotten.
fn follow(average: &mut [f32], weights: &[f32], keep: f64, step: u64) {
    let keep = keep.min((step + 1) as f64 / (step + 10) as f64) as f32;
    average.iter_mut().zip(weights).for_each(|(mean, &weight)| *mean = keep * *mean + (1.0 - keep) * weight);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_of_others_is_no_run() {
        let folder = tempfile::tempdir().unwrap();
        let run = folder.path().join("run");
        check_folder(&run).unwrap();
        open_folder(&run).unwrap();
        let put = |name: &str| std::fs::write(run.join(name), "").unwrap();
        put(".tmp1");
        check_folder(&run).unwrap();
        put("thesis.txt");
        assert!(check_folder(&run).unwrap_err().to_string().contains("holds other files"));
        put(LOG);
        check_folder(&run).unwrap();
    }
}
