//! What holds between joints and the world around: residuals of it, and how they change with places of joints.

use super::body::{Places, doubled};
use super::costs::{ABOVE, FEET};
use super::mass::centre_of_mass;
use inkrig_motion::glam::{DQuat, DVec2, DVec3, Quat, Vec3};
use inkrig_motion::humanml::Joints;
use std::ops::Range;

/// A foot is that wide on each side of the line from ankle to toe, and the centre of mass stays that far from its edge, metres.
const FOOT: f64 = 0.045;
const MARGIN: f64 = 0.01;
/// A box whose lower side is below this stands on the floor, metres.
const LOW: f32 = 0.05;

/// Someone who is told what is missed, metres, and how that changes with places of joints.
pub(super) type Tell<'a> = &'a mut dyn FnMut(f64, &[(usize, DVec3)]);

/// Something that holds over frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    /// Frames in which it holds.
    pub frames: Range<usize>,
    /// What.
    pub rule: Rule,
}

/// What holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Rule {
    /// Two joints are that far apart, metres; not asked for while it is not known how far.
    Distance([usize; 2], Option<f32>),
    /// A joint is on a plane: its normal of length 1, and how far from the origin it is along that, metres.
    Plane(usize, Vec3, f32),
    /// A joint is on the surface of a box, and no joint is in it.
    Box(usize, Cuboid),
    /// The centre of mass is over the feet that stand.
    Balance,
}

/// A box that may be turned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cuboid {
    /// Its middle.
    pub middle: Vec3,
    /// Half of its size.
    pub half: Vec3,
    /// How it is turned about its middle.
    pub turn: Quat,
}

impl Cuboid {
    /// By two corners that are across.
    pub fn between(from: Vec3, to: Vec3) -> Self {
        Self { middle: 0.5 * (from + to), half: 0.5 * (to - from).abs(), turn: Quat::IDENTITY }
    }

    /// How far outside a place is, less than 0 inside, and the direction in which that grows.
    fn distance(&self, place: DVec3) -> (f64, DVec3) {
        let turn: DQuat = self.turn.as_dquat();
        let local = turn.inverse() * (place - self.middle.as_dvec3());
        let mut over = local.abs() - self.half.as_dvec3();
        // Nobody comes to the underside of what stands on the floor.
        let stands = self.middle.y - self.half.y < LOW;
        if stands {
            over.y = local.y - f64::from(self.half.y);
        }
        let side = |axis: usize| if local[axis] < 0.0 && !(stands && axis == 1) { -1.0 } else { 1.0 };
        let outside = over.max(DVec3::ZERO);
        let far = outside.length();
        if far > 0.0 {
            let way = DVec3::from_array([0, 1, 2].map(|axis| side(axis) * outside[axis] / far));
            return (far, turn * way);
        }
        let axis = [0, 1, 2].into_iter().max_by(|a, b| over[*a].total_cmp(&over[*b])).unwrap_or(1);
        (over[axis], turn * (side(axis) * DVec3::AXES[axis]))
    }
}

impl Constraint {
    /// In a motion that its clip was turned and shifted into, at this frame.
    pub fn placed(&self, start: usize, (turn, shift): (Quat, Vec3)) -> Self {
        let rule = match &self.rule {
            Rule::Plane(joint, normal, along) => {
                let normal = turn * *normal;
                Rule::Plane(*joint, normal, along + normal.dot(shift))
            }
            Rule::Box(joint, cuboid) => {
                let middle = turn * cuboid.middle + shift;
                Rule::Box(*joint, Cuboid { middle, turn: turn * cuboid.turn, ..*cuboid })
            }
            other => other.clone(),
        };
        Self { frames: self.frames.start + start..self.frames.end + start, rule }
    }

    /// The same, a distance that is not known being that of a pose.
    pub fn measured(&self, pose: &Joints) -> Self {
        match self.rule {
            Rule::Distance([a, b], None) => {
                let rule = Rule::Distance([a, b], Some(pose[a].distance(pose[b])));
                Self { rule, ..self.clone() }
            }
            _ => self.clone(),
        }
    }

    /// The largest miss, metres, and its frame; `None` where nothing is asked for. `standing`: whether the left and the right foot stand.
    pub fn miss(&self, motion: &[Joints], standing: &[[bool; 2]]) -> Option<(f32, usize)> {
        let mut worst = None;
        for frame in self.frames.clone() {
            let Some(pose) = motion.get(frame) else { break };
            let stands = standing.get(frame).copied().unwrap_or_default();
            let mut off = 0.0_f64;
            self.rule.residuals(&doubled(pose), stands, &mut |residual, _| off = off.max(residual.abs()));
            if worst.is_none_or(|(most, _)| off as f32 > most) {
                worst = Some((off as f32, frame));
            }
        }
        worst
    }
}

impl Rule {
    /// The joint that it puts on something.
    pub(super) fn on(&self) -> Option<usize> {
        match self {
            Self::Plane(joint, ..) | Self::Box(joint, _) => Some(*joint),
            Self::Distance(..) | Self::Balance => None,
        }
    }

    /// Tells of what is missed, metres, and how that changes with places of joints.
    pub(super) fn residuals(&self, pose: &Places, standing: [bool; 2], tell: Tell<'_>) {
        match self {
            Self::Distance(_, None) => {}
            Self::Distance([a, b], Some(metres)) => {
                let between = pose[*a] - pose[*b];
                let way = between.normalize_or(DVec3::X);
                tell(between.length() - f64::from(*metres), &[(*a, way), (*b, -way)]);
            }
            Self::Plane(joint, normal, along) => {
                let normal = normal.as_dvec3();
                tell(normal.dot(pose[*joint]) - f64::from(*along), &[(*joint, normal)]);
            }
            Self::Box(joint, cuboid) => {
                let (off, way) = cuboid.distance(pose[*joint]);
                tell(off, &[(*joint, way)]);
                for other in ABOVE.into_iter().map(|(other, _)| other).filter(|other| other != joint) {
                    let (off, way) = cuboid.distance(pose[other]);
                    if off < 0.0 {
                        tell(off, &[(other, way)]);
                    }
                }
            }
            Self::Balance => balance(pose, standing, tell),
        }
    }
}

/// How far the centre of mass is from being over what the feet stand on.
fn balance(pose: &Places, standing: [bool; 2], tell: Tell<'_>) {
    let flat = |place: DVec3| DVec2::new(place.x, place.z);
    let (centre, shares) = centre_of_mass(pose);
    let centre = flat(centre);
    let feet = FEET.into_iter().zip(standing).filter(|(_, stands)| *stands).flat_map(|(foot, _)| foot);
    let feet: Vec<(usize, DVec2)> = feet.map(|joint| (joint, flat(pose[joint]))).collect();
    if over_one_of_its_triangles(centre, &feet) {
        return;
    }
    // Outside of a convex hull, its nearest place is on a line between two of its corners.
    let mut nearest: Option<(DVec2, [(usize, f64); 2])> = None;
    for (number, (a, from)) in feet.iter().enumerate() {
        for (b, to) in feet.iter().skip(number + 1) {
            let line = *to - *from;
            let part = ((centre - *from).dot(line) / line.length_squared().max(1e-12)).clamp(0.0, 1.0);
            let off = centre - from.lerp(*to, part);
            if nearest.is_none_or(|(other, _)| off.length() < other.length()) {
                nearest = Some((off, [(*a, 1.0 - part), (*b, part)]));
            }
        }
    }
    if let Some((off, ends)) = nearest
        && off.length() > FOOT - MARGIN
    {
        let way = off.normalize_or(DVec2::X);
        let way = DVec3::new(way.x, 0.0, way.y);
        let mut by: Vec<(usize, DVec3)> = shares.map(|(joint, share)| (joint, share * way)).collect();
        by.extend(ends.map(|(joint, part)| (joint, -part * way)));
        tell(off.length() - (FOOT - MARGIN), &by);
    }
}

fn over_one_of_its_triangles(place: DVec2, corners: &[(usize, DVec2)]) -> bool {
    let side = |a: DVec2, b: DVec2| (b - a).perp_dot(place - a);
    let inside = |a: DVec2, b: DVec2, c: DVec2| {
        let sides = [side(a, b), side(b, c), side(c, a)];
        sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0)
    };
    let corner = |at: usize| corners.get(at).map(|(_, place)| *place);
    [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]].into_iter().any(|[a, b, c]| {
        matches!((corner(a), corner(b), corner(c)), (Some(a), Some(b), Some(c)) if inside(a, b, c))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::joints_of;
    use crate::exact::tests::standing;
    use inkrig_motion::humanml::JOINTS;

    /// Poses around one, each joint by up to 20 cm.
    fn shaken(number: usize) -> Places {
        let mut pose = doubled(&joints_of(&standing(1))[0]);
        for (joint, place) in pose.iter_mut().enumerate() {
            let by = |axis: f64| 0.2 * (1.3 * joint as f64 + 2.1 * axis + 0.7 * number as f64).sin();
            *place += DVec3::new(by(0.0), by(1.0), by(2.0));
        }
        pose
    }

    #[test]
    fn residuals_change_as_is_said() {
        let cuboid = Cuboid {
            middle: Vec3::new(0.2, 0.4, 0.1),
            half: Vec3::new(0.3, 0.5, 0.4),
            turn: Quat::from_rotation_y(0.4),
        };
        let rules = [
            Rule::Distance([20, 11], Some(0.4)),
            Rule::Plane(21, Vec3::new(0.6, 0.0, 0.8), 0.3),
            Rule::Box(20, cuboid),
            Rule::Box(20, Cuboid { middle: Vec3::new(0.2, 0.9, 0.1), ..cuboid }),
            Rule::Balance,
        ];
        let told = |rule: &Rule, pose: &Places, stands: [bool; 2]| {
            let mut all: Vec<(f64, [DVec3; JOINTS])> = Vec::new();
            rule.residuals(pose, stands, &mut |residual, by| {
                let mut sums = [DVec3::ZERO; JOINTS];
                by.iter().for_each(|(joint, way)| sums[*joint] += *way);
                all.push((residual, sums));
            });
            all
        };
        for rule in &rules {
            let mut count = 0;
            for (number, stands) in
                (0..24).zip([[true, true], [false, true], [true, false]].into_iter().cycle())
            {
                let pose = shaken(number);
                let here = told(rule, &pose, stands);
                count += here.len();
                for (joint, axis) in (0..JOINTS).flat_map(|joint| (0..3).map(move |axis| (joint, axis))) {
                    let moved = |by: f64| {
                        let mut pose = pose;
                        pose[joint][axis] += by;
                        told(rule, &pose, stands)
                    };
                    let (more, less) = (moved(1e-6), moved(-1e-6));
                    assert!(
                        more.len() == here.len() && less.len() == here.len(),
                        "a kink: take another pose"
                    );
                    for ((own, more), less) in here.iter().zip(&more).zip(&less) {
                        let slope = (more.0 - less.0) / 2e-6;
                        assert!(
                            (slope - own.1[joint][axis]).abs() < 1e-6,
                            "{rule:?}: {slope} {}",
                            own.1[joint][axis]
                        );
                    }
                }
            }
            assert!(count > 10, "{rule:?} told {count} times");
        }
    }

    #[test]
    fn who_stands_upright_is_balanced_and_who_leans_is_not() {
        let pose = doubled(&joints_of(&standing(1))[0]);
        let off = |pose: &Places, stands: [bool; 2]| {
            let mut most = 0.0_f64;
            Rule::Balance.residuals(pose, stands, &mut |residual, _| most = most.max(residual));
            most
        };
        assert_eq!(off(&pose, [true; 2]), 0.0);
        assert_eq!(off(&pose, [false; 2]), 0.0, "in the air there is nothing to stand on");
        // On one foot the body has to come over by some 6 cm: feet are 20 cm apart.
        assert!((0.04..0.08).contains(&off(&pose, [true, false])), "{}", off(&pose, [true, false]));
        let mut leaning = pose;
        leaning.iter_mut().filter(|place| place.y > 0.5).for_each(|place| place.z += 0.4);
        assert!((0.15..0.3).contains(&off(&leaning, [true; 2])), "{}", off(&leaning, [true; 2]));
    }

    #[test]
    fn rules_go_along_with_their_clip() {
        let place = (Quat::from_rotation_y(1.1), Vec3::new(2.0, 0.0, -3.0));
        let motion = joints_of(&standing(4));
        let moved: Vec<Joints> = motion.iter().map(|pose| pose.map(|at| place.0 * at + place.1)).collect();
        let cuboid = Cuboid::between(Vec3::new(0.1, 0.0, -0.3), Vec3::new(0.9, 0.8, 0.5));
        for rule in [
            Rule::Plane(20, Vec3::new(0.6, 0.0, 0.8), 0.3),
            Rule::Box(21, cuboid),
            Rule::Distance([20, 21], Some(0.1)),
        ] {
            let own = Constraint { frames: 1..3, rule };
            let (a, at) = own.miss(&motion, &[]).unwrap();
            let (b, also) = own.placed(0, place).miss(&moved, &[]).unwrap();
            assert!((a - b).abs() < 1e-5 && at == also && a > 0.01, "{own:?}: {a} {b}");
        }
        let late = Constraint { frames: 2..9, rule: Rule::Balance };
        assert_eq!(late.placed(10, place).frames, 12..19);
        assert_eq!(late.placed(10, place).miss(&motion, &[]), None);
    }
}
