//! How far decoded latents are from trajectories and key poses, and what latents get of it.

use crate::GenerateError;
use crate::guidance::Places;
use crate::networks::{Decoding, Vae};
use inkrig_motion::humanml::{JOINTS, Statistics, WIDTH};

/// Numbers of a frame's places.
const PLACES: usize = 3 * JOINTS;

/// What a sample shall be.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// Its place in the batch.
    pub sample: usize,
    /// The joints of every frame, frames x 66 metres.
    pub places: &'a [f32],
    /// Frames and joints that its trajectory asks for.
    pub trajectory: &'a [(usize, usize)],
    /// The frame of its key pose.
    pub keypose: Option<usize>,
}

/// Sums of squared distances in normalised units over all that is asked for, divided by how much that is.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct DecodedLosses {
    /// Of joints, where they are.
    pub(crate) trajectory: f64,
    /// Of all joints of key poses, relative to the root above the ground (Eq. 8).
    pub(crate) keypose: f64,
}

/// Buffers.
#[derive(Debug)]
pub(crate) struct Decoded<'a> {
    features: &'a Statistics,
    /// One over the deviation of each of 66 numbers.
    scales: Vec<f64>,
    decoding: Decoding,
    places: Places,
    of_joints: Vec<f64>,
    row: Vec<f32>,
}

impl<'a> Decoded<'a> {
    pub(crate) fn new(features: &'a Statistics, places: &Statistics) -> Result<Self, GenerateError> {
        if places.deviation().len() != PLACES {
            let (what, got) = ("statistics of places", places.deviation().len());
            return Err(GenerateError::Length { what, expected: PLACES, got });
        }
        Ok(Self {
            features,
            scales: places.deviation().iter().map(|deviation| 1.0 / f64::from(*deviation)).collect(),
            decoding: Decoding::default(),
            places: Places::default(),
            of_joints: Vec::new(),
            row: Vec::new(),
        })
    }

    /// The losses of latents that follow one another, one for each of `wanted`, each times its `signals`, and the gradient of the sum
    /// weighted with `weights` (trajectory, key pose).
    pub(crate) fn losses(
        &mut self,
        vae: &Vae,
        latents: &[f32],
        wanted: &[Wanted<'_>],
        signals: &[f64],
        weights: (f64, f64),
    ) -> Result<(DecodedLosses, Vec<f32>), GenerateError> {
        let frames: Vec<usize> = wanted.iter().map(|wanted| wanted.places.len() / PLACES).collect();
        vae.decode(latents, &frames, &mut self.decoding)?;
        let asked: usize = wanted.iter().map(|wanted| wanted.trajectory.len()).sum();
        let posed = JOINTS * wanted.iter().filter(|wanted| wanted.keypose.is_some()).count();
        let (asked, posed) = (asked.max(1) as f64, posed.max(1) as f64);
        let mut losses = DecodedLosses::default();
        let mut grad_features = vec![0.0; self.decoding.features().len()];
        let mut first = 0;
        for ((wanted, &frames), &signal) in wanted.iter().zip(&frames).zip(signals) {
            let range = first * WIDTH..(first + frames) * WIDTH;
            first += frames;
            self.places.recover(&self.decoding.features()[range.clone()], self.features)?;
            self.of_joints.clear();
            self.of_joints.resize(frames * PLACES, 0.0);
            let joints = &self.places.joints;
            for &(frame, joint) in wanted.trajectory.iter().filter(|(frame, _)| *frame < frames) {
                for axis in 3 * joint..3 * joint + 3 {
                    let at = frame * PLACES + axis;
                    let apart = (joints[at] - f64::from(wanted.places[at])) * self.scales[axis];
                    losses.trajectory += signal * apart * apart / asked;
                    self.of_joints[at] += weights.0 * signal * 2.0 * apart * self.scales[axis] / asked;
                }
            }
            if let Some(frame) = wanted.keypose.filter(|frame| *frame < frames) {
                let row = frame * PLACES;
                for axis in 0..PLACES {
                    // The height counts as it is.
                    let of_root = if axis % 3 == 1 { None } else { Some(row + axis % 3) };
                    let own = |table: &dyn Fn(usize) -> f64| table(row + axis) - of_root.map_or(0.0, table);
                    let apart = own(&|at| joints[at]) - own(&|at| f64::from(wanted.places[at]));
                    let apart = apart * self.scales[axis];
                    losses.keypose += signal * apart * apart / posed;
                    let grad = weights.1 * signal * 2.0 * apart * self.scales[axis] / posed;
                    self.of_joints[row + axis] += grad;
                    if let Some(root) = of_root {
                        self.of_joints[root] -= grad;
                    }
                }
            }
            self.places.gradient(&self.of_joints, self.features, &mut self.row);
            grad_features[range].copy_from_slice(&self.row);
        }
        let grad = vae.gradient(&grad_features, &mut self.decoding)?.to_vec();
        Ok((losses, grad))
    }
}
