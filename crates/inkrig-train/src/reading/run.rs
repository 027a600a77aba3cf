//! A reader's run at a step: weights, optimiser, place, in one folder.

use super::settings::Pace;
use crate::TrainError;
use crate::corpus::write;
use crate::training::adamw::{AdamW, Moments, clip};
use crate::training::checkpoint::{CHECKPOINT, Checkpoint, State};
use crate::training::log::LOG;
use crate::training::muon::{self, Matrix};
use crate::training::rate::rate;
use crate::training::run::open_folder;
use inkrig_generate::readers::file::{Header, to_bytes};
use inkrig_generate::readers::network::{Network, Plan, Work};
use inkrig_generate::schedule::Noise;
use inkrig_generate::weights::Tensors;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::Write as _;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

/// Pictures whose gradients are added up before those of others: the sum does not depend on the number of threads.
const GROUP: usize = 4;
/// What a step leaves of the mean of the weights along the way, which is what is measured and written.
const AVERAGE: f32 = 0.998;

/// Hears of a step: how many were taken, of how many, and what was measured at it; can say stop.
pub type OnStep<'a, R> = dyn FnMut(u64, u64, Option<&R>) -> ControlFlow<()> + 'a;

/// What a network is taught.
pub(super) trait Lesson: Sync {
    /// A line of the log.
    type Row: Serialize + DeserializeOwned + Clone;

    /// Shows the network one example, adds to the gradient, gives the loss.
    fn example(&self, network: &Network, noise: &mut Noise, work: &mut Work, gradient: &mut [f32]) -> f64;

    /// Measures the network: how wrong it is (what is smallest is kept as best), and the line of the log.
    fn measure(&self, network: &Network, at: At) -> (f64, Self::Row);

    /// The step of a line.
    fn step_of(row: &Self::Row) -> u64;
}

/// Where a run is, for its log.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct At {
    pub step: u64,
    /// Mean since the last line.
    pub loss: f64,
    pub rate: f64,
    pub seconds: f64,
}

/// What all readers' runs are given.
pub(super) struct Task<'a> {
    pub folder: &'a Path,
    pub pace: &'a Pace,
    /// With another one it is another run.
    pub identity: String,
    /// What the weights' file says it reads.
    pub header: Header,
    /// Weights to begin with, as far as they fit.
    pub from: Option<&'a Tensors>,
    pub threads: usize,
}

/// Trains, or goes on, until all steps are taken or `progress` says stop. Gives the log, and whether it is complete.
pub(super) fn teach<L: Lesson>(
    lesson: &L,
    plan: Plan,
    task: &Task<'_>,
    progress: &mut OnStep<'_, L::Row>,
) -> Result<(Vec<L::Row>, bool), TrainError> {
    let folder = task.folder;
    open_folder(folder)?;
    let mut run = Run::open(plan, task)?;
    let log = folder.join(LOG);
    let mut rows = read_log::<L>(&log, run.moments.step)?;
    let (began, before) = (Instant::now(), run.state.seconds);
    let (mut sum, mut since) = (0.0, 0_u64);
    let pace = task.pace;
    let mut complete = false;
    while !complete {
        if run.moments.step >= pace.steps {
            complete = true;
        } else {
            sum += run.step(lesson, task)?;
            since += 1;
        }
        let step = run.moments.step;
        let mut row = None;
        if since > 0 && (complete || step.is_multiple_of(pace.measure_every)) {
            let seconds = before + began.elapsed().as_secs_f64();
            let at =
                At { step, loss: sum / since as f64, rate: run.rate(pace, step.saturating_sub(1)), seconds };
            let (wrong, new) = lesson.measure(&run.plain()?, at);
            (sum, since) = (0.0, 0);
            append(&log, &new)?;
            if run.state.best.is_none_or(|(best, _)| wrong < best) {
                run.state.best = Some((wrong, step));
                run.write_weights(&folder.join("best.safetensors"), &task.header)?;
            }
            rows.push(new);
            row = rows.last();
        }
        let stop = !complete && progress(step, pace.steps, row).is_break();
        if complete || stop || step.is_multiple_of(pace.save_every) {
            run.state.seconds = before + began.elapsed().as_secs_f64();
            run.save(folder)?;
        }
        if stop {
            break;
        }
    }
    run.write_weights(&folder.join("last.safetensors"), &task.header)?;
    Ok((rows, complete))
}

struct Run {
    network: Network,
    weights: Vec<f32>,
    average: Vec<f32>,
    /// Those that Muon moves: the layers inside blocks.
    matrices: Vec<Matrix>,
    moments: Moments,
    state: State,
    rooms: Vec<Room>,
}

impl Run {
    fn open(plan: Plan, task: &Task<'_>) -> Result<Self, TrainError> {
        let path = task.folder.join(CHECKPOINT);
        let other = |what: &str| TrainError::Content { path: path.clone(), what: what.into() };
        let (weights, average, moments, state) = match Checkpoint::read(&path)? {
            Some(found) if found.state.settings != task.identity => {
                return Err(other("is of a run with other settings: give those, or another folder"));
            }
            Some(found) if found.weights.len() != plan.numbers() => {
                return Err(other("is of another network: give another folder"));
            }
            Some(found) => (found.weights, found.average, found.moments, found.state),
            None => {
                let state = State { settings: task.identity.clone(), ..State::default() };
                (first_weights(&plan, task), None, Moments::new(plan.numbers()), state)
            }
        };
        let inside = |name: &str| name.ends_with(".linear1.weight") || name.ends_with(".linear2.weight");
        let matrices = muon::matrices_of(plan.tensors(), inside);
        let network =
            Network::taught(plan, &weights).map_err(|error| TrainError::Device(error.to_string()))?;
        let average = average.unwrap_or_else(|| weights.clone());
        Ok(Self { network, weights, average, matrices, moments, state, rooms: Vec::new() })
    }

    /// The network as it is run.
    fn plain(&self) -> Result<Network, TrainError> {
        let plan = self.network.plan().clone();
        Network::new(plan, &self.average).map_err(|error| TrainError::Device(error.to_string()))
    }

    fn rate(&self, pace: &Pace, step: u64) -> f64 {
        rate(pace.rate, step, pace.warm_up, pace.steps)
    }

    /// One step; gives the loss.
    fn step<L: Lesson>(&mut self, lesson: &L, task: &Task<'_>) -> Result<f64, TrainError> {
        let (step, pace) = (self.moments.step, task.pace);
        let groups = pace.batch.div_ceil(GROUP);
        let threads = task.threads.clamp(1, groups);
        let network = &self.network;
        self.rooms.resize_with(threads, Room::default);
        let ended = std::thread::scope(|scope| {
            let rooms = self.rooms.iter_mut().enumerate();
            let workers: Vec<_> = rooms
                .map(|(thread, room)| {
                    scope.spawn(move || {
                        for (at, group) in (thread..groups).step_by(threads).enumerate() {
                            room.group_gradient(lesson, network, pace, step, (at, group));
                        }
                    })
                })
                .collect();
            workers.into_iter().filter_map(|worker| worker.join().ok()).count()
        });
        if ended != threads {
            return Err(TrainError::Device("a thread of the training broke off".into()));
        }
        let (mut gradient, mut loss) = (vec![0.0_f32; self.weights.len()], 0.0);
        let share = 1.0 / pace.batch as f32;
        for (part, own) in (0..groups).map(|group| &self.rooms[group % threads].groups[group / threads]) {
            gradient.iter_mut().zip(part).for_each(|(sum, part)| *sum += share * part);
            loss += own / pace.batch as f64;
        }
        let length = clip(&mut gradient, pace.clip);
        if !(loss.is_finite() && length.is_finite()) {
            return Err(TrainError::Diverged { step });
        }
        let adam = AdamW { betas: (0.9, 0.98), weight_decay: pace.weight_decay };
        let rate = self.rate(pace, step);
        muon::step(&self.matrices, adam, &mut self.weights, &gradient, &mut self.moments, rate);
        // Of the first steps it is a plain mean: the beginning is soon forgotten.
        let kept = AVERAGE.min((step + 1) as f32 / (step + 10) as f32);
        let rows = self.average.iter_mut().zip(&self.weights);
        rows.for_each(|(average, weight)| *average += (1.0 - kept) * (weight - *average));
        self.network.set(&self.weights).map_err(|error| TrainError::Device(error.to_string()))?;
        Ok(loss)
    }

    fn save(&self, folder: &Path) -> Result<(), TrainError> {
        let state = State { step: self.moments.step, ..self.state.clone() };
        let (weights, moments) = (self.weights.clone(), self.moments.clone());
        let checkpoint = Checkpoint { weights, moments, average: Some(self.average.clone()), state };
        checkpoint.write(&folder.join(CHECKPOINT))
    }

    fn write_weights(&self, path: &Path, header: &Header) -> Result<(), TrainError> {
        let wrong = |what: String| TrainError::Content { path: path.to_path_buf(), what };
        let tensors = Network::to_tensors(self.network.plan(), &self.average)
            .map_err(|error| wrong(error.to_string()))?;
        let bytes = to_bytes(header, &tensors).map_err(|error| wrong(error.to_string()))?;
        write(path, &bytes)
    }
}

/// Random ones, but for the tensors that are there to begin with. Beside such, what is new changes nothing at first: what a block, a
/// join or a convolution onto another table adds begins with zeros.
fn first_weights(plan: &Plan, task: &Task<'_>) -> Vec<f32> {
    let mut row = plan.random(task.pace.seed);
    let Some(from) = task.from else { return row };
    let (mut rest, mut new) = (row.as_mut_slice(), false);
    for ((name, shape), adds) in plan.tensors().zip(plan.additions()) {
        let (own, others) = rest.split_at_mut(shape.iter().product());
        let known = from.get(name).filter(|known| known.shape() == shape);
        // The bias stands behind its weight, and says nothing without it.
        new = adds && (known.is_none() || new && name.ends_with(".bias"));
        match known {
            _ if new => own.fill(0.0),
            Some(known) => own.copy_from_slice(known.data()),
            None => {}
        }
        rest = others;
    }
    row
}

/// What a thread works with, made once: to take so much memory anew at every step takes its time.
#[derive(Default)]
struct Room {
    work: Work,
    /// Gradients and losses of the groups that were this thread's.
    groups: Vec<(Vec<f32>, f64)>,
}

impl Room {
    /// The gradients of a few examples, as the `at`-th group here. What they are belongs to the seed and their number alone.
    fn group_gradient<L: Lesson>(
        &mut self,
        lesson: &L,
        network: &Network,
        pace: &Pace,
        step: u64,
        (at, group): (usize, usize),
    ) {
        self.groups.resize_with(self.groups.len().max(at + 1), Default::default);
        let (gradient, loss) = &mut self.groups[at];
        gradient.clear();
        gradient.resize(network.plan().numbers(), 0.0);
        *loss = 0.0;
        for at in group * GROUP..((group + 1) * GROUP).min(pace.batch) {
            let number = step * pace.batch as u64 + at as u64;
            let mut noise = Noise::new(pace.seed.wrapping_add(number.wrapping_mul(0xD134_2543_DE82_EF95)));
            noise.uniform();
            *loss += lesson.example(network, &mut noise, &mut self.work, gradient);
        }
    }
}

fn append<R: Serialize>(path: &Path, row: &R) -> Result<(), TrainError> {
    let failed = |cause| TrainError::File { path: path.to_path_buf(), cause };
    let mut file = std::fs::OpenOptions::new().create(true).append(true).open(path).map_err(failed)?;
    writeln!(file, "{}", serde_json::to_string(row).unwrap_or_default()).map_err(failed)
}

/// All lines up to a step; what stands behind it was taken back when a run was killed.
fn read_log<L: Lesson>(path: &Path, step: u64) -> Result<Vec<L::Row>, TrainError> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let text = crate::corpus::read_text(path)?;
    let rows = text.lines().filter_map(|line| serde_json::from_str::<L::Row>(line).ok());
    let rows: Vec<L::Row> = rows.filter(|row| L::step_of(row) <= step).collect();
    let kept: String = rows.iter().map(|row| serde_json::to_string(row).unwrap_or_default() + "\n").collect();
    if kept != text {
        write(path, kept.as_bytes())?;
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_generate::readers::network::{Shape, Value};

    fn small(further: bool) -> (Plan, Value) {
        let mut plan = Plan::new(Shape { height: 8, width: 8, channels: 1 });
        let fine = plan.patch("fine", 0, [2, 2], [2, 2], [0, 0], 3);
        let mut coarse = plan.patch("stem", 0, [4, 4], [4, 4], [0, 0], 5);
        if further {
            coarse = plan.shrink("fine.down", fine, coarse);
        }
        let mut last = plan.block("a", coarse, 3, 7);
        if further {
            last = plan.block("b", last, 3, 7);
            let half = plan.patch("half", last, [2, 2], [2, 2], [0, 0], 4);
            last = plan.join("up", half, last);
        }
        (plan, last)
    }

    #[test]
    fn layers_that_are_new_beside_known_weights_change_nothing_at_first() {
        let ((plan, out), (further, further_out)) = (small(false), small(true));
        let row: Vec<f32> = plan.random(1).iter().map(|weight| weight + 0.1).collect();
        let tensors = Network::to_tensors(&plan, &row).unwrap();
        let pace = Pace::default();
        let folder = Path::new("");
        let header = Header::new("sketch");
        let mut task =
            Task { folder, pace: &pace, identity: String::new(), header, from: Some(&tensors), threads: 1 };
        let picture = Noise::new(2).normals(64);
        let shown = |plan: &Plan, row: &[f32], out: Value| {
            let mut work = Work::default();
            Network::new(plan.clone(), row).unwrap().forward(&picture, &mut work);
            work.value(out).to_vec()
        };
        let begun = first_weights(&further, &task);
        assert_eq!(shown(&further, &begun, further_out), shown(&plan, &row, out));
        // They are not dead: what they read is random, so that they learn; without known weights everything is.
        assert!(begun.iter().filter(|weight| **weight == 0.0).count() < begun.len() / 2);
        // A block of another depth is a new one, though its last bias would fit.
        let mut deeper = Plan::new(Shape { height: 8, width: 8, channels: 1 });
        deeper.patch("fine", 0, [2, 2], [2, 2], [0, 0], 3);
        let stem = deeper.patch("stem", 0, [4, 4], [4, 4], [0, 0], 5);
        let last = deeper.block("a", stem, 3, 9);
        let begun = first_weights(&deeper, &task);
        assert_eq!(shown(&deeper, &begun, last), shown(&deeper, &begun, stem));
        task.from = None;
        assert_eq!(first_weights(&further, &task), further.random(pace.seed));
    }
}
