//! From a plan to a clip: several are sampled with the word, each drawn to what is asked for at every few steps, and the best is
//! taken.

use crate::error::StoryboardError;
use crate::plan::{Plan, seen};
use inkrig_generate::GenerateError;
use inkrig_generate::guidance::{Target, View};
use inkrig_generate::measures::{jerk, skating};
use inkrig_generate::networks::{Decoding, Domain};
use inkrig_generate::sampling::{Conditions, Networks, Sampler, SamplingOptions};
use inkrig_motion::Features;
use inkrig_motion::glam::{Vec2, Vec3};
use inkrig_motion::humanml::{Joints, Statistics, WIDTH, recover_positions};
use rayon::prelude::*;

/// What clips are made with.
#[derive(Debug, Clone, Copy)]
pub struct Maker<'a> {
    /// The model.
    pub networks: &'a Networks,
    /// Of its features.
    pub features: &'a Statistics,
    /// The vector of a text that says nothing.
    pub no_text: &'a [f32],
    /// Frames that the model was trained with; shorter clips are cut from these.
    pub usual_frames: usize,
}

/// How clips are made.
#[derive(Debug, Clone, PartialEq)]
pub struct MakerOptions {
    /// Steps, text and guidance. Without guidance only the word counts.
    pub sampling: SamplingOptions,
    /// How many are sampled for a frame; the best is taken.
    pub candidates: usize,
    /// The same seed gives the same.
    pub seed: u64,
}

/// A clip of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Generated {
    /// Where its joints are, metres; it begins above the origin and faces +z.
    pub motion: Vec<Joints>,
    /// What it was asked for, the picture moved to where the motion is.
    pub plan: Plan,
    /// Mean distance of asked joints from their places on the picture, metres.
    pub error: f32,
    /// The largest of these distances, metres.
    pub worst: f32,
    /// Which of the candidates it is.
    pub candidate: usize,
    /// Decodings with their gradient that guidance took, of all candidates.
    pub evaluations: usize,
}

impl Maker<'_> {
    /// Makes the clip of frame `number` (from 1), whose text has this vector.
    ///
    /// # Errors
    /// When the model cannot: the clip is too long, or numbers do not fit.
    pub fn clip(
        &self,
        number: usize,
        plan: &Plan,
        text: &[f32],
        options: &MakerOptions,
    ) -> Result<Generated, StoryboardError> {
        let made: Result<Vec<Generated>, GenerateError> = (0..options.candidates.max(1))
            .into_par_iter()
            .map(|candidate| self.candidate(number, candidate, plan, text, options))
            .collect();
        let failed = |cause| StoryboardError::Generate { frame: number, cause: Box::new(cause) };
        let made = made.map_err(failed)?;
        let evaluations = made.iter().map(|clip| clip.evaluations).sum();
        let best = made.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
        let nothing = || {
            failed(GenerateError::Setting {
                setting: "the number of candidates",
                value: "0".into(),
                needed: "at least 1",
            })
        };
        Ok(Generated { evaluations, ..best.ok_or_else(nothing)? })
    }

    fn candidate(
        &self,
        number: usize,
        candidate: usize,
        plan: &Plan,
        text: &[f32],
        options: &MakerOptions,
    ) -> Result<Generated, GenerateError> {
        let seed =
            options.seed.wrapping_mul(1_000_003).wrapping_add((number as u64) << 20) + candidate as u64;
        let mut plan = plan.clone();
        if !plan.placed && options.sampling.guidance.is_some() {
            // Where the motion will have taken the figure: as far as it goes without the drawing.
            let (free, _) =
                self.sample(&Plan { keypose: None, ways: Vec::new(), ..plan.clone() }, text, options, seed)?;
            plan = placed_on(&plan, &free);
        }
        let (mut motion, evaluations) = self.sample(&plan, text, options, seed)?;
        to_floor(&mut motion);
        let plan = plan.moved(offset(&plan, &motion));
        let [error, worst] = error(&plan, &motion);
        Ok(Generated { motion, error, worst, plan, candidate, evaluations })
    }

    fn sample(
        &self,
        plan: &Plan,
        text: &[f32],
        options: &MakerOptions,
        seed: u64,
    ) -> Result<(Vec<Joints>, usize), GenerateError> {
        let frames = plan.frames.max(self.usual_frames);
        let target = Target { view: View::Plane(plan.camera), asks: plan.asks() };
        let conditions =
            Conditions::from_tables(frames, text.to_vec(), Domain::Space, Vec::new(), None, target)?;
        let sampler = Sampler { networks: self.networks, features: self.features, no_text: self.no_text };
        let sampled = sampler.sample(&[conditions], &options.sampling, seed)?;
        let mut decoding = Decoding::default();
        self.networks.vae.decode(&sampled.latents, &[frames], &mut decoding)?;
        let mut rows = decoding.features().to_vec();
        rows.truncate(plan.frames * WIDTH);
        self.features.restore(&mut rows);
        let motion = recover_positions(&Features::new(rows, WIDTH)?)?;
        Ok((motion, sampled.guided.iter().map(|guided| guided.evaluations).sum()))
    }
}

/// The plan where a motion has its key frame.
fn placed_on(plan: &Plan, motion: &[Joints]) -> Plan {
    let at = motion.get(plan.key_frame()).map(|pose| seen(&plan.camera, pose[0]));
    let asked = plan.keypose.as_ref().and_then(|(_, joints)| joints.iter().find(|(joint, _, _)| *joint == 0));
    match (at, asked) {
        (Some(at), Some((_, place, _))) => plan.moved(at - *place),
        _ => plan.clone(),
    }
}

/// How far the picture has to be moved so that what is asked for lies, in the mean, where the motion is: a drawing says
/// nothing of where on the picture its origin is.
pub(crate) fn offset(plan: &Plan, motion: &[Joints]) -> Vec2 {
    let off: Vec<Vec2> = plan
        .asks()
        .iter()
        .filter_map(|ask| Some(seen(&plan.camera, motion.get(ask.frame)?[ask.joint]) - ask.place.truncate()))
        .collect();
    off.iter().copied().sum::<Vec2>() / off.len().max(1) as f32
}

/// Mean and largest distance of asked joints from their places on the picture, metres; 0 where nothing is asked for.
fn error(plan: &Plan, motion: &[Joints]) -> [f32; 2] {
    let off: Vec<f32> = plan
        .asks()
        .iter()
        .filter_map(|ask| {
            let place = seen(&plan.camera, motion.get(ask.frame)?[ask.joint]);
            Some(place.distance(ask.place.truncate()))
        })
        .collect();
    [off.iter().sum::<f32>() / off.len().max(1) as f32, off.iter().copied().fold(0.0, f32::max)]
}

/// Moves a clip up or down so that its lowest points, but for a tenth of the frames, are on the floor.
fn to_floor(motion: &mut [Joints]) {
    let mut lowest: Vec<f32> =
        motion.iter().map(|pose| pose.iter().map(|joint| joint.y).fold(f32::INFINITY, f32::min)).collect();
    lowest.sort_by(f32::total_cmp);
    let Some(&floor) = lowest.get(lowest.len() / 10) else { return };
    motion.iter_mut().flatten().for_each(|joint| joint.y -= floor);
}

/// What is taken is near to the drawing, stands on the ground without sliding, and does not jerk.
fn cost(clip: &Generated) -> f64 {
    let motion = &clip.motion;
    let lowest =
        motion.iter().map(|pose| pose.iter().map(|joint: &Vec3| joint.y).fold(f32::INFINITY, f32::min));
    let count = motion.len().max(1) as f64;
    let away = lowest.map(|low| f64::from(low.abs())).sum::<f64>() / count;
    let jerks = jerk(motion);
    let jerks = jerks.iter().sum::<f64>() / jerks.len().max(1) as f64;
    f64::from(clip.error) + 0.1 * skating(motion).ratio + 0.2 * away + 0.5 * jerks
}
