//! A body whose bones keep their lengths, and how its joints move with what may change.

use inkrig_motion::glam::{DQuat, DVec3, Vec3};
use inkrig_motion::humanml::{JOINTS, Joints, PARENTS};
use inkrig_motion::{Clip, kinematics::Pose};

/// Places or bones of all joints.
pub(super) type Places = [DVec3; JOINTS];

/// Joints whose children are rigid with them: pelvis and chest.
const HUBS: [usize; 2] = [0, 9];
/// Joints whose bones point anywhere.
const FREE: [usize; 15] = [4, 5, 6, 7, 8, 9, 10, 11, 15, 16, 17, 18, 19, 20, 21];
/// What may change in a frame: the root's place, two turns, and the directions of bones, two numbers each.
pub(super) const FREEDOMS: usize = 3 + 3 * HUBS.len() + 2 * FREE.len();

/// The bones at rest.
#[derive(Debug, Clone)]
pub(super) struct Body {
    rest: Places,
}

/// How a body stands in a frame.
#[derive(Debug, Clone)]
pub(super) struct Stance {
    root: DVec3,
    turns: [DQuat; HUBS.len()],
    ways: [DVec3; FREE.len()],
}

/// How a bone, or the root's place, changes with the freedoms from `first` on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moves {
    first: usize,
    count: usize,
    by: [DVec3; 3],
}

impl Moves {
    pub(super) fn each(&self) -> impl Iterator<Item = (usize, DVec3)> + '_ {
        self.by.iter().take(self.count).enumerate().map(|(number, by)| (self.first + number, *by))
    }
}

impl Body {
    pub(super) fn of(clip: &Clip) -> Self {
        let joints = clip.skeleton().joints();
        Self {
            rest: std::array::from_fn(|joint| {
                joints.get(joint).map_or(DVec3::ZERO, |joint| joint.offset.as_dvec3())
            }),
        }
    }

    /// The same with limbs of another length, as a share of theirs.
    pub(super) fn with_limbs(mut self, share: f64) -> Self {
        [4, 5, 7, 8, 18, 19, 20, 21].into_iter().for_each(|joint: usize| self.rest[joint] *= share);
        self
    }

    /// How it stands in every frame of a clip.
    pub(super) fn stances(&self, clip: &Clip) -> Vec<Stance> {
        let mut pose = Pose::new(clip.skeleton());
        let stance = |frame| {
            pose.set(clip, frame);
            let way = |joint: usize| {
                let bone: Vec3 = pose.positions[joint] - pose.positions[PARENTS[joint]];
                bone.as_dvec3().normalize_or(DVec3::Y)
            };
            Stance {
                root: pose.positions[0].as_dvec3(),
                turns: HUBS.map(|hub| pose.rotations[hub].as_dquat().normalize()),
                ways: FREE.map(way),
            }
        };
        (0..clip.frames()).map(stance).collect()
    }

    /// The bone that ends at each joint; at 0 the root's place.
    pub(super) fn bones(&self, stance: &Stance) -> Places {
        let mut bones = [stance.root; JOINTS];
        for (joint, bone) in bones.iter_mut().enumerate().skip(1) {
            *bone = match place(joint) {
                Place::Rigid(hub) => stance.turns[hub] * self.rest[joint],
                Place::Free(at) => stance.ways[at] * self.rest[joint].length(),
            };
        }
        bones
    }

    /// How each of them changes.
    pub(super) fn moves(&self, stance: &Stance, bones: &Places) -> [Moves; JOINTS] {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let mut moves = [Moves { first: 0, count: 3, by: axes }; JOINTS];
        for joint in 1..JOINTS {
            moves[joint] = match place(joint) {
                Place::Rigid(hub) => {
                    Moves { first: 3 + 3 * hub, count: 3, by: axes.map(|axis| axis.cross(bones[joint])) }
                }
                Place::Free(at) => {
                    let length = self.rest[joint].length();
                    let (a, b) = stance.ways[at].any_orthonormal_pair();
                    let first = 3 + 3 * HUBS.len() + 2 * at;
                    Moves { first, count: 2, by: [length * a, length * b, DVec3::ZERO] }
                }
            };
        }
        moves
    }
}

impl Stance {
    /// After a step of [`FREEDOMS`] numbers.
    pub(super) fn moved(&self, step: &[f64]) -> Self {
        if step.iter().all(|step| *step == 0.0) {
            return self.clone();
        }
        let vector = |at: usize| match step.get(at..at + 3) {
            Some([x, y, z]) => DVec3::new(*x, *y, *z),
            _ => DVec3::ZERO,
        };
        let turn = |hub: usize| (DQuat::from_scaled_axis(vector(3 + 3 * hub)) * self.turns[hub]).normalize();
        let way = |at: usize| {
            let (a, b) = self.ways[at].any_orthonormal_pair();
            let first = 3 + 3 * HUBS.len() + 2 * at;
            let along = |number: usize| step.get(first + number).copied().unwrap_or(0.0);
            (self.ways[at] + a * along(0) + b * along(1)).normalize()
        };
        Self { root: self.root + vector(0), turns: std::array::from_fn(turn), ways: std::array::from_fn(way) }
    }
}

/// Where joints are, from bones.
pub(super) fn places(bones: &Places) -> Places {
    let mut places = *bones;
    for joint in 1..JOINTS {
        places[joint] = places[PARENTS[joint]] + bones[joint];
    }
    places
}

pub(super) fn single(places: &Places) -> Joints {
    places.map(DVec3::as_vec3)
}

pub(super) fn doubled(places: &Joints) -> Places {
    places.map(Vec3::as_dvec3)
}

/// A joint and those above it, the root last.
pub(super) fn chain(joint: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(joint), |joint| (*joint > 0).then(|| PARENTS[*joint]))
}

enum Place {
    Rigid(usize),
    Free(usize),
}

fn place(joint: usize) -> Place {
    match joint {
        1..=3 => Place::Rigid(0),
        12..=14 => Place::Rigid(1),
        _ => Place::Free(FREE.iter().position(|free| *free == joint).unwrap_or(0)),
    }
}
