//! From a plan to a clip: several are sampled with the word, each drawn to what is asked for at every few steps, and ranked.

use crate::animation::{Exact, animation};
use crate::error::StoryboardError;
use crate::exact::joints_of;
use crate::path::from_above;
use crate::plan::{Plan, seen};
use crate::space::Space;
use inkrig_generate::GenerateError;
use inkrig_generate::guidance::{Ask, Target, View};
use inkrig_generate::measures::{jerk, skating};
use inkrig_generate::networks::{Decoding, Domain};
use inkrig_generate::readers::sketch::JOINT_OF_KEY_POINT;
use inkrig_generate::sampling::{Conditions, Networks, Request, Sampler, SamplingOptions};
use inkrig_motion::Features;
use inkrig_motion::glam::{Vec2, Vec3};
use inkrig_motion::humanml::{
    Blocks, Camera, FRAME_RATE, JOINTS, Joints, Statistics, WIDTH, augment, features, keep_footing,
    recover_positions,
};
use rayon::prelude::*;

/// The step of training whose noise a motion is given that another one shall be near to: a quarter of its power is left.
const NEAR: usize = 500;

/// What clips are made with.
#[derive(Debug, Clone, Copy)]
pub struct Maker<'a> {
    /// The model.
    pub networks: &'a Networks,
    /// Of its features.
    pub features: &'a Statistics,
    /// Of places of joints, as conditions are told.
    pub places: &'a Statistics,
    /// The vector of a text that says nothing.
    pub no_text: &'a [f32],
    /// The bone that ends at each joint, metres.
    pub body: &'a Joints,
    /// Frames that the model was trained with; shorter clips are cut from these.
    pub usual_frames: usize,
}

/// How clips are made.
#[derive(Debug, Clone, PartialEq)]
pub struct MakerOptions {
    /// Steps, text and guidance.
    pub sampling: SamplingOptions,
    /// Whether the drawing counts. Without it only the word does.
    pub drawn: bool,
    /// How many are sampled for a frame.
    pub candidates: usize,
    /// The same seed gives the same.
    pub seed: u64,
}

/// A clip of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Generated {
    /// Where its joints are, metres; it begins above the origin and faces +z.
    pub motion: Vec<Joints>,
    /// What the model says of left ankle, left foot, right ankle, right foot, from 0 (moves) to 1 (stands).
    pub contacts: Vec<[f32; 4]>,
    /// What it was asked for, the picture moved to where the motion is.
    pub plan: Plan,
    /// Mean distance of asked joints from their places on the picture, and of the pelvis from its path, metres.
    pub error: f32,
    /// The largest of these distances, metres.
    pub worst: f32,
    /// Which of the candidates it is.
    pub candidate: usize,
    /// Decodings with their gradient that guidance took, of all candidates.
    pub evaluations: usize,
}

impl Maker<'_> {
    /// Makes the clip of frame `number` (from 1), whose text has this vector: the best of its [`takes`](Self::takes).
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
        let made = self.takes(number, plan, text, options)?;
        made.into_iter().next().ok_or_else(|| nothing(number))
    }

    /// All clips that are sampled for frame `number`, the best first; at least one.
    ///
    /// The number is a part of the seed, so frames of one storyboard that are drawn alike move differently, and the same frame at
    /// another place of the story gets other clips. A storyboard that is rearranged and shall keep its motions says the old numbers
    /// ([`inkrig_sketch::storyboard::Frame::number`]), as the studio does.
    ///
    /// # Errors
    /// As of [`clip`](Self::clip).
    pub fn takes(
        &self,
        number: usize,
        plan: &Plan,
        text: &[f32],
        options: &MakerOptions,
    ) -> Result<Vec<Generated>, StoryboardError> {
        self.ranked(number, plan, (text, None), options)
    }

    /// The same, but denoising begins with a motion, made so noisy that much of it is lost. Models that were distilled for few steps
    /// begin with noise all the same.
    ///
    /// # Errors
    /// As of [`clip`](Self::clip).
    pub fn takes_near(
        &self,
        number: usize,
        plan: &Plan,
        text: &[f32],
        motion: &[Joints],
        options: &MakerOptions,
    ) -> Result<Vec<Generated>, StoryboardError> {
        let failed = |cause| StoryboardError::Generate { frame: number, cause: Box::new(cause) };
        let latent = self.encoded(motion, plan.frames.max(self.usual_frames)).map_err(failed)?;
        self.ranked(number, plan, (text, Some(&latent)), options)
    }

    fn ranked(
        &self,
        number: usize,
        plan: &Plan,
        told: Told<'_>,
        options: &MakerOptions,
    ) -> Result<Vec<Generated>, StoryboardError> {
        let made: Result<Vec<Generated>, GenerateError> = (0..options.candidates.max(1))
            .into_par_iter()
            .map(|candidate| self.candidate(number, candidate, plan, told, options))
            .collect();
        let failed = |cause| StoryboardError::Generate { frame: number, cause: Box::new(cause) };
        let made = made.map_err(failed)?;
        let evaluations = made.iter().map(|clip| clip.evaluations).sum();
        let costs: Vec<f64> = if made.len() > 1 && options.drawn {
            made.par_iter().map(|clip| self.cost_met(clip)).collect::<Result<_, _>>()?
        } else {
            made.iter().map(cost).collect()
        };
        let mut ranked: Vec<(f64, Generated)> = costs
            .into_iter()
            .zip(made)
            .map(|(cost, clip)| (cost, Generated { evaluations, ..clip }))
            .collect();
        ranked.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        Ok(ranked.into_iter().map(|(_, clip)| clip).collect())
    }

    /// What a clip costs once it was moved a little to what is asked of it, as it will be: some that are near stay there, others come
    /// nearer.
    fn cost_met(&self, clip: &Generated) -> Result<f64, StoryboardError> {
        let alone = Generated { plan: Plan { space: Space::default(), ..clip.plan.clone() }, ..clip.clone() };
        let met = animation(std::slice::from_ref(&alone), None, self.body, &Exact::Soft)?;
        let error = met.met.as_ref().map_or(clip.error, |met| met.after[0]);
        Ok(cost(&Generated { motion: joints_of(&met.clip), error, ..alone }))
    }

    fn candidate(
        &self,
        number: usize,
        candidate: usize,
        plan: &Plan,
        told: Told<'_>,
        options: &MakerOptions,
    ) -> Result<Generated, GenerateError> {
        let seed = options
            .seed
            .wrapping_mul(1_000_003)
            .wrapping_add((number as u64) << 20)
            .wrapping_add(candidate as u64);
        let mut plan = plan.clone();
        if !plan.placed && options.drawn {
            // Where the motion will have taken the figure: as far as it goes without the drawing.
            let free = Plan { keypose: None, ways: Vec::new(), ..plan.clone() };
            plan = placed_on(&plan, &self.sample(&free, told, options, seed)?.motion);
        }
        let Sampled { motion, contacts, evaluations } = self.sample(&plan, told, options, seed)?;
        // The picture follows the motion, before feet are put on the floor and behind it.
        let plan = placed(&plan, &motion);
        let [error, worst] = error(&plan, &motion);
        let motion = keep_footing(&motion, &contacts, FRAME_RATE, &[])?.frames;
        let plan = placed(&plan, &motion);
        Ok(Generated { motion, contacts, error, worst, plan, candidate, evaluations })
    }

    fn sample(
        &self,
        plan: &Plan,
        (text, near): Told<'_>,
        options: &MakerOptions,
        seed: u64,
    ) -> Result<Sampled, GenerateError> {
        let frames = plan.frames.max(self.usual_frames);
        let conditions = self.conditions(frames, plan, text, options)?;
        let sampler = Sampler { networks: self.networks, features: self.features, no_text: self.no_text };
        let sampled = match near {
            Some(latent) => {
                let sampling = SamplingOptions { from: Some(NEAR), ..options.sampling.clone() };
                sampler.sample_near(latent, &[conditions], &sampling, seed)?
            }
            None => sampler.sample(&[conditions], &options.sampling, seed)?,
        };
        let mut decoding = Decoding::default();
        self.networks.vae.decode(&sampled.latents, &[frames], &mut decoding)?;
        let mut rows = decoding.features().to_vec();
        rows.truncate(plan.frames * WIDTH);
        self.features.restore(&mut rows);
        let contacts =
            rows.chunks_exact(WIDTH).filter_map(|row| row[Blocks::CONTACTS].try_into().ok()).collect();
        Ok(Sampled {
            motion: recover_positions(&Features::new(rows, WIDTH)?)?,
            contacts,
            evaluations: sampled.guided.iter().map(|guided| guided.evaluations).sum(),
        })
    }
}

/// A text's vector, and a latent to begin with.
type Told<'a> = (&'a [f32], Option<&'a [f32]>);

impl Maker<'_> {
    /// A motion as a latent of so many frames; it rests at its end where it is shorter.
    fn encoded(&self, motion: &[Joints], frames: usize) -> Result<Vec<f32>, GenerateError> {
        let mut longer = motion.to_vec();
        // Features are of pairs of poses.
        longer.resize(frames + 1, motion.last().copied().unwrap_or([Vec3::ZERO; JOINTS]));
        let mut rows = features(&longer)?.as_slice().to_vec();
        self.features.normalise(&mut rows);
        Ok(self.networks.vae.encode(&rows)?.mean)
    }

    /// What the networks are told: all that is drawn where they were taught such pictures, else the word alone; guidance follows it all.
    fn conditions(
        &self,
        frames: usize,
        plan: &Plan,
        text: &[f32],
        options: &MakerOptions,
    ) -> Result<Conditions, GenerateError> {
        let (text, view) = (text.to_vec(), View::Plane(plan.camera));
        let (drawn, mut depths) =
            if options.drawn { (plan.asks(), plan.over_ground()) } else { (Vec::new(), Vec::new()) };
        let path = plan.on_path();
        let through = |camera: &Camera| {
            let seen = |ask: &Ask| Ask { place: seen(camera, ask.place).extend(0.0), ..*ask };
            path.iter().map(seen).collect::<Vec<Ask>>()
        };
        let all = if drawn.is_empty() && !path.is_empty() {
            // How high the body is, is the word's.
            let above = from_above();
            Target { view: View::Plane(above), asks: through(&above), depths: Vec::new() }
        } else {
            depths.extend(&path);
            Target { view, asks: [drawn.clone(), through(&plan.camera)].concat(), depths: depths.clone() }
        };
        let known = plan.usual_view && self.networks.follows(Domain::Plane);
        if drawn.is_empty() || !known {
            if path.is_empty() || !self.networks.follows(Domain::Space) {
                return Conditions::from_tables(frames, text, Domain::Space, Vec::new(), None, all);
            }
            let request = Request { frames, text, view: View::Space, trajectory: path, keypose: None };
            let told = Conditions::new(&request, self.places, options.sampling.semantics)?;
            return Ok(told.guided_to(all));
        }
        let keypose = whole_pose(plan);
        let pose_is_told =
            |ask: &Ask| keypose.is_some_and(|_| !plan.on_way(ask)) && (ask.joint != 0 || path.is_empty());
        let trajectory = all.asks.iter().filter(|ask| !pose_is_told(ask)).copied().collect();
        let request = Request { frames, text, view, trajectory, keypose };
        let told = Conditions::new(&request, self.places, options.sampling.semantics)?;
        Ok(told.guided_to(all).at_depths(&depths))
    }
}

/// The drawn pose as networks know poses: with every joint that a figure has, else none.
fn whole_pose(plan: &Plan) -> Option<(usize, Joints)> {
    let (frame, joints) = plan.keypose.as_ref()?;
    let mut pose = [Vec3::ZERO; JOINTS];
    for joint in JOINT_OF_KEY_POINT {
        let (_, at) = plan.pose.iter().find(|(own, _)| *own == joint)?;
        let moved = joints.iter().find(|(own, _, _)| *own == joint);
        pose[joint] = moved.map_or(*at, |(_, at, _)| *at).extend(1.0);
    }
    Some((*frame, augment(&pose)))
}

fn nothing(number: usize) -> StoryboardError {
    let cause = GenerateError::Setting {
        setting: "the number of candidates",
        value: "0".into(),
        needed: "at least 1",
    };
    StoryboardError::Generate { frame: number, cause: Box::new(cause) }
}

struct Sampled {
    motion: Vec<Joints>,
    contacts: Vec<[f32; 4]>,
    evaluations: usize,
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

/// The plan with its picture, and its path, where a motion has them in the mean.
pub(crate) fn placed(plan: &Plan, motion: &[Joints]) -> Plan {
    let mut moved = plan.moved(offset(plan, motion));
    let off = plan.off_path(motion);
    let mean = off.iter().copied().sum::<Vec2>() / off.len().max(1) as f32;
    moved.path.iter_mut().flatten().for_each(|place| *place += Vec3::new(mean.x, 0.0, mean.y));
    moved
}

/// Mean and largest distance of asked joints from their places on the picture, and of the pelvis from its path, metres; 0 where nothing
/// is asked for.
pub(crate) fn error(plan: &Plan, motion: &[Joints]) -> [f32; 2] {
    let asks = plan.asks();
    let drawn = asks.iter().filter_map(|ask| {
        let place = seen(&plan.camera, motion.get(ask.frame)?[ask.joint]);
        Some(place.distance(ask.place.truncate()))
    });
    let off: Vec<f32> = drawn.chain(plan.off_path(motion).iter().map(|off| off.length())).collect();
    [off.iter().sum::<f32>() / off.len().max(1) as f32, off.iter().copied().fold(0.0, f32::max)]
}

/// What is taken is near to the drawing, stands on the ground without sliding, and does not jerk.
pub(crate) fn cost(clip: &Generated) -> f64 {
    let motion = &clip.motion;
    let lowest =
        motion.iter().map(|pose| pose.iter().map(|joint: &Vec3| joint.y).fold(f32::INFINITY, f32::min));
    let count = motion.len().max(1) as f64;
    let away = lowest.map(|low| f64::from(low.abs())).sum::<f64>() / count;
    let jerks = jerk(motion);
    let jerks = jerks.iter().sum::<f64>() / jerks.len().max(1) as f64;
    f64::from(clip.error) + 0.3 * skating(motion).ratio + 0.2 * away + 0.5 * jerks
}
