//! Guidance: at a denoising step, the predicted noise (or the latent) is moved until the clip that it stands for meets
//! its target (Eq. 15).

use super::lbfgs::{Lbfgs, LbfgsOptions, Objective};
use super::places::Places;
use super::settle::{SettleOptions, misses_pose, slides, strays, way};
use super::target::{Mean, Target};
use crate::GenerateError;
use crate::networks::{Decoding, Vae};
use inkrig_motion::humanml::{Joints, Statistics};
use rayon::prelude::*;

/// How guidance is done.
#[derive(Debug, Clone, PartialEq)]
pub struct GuidanceOptions {
    /// What is moved.
    pub variable: Variable,
    /// How it is moved.
    pub method: Method,
    /// What squared distances are divided by.
    pub mean: Mean,
    /// Whether it reckons with the noise of the step before, as the published code does.
    pub step_early: bool,
}

impl GuidanceOptions {
    /// The step of training that a latent's noise is taken to be of.
    pub fn reckoned_step(&self, timestep: usize) -> usize {
        timestep.saturating_sub(usize::from(self.step_early))
    }
}

/// What guidance moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variable {
    /// The predicted noise, as in the published code.
    Noise,
    /// The noisy latent, the predicted noise staying as it is, as in the paper.
    Latent,
}

/// How guidance moves it.
#[derive(Debug, Clone, PartialEq)]
pub enum Method {
    /// By L-BFGS, so many times in a row at steps above the middle of the schedule, and below.
    SecondOrder {
        /// Limits of each time.
        options: LbfgsOptions,
        /// Times at steps after 500 of the 1000, where noise is most.
        early: usize,
        /// Times at later steps.
        late: usize,
    },
    /// By steps along the gradient of the sum of distances, for comparison.
    FirstOrder {
        /// Steps.
        steps: usize,
        /// Length of a step, divided by the number of frames asked for.
        rate: f64,
        /// Whether the first number of every latent token stays as it is, as in the published code.
        spare_first: bool,
    },
}

impl Default for GuidanceOptions {
    /// As published.
    fn default() -> Self {
        let method = Method::SecondOrder { options: LbfgsOptions::default(), early: 1, late: 2 };
        Self { variable: Variable::Noise, method, mean: Mean::AllEntries, step_early: true }
    }
}

/// What guidance came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Guided {
    /// Mean of squared distances before, square metres.
    pub before: f64,
    /// And after.
    pub after: f64,
    /// Decodings with their gradient that it took.
    pub evaluations: usize,
}

/// A clip that shall meet a target.
#[derive(Debug, Clone, Copy)]
pub struct GuidedClip<'a> {
    /// What it shall meet.
    pub target: &'a Target,
    /// Frames that it is decoded to.
    pub frames: usize,
}

/// Decodes clips and says how far they are from their targets. Clips run on several threads; each is computed as if it
/// were alone.
#[derive(Debug)]
pub struct Guide<'a> {
    vae: &'a Vae,
    statistics: &'a Statistics,
    clips: Vec<(GuidedClip<'a>, ClipWork)>,
}

#[derive(Debug, Default)]
struct ClipWork {
    decoding: Decoding,
    places: Places,
    of_joints: Vec<f64>,
    of_features: Vec<f32>,
    sum: f64,
    /// A key pose, which settling holds.
    pose: Option<(usize, Joints)>,
    /// Where the pelvis was before settling, if that is held.
    way: Option<Vec<[f64; 2]>>,
}

/// From the noise in a latent to what the latent would be without: `clean = (latent - add * noise) / keep`.
#[derive(Debug, Clone, Copy)]
struct Mixture {
    keep: f32,
    add: f32,
}

impl<'a> Guide<'a> {
    /// For clips whose latents follow one another. `statistics` are those of the features.
    pub fn new(vae: &'a Vae, statistics: &'a Statistics, clips: &[GuidedClip<'a>]) -> Self {
        let clips = clips.iter().map(|clip| (*clip, ClipWork::default())).collect();
        Self { vae, statistics, clips }
    }

    /// The loss of clean latents, and its gradient: squared distances by `mean`.
    ///
    /// # Errors
    /// When the numbers of clips and latents differ, or a clip is too long.
    pub fn loss(&mut self, clean: &[f32], mean: Mean, gradient: &mut [f32]) -> Result<f64, GenerateError> {
        let entries = self.entries(mean);
        Ok(self.distance(clean, true, 1.0 / entries, gradient)? / entries)
    }

    /// Moves noise or latents at a step whose signal's power is `alpha`. `early` says which of a method's two limits
    /// holds.
    ///
    /// # Errors
    /// When the numbers of clips and latents differ, or a clip is too long.
    pub fn run(
        &mut self,
        latents: &mut [f32],
        noise: &mut [f32],
        alpha: f32,
        early: bool,
        options: &GuidanceOptions,
    ) -> Result<Guided, GenerateError> {
        let mixture = Mixture { keep: alpha.sqrt(), add: (1.0 - alpha).sqrt() };
        let (moved, fixed): (&mut [f32], &[f32]) = match options.variable {
            Variable::Noise => (noise, latents),
            Variable::Latent => (latents, noise),
        };
        let mut step = GuidedStep {
            guide: self,
            fixed,
            variable: options.variable,
            mixture,
            mean: options.mean,
            clean: vec![0.0; fixed.len()],
            first: None,
        };
        match &options.method {
            Method::SecondOrder { options, early: often, late } => {
                let mut optimiser = Lbfgs::new(options.clone());
                let mut after = None;
                for _ in 0..if early { *often } else { *late } {
                    after = Some(optimiser.minimise(moved, &mut step)?);
                }
                let before = step.first.unwrap_or(0.0);
                let after = after.unwrap_or(before);
                Ok(Guided { before, after, evaluations: optimiser.evaluations() })
            }
            Method::FirstOrder { steps, rate, spare_first } => {
                step.descend(moved, *steps, *rate, *spare_first)
            }
        }
    }

    /// How many clips there are.
    pub(super) fn count(&self) -> usize {
        self.clips.len()
    }

    /// Says which key poses settling holds, one for each clip; the pelvis may be anywhere over the ground.
    pub(super) fn hold(&mut self, poses: &[Option<&(usize, Joints)>]) {
        let each = self.clips.iter_mut().zip(poses);
        each.for_each(|((_, work), pose)| work.pose = pose.copied());
    }

    /// Settling begins anew.
    pub(super) fn forget_ways(&mut self) {
        self.clips.iter_mut().for_each(|(_, work)| work.way = None);
    }

    /// The gradient of what settling lessens: sliding, and distances from what is asked for.
    pub(super) fn settling(
        &mut self,
        clean: &[f32],
        options: &SettleOptions,
        gradient: &mut [f32],
    ) -> Result<(), GenerateError> {
        self.each(clean, gradient, |work, clip, latent, gradient, (vae, statistics)| {
            let asked = clip.target.entries(clip.frames, Mean::Asked).max(1);
            let weight = options.asked / asked as f64;
            work.places(vae, statistics, clip, latent)?;
            work.sum = clip.target.distance(&work.places.joints, false, weight, &mut work.of_joints);
            slides(&work.places.joints, options.slides, &mut work.of_joints);
            if clip.target.asks.is_empty() && work.pose.is_none() {
                let own = work.way.get_or_insert_with(|| way(&work.places.joints));
                strays(&work.places.joints, own, options.way, &mut work.of_joints);
            }
            if let Some(pose) = &work.pose {
                let (joints, view) = (&work.places.joints, clip.target.view);
                misses_pose(joints, view, pose, options.keypose, &mut work.of_joints);
            }
            work.back(vae, statistics, gradient)
        })
    }

    /// Square distances of all clips, and how many decodings and gradients.
    fn entries(&self, mean: Mean) -> f64 {
        let each = self.clips.iter().map(|(clip, _)| clip.target.entries(clip.frames, mean));
        each.sum::<usize>().max(1) as f64
    }

    /// The sum of distances; the gradient of it, times `weight`.
    fn distance(
        &mut self,
        clean: &[f32],
        squared: bool,
        weight: f64,
        gradient: &mut [f32],
    ) -> Result<f64, GenerateError> {
        self.each(clean, gradient, |work, clip, latent, gradient, (vae, statistics)| {
            work.places(vae, statistics, clip, latent)?;
            work.sum = clip.target.distance(&work.places.joints, squared, weight, &mut work.of_joints);
            work.back(vae, statistics, gradient)
        })?;
        Ok(self.clips.iter().map(|(_, work)| work.sum).sum())
    }

    /// Does something with every clip, its latent and its gradient, on several threads.
    fn each(
        &mut self,
        clean: &[f32],
        gradient: &mut [f32],
        what: impl Fn(
            &mut ClipWork,
            &GuidedClip<'_>,
            &[f32],
            &mut [f32],
            (&Vae, &Statistics),
        ) -> Result<(), GenerateError>
        + Sync,
    ) -> Result<(), GenerateError> {
        let each = self.vae.latent_width();
        let expected = self.clips.len() * each;
        if clean.len() != expected || gradient.len() != expected {
            let what = "latents of guided clips";
            return Err(GenerateError::Length { what, expected, got: clean.len().min(gradient.len()) });
        }
        let with = (self.vae, self.statistics);
        let latents = clean.par_chunks_exact(each).zip(gradient.par_chunks_exact_mut(each));
        self.clips
            .par_iter_mut()
            .zip(latents)
            .try_for_each(|((clip, work), (latent, gradient))| what(work, clip, latent, gradient, with))
    }
}

impl ClipWork {
    /// Where the joints of a latent are.
    fn places(
        &mut self,
        vae: &Vae,
        statistics: &Statistics,
        clip: &GuidedClip<'_>,
        latent: &[f32],
    ) -> Result<(), GenerateError> {
        vae.decode(latent, &[clip.frames], &mut self.decoding)?;
        self.places.recover(self.decoding.features(), statistics)
    }

    /// From the gradient of the joints to that of the latent.
    fn back(
        &mut self,
        vae: &Vae,
        statistics: &Statistics,
        gradient: &mut [f32],
    ) -> Result<(), GenerateError> {
        self.places.gradient(&self.of_joints, statistics, &mut self.of_features);
        gradient.copy_from_slice(vae.gradient(&self.of_features, &mut self.decoding)?);
        Ok(())
    }
}

struct GuidedStep<'g, 'a> {
    guide: &'g mut Guide<'a>,
    fixed: &'g [f32],
    variable: Variable,
    mixture: Mixture,
    mean: Mean,
    clean: Vec<f32>,
    first: Option<f64>,
}

impl GuidedStep<'_, '_> {
    /// What the variable stands for, into `clean`; gives how that changes with it.
    fn clean(&mut self, x: &[f32]) -> f32 {
        let Mixture { keep, add } = self.mixture;
        for (clean, (x, fixed)) in self.clean.iter_mut().zip(x.iter().zip(self.fixed)) {
            let (latent, noise) = match self.variable {
                Variable::Noise => (fixed, x),
                Variable::Latent => (x, fixed),
            };
            *clean = (latent - add * noise) / keep;
        }
        match self.variable {
            Variable::Noise => -add / keep,
            Variable::Latent => 1.0 / keep,
        }
    }

    fn descend(
        &mut self,
        x: &mut [f32],
        steps: usize,
        rate: f64,
        spare_first: bool,
    ) -> Result<Guided, GenerateError> {
        let mut gradient = vec![0.0; x.len()];
        let before = self.evaluate(x, &mut gradient)?;
        let each = self.guide.vae.latent_width();
        let rates: Vec<f64> = (self.guide.clips.iter())
            .map(|(clip, _)| rate / clip.target.densest(clip.frames).max(1) as f64)
            .collect();
        for _ in 0..steps {
            let factor = self.clean(x);
            self.guide.distance(&self.clean, false, f64::from(factor), &mut gradient)?;
            if spare_first {
                gradient.iter_mut().step_by(self.guide.vae.sizes().width).for_each(|first| *first = 0.0);
            }
            let clips = x.chunks_exact_mut(each).zip(gradient.chunks_exact(each));
            for (rate, (x, gradient)) in rates.iter().zip(clips) {
                for (x, gradient) in x.iter_mut().zip(gradient) {
                    *x -= (rate * f64::from(*gradient)) as f32;
                }
            }
        }
        let after = self.evaluate(x, &mut gradient)?;
        Ok(Guided { before, after, evaluations: steps + 2 })
    }
}

impl Objective for GuidedStep<'_, '_> {
    type Error = GenerateError;

    fn evaluate(&mut self, x: &[f32], gradient: &mut [f32]) -> Result<f64, GenerateError> {
        let factor = self.clean(x);
        let value = self.guide.loss(&self.clean, self.mean, gradient)?;
        gradient.iter_mut().for_each(|gradient| *gradient *= factor);
        self.first.get_or_insert(value);
        Ok(value)
    }
}

#[cfg(test)]
mod tests {
    use super::super::target::{Ask, View};
    use super::*;
    use crate::networks::{Parts, Sizes};
    use crate::schedule::Noise;
    use crate::weights::hashed;
    use inkrig_motion::glam::Vec3;
    use inkrig_motion::humanml::{Camera, WIDTH};

    #[test]
    fn every_variant_brings_clips_nearer_to_their_targets() {
        let sizes = Sizes::tiny();
        let vae = Vae::new(&sizes, &hashed(&sizes, Parts::VAE)).unwrap();
        let statistics = Statistics::new(vec![0.0; WIDTH], vec![0.05; WIDTH]).unwrap();
        let asks =
            (0..9).map(|frame| Ask { frame, joint: 10, place: Vec3::new(0.1, 0.2, 0.1 * frame as f32) });
        let asks: Vec<Ask> = asks.collect();
        let second = Method::SecondOrder { options: LbfgsOptions::default(), early: 1, late: 2 };
        let first = |spare_first| Method::FirstOrder { steps: 10, rate: 1.0, spare_first };
        for view in [View::Space, View::Plane(Camera::default())] {
            let target = Target { view, asks: asks.clone(), depths: Vec::new() };
            let clips =
                [GuidedClip { target: &target, frames: 8 }, GuidedClip { target: &target, frames: 12 }];
            for (variable, method, mean) in [
                (Variable::Noise, second.clone(), Mean::AllEntries),
                (Variable::Latent, second.clone(), Mean::Asked),
                (Variable::Noise, first(false), Mean::Asked),
                (Variable::Noise, first(true), Mean::Asked),
            ] {
                let (latents, noise) =
                    (Noise::new(1).normals(2 * sizes.width), Noise::new(2).normals(2 * sizes.width));
                let mut guide = Guide::new(&vae, &statistics, &clips);
                let options = GuidanceOptions { variable, method: method.clone(), mean, step_early: false };
                let (mut moved_latents, mut moved_noise) = (latents.clone(), noise.clone());
                let done = guide.run(&mut moved_latents, &mut moved_noise, 0.4, false, &options).unwrap();
                assert!(done.after < 0.8 * done.before, "{options:?}: {done:?}");
                assert_eq!(moved_latents == latents, variable == Variable::Noise);
                assert_eq!(moved_noise == noise, variable == Variable::Latent);
                let spared = matches!(method, Method::FirstOrder { spare_first: true, .. });
                let firsts = moved_noise.iter().zip(&noise).step_by(sizes.width);
                assert!(!spared || firsts.clone().all(|(moved, before)| moved == before));
            }
        }
    }

    #[test]
    fn settled_latents_slide_less_and_stay_near_what_is_asked_for() {
        let sizes = Sizes::tiny();
        let vae = Vae::new(&sizes, &hashed(&sizes, Parts::VAE)).unwrap();
        let statistics = Statistics::new(vec![0.0; WIDTH], vec![0.05; WIDTH]).unwrap();
        let ask = |frame| Ask { frame, joint: 15, place: Vec3::new(0.1, 0.1, 0.05) };
        let target = Target { view: View::Space, asks: (0..12).map(ask).collect(), depths: Vec::new() };
        let clips = [GuidedClip { target: &target, frames: 12 }];
        let mut guide = Guide::new(&vae, &statistics, &clips);
        let before = Noise::new(1).normals(sizes.width);
        let mut measure = |latents: &[f32]| {
            let asked = guide.loss(latents, Mean::Asked, &mut vec![0.0; latents.len()]).unwrap();
            let joints = guide.clips[0].1.places.joints.clone();
            (slides(&joints, 0.0, &mut vec![0.0; joints.len()]), asked)
        };
        let (slid, missed) = measure(&before);
        let mut guide = Guide::new(&vae, &statistics, &clips);
        let (mut settled, mut still) = (before.clone(), before.clone());
        guide.settle(&mut settled, &[None], &SettleOptions::default()).unwrap();
        guide.settle(&mut still, &[], &SettleOptions { steps: 0, ..SettleOptions::default() }).unwrap();
        let after = measure(&settled);
        assert!(slid > 0.2 && after.0 < 0.5 * slid && after.1 < missed, "{slid} {missed} {after:?}");
        assert_eq!(still, before);
        assert!(guide.settle(&mut [0.0; 15], &[], &SettleOptions::default()).is_err());
    }

    #[test]
    fn latents_that_do_not_fit_are_refused() {
        let sizes = Sizes::tiny();
        let vae = Vae::new(&sizes, &hashed(&sizes, Parts::VAE)).unwrap();
        let statistics = Statistics::new(vec![0.0; WIDTH], vec![1.0; WIDTH]).unwrap();
        let target = Target { view: View::Space, asks: Vec::new(), depths: Vec::new() };
        let mut guide = Guide::new(&vae, &statistics, &[GuidedClip { target: &target, frames: 8 }]);
        assert!(guide.loss(&[0.0; 15], Mean::Asked, &mut [0.0; 15]).is_err());
        assert_eq!(guide.loss(&[0.0; 16], Mean::Asked, &mut [0.0; 16]).unwrap(), 0.0);
    }
}
