//! What a change costs, as weighted squares of what is linear near by.

use super::body::{Body, FREEDOMS, Moves, Places, Stance, chain, places};
use super::stands::{Stand, stands};
use super::{Asked, Goal, Source};
use inkrig_motion::glam::DVec3;
use inkrig_motion::humanml::{JOINTS, PARENTS};

/// Weights of a bone's change, in squared metres, for each joint that goes along with it: of itself, and of its first, second and third
/// differences over frames. A motion stays as near, as quick and as smooth as it was.
const CHANGE: [f64; 4] = [0.05, 0.5, 100.0, 400.0];
/// How much less the whole body's place counts: it may go elsewhere.
const ROOT: f64 = 0.2;
/// Steps of a foot that stands, its height, and how far it is from where it stood.
const STAND: f64 = 2_000.0;
const HEIGHT: f64 = 500.0;
const STAY: f64 = 20.0;
/// Joints below the floor.
const FLOOR: f64 = 5_000.0;
/// What joints of a drawn pose weigh against other goals.
const POSE: f64 = 0.1;
/// Joints that do not go through the floor, and how high they are at least, metres.
pub(super) const ABOVE: [(usize, f64); 9] =
    [(4, 0.03), (5, 0.03), (7, 0.04), (8, 0.04), (10, 0.0), (11, 0.0), (15, 0.05), (20, 0.0), (21, 0.0)];
/// A foot that swings stays at least so high over the floor, or as high as it was, metres: else it slides.
const CLEAR: f64 = 0.06;
/// A foot on a drawn way that goes farther than this from frame to frame is lifted so high, if that costs little, metres.
const QUICK: f32 = 0.01;
const LIFT: f64 = 300.0;
/// Ankle and toe of each foot.
pub(super) const FEET: [[usize; 2]; 2] = [[7, 10], [8, 11]];
/// Neighbouring unknowns reach over this many frames.
pub(super) const REACH: usize = CHANGE.len() - 1;

/// Someone who is told of every weighted residual, and how it changes with the unknowns, in rising order.
pub(super) trait Listener {
    fn row(&mut self, weight: f64, residual: f64, by: &[(usize, f64)]);
}

/// Only the sum.
#[derive(Default)]
pub(super) struct Sum(pub(super) f64);

impl Listener for Sum {
    fn row(&mut self, weight: f64, residual: f64, _: &[(usize, f64)]) {
        self.0 += weight * residual * residual;
    }
}

/// What is changed, and what is asked for.
pub(super) struct Costs<'a> {
    body: &'a Body,
    bones: Vec<Places>,
    places: Vec<Places>,
    asked: &'a Asked<'a>,
    standing: &'a [[bool; 2]],
    /// What stands until the next frame.
    stands: Vec<Stand>,
    /// Whether each foot swings.
    swings: Vec<[bool; 2]>,
    /// Whether it is said where in space each joint is.
    held: Vec<[bool; JOINTS]>,
    /// Whether each foot goes along a drawn way.
    lifts: Vec<[bool; 2]>,
    weights: [f64; JOINTS],
    /// How much more each frame stays as it is.
    stays: Vec<f64>,
    /// Of goals and constraints.
    pub(super) goal: f64,
    /// What joints of drawn poses weigh against other goals.
    pub(super) pose: f64,
    /// Of places in space.
    pub(super) edit: f64,
}

impl<'a> Costs<'a> {
    pub(super) fn new(
        body: &'a Body,
        stances: &[Stance],
        asked: &'a Asked<'a>,
        standing: &'a [[bool; 2]],
    ) -> Self {
        let bones: Vec<Places> = stances.iter().map(|stance| body.bones(stance)).collect();
        let places: Vec<Places> = bones.iter().map(places).collect();
        let stands = stands(&places, standing, asked);
        let mut weights = [1.0; JOINTS];
        for joint in (1..JOINTS).rev() {
            weights[PARENTS[joint]] += weights[joint];
        }
        asked.stiffen(&mut weights);
        let swings = standing.iter().map(|stands| stands.map(|stands| !stands)).collect();
        let stays = asked.stays(stances.len());
        let (held, lifts) = (asked.held(places.len()), lifts(asked, places.len()));
        let (goal, pose, edit) = (1.0, POSE, 1.0);
        Self {
            body,
            bones,
            places,
            asked,
            standing,
            stands,
            swings,
            held,
            lifts,
            weights,
            stays,
            goal,
            pose,
            edit,
        }
    }

    /// Tells of all costs of a motion.
    pub(super) fn tell(&self, stances: &[Stance], to: &mut dyn Listener) {
        let bones: Vec<Places> = stances.iter().map(|stance| self.body.bones(stance)).collect();
        let moves: Vec<[Moves; JOINTS]> =
            stances.iter().zip(&bones).map(|(stance, bones)| self.body.moves(stance, bones)).collect();
        let now: Vec<Places> = bones.iter().map(places).collect();
        self.changes(&bones, &moves, to);
        let mut rows = Rows { moves: &moves, to, by: Vec::new() };
        for &Stand { frame, joint, elsewhere } in &self.stands {
            let (here, next) = (now[frame][joint], now[frame + 1][joint]);
            for axis in 0..3 {
                let way = DVec3::AXES[axis];
                rows.joints(STAND, (next - here)[axis], &[(frame, joint, -way), (frame + 1, joint, way)]);
                if elsewhere {
                    continue;
                }
                let off = (here - self.places[frame][joint])[axis];
                rows.joints(if axis == 1 { HEIGHT } else { STAY }, off, &[(frame, joint, way)]);
            }
        }
        for (frame, (own, before)) in now.iter().zip(&self.places).enumerate() {
            for (joint, floor) in ABOVE {
                if self.held[frame][joint] {
                    continue;
                }
                let of = |feet: &[[bool; 2]]| {
                    feet.get(frame)
                        .is_some_and(|feet| (0..2).any(|side| feet[side] && FEET[side][1] == joint))
                };
                let floor = if of(&self.swings) { CLEAR } else { floor };
                // What was below the floor before is not this step's to lift.
                let floors = [(FLOOR, floor.min(before[joint].y)), (LIFT, CLEAR)];
                for (weight, floor) in floors.into_iter().take(1 + usize::from(of(&self.lifts))) {
                    let low = own[joint].y - floor;
                    if low < 0.0 {
                        rows.joints(weight, low, &[(frame, joint, DVec3::Y)]);
                    }
                }
            }
        }
        for goal in self.asked.goals {
            let place = now[goal.frame][goal.joint];
            let weight = match goal.source {
                Source::Pose => self.pose * self.goal,
                Source::Edit => self.edit,
                Source::Way | Source::Path | Source::Pin => self.goal,
            };
            for (axis, at) in goal.measured() {
                let axis = axis.as_dvec3();
                rows.joints(weight, axis.dot(place) - f64::from(at), &[(goal.frame, goal.joint, axis)]);
            }
        }
        for constraint in self.asked.constraints {
            for frame in constraint.frames.clone() {
                let Some(pose) = now.get(frame) else { break };
                let stands = self.standing.get(frame).copied().unwrap_or_default();
                constraint.rule.residuals(pose, stands, &mut |residual, by| {
                    let by: Vec<(usize, usize, DVec3)> =
                        by.iter().map(|(joint, way)| (frame, *joint, *way)).collect();
                    rows.joints(self.goal, residual, &by);
                });
            }
        }
    }

    /// Of bones: how they change, and how their changes go on over frames.
    fn changes(&self, bones: &[Places], moves: &[[Moves; JOINTS]], to: &mut dyn Listener) {
        const DIFFERENCES: [&[f64]; 4] = [&[1.0], &[-1.0, 1.0], &[1.0, -2.0, 1.0], &[-1.0, 3.0, -3.0, 1.0]];
        let mut by = Vec::new();
        for joint in 0..JOINTS {
            let changes: Vec<DVec3> =
                bones.iter().zip(&self.bones).map(|(own, before)| own[joint] - before[joint]).collect();
            for (order, factors) in DIFFERENCES.into_iter().enumerate() {
                let root = if joint == 0 && order == 0 { ROOT } else { 1.0 };
                let weight = root * CHANGE[order] * self.weights[joint];
                for (first, window) in changes.windows(factors.len()).enumerate() {
                    let difference: DVec3 =
                        window.iter().zip(factors).map(|(change, factor)| *factor * *change).sum();
                    for axis in 0..3 {
                        by.clear();
                        for (number, factor) in factors.iter().enumerate() {
                            let frame = first + number;
                            let each = moves[frame][joint].each();
                            by.extend(each.map(|(at, by)| (FREEDOMS * frame + at, factor * by[axis])));
                        }
                        let stays = if order == 0 { self.stays[first] } else { 1.0 };
                        to.row(stays * weight, difference[axis], &by);
                    }
                }
            }
        }
    }
}

/// Whether each foot goes along a drawn way, for each frame: one that stays low would slide.
fn lifts(asked: &Asked<'_>, frames: usize) -> Vec<[bool; 2]> {
    let way = |frame: usize, foot: [usize; 2]| {
        let own =
            |goal: &&Goal| goal.frame == frame && goal.source == Source::Way && foot.contains(&goal.joint);
        asked.goals.iter().find(own)
    };
    let goes = |frame: usize, foot: [usize; 2]| match (way(frame, foot), way(frame + 1, foot)) {
        (Some(here), Some(next)) => here.joint == next.joint && here.at.distance(next.at) > QUICK,
        _ => false,
    };
    let either =
        |frame: usize, foot| goes(frame, foot) || frame.checked_sub(1).is_some_and(|last| goes(last, foot));
    (0..frames).map(|frame| FEET.map(|foot| either(frame, foot))).collect()
}

/// Residuals of places of joints.
struct Rows<'a> {
    moves: &'a [[Moves; JOINTS]],
    to: &'a mut dyn Listener,
    by: Vec<(usize, f64)>,
}

impl Rows<'_> {
    /// A residual that goes with places of joints along axes.
    fn joints(&mut self, weight: f64, residual: f64, of: &[(usize, usize, DVec3)]) {
        self.by.clear();
        for &(frame, joint, way) in of {
            for above in chain(joint) {
                let each = self.moves[frame][above].each();
                self.by.extend(each.map(|(at, by)| (FREEDOMS * frame + at, way.dot(by))));
            }
        }
        self.by.sort_unstable_by_key(|(at, _)| *at);
        // Joints of one frame have joints above them in common.
        self.by.dedup_by(|next, before| {
            let same = next.0 == before.0;
            before.1 += if same { next.1 } else { 0.0 };
            same
        });
        self.to.row(weight, residual, &self.by);
    }
}
