//! What nobody can do is moved to where a body can: a drawing has the proportions of nobody, and two ways may part farther than a limb is
//! long.

use super::band::Band;
use super::body::{Body, FREEDOMS, Stance, places, single};
use super::costs::Costs;
use super::{ALONE, Asked, Goal, ROUNDS, STEPS, Source, settle};
use inkrig_motion::Clip;
use inkrig_motion::glam::Vec2;
use inkrig_motion::humanml::{JOINTS, Joints};

/// Limbs of drawn poses are a little bent: a place that can just be reached is met slowly, and held by a knee that snaps.
const BENT: f64 = 0.985;
/// A way that a body comes so near to is left as it was drawn, metres.
const REACHED: f32 = 0.001;
/// What joints of drawn poses weigh against others that stay: next to nothing, so that these are not drawn away.
const GIVES_WAY: f64 = 1e-3;

/// How far goals were moved at most, metres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Proportioned {
    /// Joints of drawn poses.
    pub poses: f32,
    /// Drawn ways.
    pub ways: f32,
}

/// Moves goals of drawn poses and ways to where a body with the bones of a clip can have them together, as little as can be. Pins and
/// places in space stay; ways come before poses.
pub fn proportion(clip: &Clip, goals: &mut [Goal]) -> Proportioned {
    let mut farthest = Proportioned::default();
    if clip.skeleton().len() != JOINTS {
        return farthest;
    }
    let body = Body::of(clip).with_limbs(BENT);
    let stances = body.stances(clip);
    let first = goals.iter().map(|goal| goal.frame).min().unwrap_or(0);
    let count = goals.iter().map(|goal| goal.frame + 1).max().unwrap_or(0).saturating_sub(first);
    for (frame, stance) in stances.iter().enumerate().skip(first).take(count) {
        // Ways first, for themselves: a pose is moved to where they leave it.
        for moves in [Source::Way, Source::Pose] {
            let counts = |goal: &&Goal| {
                goal.frame == frame
                    && goal.joint < JOINTS
                    && (moves == Source::Pose || goal.source != Source::Pose)
            };
            let own: Vec<Goal> = goals.iter().filter(counts).map(|goal| Goal { frame: 0, ..*goal }).collect();
            // What is alone can be met: the whole body may go there.
            if own.len() < 2 || own.iter().all(|goal| goal.source != moves) {
                continue;
            }
            let Some(pose) = fitted(&body, stance, &own) else { continue };
            let (most, left) = match moves {
                Source::Way => (&mut farthest.ways, REACHED),
                _ => (&mut farthest.poses, 0.0),
            };
            for goal in goals.iter_mut().filter(|goal| goal.frame == frame && goal.source == moves) {
                let miss = pose.get(goal.joint).map_or(Vec2::ZERO, |place| goal.miss(*place).truncate());
                if miss.length() > left {
                    goal.at += miss;
                    *most = most.max(miss.length());
                }
            }
        }
    }
    farthest
}

/// The pose that comes nearest to goals.
fn fitted(body: &Body, stance: &Stance, goals: &[Goal]) -> Option<Joints> {
    let asked = Asked { goals, ..Asked::default() };
    let mut costs = Costs::new(body, std::slice::from_ref(stance), &asked, &[]);
    costs.pose = GIVES_WAY;
    let mut fitted = vec![stance.clone()];
    let mut band = Band::new(FREEDOMS, FREEDOMS - 1);
    for weight in ROUNDS {
        (costs.goal, costs.edit) = (weight, ALONE * weight);
        settle(&costs, &mut fitted, &mut band, 2 * STEPS);
    }
    fitted.first().map(|stance| single(&places(&body.bones(stance))))
}
