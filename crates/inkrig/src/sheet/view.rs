//! The poses of a sheet as the camera sees them.

use super::SheetOptions;
use crate::preview::track::{ground, usable};
use inkrig_motion::{
    Clip,
    capsules::Body,
    glam::{Quat, Vec2, Vec3},
    kinematics::Pose,
};

/// The most joints that are drawn.
const MOST_JOINTS: usize = 512;

/// All poses in view space: x to the right, y up, z towards the camera, metres. In each the character stands over
/// the origin.
#[derive(Debug, Clone)]
pub(super) struct Scene {
    pub(super) body: Body,
    pub(super) poses: Vec<View>,
    /// Bounding box of all poses in the picture plane, metres.
    pub(super) low: Vec2,
    pub(super) high: Vec2,
    /// Drawn pale, as what is compared with.
    pub(super) pale: bool,
}

/// One pose as the camera sees it.
#[derive(Debug, Clone)]
pub(super) struct View {
    pub(super) seconds: f64,
    /// How far the pose is through the clip, 0 to 1.
    pub(super) progress: f64,
    pub(super) joints: Vec<Vec3>,
    /// The joints' shadows on the ground, under a light from above.
    pub(super) shadows: Vec<Vec3>,
    /// Corners of an arrow on the ground ahead of the character, the tip first; when names tell where it faces.
    pub(super) heading: Option<[Vec3; 3]>,
}

impl Scene {
    /// Takes the poses of `clip` at `frames`.
    pub(super) fn of(clip: &Clip, frames: &[usize], options: &SheetOptions<'_>) -> Self {
        let body = Body::of(clip, MOST_JOINTS);
        let world: Vec<Vec<Vec3>> = places(clip, frames, &body);
        let mut lows: Vec<f32> = world.iter().map(|joints| lowest(joints)).collect();
        let floor = ground(&mut lows, body.size);
        let front = world.iter().find_map(|joints| body.facing(joints)).unwrap_or(Vec3::Z);
        let turn = Quat::from_rotation_y(-front.x.atan2(front.z) - options.yaw);
        let view = Quat::from_rotation_x(options.pitch) * turn;
        let last = (clip.frames() - 1).max(1) as f64;
        let poses: Vec<View> = (world.iter().zip(frames))
            .map(|(joints, &frame)| {
                let seconds = frame as f64 / clip.frame_rate();
                let (joints, shadows, heading) = stand(joints, &body, floor, view);
                View { seconds, progress: frame as f64 / last, joints, shadows, heading }
            })
            .collect();
        let (low, high) = bounds(&body, &poses);
        Self { body, poses, low, high, pale: false }
    }
}

fn places(clip: &Clip, frames: &[usize], body: &Body) -> Vec<Vec<Vec3>> {
    let mut pose = Pose::new(clip.skeleton());
    (frames.iter())
        .map(|&frame| {
            pose.set(clip, frame);
            body.joints.iter().map(|&joint| usable(pose.positions[joint])).collect()
        })
        .collect()
}

fn lowest(joints: &[Vec3]) -> f32 {
    joints.iter().map(|joint| joint.y).fold(f32::MAX, f32::min)
}

type Standing = (Vec<Vec3>, Vec<Vec3>, Option<[Vec3; 3]>);

/// Puts a pose over the origin, by the middle of its main limbs, and turns it into view space.
fn stand(joints: &[Vec3], body: &Body, floor: f32, view: Quat) -> Standing {
    let (mut low, mut high) = (Vec3::MAX, Vec3::MIN);
    for place in main(body, joints) {
        (low, high) = (low.min(place), high.max(place));
    }
    let middle = if low.cmple(high).all() { low + 0.5 * (high - low) } else { Vec3::ZERO };
    let origin = Vec3::new(middle.x, floor, middle.z);
    let seen = joints.iter().map(|&joint| view * (joint - origin)).collect();
    let shadows = joints.iter().map(|&joint| {
        let above = joint - origin;
        view * Vec3::new(above.x, 0.0, above.z)
    });
    let heading = body.facing(joints).map(|facing| {
        let across = Vec3::new(facing.z, 0.0, -facing.x);
        let size = body.size;
        let (tip, back) = (facing * 0.46 * size, facing * 0.3 * size);
        [tip, back + across * 0.1 * size, back - across * 0.1 * size].map(|place| view * place)
    });
    (seen, shadows.collect(), heading)
}

/// The ends of the character's limbs; those of props are not among them.
fn main<'a>(body: &'a Body, joints: &'a [Vec3]) -> impl Iterator<Item = Vec3> + 'a {
    let own = |joint: &usize| body.own.get(*joint) == Some(&true);
    let ends = body.limbs.iter().flat_map(|limb| [limb.from, limb.to]).filter(own);
    ends.filter_map(|joint| joints.get(joint).copied())
}

fn bounds(body: &Body, poses: &[View]) -> (Vec2, Vec2) {
    // The ground is always in the picture, and a point is not magnified without end.
    let least = 0.25 * body.size;
    let (mut low, mut high) = (Vec2::new(-least, 0.0), Vec2::splat(least));
    for place in poses.iter().flat_map(|pose| main(body, &pose.joints)) {
        (low, high) = (low.min(place.truncate()), high.max(place.truncate()));
    }
    let margin = Vec2::splat(0.05 * body.size);
    (low - margin, high + margin)
}
