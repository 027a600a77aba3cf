//! A body of capsules for a bare skeleton, so that its file shows something in every program: each limb is a tapered
//! capsule that moves with the joint at its beginning.

use inkrig_motion::{
    Clip, Joint, Skeleton,
    glam::{Quat, Vec3},
    rig,
};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Corners around a limb.
const SIDES: u16 = 8;

/// A skin of triangles.
#[derive(Default)]
pub(crate) struct Body {
    /// Of the corners, at rest, metres.
    pub(crate) places: Vec<Vec3>,
    pub(crate) normals: Vec<Vec3>,
    /// The joint that each corner moves with.
    pub(crate) bones: Vec<usize>,
    /// Three corners a triangle.
    pub(crate) indices: Vec<u32>,
}

/// The body of a clip's skeleton at rest. Limbs move with joints that are `skinned` only.
pub(crate) fn body(clip: &Clip, skinned: &dyn Fn(usize) -> bool) -> Body {
    let mut body = Body::default();
    let places = clip.skeleton().rest_positions();
    let place = |joint: usize| places.get(joint).copied().unwrap_or_default();
    for limb in limbs(clip).iter().filter(|limb| skinned(limb.from)) {
        body.capsule([place(limb.from), place(limb.to)], limb.radii, limb.from);
    }
    body
}

/// A capsule from one joint to another, or a ball.
struct Limb {
    from: usize,
    to: usize,
    /// Metres, at either end.
    radii: [f32; 2],
}

fn limbs(clip: &Clip) -> Vec<Limb> {
    let skeleton = clip.skeleton();
    let joints = skeleton.joints();
    let controls = rig::controls(skeleton);
    let size = size(skeleton, &controls);
    let carried = carried(skeleton, &controls);
    let total = skeleton.roots().filter_map(|root| carried.get(root)).sum::<f32>().max(f32::MIN_POSITIVE);
    // Thickness follows what a limb carries, as in a tree.
    let radius = |length: f32| size * (0.066 * (length / total).sqrt()).clamp(0.008, 0.05);
    let hidden = carriers(clip, &controls);
    let mut bare = vec![true; joints.len()];
    let mut limbs = Vec::new();
    for (to, joint) in joints.iter().enumerate() {
        let (Some(from), Some(&below)) = (joint.parent, carried.get(to)) else { continue };
        if hidden.get(to) == Some(&true) || joint.offset.length() < 1e-4 * size {
            continue;
        }
        let head = joints.get(from).is_some_and(is_head);
        let radii = if head {
            [0.042 * size, 0.05 * size]
        } else {
            [radius(below + joint.offset.length()), radius(below)]
        };
        limbs.push(Limb { from, to, radii });
        for end in [from, to] {
            if let Some(bare) = bare.get_mut(end) {
                *bare = false;
            }
        }
    }
    // A head without a crown, and what hangs on nothing, become balls.
    let ends: Vec<usize> = limbs.iter().map(|limb| limb.from).collect();
    for (index, joint) in joints.iter().enumerate().filter(|(_, joint)| !joint.end_site) {
        let ball = |radius: f32| Limb { from: index, to: index, radii: [radius; 2] };
        if is_head(joint) && !ends.contains(&index) {
            limbs.push(ball(0.05 * size));
        } else if bare.get(index) == Some(&true) && hidden.get(index) != Some(&true) || limbs.is_empty() {
            limbs.push(ball(0.03 * size));
        }
    }
    limbs
}

fn is_head(joint: &Joint) -> bool {
    joint.parent.is_some() && !joint.end_site && joint.name.to_ascii_lowercase().ends_with("head")
}

/// The figure's size at rest, metres, without what steers it.
fn size(skeleton: &Skeleton, controls: &[bool]) -> f32 {
    let places = skeleton.rest_positions();
    let own = || places.iter().zip(controls).filter(|(_, control)| !**control).map(|(place, _)| *place);
    let (low, high) = (own().fold(Vec3::MAX, Vec3::min), own().fold(Vec3::MIN, Vec3::max));
    let size = if controls.contains(&true) { (high - low).max_element() } else { skeleton.extent() };
    if size.is_normal() { size } else { 1.0 }
}

/// Length of all that hangs below each joint, metres.
fn carried(skeleton: &Skeleton, controls: &[bool]) -> Vec<f32> {
    let mut carried = vec![0.0_f32; skeleton.len()];
    for (index, joint) in skeleton.joints().iter().enumerate().rev() {
        let length = carried.get(index).copied().unwrap_or(0.0) + joint.offset.length();
        if let Some(slot) = joint
            .parent
            .and_then(|parent| carried.get_mut(parent))
            .filter(|_| length.is_finite() && controls.get(index) != Some(&true))
        {
            *slot += length;
        }
    }
    carried
}

/// Joints whose way from the parent only places the figure in the world: the travelling one, what stands above it, and
/// hips that hang alone below a root; and what only steers others.
fn carriers(clip: &Clip, controls: &[bool]) -> Vec<bool> {
    let skeleton = clip.skeleton();
    let travelling = clip.travel_joint();
    let mut hidden = skeleton.ancestors(travelling);
    if let Some(slot) = hidden.get_mut(travelling) {
        *slot = true;
    }
    let joints = skeleton.joints();
    let mut children = vec![0_usize; joints.len()];
    for (joint, _) in joints.iter().zip(controls).filter(|(_, control)| !**control) {
        if let Some(count) = joint.parent.and_then(|parent| children.get_mut(parent)) {
            *count += 1;
        }
    }
    for (slot, _) in hidden.iter_mut().zip(controls).filter(|(_, control)| **control) {
        *slot = true;
    }
    let count = |joint: usize| children.get(joint).copied().unwrap_or(0);
    for (index, joint) in joints.iter().enumerate() {
        let Some(parent) = joint.parent else { continue };
        let root = joints.get(parent).is_some_and(|parent| parent.parent.is_none());
        if let Some(slot) = hidden.get_mut(index).filter(|_| root && count(parent) == 1 && count(index) > 1) {
            *slot = true;
        }
    }
    hidden
}

impl Body {
    /// Rings from pole to pole: a cap, the wall, a cap.
    fn capsule(&mut self, ends: [Vec3; 2], radii: [f32; 2], bone: usize) {
        let [from, to] = ends;
        let axis = (to - from).try_normalize().unwrap_or(Vec3::Y);
        let turned = Quat::from_rotation_arc(Vec3::Y, axis);
        let first = self.places.len() as u32;
        let [low, high] = radii;
        // Angle from the equator of the cap, and which end.
        let half = 0.5 * FRAC_PI_2;
        let rings = [
            (-FRAC_PI_2, from, low),
            (-half, from, low),
            (0.0, from, low),
            (0.0, to, high),
            (half, to, high),
            (FRAC_PI_2, to, high),
        ];
        for (angle, end, radius) in rings {
            let pole = angle.abs() == FRAC_PI_2;
            for side in 0..if pole { 1 } else { SIDES } {
                let around = TAU * f32::from(side) / f32::from(SIDES);
                let flat = if pole { 0.0 } else { angle.cos() };
                let normal = turned * Vec3::new(flat * around.cos(), angle.sin(), flat * around.sin());
                self.places.push(end + radius * normal);
                self.normals.push(normal.normalize());
                self.bones.push(bone);
            }
        }
        self.faces(first);
    }

    fn faces(&mut self, first: u32) {
        let sides = u32::from(SIDES);
        let next = |side: u32| (side + 1) % sides;
        let last = first + 1 + 4 * sides;
        for side in 0..sides {
            self.indices.extend([first, first + 1 + side, first + 1 + next(side)]);
            for ring in 0..3 {
                let below = first + 1 + ring * sides;
                let above = below + sides;
                self.indices.extend([below + side, above + side, below + next(side)]);
                self.indices.extend([below + next(side), above + side, above + next(side)]);
            }
            let below = last - sides;
            self.indices.extend([below + side, last, below + next(side)]);
        }
    }
}
