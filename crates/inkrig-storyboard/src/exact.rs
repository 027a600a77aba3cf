//! After sampling, a motion is moved until drawn ways and poses are met: by least change, with bones as long as they are, feet
//! that stand where they stand, and smoothly.
//!
//! What is moved are the root's place, the turns of pelvis and chest, and the directions of all other bones, so bone lengths hold
//! whatever happens. All frames are solved at once: the change of each bone, and how it goes on over frames, against goals that weigh
//! more from round to round (the penalty method, Nocedal and Wright 2006, section 17.1), each round by damped Gauss-Newton steps.

mod band;
mod body;
mod costs;

use band::Band;
use body::{Body, FREEDOMS, Stance, places, single};
use costs::{Costs, Listener, REACH, Sum};
use inkrig_motion::glam::{Quat, Vec2, Vec3};
use inkrig_motion::humanml::{Camera, JOINTS, Joints};
use inkrig_motion::{Clip, kinematics};

/// What of a drawing a goal comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// A trajectory.
    Way,
    /// A joint that the user has placed.
    Pin,
    /// A joint that was read of the figure: it gives way to the others where a body cannot have all.
    Pose,
}

/// A joint's place on a picture, at a frame of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Frame of the motion.
    pub frame: usize,
    /// Joint, 0 to 21.
    pub joint: usize,
    /// The picture's axes in the motion's world.
    pub axes: [Vec3; 2],
    /// The place along them, metres.
    pub at: Vec2,
    /// What asks for it.
    pub source: Source,
}

impl Goal {
    /// A place on the picture of a clip that was turned and shifted into the motion.
    pub fn placed(
        frame: usize,
        joint: usize,
        at: Vec2,
        camera: &Camera,
        (turn, shift): (Quat, Vec3),
        source: Source,
    ) -> Self {
        let view = camera.view_from_world();
        let axes = [view.row(0), view.row(1)].map(|axis| turn * axis);
        let at = at + Vec2::new(axes[0].dot(shift), axes[1].dot(shift));
        Self { frame, joint, axes, at, source }
    }

    /// How far a place is from it on the picture.
    pub fn miss(&self, place: Vec3) -> Vec2 {
        Vec2::new(self.axes[0].dot(place), self.axes[1].dot(place)) - self.at
    }
}

/// When goals are met well enough.
#[derive(Debug, Clone, PartialEq)]
pub struct MeetOptions {
    /// The largest miss that is fine, metres.
    pub tolerance: f32,
    /// How much a squared miss weighs at most, against changes that weigh about 1.
    pub weight: f64,
    /// Steps at most, of all rounds.
    pub steps: usize,
}

impl Default for MeetOptions {
    /// Two millimetres.
    fn default() -> Self {
        Self { tolerance: 0.002, weight: 1e6, steps: 120 }
    }
}

impl MeetOptions {
    /// Near to the goals, where that costs little.
    pub fn soft() -> Self {
        Self { tolerance: 0.01, weight: 10.0, steps: 6 }
    }
}

/// A motion that meets its goals, as far as it can.
#[derive(Debug, Clone, PartialEq)]
pub struct Met {
    /// All joints.
    pub motion: Vec<Joints>,
    /// Mean and largest miss of goals, before and after, metres.
    pub before: [f32; 2],
    /// See `before`.
    pub after: [f32; 2],
    /// Steps that were taken.
    pub steps: usize,
}

/// How much goals weigh, from round to round.
const ROUNDS: [f64; 6] = [1e1, 1e2, 1e3, 1e4, 1e5, 1e6];
/// Steps of a round.
const STEPS: usize = 16;
/// A round is done when a step makes less of the costs, as a share.
const LITTLE: f64 = 3e-4;
/// Limbs of drawn poses are a little bent: a place that can just be reached is met slowly, and held by a knee that snaps.
const BENT: f64 = 0.985;
/// Damping of the first step, how it changes with success, and when there is no hope left.
const DAMPING: f64 = 1e-4;
const CALMER: f64 = 10.0;
const HOPELESS: f64 = 1e6;

/// Moves a clip of the model's skeleton to its goals. `standing`: whether the left and the right foot stand, for each frame.
///
/// A clip of another skeleton stays as it is, as its misses say.
pub fn meet(clip: &Clip, goals: &[Goal], standing: &[[bool; 2]], options: &MeetOptions) -> Met {
    let motion = joints_of(clip);
    let goals: Vec<Goal> =
        goals.iter().filter(|goal| goal.frame < motion.len() && goal.joint < JOINTS).copied().collect();
    let before = misses(&motion, &goals);
    if goals.is_empty() || clip.skeleton().len() != JOINTS {
        return Met { motion, before, after: before, steps: 0 };
    }
    let body = Body::of(clip);
    let mut stances = body.stances(clip);
    let mut costs = Costs::new(&body, &stances, &goals, standing);
    let mut band = Band::new(FREEDOMS * stances.len(), FREEDOMS * (REACH + 1) - 1);
    let shown = |stances: &[Stance]| -> Vec<Joints> {
        stances.iter().map(|stance| single(&places(&body.bones(stance)))).collect()
    };
    let mut steps = 0;
    for weight in ROUNDS.into_iter().filter(|weight| *weight <= options.weight) {
        costs.goal = weight;
        steps += settle(&costs, &mut stances, &mut band, STEPS.min(options.steps - steps));
        if steps >= options.steps || misses(&shown(&stances), &goals)[1] < options.tolerance {
            break;
        }
    }
    let motion = shown(&stances);
    let after = misses(&motion, &goals);
    Met { motion, before, after, steps }
}

/// Damped Gauss-Newton steps (Levenberg and Marquardt) until little comes of them; says how many were taken.
fn settle(costs: &Costs<'_>, stances: &mut Vec<Stance>, band: &mut Band, most: usize) -> usize {
    let cost = |stances: &[Stance]| {
        let mut sum = Sum::default();
        costs.tell(stances, &mut sum);
        sum.0
    };
    let (mut now, mut damping) = (cost(stances), DAMPING);
    for done in 0..most {
        band.clear();
        costs.tell(stances, band);
        loop {
            let moved: Option<Vec<Stance>> = band.step(damping).map(|step| {
                stances.iter().zip(step.chunks_exact(FREEDOMS)).map(|(own, step)| own.moved(step)).collect()
            });
            let better = moved.map(|moved| (cost(&moved), moved)).filter(|(next, _)| *next < now);
            if let Some((next, moved)) = better {
                let little = now - next < LITTLE * now;
                (now, *stances) = (next, moved);
                damping = (damping / CALMER).max(1e-9);
                if little {
                    return done + 1;
                }
                break;
            }
            damping *= CALMER;
            if damping > HOPELESS {
                return done;
            }
        }
    }
    most
}

impl Listener for Band {
    fn row(&mut self, weight: f64, residual: f64, by: &[(usize, f64)]) {
        self.add(weight, residual, by);
    }
}

/// Moves goals of drawn poses to where a body with the bones of a clip can have them, as little as can be; others stay. Says how far
/// the farthest went, metres. A drawing has the proportions of nobody.
pub fn proportion(clip: &Clip, goals: &mut [Goal]) -> f32 {
    if clip.skeleton().len() != JOINTS {
        return 0.0;
    }
    let body = Body::of(clip).with_limbs(BENT);
    let stances = body.stances(clip);
    let mut farthest = 0.0_f32;
    for (frame, stance) in stances.iter().enumerate() {
        let at_frame = |goal: &&Goal| goal.frame == frame && goal.joint < JOINTS;
        let own: Vec<Goal> = goals.iter().filter(at_frame).map(|goal| Goal { frame: 0, ..*goal }).collect();
        if !own.iter().any(|goal| goal.source == Source::Pose) {
            continue;
        }
        let mut costs = Costs::new(&body, std::slice::from_ref(stance), &own, &[]);
        let mut fitted = vec![stance.clone()];
        let mut band = Band::new(FREEDOMS, FREEDOMS - 1);
        for weight in ROUNDS {
            costs.goal = weight;
            settle(&costs, &mut fitted, &mut band, 2 * STEPS);
        }
        let Some(pose) = fitted.first().map(|stance| single(&places(&body.bones(stance)))) else { continue };
        for goal in goals.iter_mut().filter(|goal| goal.frame == frame && goal.source == Source::Pose) {
            let miss = pose.get(goal.joint).map_or(Vec2::ZERO, |place| goal.miss(*place));
            goal.at += miss;
            farthest = farthest.max(miss.length());
        }
    }
    farthest
}

/// All joints of all frames.
pub(crate) fn joints_of(clip: &Clip) -> Vec<Joints> {
    let places = kinematics::positions(clip);
    (0..clip.frames()).filter_map(|frame| places.frame(frame).try_into().ok()).collect()
}

/// Mean and largest miss of goals.
pub fn misses(motion: &[Joints], goals: &[Goal]) -> [f32; 2] {
    let off: Vec<f32> = goals
        .iter()
        .filter_map(|goal| Some(goal.miss(motion.get(goal.frame)?[goal.joint]).length()))
        .collect();
    let mean = off.iter().sum::<f32>() / off.len().max(1) as f32;
    [mean, off.iter().copied().fold(0.0, f32::max)]
}

#[cfg(test)]
mod tests;
