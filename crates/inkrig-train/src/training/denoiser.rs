//! The second stage: the denoiser and the vectors of verbs, on latents of a finished autoencoder.

use super::course::{Course, Optimiser, Settings, broken, is_share, read_settings};
use super::latents::{Cut, Drawing, Latents, windows};
use super::motions::{self, Selection};
use super::run::{OnStep, Place, Report, run};
use super::stage::{Stage, Weights, network, seed_of, told};
use super::weights_file::{merged, named, read_weights, write_weights};
use crate::TrainError;
use crate::corpus::{Manifest, Split};
use inkrig_generate::checkpoint::ModelHeader;
use inkrig_generate::learning::{DenoiserLearner, NoisyVerbs};
use inkrig_generate::networks::{Denoiser, Noisy, Parts, Sizes, Vae, Work};
use inkrig_generate::schedule::{Noise, NoiseSchedule, STEPS};
use inkrig_generate::text::{VERBS, VerbTable};
use inkrig_generate::weights::{Tensor as Plain, Tensors, random};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Held-out windows that are measured, and timesteps of each.
const MEASURED: (usize, usize) = (384, 4);
/// Deviation of the verbs' vectors to begin with.
const VERB_DEVIATION: f32 = 0.5;

/// How the denoiser is trained.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DenoiserSettings {
    /// Steps, rates, measurements.
    pub course: Course,
    /// Whether the denoiser says the velocity, by a layer of its own; else the noise, as published.
    pub velocity: bool,
    /// Numbers of a row in feed-forward blocks on whole latents; 0 for blocks with attention, as published. They say the velocity.
    pub trunk: usize,
    /// Share of numbers that are dropped.
    pub dropout: f64,
    /// Share of samples that lose their text, so that there is a prediction without.
    pub text_dropped: f64,
    /// Frames of most windows.
    pub frames: usize,
    /// Frames from one window to the next.
    pub stride: usize,
    /// One more window, of another length, for this share of them.
    pub other_lengths: f64,
    /// The shortest of those.
    pub shortest: usize,
    /// The longest of those.
    pub longest: usize,
    /// 0: every second of motion as often; 1: every action.
    pub balance: f64,
    /// Whether mirror images are learned from, too.
    pub mirrored: bool,
    /// Share of clips of which a copy is learned from that is faster or slower, up to 1.3 times.
    pub retimed: f64,
    /// Share of samples that are mixed of two windows of a verb.
    pub mixed: f64,
}

impl Default for DenoiserSettings {
    fn default() -> Self {
        Self {
            course: Course {
                steps: 30_000,
                batch: 256,
                rate: 1.5e-3,
                warm_up: 200,
                weight_decay: 0.02,
                optimiser: Optimiser::AdamW,
                betas: (0.9, 0.99),
                average: 0.999,
                measure_every: 500,
                save_every: 250,
                ..Course::default()
            },
            velocity: true,
            trunk: 512,
            dropout: 0.1,
            text_dropped: 0.1,
            frames: 40,
            stride: 10,
            other_lengths: 0.0,
            shortest: 20,
            longest: 120,
            balance: 0.5,
            mirrored: true,
            retimed: 1.0,
            mixed: 0.25,
        }
    }
}

impl Settings for DenoiserSettings {
    fn check(&self) -> Result<(), String> {
        self.course.check()?;
        broken([
            (
                "trunk",
                self.trunk <= 4096 && (self.trunk == 0 || self.velocity),
                "0 to 4096, and 0 where `velocity` is false".into(),
            ),
            ("dropout", (0.0..1.0).contains(&self.dropout), "from 0 to below 1".to_string()),
            ("text_dropped", is_share(self.text_dropped), "0 to 1".into()),
            ("frames", self.frames >= 2, "2 or more".into()),
            ("stride", self.stride > 0, "1 or more".into()),
            ("other_lengths", is_share(self.other_lengths), "0 to 1".into()),
            ("shortest", (2..=self.longest).contains(&self.shortest), "2 to longest".into()),
            ("balance", is_share(self.balance), "0 to 1".into()),
            ("retimed", is_share(self.retimed), "0 to 1".into()),
            ("mixed", is_share(self.mixed), "0 to 1".into()),
        ])
    }
}

impl DenoiserSettings {
    /// Reads a TOML file, in which the settings of the course stand beside the others; what it does not say is as by default.
    ///
    /// # Errors
    /// When it cannot be read, or a value is out of its range.
    pub fn read(path: &Path) -> Result<Self, TrainError> {
        read_settings(path)
    }

    /// What is taken of the split that is learned from.
    fn selection(&self) -> Selection {
        let Self { balance, mirrored, retimed, .. } = *self;
        Selection { balance, mirrored, retimed, seed: self.course.seed }
    }

    fn cut(&self, sizes: &Sizes) -> Result<Cut, TrainError> {
        let Self { frames, stride, other_lengths, shortest, longest, .. } = *self;
        Cut { frames, stride, other_lengths, shortest, longest }.checked(sizes)
    }
}

/// Trains the denoiser on the latents of the autoencoder in `vae`, or goes on with it. What it writes are whole models, with the
/// autoencoder and the verbs.
///
/// # Errors
/// When corpus, autoencoder or checkpoint cannot be read, the checkpoint is of other settings, a loss is no number, or nothing can be
/// written.
pub fn train_denoiser(
    place: &Place<'_>,
    vae: &Path,
    settings: &DenoiserSettings,
    progress: &mut OnStep<'_>,
) -> Result<Report, TrainError> {
    settings.check().map_err(TrainError::Device)?;
    let (header, base) = read_weights(vae)?;
    let sizes = Sizes {
        guidance_width: 0,
        velocity: settings.velocity,
        trunk: settings.trunk,
        ..header.sizes.clone()
    };
    let header = ModelHeader { sizes: sizes.clone(), ..header };
    let content = |what: String| TrainError::Content { path: vae.into(), what };
    let (statistics, _) = header.statistics().map_err(|error| content(error.to_string()))?;
    let network_of_vae = Vae::new(&sizes, &base).map_err(|error| content(error.to_string()))?;
    let manifest = Manifest::read(place.corpus)?;
    let cut = settings.cut(&sizes)?;
    let latents = |split, selection, cut| {
        let motions = motions::read(&manifest, split, &statistics, selection)?;
        let windows = windows(&motions, cut, settings.course.seed);
        Latents::encode(&network_of_vae, &motions, &windows, place.replicas.max(1))
    };
    let stage = DenoiserStage {
        train: latents(Split::Train, settings.selection(), cut)?,
        held_out: latents(Split::Val, Selection::PLAIN, Cut { other_lengths: 0.0, ..cut })?,
        schedule: NoiseSchedule::default(),
        base: named(&base, "vae."),
        settings,
        sizes,
        header,
    };
    if stage.train.len() == 0 || stage.held_out.len() == 0 {
        return Err(TrainError::Device("the corpus has no clip as long as `shortest`".into()));
    }
    let first = match place.from {
        Some(path) => own_of(&read_weights(path)?.1),
        None => stage.beginning(),
    };
    Ok(run(&stage, first, place, progress)?.0)
}

/// The tensors of a model that this stage trains.
fn own_of(weights: &Tensors) -> Tensors {
    merged(&named(weights, "denoiser.denoiser."), &named(weights, "text."))
}

struct DenoiserStage<'a> {
    settings: &'a DenoiserSettings,
    sizes: Sizes,
    header: ModelHeader,
    /// The autoencoder.
    base: Tensors,
    train: Latents,
    held_out: Latents,
    schedule: NoiseSchedule,
}

impl DenoiserStage<'_> {
    fn beginning(&self) -> Tensors {
        let seed = self.settings.course.seed;
        let only = Parts { vae: false, denoiser: true, control: false, control_2d: false };
        let mut weights = random(&self.sizes, only, seed);
        let mut noise = Noise::new(seed ^ 0x7665_7262);
        let width = self.sizes.text_width;
        let mut row = |name: &str, shape: Vec<usize>| {
            let count = shape.iter().product();
            let numbers = noise.normals(count).into_iter().map(|x| VERB_DEVIATION * x).collect();
            if let Ok(tensor) = Plain::new(shape, numbers) {
                weights.insert(name, tensor);
            }
        };
        row(VerbTable::VERBS, vec![VERBS.len(), width]);
        row(VerbTable::NOTHING, vec![width]);
        weights
    }
}

impl Stage for DenoiserStage<'_> {
    type Replica = DenoiserLearner;
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
        let told = told::<DenoiserSettings>(settings, &[], &[("retimed", 0.0)]);
        told.is_some_and(|told| told == *self.settings)
    }

    fn replica(&self) -> Result<DenoiserLearner, TrainError> {
        let weights = self.settings.course.for_learning(self.beginning());
        DenoiserLearner::new(&self.sizes, &weights).map_err(network)
    }

    fn draw(&self, step: u64, replicas: usize) -> Vec<Self::Work> {
        works(&self.settings.course, step, replicas)
    }

    fn gradient(
        &self,
        learner: &mut DenoiserLearner,
        weights: Weights<'_>,
        (count, seed): Self::Work,
        _step: u64,
        gradient: &mut Vec<f32>,
    ) -> Result<Vec<f64>, TrainError> {
        let mut draw = Noise::new(seed);
        let DenoiserSettings { text_dropped, mixed, dropout, .. } = *self.settings;
        let (mut latents, verbs) = self.train.draw(count, Drawing { text_dropped, mixed }, &mut draw);
        let noise = draw.normals(latents.len());
        let timesteps = timesteps(count, &mut draw);
        let each = self.train.each;
        let rows = latents.chunks_exact_mut(each).zip(noise.chunks_exact(each));
        rows.zip(&timesteps)
            .for_each(|((latent, noise), &step)| self.schedule.add_noise(latent, noise, step));
        let batch = NoisyVerbs { latents: &latents, noise: &noise, timesteps: &timesteps, verbs: &verbs };
        let dropout = Some((dropout as f32, seed));
        Ok(vec![learner.step(weights.now, &batch, dropout, gradient).map_err(network)?])
    }

    fn measure(&self, weights: &Tensors) -> Result<Vec<(&'static str, f64)>, TrainError> {
        let error = noise_error(&self.sizes, weights, &self.held_out, &self.schedule).map_err(network)?;
        Ok(vec![("held_out_noise", error)])
    }

    fn write(&self, path: &Path, weights: &Tensors) -> Result<(), TrainError> {
        write_weights(path, &merged(&self.base, weights), &self.header)
    }
}

/// What replicas draw of a step's batch: how many samples, and a seed each.
pub(super) fn works(course: &Course, step: u64, replicas: usize) -> Vec<(usize, u64)> {
    let seed = seed_of(course.seed, step);
    let mut noise = Noise::new(seed);
    let each = course.batch.div_ceil(replicas);
    (0..replicas).map(|_| (each, (noise.uniform() * (1_u64 << 53) as f64) as u64)).collect()
}

/// One for each sample, evenly drawn.
pub(super) fn timesteps(count: usize, noise: &mut Noise) -> Vec<usize> {
    (0..count).map(|_| ((noise.uniform() * STEPS as f64) as usize).min(STEPS - 1)).collect()
}

/// Mean squared error of what is predicted of held-out latents, at noises and timesteps that are always the same.
fn noise_error(
    sizes: &Sizes,
    weights: &Tensors,
    held_out: &Latents,
    schedule: &NoiseSchedule,
) -> Result<f64, inkrig_generate::GenerateError> {
    let denoiser = Denoiser::new(sizes, weights)?;
    let width = sizes.text_width;
    let verbs = weights.expect(VerbTable::VERBS, &[VERBS.len(), width])?;
    let nothing = weights.expect(VerbTable::NOTHING, &[width])?;
    let (most, times) = MEASURED;
    let every = held_out.len().div_ceil(most).max(1);
    let (mut sum, mut count, mut work) = (0.0, 0_usize, Work::default());
    for (at, window) in (0..held_out.len()).step_by(every).enumerate() {
        let mut draw = Noise::new(at as u64);
        let latent = held_out.mean(window);
        let noise = draw.normals(latent.len() * times);
        // One in each part of the schedule.
        let part = |time: usize| (time as f64 + draw.uniform()) / times as f64 * STEPS as f64;
        let timesteps: Vec<usize> = (0..times).map(part).map(|step| (step as usize).min(STEPS - 1)).collect();
        let mut latents = latent.repeat(times);
        let rows = latents.chunks_exact_mut(latent.len()).zip(noise.chunks_exact(latent.len()));
        rows.zip(&timesteps).for_each(|((latent, noise), &step)| schedule.add_noise(latent, noise, step));
        let verb = held_out.verbs(window).first();
        let text = verb.and_then(|&verb| verbs.chunks_exact(width).nth(verb)).unwrap_or(nothing);
        let texts = text.repeat(times);
        let noisy = Noisy { latents: &latents, timesteps: &timesteps, texts: &texts, guidance: None };
        let predicted = denoiser.noise(&noisy, None, &mut work)?;
        let rows = predicted.chunks_exact(latent.len()).zip(noise.chunks_exact(latent.len()));
        for ((predicted, noise), &timestep) in rows.zip(&timesteps) {
            let off = |(a, b): (&f32, &f32)| f64::from(a - b) * f64::from(a - b);
            let apart: f64 = predicted.iter().zip(noise).map(off).sum();
            sum += f64::from(denoiser.loss_weight(timestep)) * apart;
        }
        count += noise.len();
    }
    Ok(sum / count.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::super::course::parse_settings;
    use super::*;

    #[test]
    fn settings_and_their_course_stand_in_one_flat_file() {
        let settings: DenoiserSettings =
            parse_settings("batch = 32\nmixed = 0.5\nbetas = [0.5, 0.6]").unwrap();
        let usual = DenoiserSettings::default();
        let course = Course { batch: 32, betas: (0.5, 0.6), ..usual.course.clone() };
        assert_eq!(settings, DenoiserSettings { course, mixed: 0.5, ..usual });
        for (text, part) in [
            ("stesp = 3", "stesp"),
            ("rate = 2.0", "rate is out of range"),
            ("average = 1.0", "average"),
            ("batch = 'many'", "batch"),
            ("mixed = nan", "mixed"),
        ] {
            let error = parse_settings::<DenoiserSettings>(text).unwrap_err();
            assert!(error.contains(part), "{part}: {error}");
        }
    }

    #[test]
    fn replicas_draw_apart_and_the_same_again() {
        let course = Course { batch: 9, ..Course::default() };
        let two = works(&course, 3, 2);
        assert_eq!((two[0].0, two[1].0), (5, 5));
        assert!(two[0].1 != two[1].1 && two == works(&course, 3, 2) && two != works(&course, 4, 2));
        let times = timesteps(2000, &mut Noise::new(1));
        assert!(times.iter().all(|&time| time < STEPS));
        assert!(times.iter().any(|&time| time < 20) && times.iter().any(|&time| time > 980));
    }
}
