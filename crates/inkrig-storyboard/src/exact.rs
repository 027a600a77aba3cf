//! After sampling, a motion is moved until drawn ways and poses are met: by least change, with bones as long as they are, feet
//! that stand where they stand, and smoothly.
//!
//! What is moved are the root's place, the turns of pelvis and chest, and the directions of all other bones, so bone lengths hold
//! whatever happens. All frames are solved at once: the change of each bone, and how it goes on over frames, against goals that weigh
//! more from round to round (the penalty method, Nocedal and Wright 2006, section 17.1), each round by damped Gauss-Newton steps.

mod asked;
mod band;
mod body;
mod constraints;
mod costs;
mod mass;
mod proportion;
mod stands;

pub use asked::{Asked, Goal, Source};
pub use constraints::{Constraint, Cuboid, Rule};
pub use proportion::{Proportioned, proportion};

use band::Band;
use body::{Body, FREEDOMS, Stance, places, single};
use costs::{Costs, Listener, REACH, Sum};
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{JOINTS, Joints};
use inkrig_motion::{Clip, kinematics};

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
/// A place in space counts as so many: it pulls a single frame against all around.
const ALONE: f64 = 100.0;
/// Steps of a round.
const STEPS: usize = 16;
/// A round is done when a step makes less of the costs, as a share.
const LITTLE: f64 = 3e-4;
/// Damping of the first step, how it changes with success, and when there is no hope left.
const DAMPING: f64 = 1e-4;
const CALMER: f64 = 10.0;
const HOPELESS: f64 = 1e6;

/// Moves a clip of the model's skeleton to its goals. `standing`: whether the left and the right foot stand, for each frame.
///
/// A clip of another skeleton stays as it is, as its misses say.
pub fn meet(clip: &Clip, goals: &[Goal], standing: &[[bool; 2]], options: &MeetOptions) -> Met {
    meet_all(clip, &Asked { goals, ..Asked::default() }, standing, options)
}

/// The same with constraints, and frames that stay. What was put in space is met however little the drawing counts.
pub fn meet_all(clip: &Clip, asked: &Asked<'_>, standing: &[[bool; 2]], options: &MeetOptions) -> Met {
    let motion = joints_of(clip);
    let can_be = |goal: &&Goal| goal.frame < motion.len() && goal.joint < JOINTS;
    let goals: Vec<Goal> = asked.goals.iter().filter(can_be).copied().collect();
    let asked = Asked { goals: &goals, ..*asked };
    let before = misses(&motion, &goals);
    if (goals.is_empty() && asked.constraints.is_empty()) || clip.skeleton().len() != JOINTS {
        return Met { motion, before, after: before, steps: 0 };
    }
    let body = Body::of(clip);
    let mut stances = body.stances(clip);
    let mut costs = Costs::new(&body, &stances, &asked, standing);
    let mut band = Band::new(FREEDOMS * stances.len(), FREEDOMS * (REACH + 1) - 1);
    band.hold(asked.frozen, FREEDOMS);
    let shown = |stances: &[Stance]| -> Vec<Joints> {
        stances.iter().map(|stance| single(&places(&body.bones(stance)))).collect()
    };
    let edited = asked.edits().next().is_some();
    let exact = MeetOptions::default();
    let (most, tolerance) = if edited {
        (options.steps.max(exact.steps), options.tolerance.min(exact.tolerance))
    } else {
        (options.steps, options.tolerance)
    };
    let mut steps = 0;
    for weight in ROUNDS.into_iter().filter(|weight| edited || *weight <= options.weight) {
        (costs.goal, costs.edit) = (weight.min(options.weight), ALONE * weight);
        steps += settle(&costs, &mut stances, &mut band, STEPS.min(most - steps));
        let now = shown(&stances);
        let met = asked.worst(&now, standing, weight <= options.weight) < tolerance;
        if steps >= most || met {
            break;
        }
    }
    let motion = shown(&stances);
    let after = misses(&motion, &goals);
    Met { motion, before, after, steps }
}

/// Where the centre of mass of a body is, by the usual shares of its segments.
pub fn centre_of_mass(pose: &Joints) -> Vec3 {
    mass::centre_of_mass(&body::doubled(pose)).0.as_vec3()
}

/// A clip's joints as [`meet`] has them where it moves nothing, to the bit.
pub(crate) fn as_it_is(clip: &Clip) -> Vec<Joints> {
    let body = Body::of(clip);
    body.stances(clip).iter().map(|stance| single(&places(&body.bones(stance)))).collect()
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
