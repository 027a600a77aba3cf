//! The fourth stage: encoders of conditions on the picture, which learn to say what those of space say (stage B of the paper).

use super::conditions::Drawer;
use super::control::{Base, ControlSettings, lost, own_names};
use super::control_measure::{HeldOut, measure};
use super::course::{Course, Settings, broken, is_share, read_settings};
use super::denoiser::{timesteps, works};
use super::estimate::{EstimateSettings, EstimateStage, Told};
use super::latents::{Cut, Latents, Window, windows};
use super::motions::{self, Motion, Selection};
use super::picture::Drawing;
use super::run::{OnStep, Place, Report, run};
use super::stage::{Stage, Weights, network};
use super::weights_file::{merged, read_weights, write_weights};
use crate::TrainError;
use crate::corpus::{Manifest, Split};
use inkrig_generate::guidance::View;
use inkrig_generate::learning::{
    AlignBatch, AlignLearner, AlignObjective, ControlBatch, ControlObjective, Wanted,
};
use inkrig_generate::networks::{ConditionRows, Parts};
use inkrig_generate::schedule::{Noise, NoiseSchedule};
use inkrig_generate::weights::Tensors;
use inkrig_motion::humanml::Camera;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The networks that this stage trains.
const PLANE: Parts = Parts { vae: false, denoiser: false, control: false, control_2d: true };

/// How the encoders of drawings are trained.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AlignSettings {
    /// Steps, rates, measurements.
    pub course: Course,
    /// Frames of windows.
    pub frames: usize,
    /// Frames from one window to the next.
    pub stride: usize,
    /// 0: every second of motion as often; 1: every action.
    pub balance: f64,
    /// From where training looks, and how its drawings differ from the motion.
    pub drawing: Drawing,
    /// Weight of the contrast between the samples of a step.
    pub contrast_weight: f64,
    /// What similarities are divided by.
    pub temperature: f64,
    /// Weight of the squared distance of both domains' vectors.
    pub matching_weight: f64,
    /// Samples of a step that are denoised by what the picture says; 0 for none.
    pub denoised: usize,
    /// Weight of the noise's squared error in those.
    pub noise_weight: f64,
    /// Of trajectories' squared distance, in normalised units.
    pub trajectory_weight: f64,
    /// Of key poses'.
    pub keypose_weight: f64,
    /// Distances in samples with much noise count less: times this power of the share of signal.
    pub signal_power: f64,
    /// Held-out windows that are sampled at every measurement.
    pub measured: usize,
    /// Where control is by an estimate: weights and dropout are its own then.
    pub estimate: EstimateSettings,
}

impl Default for AlignSettings {
    fn default() -> Self {
        Self {
            course: Course {
                steps: 6_000,
                batch: 256,
                rate: 1e-3,
                warm_up: 150,
                weight_decay: 0.01,
                average: 0.997,
                measure_every: 500,
                save_every: 250,
                ..Course::default()
            },
            frames: 40,
            stride: 10,
            balance: 0.5,
            drawing: Drawing::default(),
            contrast_weight: 1.0,
            temperature: 0.07,
            matching_weight: 1.0,
            denoised: 16,
            noise_weight: 1.0,
            trajectory_weight: 0.0,
            keypose_weight: 1.0,
            signal_power: 0.5,
            measured: 48,
            estimate: EstimateSettings::default(),
        }
    }
}

impl Settings for AlignSettings {
    fn check(&self) -> Result<(), String> {
        self.course.check()?;
        self.estimate.check()?;
        let weight = |value: f64| value >= 0.0 && value.is_finite();
        broken([
            ("frames", self.frames >= 2, "2 or more".to_string()),
            ("stride", self.stride > 0, "1 or more".into()),
            ("balance", is_share(self.balance), "0 to 1".into()),
            (
                "drawing",
                self.drawing.fits(),
                "ranges from the smaller to the larger, and shares of 0 to 1".into(),
            ),
            ("contrast_weight", weight(self.contrast_weight), "0 or more".into()),
            ("temperature", self.temperature > 0.0 && self.temperature <= 100.0, "above 0".into()),
            ("matching_weight", weight(self.matching_weight), "0 or more".into()),
            ("denoised", self.denoised <= self.course.batch, "at most the batch".into()),
            ("noise_weight", weight(self.noise_weight), "0 or more".into()),
            ("trajectory_weight", weight(self.trajectory_weight), "0 or more".into()),
            ("keypose_weight", weight(self.keypose_weight), "0 or more".into()),
            ("signal_power", weight(self.signal_power), "0 or more".into()),
            ("measured", self.measured > 0, "1 or more".into()),
        ])
    }
}

impl AlignSettings {
    /// Reads a TOML file, in which the settings of the course stand beside the others; what it does not say is as by default.
    ///
    /// # Errors
    /// When it cannot be read, or a value is out of its range.
    pub fn read(path: &Path) -> Result<Self, TrainError> {
        read_settings(path)
    }
}

/// Trains the encoders of drawings for the control in `model`, or goes on with them. What it writes are whole models.
///
/// # Errors
/// When corpus, model or checkpoint cannot be read, the model has no control, the checkpoint is of other settings, a loss is no number, or
/// nothing can be written.
pub fn train_align(
    place: &Place<'_>,
    model: &Path,
    settings: &AlignSettings,
    progress: &mut OnStep<'_>,
) -> Result<Report, TrainError> {
    settings.check().map_err(TrainError::Device)?;
    let base = Base::read(model, &settings.course)?;
    let what = if !Parts::of(&base.weights).control {
        Some("has no control: train that first")
    } else if base.header.is_distilled() {
        Some("is distilled: give the model that it was distilled from")
    } else {
        None
    };
    if let Some(what) = what {
        return Err(TrainError::Content { path: model.into(), what: what.into() });
    }
    let AlignSettings { frames, stride, .. } = *settings;
    let cut = Cut { frames, stride, other_lengths: 0.0, shortest: frames, longest: frames };
    let cut = cut.checked(&base.header.sizes)?;
    let manifest = Manifest::read(place.corpus)?;
    let read = |split, selection| motions::read(&manifest, split, &base.features, selection);
    let motions = read(Split::Train, Selection::both_sides(settings.balance))?;
    let windows = windows(&motions, cut, settings.course.seed);
    let view = View::Plane(Camera::default());
    let latents = Latents::encode(&base.vae, &motions, &windows, place.replicas.max(1))?;
    let held_out =
        HeldOut::new(&read(Split::Val, Selection::PLAIN)?, frames, settings.measured, &base, view)?;
    if base.header.sizes.estimate > 0 {
        let (told, usual, base) = (Told::Plane(settings), ControlSettings::default(), &base);
        let schedule = NoiseSchedule::default();
        let stage = EstimateStage { told, base, motions, windows, latents, held_out, usual, schedule };
        return stage.run(place, progress);
    }
    let stage = AlignStage {
        latents,
        held_out,
        windows,
        motions,
        schedule: NoiseSchedule::default(),
        settings,
        base: &base,
    };
    let first = match place.from {
        Some(path) => stage.own_of(&read_weights(path)?.1),
        None => stage.beginning(),
    };
    Ok(run(&stage, first, place, progress)?.0)
}

struct AlignStage<'a> {
    settings: &'a AlignSettings,
    base: &'a Base,
    motions: Vec<Motion>,
    windows: Vec<Window>,
    latents: Latents,
    held_out: HeldOut,
    schedule: NoiseSchedule,
}

impl AlignStage<'_> {
    fn own_of(&self, weights: &Tensors) -> Tensors {
        let own = own_names(&self.base.header.sizes, PLANE);
        own.filter_map(|name| Some((name.clone(), weights.get(&name)?.clone()))).collect()
    }

    /// Copies of the encoders of space.
    fn beginning(&self) -> Tensors {
        let own = own_names(&self.base.header.sizes, PLANE);
        let copy = |name: String| {
            let of_space = name.replacen("_2d.", ".", 1);
            Some((name, self.base.weights.get(&of_space)?.clone()))
        };
        own.filter_map(copy).collect()
    }
}

impl<'a> Stage for AlignStage<'a> {
    type Replica = AlignLearner<'a>;
    /// How many samples, and the seed of what is drawn for them.
    type Work = (usize, u64);

    const PARTS: &'static [&'static str] = &["contrast", "matching", "noise", "keypose"];

    fn course(&self) -> Course {
        self.settings.course.clone()
    }

    fn settings(&self) -> String {
        serde_json::to_string(self.settings).unwrap_or_default()
    }

    fn is_same(&self, settings: &str) -> bool {
        serde_json::from_str::<AlignSettings>(settings).is_ok_and(|settings| settings == *self.settings)
    }

    fn replica(&self) -> Result<AlignLearner<'a>, TrainError> {
        let base = self.base;
        let parts = (&base.quick_vae, &base.quick);
        let own = self.settings.course.for_learning(self.beginning());
        AlignLearner::new(&base.header.sizes, &own, parts, &base.features, &base.places).map_err(network)
    }

    fn draw(&self, step: u64, replicas: usize) -> Vec<Self::Work> {
        works(&self.settings.course, step, replicas)
    }

    fn gradient(
        &self,
        learner: &mut AlignLearner<'a>,
        weights: Weights<'_>,
        (count, seed): Self::Work,
        _step: u64,
        gradient: &mut Vec<f32>,
    ) -> Result<Vec<f64>, TrainError> {
        let settings = self.settings;
        let mut draw = Noise::new(seed);
        let drawer = Drawer { features: &self.base.features, places: &self.base.places };
        // All have both; which are asked for is as in the stage before.
        let before = ControlSettings {
            trajectory_dropped: 0.0,
            keypose_dropped: 0.0,
            any_joints: 0.0,
            ..ControlSettings::default()
        };
        let (mut drawn, mut pictures, mut chosen) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..count {
            let window = self.latents.pick(&mut draw);
            let own = self.windows.get(window).ok_or_else(|| lost("a window"))?;
            let own = drawer.draw(own, &self.motions, &before.mixture(), &mut draw)?;
            let picture = settings.drawing.of(&own, &self.base.places, &mut draw)?;
            let keypose = picture.keypose().into_iter().cloned().collect();
            pictures.push((picture.trajectory().to_vec(), keypose));
            drawn.push(own);
            chosen.push(window);
        }
        let share = (settings.denoised * count).div_ceil(settings.course.batch.max(1));
        let (mut noisy, mut texts) = (Vec::new(), Vec::new());
        for &window in chosen.iter().take(share) {
            self.latents.sample(window, &mut draw, &mut noisy);
            texts.extend_from_slice(self.base.verbs.row(self.latents.verb(window, 0.1, &mut draw)));
        }
        let noise = draw.normals(noisy.len());
        let timesteps = timesteps(share, &mut draw);
        let each = self.latents.each;
        let rows = noisy.chunks_exact_mut(each).zip(noise.chunks_exact(each));
        rows.zip(&timesteps)
            .for_each(|((latent, noise), &step)| self.schedule.add_noise(latent, noise, step));
        let wanted: Vec<Wanted<'_>> = drawn
            .iter()
            .enumerate()
            .take(share)
            .map(|(sample, own)| Wanted {
                sample,
                places: &own.places,
                trajectory: &own.asked,
                keypose: own.frame,
            })
            .collect();
        let space: (Vec<ConditionRows>, Vec<ConditionRows>) =
            drawn.iter().map(|own| (own.trajectory.clone(), own.keypose.clone())).unzip();
        let plane: (Vec<ConditionRows>, Vec<ConditionRows>) = pictures.into_iter().unzip();
        let first = |rows: &'_ [ConditionRows]| rows.iter().take(share).cloned().collect::<Vec<_>>();
        let (trajectories, keyposes) = (first(&plane.0), first(&plane.1));
        let denoised = ControlBatch {
            noisy: &noisy,
            noise: &noise,
            timesteps: &timesteps,
            texts: &texts,
            trajectories: &trajectories,
            keyposes: &keyposes,
            wanted: &wanted,
        };
        let batch = AlignBatch {
            trajectories: (&space.0, &plane.0),
            keyposes: (&space.1, &plane.1),
            denoised: (share > 0).then_some(denoised),
        };
        let objective = AlignObjective {
            contrast: settings.contrast_weight,
            temperature: settings.temperature,
            matching: settings.matching_weight,
            control: ControlObjective {
                noise: settings.noise_weight,
                trajectory: settings.trajectory_weight,
                keypose: settings.keypose_weight,
                signal_power: settings.signal_power,
            },
        };
        let losses = learner.step(weights.now, &batch, &objective, gradient).map_err(network)?;
        let control = losses.control;
        Ok(vec![losses.total, losses.contrast, losses.matching, control.noise, control.keypose])
    }

    fn measure(&self, weights: &Tensors) -> Result<Vec<(&'static str, f64)>, TrainError> {
        measure(self.base, &merged(&self.base.weights, weights), &self.held_out)
    }

    fn write(&self, path: &Path, weights: &Tensors) -> Result<(), TrainError> {
        write_weights(path, &merged(&self.base.weights, weights), &self.base.header)
    }
}
