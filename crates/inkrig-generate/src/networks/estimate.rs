//! Control by an estimate: what the conditions alone say of the latent, and a correction of every prediction by it.
//!
//! Not in the papers. Their ControlNet and adapter tell the denoiser's copies of one vector for all that is asked; with an hour of motion
//! and minutes of training such control moved nothing (docs/training.md has the figures). Here an [`Estimator`] says at once which
//! latent is to be expected (a regression), and a [`Correction`] weighs that against what the denoiser makes of the noisy latent, which
//! knows the word and what conditions leave open. Then it is told where the motion still misses what is asked for, and moves it there: a
//! step of guidance that is learned instead of searched for. The denoiser stays as it is.

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
/// Times at which misses are told: motion is smoother than trajectories may be.
const MISS_SLOTS: usize = 20;
/// A miss of so many metres counts as one, and none for more than [`MOST`] times that.
const MISS: f32 = 0.25;
const MOST: f32 = 4.0;
/// Corrections of a prediction in training, and in sampling as long as there is noise: the second is told what the first still misses.
pub(crate) const CORRECTIONS: usize = 2;
/// Corrections in sampling where hardly any noise is left, below timestep [`LITTLE_NOISE`] of 1000, when nothing settles the motion
/// afterwards: what is missed there stays missed. As many at every timestep make motion jerk and feet slide.
const LATE_CORRECTIONS: usize = 8;
const LITTLE_NOISE: usize = 100;
/// Numbers that say the timestep.
pub(super) const WAVES: usize = 128;
/// Numbers that conditions are told by: slots; the key pose, when it is, whether there is one; the clip's length.
pub(super) const TOLD: usize = SLOTS * SLOT + POSE + COSINES + 2;
/// Numbers that misses are told by: slots; the key pose, whether there is one.
pub(crate) const MISSED: usize = MISS_SLOTS * SLOT + POSE + 1;

/// How often sampling corrects its prediction at a timestep; `settled`: whether the motion is settled afterwards, which meets what is
/// asked for better than this does.
pub(crate) fn corrections_at(timestep: usize, settled: bool) -> usize {
    if timestep < LITTLE_NOISE && !settled { LATE_CORRECTIONS } else { CORRECTIONS }
}

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
        for (joint, place) in row.chunks_exact(3).enumerate().take(JOINTS) {
            if place.iter().any(|number| *number != 0.0) {
                add_to_slots(slots, (*frame, frames), joint, place);
            }
        }
    }
    mean_of_slots(slots);
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

/// By how much a motion misses places that are asked for, as a [`Correction`] takes it: `joints` are frames, joints and metres, in the
/// world; `pose` the metres of all joints of a key pose.
pub(crate) fn missed(frames: usize, joints: &[(usize, usize, [f32; 3])], pose: Option<&[f32]>) -> Vec<f32> {
    let frames = frames.max(1);
    let scaled = |metres: f32| (metres / MISS).clamp(-MOST, MOST);
    let mut row = vec![0.0; MISSED];
    let (slots, rest) = row.split_at_mut(MISS_SLOTS * SLOT);
    for (frame, joint, by) in joints.iter().filter(|(frame, joint, _)| *frame < frames && *joint < JOINTS) {
        add_to_slots(slots, (*frame, frames), *joint, &by.map(scaled));
    }
    mean_of_slots(slots);
    if let (Some(pose), Some((last, row))) = (pose, rest.split_last_mut()) {
        row.iter_mut().zip(pose).for_each(|(row, by)| *row = scaled(*by));
        *last = 1.0;
    }
    row
}

/// From the gradient of a row of [`missed`] numbers to that of the metres that it was made of, in their order; those of the pose behind
/// them.
pub(crate) fn missed_back(
    frames: usize,
    joints: &[(usize, usize, [f32; 3])],
    pose: Option<&[f32]>,
    grad: &[f32],
) -> (Vec<[f32; 3]>, Vec<f32>) {
    let frames = frames.max(1);
    let open = |metres: f32, grad: f32| if (metres / MISS).abs() < MOST { grad / MISS } else { 0.0 };
    let (slots, rest) = grad.split_at(MISS_SLOTS * SLOT);
    let fits = |frame: usize, joint: usize| frame < frames && joint < JOINTS;
    let mut counts = [0.0_f32; MISS_SLOTS * JOINTS];
    for &(frame, joint, _) in joints.iter().filter(|(frame, joint, _)| fits(*frame, *joint)) {
        touched(frame, frames, MISS_SLOTS).for_each(|slot| counts[slot * JOINTS + joint] += 1.0);
    }
    let of_joints = joints.iter().map(|&(frame, joint, by)| {
        let mut of = [0.0; 3];
        if fits(frame, joint) {
            for slot in touched(frame, frames, MISS_SLOTS) {
                let share = 1.0 / counts[slot * JOINTS + joint].max(1.0);
                let own = &slots[slot * SLOT + 4 * joint..][..3];
                of.iter_mut().zip(own).for_each(|(of, grad)| *of += share * grad);
            }
        }
        std::array::from_fn(|axis| open(by[axis], of[axis]))
    });
    let of_pose = pose.into_iter().flatten().zip(rest).map(|(by, grad)| open(*by, *grad));
    (of_joints.collect(), of_pose.collect())
}

/// The slots that a frame touches.
fn touched(frame: usize, frames: usize, slots: usize) -> std::ops::Range<usize> {
    let first = frame * slots / frames;
    first..((frame + 1) * slots).div_ceil(frames).max(first + 1).min(slots)
}

/// Adds what is said of a joint at a frame, of so many, to all slots that the frame touches.
fn add_to_slots(slots: &mut [f32], (frame, frames): (usize, usize), joint: usize, numbers: &[f32]) {
    for slot in touched(frame, frames, slots.len() / SLOT) {
        let own = &mut slots[slot * SLOT + 4 * joint..][..4];
        own.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += number);
        own[3] += 1.0;
    }
}

/// More than one frame of a slot: their mean.
fn mean_of_slots(slots: &mut [f32]) {
    for joint in slots.chunks_exact_mut(4).filter(|joint| joint[3] > 1.0) {
        let count = joint[3];
        joint.iter_mut().for_each(|number| *number /= count);
    }
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

/// Weighs what is estimated against what the denoiser says, and moves the motion to where it is asked to be.
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

    /// Noisy latent, weighed one, estimate, what else is known, timestep, misses.
    pub(super) fn inputs(sizes: &Sizes) -> usize {
        3 * sizes.latent_tokens * sizes.width + sizes.estimate + WAVES + MISSED
    }

    /// How much a correction counts at a timestep: as a velocity, so that it does nothing where no noise is left.
    pub(super) fn share(&self, timestep: usize) -> f32 {
        (1.0 - self.schedule.alpha(timestep)).sqrt()
    }

    /// Moves the clean latents that the denoiser sees towards the estimate, as much as the conditions and the timestep say; in place.
    pub(crate) fn weigh(
        &self,
        clean: &mut [f32],
        timesteps: &[usize],
        estimate: &Estimate,
        tape: &mut CorrectionTape,
    ) {
        let known = estimate.hidden.len() / timesteps.len().max(1);
        tape.weighed.clear();
        for (hidden, &timestep) in estimate.hidden.chunks_exact(known.max(1)).zip(timesteps) {
            tape.weighed.extend_from_slice(hidden);
            tape.weighed.extend(timestep_waves(timestep, WAVES));
        }
        tape.shares = self.gate.apply(&tape.weighed);
        tape.apart.clear();
        let rows = tape.shares.chunks_exact_mut(self.width).zip(clean.chunks_exact_mut(self.width));
        let rows = rows.zip(estimate.latents.chunks_exact(self.width)).zip(timesteps);
        for (((shares, clean), estimate), &timestep) in rows {
            let most = self.share(timestep);
            for ((share, clean), estimate) in shares.iter_mut().zip(clean).zip(estimate) {
                *share = 1.0 / (1.0 + (-*share).exp());
                let apart = most * (estimate - *clean);
                tape.apart.push(apart);
                *clean += *share * apart;
            }
        }
    }

    /// Moves weighed latents to where `missed` (a row of [`missed`] for each sample) says that they are asked to be; in place.
    pub(crate) fn correct(
        &self,
        noisy: &[f32],
        weighed: &mut [f32],
        timesteps: &[usize],
        (estimate, missed): (&Estimate, &[f32]),
        tape: &mut CorrectionTape,
    ) {
        let known = estimate.hidden.len() / timesteps.len().max(1);
        let mut input = Vec::with_capacity(timesteps.len() * (3 * self.width + known + WAVES + MISSED));
        for (sample, &timestep) in timesteps.iter().enumerate() {
            let own = sample * self.width..(sample + 1) * self.width;
            let hidden = &estimate.hidden[sample * known..(sample + 1) * known];
            let misses = &missed[sample * MISSED..(sample + 1) * MISSED];
            let waves = timestep_waves(timestep, WAVES);
            let parts = [&noisy[own.clone()], &weighed[own.clone()], &estimate.latents[own], hidden];
            parts.iter().for_each(|part| input.extend_from_slice(part));
            input.extend(waves);
            input.extend_from_slice(misses);
        }
        tape.hidden = self.trunk.forward(input, &mut tape.trunk);
        let moved = self.latent.apply(&tape.hidden);
        let rows = weighed.chunks_exact_mut(self.width).zip(moved.chunks_exact(self.width));
        for ((clean, moved), &timestep) in rows.zip(timesteps) {
            let share = self.share(timestep);
            clean.iter_mut().zip(moved).for_each(|(clean, moved)| *clean += share * moved);
        }
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
    /// What the shares are of.
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
    fn what_nothing_settles_is_corrected_more_where_little_noise_is_left() {
        let both = |timestep| [false, true].map(|settled| corrections_at(timestep, settled));
        assert_eq!((both(1), both(99)), ([8, 2], [8, 2]));
        assert_eq!((both(100), both(981)), ([2, 2], [2, 2]));
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
