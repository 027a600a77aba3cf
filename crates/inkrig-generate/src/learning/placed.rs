//! How far joints are from where they are asked to be, in metres, as the linear path decodes latents, and what latents get of it.

use crate::GenerateError;
use crate::guidance::Places;
use crate::networks::{Decoding, Vae};
use inkrig_motion::humanml::{JOINTS, Statistics, WIDTH};

/// Numbers of a frame's places.
const PLACES: usize = 3 * JOINTS;
/// Below this, metres, distances count by their square, so that they have a slope at zero.
const ROUNDED: f64 = 0.01;

/// What is asked of a sample.
#[derive(Debug, Clone, Copy)]
pub struct Asked<'a> {
    /// Its frames.
    pub frames: usize,
    /// Frames and joints that its trajectory asks for.
    pub trajectory: &'a [(usize, usize)],
    /// The frame of its key pose.
    pub keypose: Option<usize>,
}

/// Mean distances, metres.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Distances {
    /// Of joints that trajectories ask for.
    pub trajectory: f64,
    /// Of all joints of key poses, the pelvis at its place.
    pub keypose: f64,
}

/// Buffers.
#[derive(Debug)]
pub(crate) struct Placed<'a> {
    vae: &'a Vae,
    features: &'a Statistics,
    decoding: Decoding,
    places: Places,
}

impl<'a> Placed<'a> {
    pub(crate) fn new(vae: &'a Vae, features: &'a Statistics) -> Self {
        Self { vae, features, decoding: Decoding::default(), places: Places::default() }
    }

    /// Where the joints of clean latents are, frames x 66 metres of one sample after the other.
    pub(crate) fn places(&mut self, latents: &[f32], asked: &[Asked<'_>]) -> Result<Vec<f64>, GenerateError> {
        self.decode(latents, asked)?;
        let (mut all, mut rest) = (Vec::new(), self.decoding.features());
        for asked in asked {
            let (own, others) = rest.split_at(asked.frames * WIDTH);
            rest = others;
            self.places.recover(own, self.features)?;
            all.extend_from_slice(&self.places.joints);
        }
        Ok(all)
    }

    fn decode(&mut self, latents: &[f32], asked: &[Asked<'_>]) -> Result<(), GenerateError> {
        let frames: Vec<usize> = asked.iter().map(|asked| asked.frames).collect();
        self.vae.decode_quickly(latents, &frames, &mut self.decoding)
    }

    /// Distances of latents from `wanted` places (see [`Self::places`]), and the gradient of their sum weighted with `weights`
    /// (trajectory, key pose).
    pub(crate) fn distances(
        &mut self,
        latents: &[f32],
        asked: &[Asked<'_>],
        mut wanted: &[f64],
        weights: (f64, f64),
    ) -> Result<(Distances, Vec<f32>), GenerateError> {
        self.decode(latents, asked)?;
        let drawn: usize = asked.iter().map(|asked| asked.trajectory.len()).sum();
        let posed = JOINTS * asked.iter().filter(|asked| asked.keypose.is_some()).count();
        let each = (1.0 / drawn.max(1) as f64, 1.0 / posed.max(1) as f64);
        let mut sums = Distances::default();
        let mut grads = Vec::with_capacity(self.decoding.features().len());
        let (mut of_joints, mut row) = (Vec::new(), Vec::new());
        let mut first = 0;
        for asked in asked {
            let own = first..first + asked.frames * WIDTH;
            first = own.end;
            self.places.recover(&self.decoding.features()[own], self.features)?;
            let (target, others) = wanted.split_at(asked.frames * PLACES);
            wanted = others;
            of_joints.clear();
            of_joints.resize(asked.frames * PLACES, 0.0);
            let joints = &self.places.joints;
            for &(frame, joint) in
                asked.trajectory.iter().filter(|(frame, joint)| *frame < asked.frames && *joint < JOINTS)
            {
                let at = frame * PLACES + 3 * joint;
                let (distance, slope) = distance(|axis| joints[at + axis] - target[at + axis]);
                sums.trajectory += each.0 * distance;
                add(&mut of_joints[at..], slope, weights.0 * each.0);
            }
            if let Some(frame) = asked.keypose.filter(|frame| *frame < asked.frames) {
                let root = frame * PLACES;
                for at in (root..root + PLACES).step_by(3) {
                    let place = |table: &[f64], axis: usize| table[at + axis] - table[root + axis];
                    let (distance, slope) = distance(|axis| place(joints, axis) - place(target, axis));
                    sums.keypose += each.1 * distance;
                    add(&mut of_joints[at..], slope, weights.1 * each.1);
                    add(&mut of_joints[root..], slope, -weights.1 * each.1);
                }
            }
            self.places.gradient(&of_joints, self.features, &mut row);
            grads.extend_from_slice(&row);
        }
        Ok((sums, self.vae.gradient_quickly(&grads, &mut self.decoding)?))
    }
}

/// A rounded length, and its slope along each axis.
fn distance(apart: impl Fn(usize) -> f64) -> (f64, [f64; 3]) {
    let apart = [apart(0), apart(1), apart(2)];
    let length = (apart.iter().map(|x| x * x).sum::<f64>() + ROUNDED * ROUNDED).sqrt();
    (length - ROUNDED, apart.map(|x| x / length))
}

fn add(to: &mut [f64], slope: [f64; 3], weight: f64) {
    to.iter_mut().zip(slope).for_each(|(to, slope)| *to += weight * slope);
}
