//! Control by an estimate: what the conditions alone say of the latent, and a correction of every prediction by it.
//!
//! Not in the papers. Their ControlNet and adapter tell the denoiser's copies of one vector for all that is asked; with an hour of motion
//! and minutes of training such control moved nothing (docs/training.md has the figures). Here an [`Estimator`] says at once which
//! latent is to be expected (a regression), and a [`Correction`] weighs that against what the denoiser makes of the noisy latent, which
//! knows the word and what conditions leave open. The denoiser stays as it is.

use super::conditions::Domain;
use super::embedding::timestep_waves;
use super::linear::Linear;
use super::names::POSE;
use super::sizes::Sizes;
use super::trunk::{Trunk, TrunkTape};
use crate::GenerateError;
use crate::schedule::NoiseSchedule;
use crate::weights::Tensors;
use inkrig_motion::humanml::JOINTS;
use std::f64::consts::PI;

/// Times at which trajectories are told, evenly over a clip of any length.
const SLOTS: usize = 40;
/// Numbers of a slot: where each joint shall be, and whether that is asked.
const SLOT: usize = 4 * JOINTS;
/// Cosines that say when the key pose is.
const COSINES: usize = 32;
/// Key poses are told relative to the root, where deviations of places in space are too large a measure.
const POSE_SCALE: f32 = 3.0;
/// Frames of a clip of usual length.
const USUAL: f32 = 40.0;
/// Numbers that say the timestep.
pub(super) const WAVES: usize = 128;
/// Numbers that conditions are told by: slots; the key pose, when it is, whether there is one; the clip's length.
pub(super) const TOLD: usize = SLOTS * SLOT + POSE + COSINES + 2;

/// What conditions say of latents.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Estimate {
    /// Which latents are to be expected, samples x latent tokens x width.
    pub latents: Vec<f32>,
    /// What else is known, samples x the estimator's width.
    pub(crate) hidden: Vec<f32>,
}

impl Estimate {
    /// Of the first samples of so many.
    pub(crate) fn first(&self, samples: usize, of: usize) -> Self {
        let part = |row: &[f32]| row.iter().take(row.len() / of.max(1) * samples).copied().collect();
        Self { latents: part(&self.latents), hidden: part(&self.hidden) }
    }
}

/// What a clip of so many frames is asked for, as an [`Estimator`] takes it. Frames of 66 normalised numbers each, zeros where a joint is
/// not asked for.
pub fn told(
    frames: usize,
    trajectory: &[(usize, Vec<f32>)],
    keypose: Option<&(usize, Vec<f32>)>,
) -> Vec<f32> {
    let frames = frames.max(1);
    let mut told = vec![0.0; TOLD];
    let (slots, rest) = told.split_at_mut(SLOTS * SLOT);
    for (frame, row) in trajectory.iter().filter(|(frame, _)| *frame < frames) {
        let first = frame * SLOTS / frames;
        let end = ((frame + 1) * SLOTS).div_ceil(frames).max(first + 1);
        for slot in slots.chunks_exact_mut(SLOT).take(end).skip(first) {
            for (joint, place) in slot.chunks_exact_mut(4).zip(row.chunks_exact(3)) {
                if place.iter().any(|number| *number != 0.0) {
                    joint.iter_mut().zip(place).for_each(|(sum, number)| *sum += number);
                    joint[3] += 1.0;
                }
            }
        }
    }
    // More than one frame of a slot: their mean.
    for joint in slots.chunks_exact_mut(4).filter(|joint| joint[3] > 1.0) {
        let count = joint[3];
        joint.iter_mut().for_each(|number| *number /= count);
    }
    let (pose, rest) = rest.split_at_mut(POSE);
    let (when, last) = rest.split_at_mut(COSINES);
    if let Some((frame, row)) = keypose {
        pose.iter_mut().zip(row).for_each(|(pose, number)| *pose = POSE_SCALE * number);
        let time = PI * (*frame as f64 + 0.5) / frames as f64;
        when.iter_mut().enumerate().for_each(|(wave, when)| *when = (wave as f64 * time).cos() as f32);
        last[0] = 1.0;
    }
    last[1] = (frames as f32 / USUAL).ln();
    told
}

/// From conditions to the latent that is to be expected.
#[derive(Debug, Clone)]
pub struct Estimator {
    pub(super) trunk: Trunk,
    pub(super) latent: Linear,
}

impl Estimator {
    /// Takes the weights that are named `estimate.space.*` or `estimate.plane.*`.
    ///
    /// # Errors
    /// When the sizes cannot be, or a weight is missing or of another shape.
    pub fn new(sizes: &Sizes, weights: &Tensors, domain: Domain) -> Result<Self, GenerateError> {
        sizes.check()?;
        let name = if domain == Domain::Space { "estimate.space" } else { "estimate.plane" };
        let latent = sizes.latent_tokens * sizes.width;
        Ok(Self {
            trunk: Trunk::new(weights, name, TOLD, sizes.estimate)?,
            latent: Linear::new(weights, &format!("{name}.latent"), latent, sizes.estimate)?,
        })
    }

    /// Of samples' conditions, one row of [`told`] for each.
    pub fn estimate(&self, told: Vec<f32>) -> Estimate {
        let hidden = self.trunk.forward(told, &mut TrunkTape::default());
        Estimate { latents: self.latent.apply(&hidden), hidden }
    }
}

/// Weighs what is estimated against what the denoiser says.
#[derive(Debug, Clone)]
pub struct Correction {
    pub(super) trunk: Trunk,
    pub(super) latent: Linear,
    pub(super) gate: Linear,
    pub(super) width: usize,
    pub(super) schedule: NoiseSchedule,
}

impl Correction {
    /// Takes the weights that are named `estimate.correction.*`.
    ///
    /// # Errors
    /// When the sizes cannot be, or a weight is missing or of another shape.
    pub fn new(sizes: &Sizes, weights: &Tensors) -> Result<Self, GenerateError> {
        sizes.check()?;
        let (name, width) = ("estimate.correction", sizes.latent_tokens * sizes.width);
        let linear = |leaf: &str, inputs| Linear::new(weights, &format!("{name}.{leaf}"), width, inputs);
        Ok(Self {
            trunk: Trunk::new(weights, name, Self::inputs(sizes), sizes.estimate)?,
            latent: linear("latent", sizes.estimate)?,
            gate: linear("gate", sizes.estimate + WAVES)?,
            width,
            schedule: NoiseSchedule::default(),
        })
    }

    /// Noisy latent, clean one as the denoiser sees it, estimate, what else is known, timestep.
    pub(super) fn inputs(sizes: &Sizes) -> usize {
        3 * sizes.latent_tokens * sizes.width + sizes.estimate + WAVES
    }

    /// Corrects the noise that the denoiser predicts in latents of one timestep.
    ///
    /// # Errors
    /// When the numbers of noise, latents and estimates do not fit each other.
    pub fn correct(
        &self,
        noise: &mut [f32],
        noisy: &[f32],
        timestep: usize,
        estimate: &Estimate,
    ) -> Result<(), GenerateError> {
        for (what, got) in [("latents", noisy.len()), ("estimated latents", estimate.latents.len())] {
            if got != noise.len() {
                return Err(GenerateError::Length { what, expected: noise.len(), got });
            }
        }
        let alpha = self.schedule.alpha(timestep);
        let mut clean = vec![0.0; noise.len()];
        self.schedule.clean(noisy, noise, timestep, &mut clean);
        let timesteps = vec![timestep; noise.len() / self.width.max(1)];
        let velocity = self.velocity(noisy, &clean, &timesteps, estimate, &mut CorrectionTape::default());
        noise.iter_mut().zip(velocity).for_each(|(noise, velocity)| *noise -= alpha.sqrt() * velocity);
        Ok(())
    }

    /// What is to be taken from the velocity: the estimate's share of its distance from the denoiser's clean latent, and what the blocks
    /// add. All of it is a velocity, so that it does nothing where no noise is left.
    pub(super) fn velocity(
        &self,
        noisy: &[f32],
        clean: &[f32],
        timesteps: &[usize],
        estimate: &Estimate,
        tape: &mut CorrectionTape,
    ) -> Vec<f32> {
        let known = estimate.hidden.len() / timesteps.len().max(1);
        let mut input = Vec::with_capacity(timesteps.len() * (3 * self.width + known + WAVES));
        tape.weighed.clear();
        for (sample, &timestep) in timesteps.iter().enumerate() {
            let own = sample * self.width..(sample + 1) * self.width;
            let waves = timestep_waves(timestep, WAVES);
            let hidden = &estimate.hidden[sample * known..(sample + 1) * known];
            for part in [&noisy[own.clone()], &clean[own.clone()], &estimate.latents[own], hidden, &waves] {
                input.extend_from_slice(part);
            }
            tape.weighed.extend_from_slice(hidden);
            tape.weighed.extend_from_slice(&waves);
        }
        tape.hidden = self.trunk.forward(input, &mut tape.trunk);
        let mut velocity = self.latent.apply(&tape.hidden);
        tape.shares = self.gate.apply(&tape.weighed);
        tape.shares.iter_mut().for_each(|share| *share = 1.0 / (1.0 + (-*share).exp()));
        tape.apart.clear();
        tape.apart.extend(estimate.latents.iter().zip(clean).map(|(estimate, clean)| estimate - clean));
        let weighed = tape.shares.iter().zip(&tape.apart);
        velocity.iter_mut().zip(weighed).for_each(|(velocity, (share, apart))| *velocity += share * apart);
        velocity
    }
}

/// What the way back needs of a correction.
#[derive(Debug, Clone, Default)]
pub(crate) struct CorrectionTape {
    pub(super) trunk: TrunkTape,
    pub(super) hidden: Vec<f32>,
    /// What went into the gate.
    pub(super) weighed: Vec<f32>,
    pub(super) shares: Vec<f32>,
    pub(super) apart: Vec<f32>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(numbers: &[(usize, f32)]) -> Vec<f32> {
        let mut row = vec![0.0; POSE];
        numbers.iter().for_each(|&(at, number)| row[at] = number);
        row
    }

    #[test]
    fn clips_of_any_length_are_told_in_the_same_slots() {
        let asked = |frames: usize| -> Vec<(usize, Vec<f32>)> {
            (0..frames).map(|frame| (frame, row(&[(30, 1.0), (31, frame as f32 / frames as f32)]))).collect()
        };
        let joint = |told: &[f32], slot: usize| told[slot * SLOT + 40..][..4].to_vec();
        let usual = told(40, &asked(40), None);
        for frames in [20, 40, 100, 120] {
            let told = told(frames, &asked(frames), None);
            for slot in 0..SLOTS {
                let (own, other) = (joint(&told, slot), joint(&usual, slot));
                assert_eq!((own[0], own[3]), (1.0, 1.0));
                assert!((own[1] - other[1]).abs() < 0.03, "{frames} {slot} {own:?} {other:?}");
            }
            assert_eq!(told[TOLD - 1], (frames as f32 / 40.0).ln());
        }
        // One frame of many touches one slot, and joints that nobody asks for stay empty.
        let one = told(120, &[(60, row(&[(30, 1.0)]))], None);
        assert_eq!(one[..SLOTS * SLOT].iter().filter(|x| **x != 0.0).count(), 2);
        assert_eq!(told(40, &[(40, row(&[(30, 1.0)]))], None), told(40, &[], None));
    }

    #[test]
    fn a_key_pose_and_its_time_are_told_apart() {
        let pose = row(&[(5, 0.5)]);
        let at = |frame| told(40, &[], Some(&(frame, pose.clone())));
        assert_ne!(at(3), at(4));
        assert_eq!(at(3)[SLOTS * SLOT + 5], 1.5);
        assert_eq!((at(3)[TOLD - 2], told(40, &[], None)[TOLD - 2]), (1.0, 0.0));
    }
}
