//! Control by an estimate: in space the third stage, on the picture the fourth.

use super::align::AlignSettings;
use super::conditions::{Drawer, Drawn, Mixture};
use super::control::{Base, ControlSettings, lost, own_names};
use super::control_measure::{HeldOut, measure};
use super::course::{Course, broken, is_share};
use super::denoiser::{timesteps, works};
use super::latents::{Latents, Window};
use super::motions::Motion;
use super::picture::Drawing;
use super::run::{OnStep, Place, Report, run};
use super::stage::{Stage, Weights, network};
use super::weights_file::{merged, read_weights, write_weights};
use crate::TrainError;
use inkrig_generate::learning::{Asked, EstimateBatch, EstimateLearner, EstimateObjective};
use inkrig_generate::networks::{Domain, Parts};
use inkrig_generate::schedule::{Noise, NoiseSchedule, STEPS};
use inkrig_generate::weights::{Tensor, Tensors, random};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// How control by an estimate is trained.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct EstimateSettings {
    /// Numbers of a row in its networks; 0: ControlNet and adapter, as published. A model that has control already keeps its own.
    pub width: usize,
    /// Share of numbers that are dropped.
    pub dropout: f64,
    /// Weight of the corrected velocity's squared error.
    pub velocity: f64,
    /// Of the estimated latent's squared error.
    pub estimate: f64,
    /// Of trajectories' mean distance, metres.
    pub trajectory: f64,
    /// Of key poses', the pelvis at its place.
    pub keypose: f64,
    /// How much distances count in the estimate, to how much in what is predicted.
    pub estimated: f64,
    /// Noise that the timestep does not say, as a share of the noise that it does, from none to this: what is sampled is not quite what was
    /// trained on (Ning et al. 2023, Input perturbation).
    pub perturbed: f64,
    /// Share of samples that the model itself brings to their timestep from a later one.
    pub rolled: f64,
}

impl Default for EstimateSettings {
    fn default() -> Self {
        Self {
            width: 384,
            dropout: 0.05,
            velocity: 1.0,
            estimate: 0.3,
            trajectory: 2.0,
            keypose: 4.0,
            estimated: 0.5,
            perturbed: 0.5,
            rolled: 0.3,
        }
    }
}

impl EstimateSettings {
    pub(super) fn check(&self) -> Result<(), String> {
        let weight = |value: f64| value >= 0.0 && value.is_finite();
        broken([
            ("estimate.width", self.width <= 4096, "0 to 4096".to_string()),
            ("estimate.dropout", (0.0..1.0).contains(&self.dropout), "from 0 to below 1".into()),
            ("estimate.velocity", weight(self.velocity), "0 or more".into()),
            ("estimate.estimate", weight(self.estimate), "0 or more".into()),
            ("estimate.trajectory", weight(self.trajectory), "0 or more".into()),
            ("estimate.keypose", weight(self.keypose), "0 or more".into()),
            ("estimate.estimated", weight(self.estimated), "0 or more".into()),
            ("estimate.rolled", is_share(self.rolled), "0 to 1".into()),
            ("estimate.perturbed", is_share(self.perturbed), "0 to 1".into()),
        ])
    }
}

/// Which stage it is, and its settings.
#[derive(Debug, Clone, Copy)]
pub(super) enum Told<'a> {
    Space(&'a ControlSettings),
    Plane(&'a AlignSettings),
}

impl<'a> Told<'a> {
    fn course(self) -> &'a Course {
        match self {
            Self::Space(settings) => &settings.course,
            Self::Plane(settings) => &settings.course,
        }
    }

    fn estimate(self) -> &'a EstimateSettings {
        match self {
            Self::Space(settings) => &settings.estimate,
            Self::Plane(settings) => &settings.estimate,
        }
    }

    fn domain(self) -> Domain {
        match self {
            Self::Space(_) => Domain::Space,
            Self::Plane(_) => Domain::Plane,
        }
    }

    fn drawing(self) -> Option<&'a Drawing> {
        match self {
            Self::Space(_) => None,
            Self::Plane(settings) => Some(&settings.drawing),
        }
    }

    fn parts(self) -> Parts {
        let space = self.domain() == Domain::Space;
        Parts { vae: false, denoiser: false, control: space, control_2d: !space }
    }
}

pub(super) struct EstimateStage<'a> {
    pub(super) told: Told<'a>,
    pub(super) base: &'a Base,
    pub(super) motions: Vec<Motion>,
    pub(super) windows: Vec<Window>,
    pub(super) latents: Latents,
    pub(super) held_out: HeldOut,
    /// Which conditions are drawn, where a stage does not say it.
    pub(super) usual: ControlSettings,
    pub(super) schedule: NoiseSchedule,
}

impl EstimateStage<'_> {
    /// Runs it; weights begin as they are in the base, those on the picture as copies of those in space, at random where neither is there.
    pub(super) fn run(&self, place: &Place<'_>, progress: &mut OnStep<'_>) -> Result<Report, TrainError> {
        let first = match place.from {
            Some(path) => self.own_of(&read_weights(path)?.1),
            None => self.beginning(),
        };
        Ok(run(self, first, place, progress)?.0)
    }

    /// What weights have of this stage's networks; the rest, or what has another shape there, as a run begins.
    fn own_of(&self, weights: &Tensors) -> Tensors {
        let mut own = self.beginning();
        for name in own_names(&self.base.header.sizes, self.told.parts()) {
            let fits = |tensor: &&Tensor| own.get(&name).is_some_and(|own| own.shape() == tensor.shape());
            if let Some(tensor) = weights.get(&name).filter(fits).cloned() {
                own.insert(name, tensor);
            }
        }
        own
    }

    fn beginning(&self) -> Tensors {
        let sizes = &self.base.header.sizes;
        let mut own = random(sizes, self.told.parts(), self.told.course().seed);
        for name in own_names(sizes, self.told.parts()) {
            let of_space = name.replacen(".plane.", ".space.", 1);
            if let Some(tensor) = self.base.weights.get(&of_space) {
                own.insert(name, tensor.clone());
            }
        }
        own
    }

    fn mixture(&self) -> Mixture<'_> {
        match self.told {
            Told::Space(settings) => settings.mixture(),
            Told::Plane(_) => self.usual.mixture(),
        }
    }
}

impl<'a> Stage for EstimateStage<'a> {
    type Replica = EstimateLearner<'a>;
    /// How many samples, and the seed of what is drawn for them.
    type Work = (usize, u64);

    const PARTS: &'static [&'static str] =
        &["velocity", "estimate", "trajectory", "keypose", "estimated_trajectory", "estimated_keypose"];

    fn course(&self) -> Course {
        self.told.course().clone()
    }

    fn settings(&self) -> String {
        match self.told {
            Told::Space(settings) => serde_json::to_string(settings).unwrap_or_default(),
            Told::Plane(settings) => serde_json::to_string(settings).unwrap_or_default(),
        }
    }

    fn is_same(&self, settings: &str) -> bool {
        match self.told {
            Told::Space(own) => {
                serde_json::from_str::<ControlSettings>(settings).is_ok_and(|told| told == *own)
            }
            Told::Plane(own) => {
                serde_json::from_str::<AlignSettings>(settings).is_ok_and(|told| told == *own)
            }
        }
    }

    fn replica(&self) -> Result<EstimateLearner<'a>, TrainError> {
        let base = self.base;
        let own = self.told.course().for_learning(self.beginning());
        let stays = (&base.quick_vae, &base.quick);
        EstimateLearner::new(&base.header.sizes, &own, stays, self.told.domain(), &base.features)
            .map_err(network)
    }

    fn draw(&self, step: u64, replicas: usize) -> Vec<Self::Work> {
        works(self.told.course(), step, replicas)
    }

    fn gradient(
        &self,
        learner: &mut EstimateLearner<'a>,
        weights: Weights<'_>,
        (count, seed): Self::Work,
        _step: u64,
        gradient: &mut Vec<f32>,
    ) -> Result<Vec<f64>, TrainError> {
        let settings = self.told.estimate();
        let mut draw = Noise::new(seed);
        let drawer = Drawer { features: &self.base.features, places: &self.base.places };
        let (mut clean, mut texts) = (Vec::new(), Vec::new());
        let (mut samples, mut conditions) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for _ in 0..count {
            let window = self.latents.pick(&mut draw);
            self.latents.sample(window, &mut draw, &mut clean);
            let verb = self.latents.verb(window, self.usual.text_dropped, &mut draw);
            texts.extend_from_slice(self.base.verbs.row(verb));
            let window = self.windows.get(window).ok_or_else(|| lost("a window"))?;
            let drawn = drawer.draw(window, &self.motions, &self.mixture(), &mut draw)?;
            conditions.push(match self.told.drawing() {
                Some(drawing) => drawing.of(&drawn, &self.base.places, &mut draw)?,
                None => drawn.conditions.clone(),
            });
            samples.push(drawn);
        }
        let timesteps = timesteps(count, &mut draw);
        let mut noisy = clean.clone();
        let each = self.latents.each;
        let rolled = (settings.rolled * count as f64).round() as usize;
        let later = |&step: &usize| step + ((STEPS - step) as f64 * draw.uniform()) as usize;
        let rolled: Vec<usize> = timesteps.iter().take(rolled).map(later).collect();
        let noised = rolled.iter().chain(timesteps.iter().skip(rolled.len()));
        for (latent, &step) in noisy.chunks_exact_mut(each).zip(noised) {
            let more = 1.0 + (settings.perturbed * draw.uniform()).powi(2);
            let noise: Vec<f32> = draw.normals(each).iter().map(|x| x * more.sqrt() as f32).collect();
            self.schedule.add_noise(latent, &noise, step);
        }
        let asked: Vec<Asked<'_>> = samples
            .iter()
            .map(|drawn: &Drawn| Asked {
                frames: drawn.joints.len(),
                trajectory: &drawn.asked,
                keypose: drawn.frame,
            })
            .collect();
        let batch = EstimateBatch {
            clean: &clean,
            noisy: &noisy,
            timesteps: &timesteps,
            rolled: &rolled,
            texts: &texts,
            conditions: &conditions,
            asked: &asked,
        };
        let EstimateSettings { velocity, estimate, trajectory, keypose, estimated, .. } = *settings;
        let objective = EstimateObjective { velocity, estimate, trajectory, keypose, estimated };
        let dropout = (settings.dropout > 0.0).then_some((settings.dropout as f32, seed));
        let losses = learner.step(weights.now, &batch, &objective, dropout, gradient).map_err(network)?;
        let (predicted, estimated) = (losses.predicted, losses.estimated);
        Ok(vec![
            losses.total,
            losses.velocity,
            losses.estimate,
            predicted.trajectory,
            predicted.keypose,
            estimated.trajectory,
            estimated.keypose,
        ])
    }

    fn measure(&self, weights: &Tensors) -> Result<Vec<(&'static str, f64)>, TrainError> {
        measure(self.base, &merged(&self.base.weights, weights), &self.held_out)
    }

    fn write(&self, path: &Path, weights: &Tensors) -> Result<(), TrainError> {
        let all = merged(&self.base.weights, weights);
        // An estimator of pictures belongs to the correction that it was trained with.
        let stale = |name: &str| self.told.domain() == Domain::Space && name.starts_with("estimate.plane.");
        let kept = all.into_iter().filter(|(name, _)| !stale(name)).collect();
        write_weights(path, &kept, &self.base.header)
    }
}
