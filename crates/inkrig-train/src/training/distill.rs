//! The fast model: a denoiser distilled for one to four steps (latent consistency, MotionLCM).

use super::control::Base;
use super::course::{Course, Settings, broken, is_share, read_settings};
use super::denoiser::works;
use super::latents::{Cut, Latents, windows};
use super::motions::{self, Selection};
use super::run::{OnStep, Place, Report, run};
use super::stage::{Stage, Weights, network};
use super::weights_file::{merged, named, read_weights, write_weights};
use crate::TrainError;
use crate::corpus::{Manifest, Split};
use inkrig_generate::checkpoint::ModelHeader;
use inkrig_generate::learning::{DistillBatch, DistillLearner};
use inkrig_generate::networks::{Denoiser, Noisy, Sizes, Work, guidance_waves};
use inkrig_generate::schedule::{Ddim, Lcm, Noise, NoiseSchedule, STEPS};
use inkrig_generate::text::TextEncoder as _;
use inkrig_generate::weights::{Tensor, Tensors};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Held-out windows whose clips by teacher and student are compared.
const MEASURED: usize = 64;

/// How the denoiser is distilled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DistillSettings {
    /// Steps, rates, measurements. `average` is the share that the target keeps of itself at a step.
    pub course: Course,
    /// Frames of windows.
    pub frames: usize,
    /// Frames from one window to the next.
    pub stride: usize,
    /// 0: every second of motion as often; 1: every action.
    pub balance: f64,
    /// From and to: how much more the text counts than nothing does.
    pub text_weights: (f32, f32),
    /// Steps of the teacher, of which the student skips all but a few: 2 to 50.
    pub solver_steps: usize,
    /// Where the distance turns from a square to a length.
    pub huber: f32,
    /// Numbers of the embedding of the text's weight.
    pub guidance_width: usize,
}

impl Default for DistillSettings {
    fn default() -> Self {
        Self {
            course: Course {
                steps: 10_000,
                batch: 128,
                rate: 2e-4,
                warm_up: 200,
                average: 0.95,
                measure_every: 500,
                save_every: 250,
                ..Course::default()
            },
            frames: 40,
            stride: 10,
            balance: 0.5,
            text_weights: (1.0, 4.0),
            solver_steps: 50,
            huber: 1e-3,
            guidance_width: 256,
        }
    }
}

impl Settings for DistillSettings {
    fn check(&self) -> Result<(), String> {
        self.course.check()?;
        let (least, most) = self.text_weights;
        broken([
            ("average", self.course.average > 0.0, "above 0: it is what the target keeps".to_string()),
            ("frames", self.frames >= 2, "2 or more".into()),
            ("stride", self.stride > 0, "1 or more".into()),
            ("balance", is_share(self.balance), "0 to 1".into()),
            (
                "text_weights",
                least >= 1.0 && most >= least && most <= 100.0,
                "1 to 100, the smaller first".into(),
            ),
            ("solver_steps", (2..=50).contains(&self.solver_steps), "2 to 50".into()),
            ("huber", self.huber > 0.0 && self.huber < 1e3, "above 0".into()),
            (
                "guidance_width",
                self.guidance_width > 0
                    && self.guidance_width.is_multiple_of(2)
                    && self.guidance_width <= 4096,
                "even, 2 to 4096".into(),
            ),
        ])
    }
}

impl DistillSettings {
    /// Reads a TOML file, in which the settings of the course stand beside the others; what it does not say is as by default.
    ///
    /// # Errors
    /// When it cannot be read, or a value is out of its range.
    pub fn read(path: &Path) -> Result<Self, TrainError> {
        read_settings(path)
    }
}

/// Distils the denoiser in `model`, or goes on with it. What it writes are whole models: the student in the denoiser's place, and all
/// else as it was. ControlNet and adapter, where the model has them, take the text's weight too, and make nothing of it.
///
/// # Errors
/// When corpus, model or checkpoint cannot be read, the model was distilled already, the checkpoint is of other settings, a loss is no
/// number, or nothing can be written.
pub fn train_distill(
    place: &Place<'_>,
    model: &Path,
    settings: &DistillSettings,
    progress: &mut OnStep<'_>,
) -> Result<Report, TrainError> {
    settings.check().map_err(TrainError::Device)?;
    let base = Base::read(model, &settings.course)?;
    if base.header.is_distilled() {
        let what = "is distilled already: give the model that it was distilled from".into();
        return Err(TrainError::Content { path: model.into(), what });
    }
    let sizes = Sizes { guidance_width: settings.guidance_width, ..base.header.sizes.clone() };
    let cut = Cut {
        frames: settings.frames,
        stride: settings.stride,
        other_lengths: 0.0,
        shortest: settings.frames,
        longest: settings.frames,
    };
    let cut = cut.checked(&sizes)?;
    let manifest = Manifest::read(place.corpus)?;
    let latents = |split, selection| {
        let motions = motions::read(&manifest, split, &base.features, selection)?;
        let windows = windows(&motions, cut, settings.course.seed);
        Latents::encode(&base.vae, &motions, &windows, place.replicas.max(1))
    };
    let mut stage = DistillStage {
        train: latents(Split::Train, Selection::both_sides(settings.balance))?,
        header: ModelHeader { sizes: sizes.clone(), ..base.header.clone() },
        no_text: base.verbs.encode("").map_err(network)?,
        held_out: HeldOut::default(),
        schedule: NoiseSchedule::default(),
        settings,
        sizes,
        base: &base,
    };
    stage.held_out = stage.teacher(&latents(Split::Val, Selection::PLAIN)?).map_err(network)?;
    let first = match place.from {
        Some(path) => named(&read_weights(path)?.1, "denoiser.denoiser."),
        None => stage.beginning()?,
    };
    Ok(run(&stage, first, place, progress)?.0)
}

struct DistillStage<'a> {
    settings: &'a DistillSettings,
    base: &'a Base,
    sizes: Sizes,
    header: ModelHeader,
    train: Latents,
    no_text: Vec<f32>,
    held_out: HeldOut,
    schedule: NoiseSchedule,
}

/// Noises and texts, and what the teacher makes of them.
#[derive(Default)]
struct HeldOut {
    noises: Vec<f32>,
    texts: Vec<f32>,
    latents: Vec<f32>,
    count: usize,
}

impl DistillStage<'_> {
    /// The teacher, and a layer (or columns of the first) that makes nothing of the text's weight.
    fn beginning(&self) -> Result<Tensors, TrainError> {
        let mut own = named(&self.base.weights, "denoiser.denoiser.");
        let first = "denoiser.denoiser.trunk.input.weight";
        let Some(weight) = own.get(first) else {
            own.insert("denoiser.denoiser.time_embedding.cond_proj.weight", self.nothing()?);
            return Ok(own);
        };
        let [outputs, inputs] = weight.shape() else { return Ok(own) };
        let (more, mut numbers) = (self.sizes.guidance_width, Vec::new());
        for row in weight.data().chunks_exact(*inputs) {
            numbers.extend_from_slice(row);
            numbers.resize(numbers.len() + more, 0.0);
        }
        let wider = Tensor::new(vec![*outputs, inputs + more], numbers).map_err(network)?;
        own.insert(first, wider);
        Ok(own)
    }

    fn nothing(&self) -> Result<Tensor, TrainError> {
        let shape = vec![self.sizes.text_width, self.sizes.guidance_width];
        Tensor::new(shape.clone(), vec![0.0; shape.iter().product()]).map_err(network)
    }

    /// What text weight clips are measured with.
    fn text_weight(&self) -> f32 {
        let (least, most) = self.settings.text_weights;
        self.header.text_weight.unwrap_or(7.5).clamp(least, most)
    }

    /// Samples of the teacher by all of its steps.
    fn teacher(&self, held_out: &Latents) -> Result<HeldOut, inkrig_generate::GenerateError> {
        let plain = Sizes { guidance_width: 0, ..self.sizes.clone() };
        let denoiser = Denoiser::new(&plain, &self.base.weights)?;
        let every = held_out.len().div_ceil(MEASURED).max(1);
        let mut made = HeldOut::default();
        let mut noise = Noise::new(0);
        for window in (0..held_out.len()).step_by(every) {
            made.texts.extend_from_slice(self.base.verbs.row(held_out.verbs(window).first().copied()));
            made.noises.extend(noise.normals(held_out.each));
            made.count += 1;
        }
        let count = made.count;
        let ddim = Ddim::new(50)?;
        made.latents = made.noises.clone();
        let texts = [&made.texts[..], &self.no_text.repeat(count)].concat();
        let mut work = Work::default();
        for timestep in ddim.timesteps() {
            let latents = made.latents.repeat(2);
            let timesteps = vec![timestep; 2 * count];
            let noisy = Noisy { latents: &latents, timesteps: &timesteps, texts: &texts, guidance: None };
            let mut with = denoiser.noise(&noisy, None, &mut work)?;
            let without = with.split_off(made.latents.len());
            let weight = self.text_weight();
            with.iter_mut().zip(without).for_each(|(with, without)| {
                *with = without + weight * (*with - without);
            });
            ddim.step(&mut made.latents, &with, timestep);
        }
        Ok(made)
    }
}

impl Stage for DistillStage<'_> {
    type Replica = DistillLearner;
    /// How many samples, and the seed of what is drawn for them.
    type Work = (usize, u64);

    const PARTS: &'static [&'static str] = &[];

    fn course(&self) -> Course {
        self.settings.course.clone()
    }

    fn settings(&self) -> String {
        serde_json::to_string(self.settings).unwrap_or_default()
    }

    fn is_same(&self, settings: &str) -> bool {
        serde_json::from_str::<DistillSettings>(settings).is_ok_and(|settings| settings == *self.settings)
    }

    fn replica(&self) -> Result<DistillLearner, TrainError> {
        let (course, huber) = (&self.settings.course, self.settings.huber);
        let teacher = course.for_learning(named(&self.base.weights, "denoiser.denoiser."));
        let own = course.for_learning(self.beginning()?);
        DistillLearner::new(&self.sizes, &own, &teacher, &self.no_text, huber).map_err(network)
    }

    fn draw(&self, step: u64, replicas: usize) -> Vec<Self::Work> {
        works(&self.settings.course, step, replicas)
    }

    fn gradient(
        &self,
        learner: &mut DistillLearner,
        weights: Weights<'_>,
        (count, seed): Self::Work,
        _step: u64,
        gradient: &mut Vec<f32>,
    ) -> Result<Vec<f64>, TrainError> {
        let mut draw = Noise::new(seed);
        let (mut noisy, mut texts) = (Vec::new(), Vec::new());
        let (mut starts, mut ends, mut text_weights) = (Vec::new(), Vec::new(), Vec::new());
        let solver = self.settings.solver_steps;
        let stride = STEPS / solver;
        let (least, most) = self.settings.text_weights;
        for _ in 0..count {
            let window = self.train.pick(&mut draw);
            let first = noisy.len();
            self.train.sample(window, &mut draw, &mut noisy);
            texts.extend_from_slice(self.base.verbs.row(self.train.verb(window, 0.0, &mut draw)));
            let step = ((draw.uniform() * solver as f64) as usize).min(solver - 1);
            let start = (step + 1) * stride - 1;
            starts.push(start);
            ends.push(start.saturating_sub(stride));
            text_weights.push(least + (most - least) * draw.uniform() as f32);
            let noise = draw.normals(self.train.each);
            if let Some(latent) = noisy.get_mut(first..) {
                self.schedule.add_noise(latent, &noise, start);
            }
        }
        let batch = DistillBatch {
            noisy: &noisy,
            starts: &starts,
            ends: &ends,
            texts: &texts,
            text_weights: &text_weights,
        };
        Ok(vec![learner.step(weights.now, weights.average, &batch, gradient).map_err(network)?])
    }

    /// How far clips of one and of four steps are from the teacher's of fifty, from the same noise: the root of the mean square over
    /// the latents' numbers.
    fn measure(&self, weights: &Tensors) -> Result<Vec<(&'static str, f64)>, TrainError> {
        let apart = |steps| self.apart(weights, steps).map_err(network);
        let (four, one) = (apart(4)?, apart(1)?);
        Ok(vec![("held_out_one_step", one), ("held_out_four_steps", four)])
    }

    fn write(&self, path: &Path, weights: &Tensors) -> Result<(), TrainError> {
        let mut whole = merged(&self.base.weights, weights);
        for network in ["controlnet", "denoiser"] {
            if whole.get(&format!("{network}.time_embedding.linear_1.weight")).is_some() {
                whole.insert(format!("{network}.time_embedding.cond_proj.weight"), self.nothing()?);
            }
        }
        write_weights(path, &whole, &self.header)
    }
}

impl DistillStage<'_> {
    fn apart(&self, weights: &Tensors, steps: usize) -> Result<f64, inkrig_generate::GenerateError> {
        let HeldOut { noises, texts, latents: wanted, count } = &self.held_out;
        let student = Denoiser::new(&self.sizes, weights)?;
        let lcm = Lcm::new(steps)?;
        let waves = guidance_waves(self.text_weight(), self.sizes.guidance_width);
        let mut latents = noises.clone();
        let (mut work, mut fresh) = (Work::default(), Noise::new(1));
        let timesteps = lcm.timesteps();
        for (at, &timestep) in timesteps.iter().enumerate() {
            let all = vec![timestep; *count];
            let noisy = Noisy { latents: &latents, timesteps: &all, texts, guidance: Some(&waves) };
            let noise = student.noise(&noisy, None, &mut work)?;
            let next = timesteps.get(at + 1).map(|&next| (next, fresh.normals(latents.len())));
            let next = next.as_ref().map(|(next, noise)| (*next, &noise[..]));
            lcm.step(&mut latents, &noise, timestep, next);
        }
        let squares = latents.iter().zip(wanted).map(|(a, b)| f64::from(a - b) * f64::from(a - b));
        Ok((squares.sum::<f64>() / wanted.len().max(1) as f64).sqrt())
    }
}
