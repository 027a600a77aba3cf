//! What is drawn of a character where there is no skin: which joints, limbs between them with a thickness, and which side they are on.

mod sides;

pub use sides::Side;

use crate::{Clip, Skeleton, rig};
use glam::Vec3;
use sides::sides;

/// A tapered capsule between two joints of a [`Body`]; a ball when both are the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limb {
    /// Where it begins.
    pub from: usize,
    /// Where it ends.
    pub to: usize,
    /// Radius at `from`, metres.
    pub from_radius: f32,
    /// Radius at `to`, metres.
    pub to_radius: f32,
    /// Side of the body.
    pub side: Side,
}

/// The drawn part of a skeleton.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Index in the skeleton of every drawn joint, rising.
    pub joints: Vec<usize>,
    /// For every drawn joint whether it hangs on the root that the character travels with; props do not.
    pub own: Vec<bool>,
    /// Between places in `joints`.
    pub limbs: Vec<Limb>,
    /// A left and a right joint that hang on one parent (hips or shoulders): what tells where the body faces.
    pub pair: Option<[usize; 2]>,
    /// The character's size in metres, above 0.
    pub size: f32,
    /// The joint of the skeleton that the camera follows.
    pub travel_joint: usize,
}

impl Body {
    /// Limbs for the character of `clip`. Of a skeleton with more than `most` joints those are drawn that carry
    /// the longest chains; never those that only steer others.
    pub fn of(clip: &Clip, most: usize) -> Self {
        let skeleton = clip.skeleton();
        let controls = rig::controls(skeleton);
        let weights = weights(skeleton, &controls);
        let joints = heaviest(&weights, &controls, most.max(1));
        let sides = sides(skeleton);
        let size = size(clip, &controls);
        let travel_joint = clip.travel_joint();
        let roots = roots(skeleton);
        let own = joints.iter().map(|&joint| roots[joint] == roots[travel_joint]).collect();
        let mut body = Self { joints, own, limbs: Vec::new(), pair: None, size, travel_joint };
        body.limbs =
            body.find_limbs(skeleton, &weights, &carriers(skeleton, &controls, travel_joint), &sides);
        body.pair = body.find_pair(skeleton, &sides);
        body
    }

    /// The horizontal direction that the body faces, unit length, given the places of the drawn joints. `None`
    /// when names tell no sides or the body lies on its side.
    pub fn facing(&self, positions: &[Vec3]) -> Option<Vec3> {
        let [left, right] = self.pair?;
        let lateral = *positions.get(left)? - *positions.get(right)?;
        let forward = lateral.normalize_or_zero().cross(Vec3::Y);
        (forward.length() > 0.3).then(|| forward.normalize())
    }

    fn find_limbs(&self, skeleton: &Skeleton, weights: &[f32], hidden: &[bool], sides: &[Side]) -> Vec<Limb> {
        let total: f32 = (skeleton.roots().map(|root| weights[root])).sum::<f32>().max(f32::MIN_POSITIVE);
        let radius = |weight: f32| self.size * (0.066 * (weight / total).sqrt()).clamp(0.008, 0.05);
        let joints = skeleton.joints();
        let mut limbs = Vec::new();
        let mut bare = vec![true; self.joints.len()];
        for (to, &child) in self.joints.iter().enumerate() {
            let Some(parent) = joints[child].parent else { continue };
            let Ok(from) = self.joints.binary_search(&parent) else { continue };
            bare[from] = false;
            if hidden[child] {
                continue;
            }
            bare[to] = false;
            // As in a tree, cross-sections follow what they carry (the pipe model of da Vinci).
            let from_radius = radius(weights[child] + joints[child].offset.length());
            limbs.push(Limb { from, to, from_radius, to_radius: radius(weights[child]), side: sides[child] });
        }
        self.shape_head(skeleton, weights, &mut limbs);
        // What hangs on nothing and carries nothing is still seen.
        for (place, _) in bare.iter().enumerate().filter(|(_, bare)| **bare) {
            let radius = 0.03 * self.size;
            let side = sides[self.joints[place]];
            limbs.push(Limb { from: place, to: place, from_radius: radius, to_radius: radius, side });
        }
        limbs
    }

    /// Makes one limb of the head as thick as a head; a head without limbs becomes a ball.
    fn shape_head(&self, skeleton: &Skeleton, weights: &[f32], limbs: &mut Vec<Limb>) {
        let joints = skeleton.joints();
        let named = |joint: &usize| {
            joints[*joint].parent.is_some()
                && joints[*joint].name.to_ascii_lowercase().contains("head")
                && !joints[*joint].end_site
        };
        // A head that is the root begins a snake.
        let Some(head) = self.joints.iter().position(named) else { return };
        let length =
            |limb: &Limb| joints[self.joints[limb.to]].offset.length() + weights[self.joints[limb.to]];
        // Rather to the top of the skull than to an eye.
        let crown = (limbs.iter_mut().filter(|limb| limb.from == head)).max_by(|a, b| {
            let middle = |limb: &Limb| limb.side == Side::Middle;
            middle(a).cmp(&middle(b)).then(length(a).total_cmp(&length(b)))
        });
        let (from_radius, to_radius, side) = (0.042 * self.size, 0.05 * self.size, Side::Middle);
        match crown {
            Some(limb) => *limb = Limb { from_radius, to_radius, side, ..*limb },
            None => limbs.push(Limb { from: head, to: head, from_radius: to_radius, to_radius, side }),
        }
    }

    fn find_pair(&self, skeleton: &Skeleton, sides: &[Side]) -> Option<[usize; 2]> {
        let joints = skeleton.joints();
        let mut first: Vec<[Option<usize>; 2]> = vec![[None; 2]; joints.len()];
        for (index, joint) in joints.iter().enumerate() {
            let Some(parent) = joint.parent else { continue };
            match sides[index] {
                Side::Left => first[parent][0] = first[parent][0].or(Some(index)),
                Side::Right => first[parent][1] = first[parent][1].or(Some(index)),
                Side::Middle => {}
            }
        }
        let place = |joint: usize| self.joints.binary_search(&joint).ok();
        first.iter().find_map(|pair| {
            let [Some(left), Some(right)] = *pair else { return None };
            let apart = joints[left].offset.distance(joints[right].offset) > 0.01 * self.size;
            if apart { Some([place(left)?, place(right)?]) } else { None }
        })
    }
}

/// The root that each joint hangs on.
fn roots(skeleton: &Skeleton) -> Vec<usize> {
    let mut roots: Vec<usize> = Vec::with_capacity(skeleton.len());
    for (index, joint) in skeleton.joints().iter().enumerate() {
        roots.push(joint.parent.map_or(index, |parent| roots[parent]));
    }
    roots
}

/// Length of everything that hangs below each joint, metres.
fn weights(skeleton: &Skeleton, controls: &[bool]) -> Vec<f32> {
    let mut weights = vec![0.0_f32; skeleton.len()];
    for (index, joint) in skeleton.joints().iter().enumerate().rev() {
        if let Some(parent) = joint.parent.filter(|_| !controls[index]) {
            let carried = weights[index] + joint.offset.length();
            weights[parent] += if carried.is_finite() { carried } else { 0.0 };
        }
    }
    weights
}

/// The `most` joints with the largest weights, rising. A parent is never lighter than its child, so what is kept
/// hangs together.
fn heaviest(weights: &[f32], controls: &[bool], most: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..weights.len()).filter(|&joint| !controls[joint]).collect();
    order.sort_by(|&a, &b| weights[b].total_cmp(&weights[a]).then(a.cmp(&b)));
    order.truncate(most);
    order.sort_unstable();
    order
}

/// The joints whose limb to the parent only places the character in the world: the travelling joint, what stands
/// above it, and hips that hang alone below a root.
fn carriers(skeleton: &Skeleton, controls: &[bool], travel_joint: usize) -> Vec<bool> {
    let joints = skeleton.joints();
    let mut children = vec![0_usize; joints.len()];
    for (joint, _) in joints.iter().zip(controls).filter(|(_, control)| !**control) {
        if let Some(parent) = joint.parent {
            children[parent] += 1;
        }
    }
    let mut hidden = vec![false; joints.len()];
    let mut above = Some(travel_joint);
    while let Some(joint) = above {
        hidden[joint] = true;
        above = joints[joint].parent;
    }
    for (index, joint) in joints.iter().enumerate() {
        let Some(parent) = joint.parent else { continue };
        hidden[index] |= joints[parent].parent.is_none() && children[parent] == 1 && children[index] > 1;
    }
    hidden
}

/// The character's size: that of the rest pose, or of the first pose when the rest pose is a point or joints that
/// steer others stand in it.
fn size(clip: &Clip, controls: &[bool]) -> f32 {
    let usable = |size: f32| (size.is_normal() && size > 0.0).then_some(size.clamp(1e-6, 1e9));
    let posed = || {
        let mut pose = crate::kinematics::Pose::new(clip.skeleton());
        pose.set(clip, 0);
        let own = pose.positions.iter().zip(controls).filter(|(_, control)| !**control);
        let (low, high) =
            own.fold((Vec3::MAX, Vec3::MIN), |(low, high), (place, _)| (low.min(*place), high.max(*place)));
        (high - low).max_element()
    };
    let rest = Some(clip.skeleton().extent()).filter(|_| !controls.contains(&true)).and_then(usable);
    rest.or_else(|| usable(posed())).unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Joint;
    use glam::Quat;
    use std::sync::Arc;

    fn clip_of(joints: Vec<Joint>) -> Clip {
        let skeleton = Arc::new(Skeleton::new(joints).unwrap());
        let rotations = vec![Quat::IDENTITY; skeleton.len()];
        Clip::new(skeleton, 30.0, rotations, vec![]).unwrap()
    }

    #[test]
    fn a_body_faces_across_its_hips() {
        let body = |turn: Quat| {
            let joints = vec![
                Joint::new("hips", None, Vec3::ZERO),
                Joint::new("leg_l", Some(0), turn * Vec3::X),
                Joint::new("leg_r", Some(0), turn * -Vec3::X),
            ];
            let clip = clip_of(joints);
            Body::of(&clip, 10).facing(&clip.skeleton().rest_positions())
        };
        assert!(body(Quat::IDENTITY).unwrap().distance(Vec3::Z) < 1e-6);
        assert!(
            body(Quat::from_rotation_y(1.0)).unwrap().distance(Quat::from_rotation_y(1.0) * Vec3::Z) < 1e-6
        );
        assert_eq!(body(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2)), None);
    }

    #[test]
    fn the_limb_to_a_still_root_is_not_drawn_but_a_lone_joint_is() {
        let body = Body::of(
            &clip_of(vec![
                Joint::new("world", None, Vec3::ZERO),
                Joint::new("hips", Some(0), Vec3::Y),
                Joint::new("spine", Some(1), Vec3::Y),
                Joint::new("leg", Some(1), -Vec3::Y),
                Joint::new("ball", None, Vec3::X),
            ]),
            10,
        );
        let ends: Vec<_> = body.limbs.iter().map(|limb| (limb.from, limb.to)).collect();
        assert_eq!(ends, [(1, 2), (1, 3), (4, 4)]);
        assert!(body.limbs.iter().all(|limb| limb.from_radius > 0.0 && limb.to_radius > 0.0));
    }

    #[test]
    fn what_steers_is_not_drawn() {
        let body = Body::of(
            &clip_of(vec![
                Joint::new("Body", None, Vec3::ZERO),
                Joint::new("Hips", Some(0), Vec3::Y),
                Joint::new("Spine", Some(1), Vec3::Y),
                Joint::new("Leg", Some(1), -Vec3::Y),
                Joint::new("PoleTarget.L", Some(0), Vec3::Z * 30.0),
                Joint::new("PoleTarget.L_end", Some(4), Vec3::Z),
            ]),
            10,
        );
        let ends: Vec<_> = body.limbs.iter().map(|limb| (limb.from, limb.to)).collect();
        assert_eq!((body.joints.as_slice(), ends.as_slice()), (&[0, 1, 2, 3][..], &[(1, 2), (1, 3)][..]));
        assert_eq!(body.size, 2.0);
    }

    #[test]
    fn thinning_keeps_what_hangs_together() {
        let mut joints = vec![Joint::new("root", None, Vec3::ZERO)];
        for index in 1..1000_usize {
            joints.push(Joint::new(format!("j{index}"), Some((index - 1) / 3), Vec3::Y * 0.1));
        }
        let clip = clip_of(joints);
        let body = Body::of(&clip, 100);
        assert_eq!(body.joints.len(), 100);
        for &joint in &body.joints {
            let parent = clip.skeleton().joints()[joint].parent;
            assert!(parent.is_none_or(|parent| body.joints.contains(&parent)));
        }
    }
}
