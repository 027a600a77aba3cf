//! A body in variables that cannot change the length of a bone, and the way back for gradients.

use inkrig_motion::glam::{DQuat, DVec3, Vec3};
use inkrig_motion::humanml::{JOINTS, Joints, PARENTS};
use inkrig_motion::{Clip, kinematics::Pose};

/// Joints whose children are rigid with them: pelvis and chest.
const HUBS: [usize; 2] = [0, 9];
/// Numbers of a frame: the root's place, two turns of four numbers, and the directions of 15 bones.
pub(super) const WIDTH: usize = 3 + 4 * HUBS.len() + 3 * FREE.len();
/// Joints whose bones point anywhere.
const FREE: [usize; 15] = [4, 5, 6, 7, 8, 9, 10, 11, 15, 16, 17, 18, 19, 20, 21];

/// What variables mean for the joints of a skeleton.
#[derive(Debug, Clone)]
pub(super) struct Variables {
    /// The bone that ends at each joint, at rest.
    rest: [DVec3; JOINTS],
}

impl Variables {
    pub(super) fn of(clip: &Clip) -> Self {
        let joints = clip.skeleton().joints();
        Self {
            rest: std::array::from_fn(|joint| {
                joints.get(joint).map_or(DVec3::ZERO, |joint| joint.offset.as_dvec3())
            }),
        }
    }

    /// The variables of a clip.
    pub(super) fn start(&self, clip: &Clip) -> Vec<f32> {
        let mut pose = Pose::new(clip.skeleton());
        let mut x = Vec::with_capacity(clip.frames() * WIDTH);
        for frame in 0..clip.frames() {
            pose.set(clip, frame);
            x.extend(pose.positions[0].to_array());
            for hub in HUBS {
                let turn = pose.rotations[hub];
                x.extend([turn.w, turn.x, turn.y, turn.z]);
            }
            for joint in FREE {
                let bone: Vec3 = pose.positions[joint] - pose.positions[PARENTS[joint]];
                x.extend(bone.normalize_or(Vec3::Y).to_array());
            }
        }
        x
    }

    /// Where the joints are.
    pub(super) fn joints(&self, x: &[f32]) -> Vec<Joints> {
        x.chunks_exact(WIDTH).map(|x| self.pose(x).map(single)).collect()
    }

    /// The joints of one frame.
    pub(super) fn pose(&self, x: &[f32]) -> [DVec3; JOINTS] {
        let mut pose = [vector(x, 0); JOINTS];
        for joint in 1..JOINTS {
            let bone = match hub(joint) {
                Some(hub) => turn(x, hub) * self.rest[joint],
                None => {
                    let way = vector(x, place(joint));
                    way * (self.rest[joint].length() / way.length().max(1e-9))
                }
            };
            pose[joint] = pose[PARENTS[joint]] + bone;
        }
        pose
    }

    /// Adds the gradient with respect to the variables of a frame, for one with respect to the joints, which is used up.
    pub(super) fn gradient(&self, x: &[f32], of: &mut [DVec3; JOINTS], out: &mut [f32]) {
        for joint in (1..JOINTS).rev() {
            let force = of[joint];
            of[PARENTS[joint]] += force;
            match hub(joint) {
                Some(hub) => {
                    let by = by_turn(x, hub, self.rest[joint], force);
                    add(out, 3 + 4 * hub, &by);
                }
                None => {
                    let at = place(joint);
                    let way = vector(x, at);
                    let length = way.length().max(1e-9);
                    let along = way / length;
                    let by = (force - along * along.dot(force)) * (self.rest[joint].length() / length);
                    add(out, at, &by.to_array());
                }
            }
        }
        add(out, 0, &of[0].to_array());
    }
}

fn single(place: DVec3) -> Vec3 {
    place.as_vec3()
}

/// Which hub a joint is rigid with.
fn hub(joint: usize) -> Option<usize> {
    match joint {
        1..=3 => Some(0),
        12..=14 => Some(1),
        _ => None,
    }
}

/// Where a free bone's direction stands.
fn place(joint: usize) -> usize {
    let before = FREE.iter().position(|free| *free == joint).unwrap_or(0);
    3 + 4 * HUBS.len() + 3 * before
}

fn vector(x: &[f32], at: usize) -> DVec3 {
    match x.get(at..at + 3) {
        Some([x, y, z]) => DVec3::new(f64::from(*x), f64::from(*y), f64::from(*z)),
        _ => DVec3::ZERO,
    }
}

/// The four numbers of a hub's turn, of any length.
fn numbers(x: &[f32], hub: usize) -> [f64; 4] {
    match x.get(3 + 4 * hub..7 + 4 * hub) {
        Some([w, x, y, z]) => [*w, *x, *y, *z].map(f64::from),
        _ => [1.0, 0.0, 0.0, 0.0],
    }
}

fn turn(x: &[f32], hub: usize) -> DQuat {
    let [w, x, y, z] = numbers(x, hub);
    let turn = DQuat::from_xyzw(x, y, z, w);
    if turn.length_squared() > 0.0 { turn.normalize() } else { DQuat::IDENTITY }
}

/// How `force . (q v q* / |q|^2)` changes with the four numbers of q.
fn by_turn(x: &[f32], hub: usize, v: DVec3, force: DVec3) -> [f64; 4] {
    let [w, ux, uy, uz] = numbers(x, hub);
    let u = DVec3::new(ux, uy, uz);
    let square = (w * w + u.length_squared()).max(1e-12);
    let turned = (w * w - u.length_squared()) * v + 2.0 * u.dot(v) * u + 2.0 * w * u.cross(v);
    let value = force.dot(turned) / square;
    let by_w = 2.0 * w * force.dot(v) + 2.0 * force.dot(u.cross(v));
    let by_u =
        -2.0 * u * force.dot(v) + 2.0 * (u.dot(v) * force + force.dot(u) * v) + 2.0 * w * v.cross(force);
    let by_u = (by_u - 2.0 * value * u) / square;
    [(by_w - 2.0 * value * w) / square, by_u.x, by_u.y, by_u.z]
}

fn add(out: &mut [f32], at: usize, by: &[f64]) {
    for (out, by) in out.iter_mut().skip(at).zip(by) {
        *out += *by as f32;
    }
}
