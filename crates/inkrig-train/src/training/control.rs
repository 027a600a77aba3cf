//! The third stage: control by trajectories and key poses in space, on a finished denoiser (stage A of the paper).

use super::conditions::{Drawer, Mixture};
use super::control_measure::{HeldOut, measure};
use super::course::{Course, Settings, broken, is_share, read_settings};
use super::denoiser::{timesteps, works};
use super::estimate::{EstimateSettings, EstimateStage, Told};
use super::latents::{Cut, Latents, Window, windows};
use super::motions::{self, Motion, Selection};
use super::run::{OnStep, Place, Report, run};
use super::stage::{Stage, Weights, network};
use super::weights_file::{merged, named, read_weights, write_weights};
use crate::TrainError;
use crate::corpus::{Manifest, Split};
use inkrig_generate::checkpoint::ModelHeader;
use inkrig_generate::guidance::View;
use inkrig_generate::learning::{ControlBatch, ControlLearner, ControlObjective, Wanted};
use inkrig_generate::networks::{ConditionRows, Domain, Parts, Sizes, Vae, tensors};
use inkrig_generate::schedule::{Noise, NoiseSchedule};
use inkrig_generate::text::VerbTable;
use inkrig_generate::weights::{Tensors, random};
use inkrig_motion::humanml::Statistics;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Joints that trajectories are drawn for: pelvis, feet, head, wrists.
const JOINTS_DRAWN: [usize; 6] = [0, 10, 11, 15, 20, 21];

/// The networks that this stage trains.
const SPACE: Parts = Parts { vae: false, denoiser: false, control: true, control_2d: false };

/// How control is trained.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ControlSettings {
    /// Steps, rates, measurements.
    pub course: Course,
    /// Share of numbers that are dropped in the networks that are trained.
    pub dropout: f64,
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
    /// Joints that trajectories are drawn for, 0 to 21.
    pub joints: Vec<usize>,
    /// Share of samples that lose their text.
    pub text_dropped: f64,
    /// Share of samples that lose their trajectory.
    pub trajectory_dropped: f64,
    /// Share of samples that lose their key pose. None loses both.
    pub keypose_dropped: f64,
    /// Share of trajectories that ask for the first or the last frames.
    pub contiguous: f64,
    /// Share of trajectories that ask for all frames; the rest ask for frames at random.
    pub all_frames: f64,
    /// Samples of a step whose joints are compared; 0 for none.
    pub decoded: usize,
    /// Weight of the noise's squared error.
    pub noise_weight: f64,
    /// Of trajectories' squared distance, in normalised units.
    pub trajectory_weight: f64,
    /// Of key poses'.
    pub keypose_weight: f64,
    /// Distances in samples with much noise count less: times this power of the share of signal. 0: all alike, as published.
    pub signal_power: f64,
    /// Held-out windows that are sampled at every measurement.
    pub measured: usize,
    /// Share of trajectories that are of any joints.
    pub any_joints: f64,
    /// Control by an estimate instead of ControlNet and adapter, where its width is not 0. Weights and dropout are its own then.
    pub estimate: EstimateSettings,
}

impl Default for ControlSettings {
    fn default() -> Self {
        Self {
            course: Course {
                steps: 12_000,
                batch: 256,
                rate: 1.5e-3,
                warm_up: 150,
                weight_decay: 0.01,
                average: 0.997,
                measure_every: 500,
                save_every: 250,
                ..Course::default()
            },
            dropout: 0.0,
            frames: 40,
            stride: 10,
            other_lengths: 0.1,
            shortest: 20,
            longest: 120,
            balance: 0.5,
            mirrored: true,
            retimed: 0.0,
            joints: JOINTS_DRAWN.to_vec(),
            text_dropped: 0.1,
            trajectory_dropped: 0.15,
            keypose_dropped: 0.15,
            contiguous: 0.4,
            all_frames: 0.3,
            decoded: 16,
            noise_weight: 1.0,
            trajectory_weight: 1.0,
            keypose_weight: 1.0,
            signal_power: 0.5,
            measured: 48,
            any_joints: 0.2,
            estimate: EstimateSettings::default(),
        }
    }
}

impl Settings for ControlSettings {
    fn check(&self) -> Result<(), String> {
        self.course.check()?;
        self.estimate.check()?;
        let weight = |value: f64| value >= 0.0 && value.is_finite();
        broken([
            ("dropout", (0.0..1.0).contains(&self.dropout), "from 0 to below 1".to_string()),
            ("frames", self.frames >= 2, "2 or more".into()),
            ("stride", self.stride > 0, "1 or more".into()),
            ("other_lengths", is_share(self.other_lengths), "0 to 1".into()),
            ("shortest", (2..=self.longest).contains(&self.shortest), "2 to longest".into()),
            ("balance", is_share(self.balance), "0 to 1".into()),
            ("retimed", is_share(self.retimed), "0 to 1".into()),
            (
                "joints",
                !self.joints.is_empty() && self.joints.iter().all(|&joint| joint < 22),
                "at least one, from 0 to 21".into(),
            ),
            ("text_dropped", is_share(self.text_dropped), "0 to 1".into()),
            ("trajectory_dropped", is_share(self.trajectory_dropped), "0 to 1".into()),
            ("keypose_dropped", is_share(self.keypose_dropped), "0 to 1".into()),
            ("contiguous", is_share(self.contiguous), "0 to 1".into()),
            ("all_frames", is_share(self.all_frames + self.contiguous), "at most 1 with contiguous".into()),
            ("decoded", self.decoded <= self.course.batch, "at most the batch".into()),
            ("noise_weight", weight(self.noise_weight), "0 or more".into()),
            ("trajectory_weight", weight(self.trajectory_weight), "0 or more".into()),
            ("keypose_weight", weight(self.keypose_weight), "0 or more".into()),
            ("signal_power", weight(self.signal_power), "0 or more".into()),
            ("any_joints", is_share(self.any_joints), "0 to 1".into()),
            ("measured", self.measured > 0, "1 or more".into()),
        ])
    }
}

impl ControlSettings {
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

    pub(super) fn mixture(&self) -> Mixture<'_> {
        let Self { any_joints, trajectory_dropped, keypose_dropped, contiguous, all_frames, .. } = *self;
        let joints = &self.joints;
        Mixture { joints, any_joints, trajectory_dropped, keypose_dropped, contiguous, all_frames }
    }
}

/// Trains control on the denoiser in `model`, or goes on with it. What it writes are whole models.
///
/// # Errors
/// When corpus, model or checkpoint cannot be read, the checkpoint is of other settings, a loss is no number, or nothing can be written.
pub fn train_control(
    place: &Place<'_>,
    model: &Path,
    settings: &ControlSettings,
    progress: &mut OnStep<'_>,
) -> Result<Report, TrainError> {
    settings.check().map_err(TrainError::Device)?;
    let mut base = Base::read(model, &settings.course)?;
    if !Parts::of(&base.weights).control {
        base.header.sizes.estimate = settings.estimate.width;
    }
    if base.header.sizes.trunk > 0 && base.header.sizes.estimate == 0 {
        let what = "its denoiser is of feed-forward blocks, which ControlNet and adapter cannot copy: set estimate.width above 0".into();
        return Err(TrainError::Content { path: model.into(), what });
    }
    let cut = settings.cut(&base.header.sizes)?;
    let manifest = Manifest::read(place.corpus)?;
    let read = |split, selection| motions::read(&manifest, split, &base.features, selection);
    let motions = read(Split::Train, settings.selection())?;
    let windows_of_train = windows(&motions, cut, settings.course.seed);
    let (held_out, view) = (read(Split::Val, Selection::PLAIN)?, View::Space);
    let held_out = HeldOut::new(&held_out, settings.frames, settings.measured, &base, view)?;
    let latents = Latents::encode(&base.vae, &motions, &windows_of_train, place.replicas.max(1))?;
    if base.header.sizes.estimate > 0 {
        let (told, usual, base) = (Told::Space(settings), settings.clone(), &base);
        let (windows, schedule) = (windows_of_train, NoiseSchedule::default());
        let stage = EstimateStage { told, base, motions, windows, latents, held_out, usual, schedule };
        return stage.run(place, progress);
    }
    let stage = ControlStage {
        latents,
        windows: windows_of_train,
        motions,
        held_out,
        schedule: NoiseSchedule::default(),
        settings,
        base: &base,
    };
    let first = match place.from {
        Some(path) => own_of(&base.header.sizes, &read_weights(path)?.1),
        None => stage.beginning(),
    };
    Ok(run(&stage, first, place, progress)?.0)
}

/// A model with a denoiser, which stays as it is.
pub(super) struct Base {
    pub header: ModelHeader,
    pub weights: Tensors,
    pub vae: Vae,
    /// The same for learning: perhaps in half precision.
    pub quick: Tensors,
    pub quick_vae: Vae,
    pub verbs: VerbTable,
    pub features: Statistics,
    pub places: Statistics,
}

impl Base {
    pub(super) fn read(path: &Path, course: &Course) -> Result<Self, TrainError> {
        let content = |what: String| TrainError::Content { path: path.into(), what };
        let (header, weights) = read_weights(path)?;
        let (features, places) = header.statistics().map_err(|error| content(error.to_string()))?;
        let of = |error: inkrig_generate::GenerateError| content(error.to_string());
        let quick = course.for_learning(weights.clone());
        Ok(Self {
            vae: Vae::new(&header.sizes, &weights).map_err(of)?,
            quick_vae: Vae::new(&header.sizes, &quick).map_err(of)?,
            quick,
            verbs: VerbTable::new(&weights, header.sizes.text_width).map_err(of)?,
            header,
            weights,
            features,
            places,
        })
    }
}

/// Names of the tensors of some networks that are read by them.
pub(super) fn own_names(sizes: &Sizes, parts: Parts) -> impl Iterator<Item = String> {
    tensors(sizes, parts).into_iter().filter(|spec| spec.used).map(|spec| spec.name)
}

fn own_of(sizes: &Sizes, weights: &Tensors) -> Tensors {
    let own = own_names(sizes, SPACE).filter_map(|name| Some((name.clone(), weights.get(&name)?.clone())));
    own.collect()
}

struct ControlStage<'a> {
    settings: &'a ControlSettings,
    base: &'a Base,
    motions: Vec<Motion>,
    windows: Vec<Window>,
    latents: Latents,
    held_out: HeldOut,
    schedule: NoiseSchedule,
}

impl ControlStage<'_> {
    /// Copies of the denoiser without effect: the layers behind their blocks are zero. So is the last of the condition's in the published
    /// code, but one of the two is enough, and with both nothing is learned at first.
    fn beginning(&self) -> Tensors {
        let sizes = &self.base.header.sizes;
        let mut own = own_of(sizes, &random(sizes, SPACE, self.settings.course.seed));
        for (name, tensor) in named(&self.base.weights, "denoiser.denoiser.") {
            let part = name.trim_start_matches("denoiser.denoiser.");
            for copy in [format!("controlnet.{part}"), format!("denoiser.{part}")] {
                if own.get(&copy).is_some() {
                    own.insert(copy, tensor.clone());
                }
            }
        }
        let layer = |at: usize| format!("controlnet.controlnet_cond_embedding.{at}.weight");
        if let Some(tensor) = own.get(&layer(1)).cloned() {
            own.insert(layer(2), tensor);
        }
        own
    }
}

impl<'a> Stage for ControlStage<'a> {
    type Replica = ControlLearner<'a>;
    /// How many samples, and the seed of what is drawn for them.
    type Work = (usize, u64);

    const PARTS: &'static [&'static str] = &["noise", "trajectory", "keypose"];

    fn course(&self) -> Course {
        self.settings.course.clone()
    }

    fn settings(&self) -> String {
        serde_json::to_string(self.settings).unwrap_or_default()
    }

    fn is_same(&self, settings: &str) -> bool {
        serde_json::from_str::<ControlSettings>(settings).is_ok_and(|settings| settings == *self.settings)
    }

    fn replica(&self) -> Result<ControlLearner<'a>, TrainError> {
        let (base, course) = (self.base, &self.settings.course);
        let parts = (&base.quick_vae, &base.quick);
        let own = course.for_learning(self.beginning());
        let sizes = &base.header.sizes;
        ControlLearner::new(sizes, &own, parts, Domain::Space, &base.features, &base.places).map_err(network)
    }

    fn draw(&self, step: u64, replicas: usize) -> Vec<Self::Work> {
        works(&self.settings.course, step, replicas)
    }

    fn gradient(
        &self,
        learner: &mut ControlLearner<'a>,
        weights: Weights<'_>,
        (count, seed): Self::Work,
        _step: u64,
        gradient: &mut Vec<f32>,
    ) -> Result<Vec<f64>, TrainError> {
        let settings = self.settings;
        let mut draw = Noise::new(seed);
        let drawer = Drawer { features: &self.base.features, places: &self.base.places };
        let (mut noisy, mut texts, mut drawn) = (Vec::new(), Vec::new(), Vec::with_capacity(count));
        for _ in 0..count {
            let window = self.latents.pick(&mut draw);
            self.latents.sample(window, &mut draw, &mut noisy);
            let verb = self.latents.verb(window, settings.text_dropped, &mut draw);
            texts.extend_from_slice(self.base.verbs.row(verb));
            let window = self.windows.get(window).ok_or_else(|| lost("a window"))?;
            drawn.push(drawer.draw(window, &self.motions, &settings.mixture(), &mut draw)?);
        }
        let noise = draw.normals(noisy.len());
        let timesteps = timesteps(count, &mut draw);
        let each = self.latents.each;
        let rows = noisy.chunks_exact_mut(each).zip(noise.chunks_exact(each));
        rows.zip(&timesteps)
            .for_each(|((latent, noise), &step)| self.schedule.add_noise(latent, noise, step));
        let share = (settings.decoded * count).div_ceil(settings.course.batch.max(1));
        let wanted: Vec<Wanted<'_>> = drawn
            .iter()
            .enumerate()
            .take(share)
            .map(|(sample, drawn)| Wanted {
                sample,
                places: &drawn.places,
                trajectory: &drawn.asked,
                keypose: drawn.frame,
            })
            .collect();
        let trajectories: Vec<ConditionRows> = drawn.iter().map(|drawn| drawn.trajectory.clone()).collect();
        let keyposes: Vec<ConditionRows> = drawn.iter().map(|drawn| drawn.keypose.clone()).collect();
        let batch = ControlBatch {
            noisy: &noisy,
            noise: &noise,
            timesteps: &timesteps,
            texts: &texts,
            trajectories: &trajectories,
            keyposes: &keyposes,
            wanted: &wanted,
        };
        let objective = ControlObjective {
            noise: settings.noise_weight,
            trajectory: settings.trajectory_weight,
            keypose: settings.keypose_weight,
            signal_power: settings.signal_power,
        };
        let dropout = Some((settings.dropout as f32, seed));
        let losses = learner.step(weights.now, &batch, &objective, dropout, gradient).map_err(network)?;
        Ok(vec![losses.total, losses.noise, losses.trajectory, losses.keypose])
    }

    fn measure(&self, weights: &Tensors) -> Result<Vec<(&'static str, f64)>, TrainError> {
        measure(self.base, &merged(&self.base.weights, weights), &self.held_out)
    }

    fn write(&self, path: &Path, weights: &Tensors) -> Result<(), TrainError> {
        write_weights(path, &merged(&self.base.weights, weights), &self.base.header)
    }
}

/// For what cannot be missing.
pub(super) fn lost(what: &str) -> TrainError {
    TrainError::Device(format!("{what} went missing"))
}
