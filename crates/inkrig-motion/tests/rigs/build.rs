//! Skeletons of people under the names of any program.

use inkrig_motion::glam::Vec3;
use inkrig_motion::rig::{Arm, Humanoid, Leg};
use inkrig_motion::{Joint, Skeleton};

/// The names of a program's skeleton. Empty: it has no such joint.
pub(crate) struct Convention {
    pub(crate) program: &'static str,
    /// Above the hips.
    pub(crate) above: &'static [&'static str],
    pub(crate) hips: &'static str,
    pub(crate) spine: &'static [&'static str],
    pub(crate) neck: &'static [&'static str],
    pub(crate) head: &'static str,
    /// Left: collar bone, shoulder, elbow, wrist, hip, knee, ankle, ball.
    pub(crate) left: [&'static str; 8],
    /// What makes a left name a right one: every first becomes the second.
    pub(crate) mirror: &'static [(&'static str, &'static str)],
    /// Name and parent of joints that are no part of the body; those of the left are mirrored too.
    pub(crate) extra: &'static [(&'static str, &'static str)],
}

/// Half of a body in a T-pose, metres: where the left joints are.
const LEFT: [Vec3; 8] = [
    Vec3::new(0.03, 1.42, 0.0),
    Vec3::new(0.18, 1.44, -0.01),
    Vec3::new(0.45, 1.44, -0.02),
    Vec3::new(0.7, 1.44, 0.0),
    Vec3::new(0.1, 0.92, 0.0),
    Vec3::new(0.1, 0.5, 0.01),
    Vec3::new(0.1, 0.08, -0.02),
    Vec3::new(0.1, 0.02, 0.12),
];

/// Joints with their places in the world, from which offsets are made.
#[derive(Default)]
pub(crate) struct Build {
    joints: Vec<(String, Option<usize>, Vec3)>,
}

impl Build {
    pub(crate) fn add(&mut self, name: impl Into<String>, parent: Option<usize>, place: Vec3) -> usize {
        self.joints.push((name.into(), parent, place));
        self.joints.len() - 1
    }

    pub(crate) fn find(&self, name: &str) -> usize {
        self.joints.iter().position(|joint| joint.0 == name).unwrap_or_else(|| panic!("no {name}"))
    }

    pub(crate) fn skeleton(&self) -> Skeleton {
        let joint = |(name, parent, place): &(String, Option<usize>, Vec3)| {
            Joint::new(
                name.clone(),
                *parent,
                *place - parent.map_or(Vec3::ZERO, |above| self.joints[above].2),
            )
        };
        Skeleton::new(self.joints.iter().map(joint).collect()).unwrap()
    }
}

impl Convention {
    /// The skeleton, and the body that must be found in it.
    pub(crate) fn build(&self) -> (Skeleton, Humanoid) {
        let mut build = Build::default();
        let mut above = None;
        for name in self.above {
            above = Some(build.add(*name, above, Vec3::ZERO));
        }
        let hips = build.add(self.hips, above, Vec3::new(0.0, 0.95, 0.0));
        let mut at = hips;
        let mut line = |build: &mut Build, names: &[&str], from: f32, to: f32| -> Vec<usize> {
            let step = (to - from) / names.len().max(1) as f32;
            (names.iter().enumerate())
                .map(|(index, name)| {
                    at = build.add(*name, Some(at), Vec3::new(0.0, from + step * index as f32, 0.0));
                    at
                })
                .collect()
        };
        let spine = line(&mut build, self.spine, 1.05, 1.4);
        let neck = line(&mut build, self.neck, 1.5, 1.6);
        let head = line(&mut build, &[self.head], 1.6, 1.6)[0];
        build.add(format!("{}_End", self.head), Some(head), Vec3::new(0.0, 1.8, 0.0));
        let chest = *spine.last().unwrap();
        let mut found = [Vec::new(), Vec::new()];
        for (side, found) in found.iter_mut().enumerate() {
            let flip = |place: Vec3| if side == 0 { place } else { place * Vec3::new(-1.0, 1.0, 1.0) };
            for (limb, parent) in [(0..4, chest), (4..8, hips)] {
                let mut at = parent;
                for (name, place) in self.left[limb.clone()].iter().zip(&LEFT[limb]) {
                    let named = !name.is_empty();
                    if named {
                        at = build.add(self.sided(name, side), Some(at), flip(*place));
                    }
                    found.push(named.then_some(at));
                }
            }
        }
        for side in 0..2 {
            for (name, parent) in self.extra {
                let (own, parent) = (self.sided(name, side), self.sided(parent, side));
                // What stands in the middle has one side.
                if side == 0 || own != *name {
                    let parent = build.find(&parent);
                    let place = build.joints[parent].2 + Vec3::new(0.0, -0.02, 0.03);
                    build.add(own, Some(parent), place);
                }
            }
        }
        let arm = |joints: &[Option<usize>]| {
            Some(Arm { clavicle: joints[0], upper: joints[1]?, lower: joints[2]?, hand: joints[3] })
        };
        let leg = |joints: &[Option<usize>]| Leg {
            upper: joints[4].unwrap(),
            lower: joints[5].unwrap(),
            foot: joints[6],
            toes: joints[7],
        };
        let [left, right] = &found;
        let body = Humanoid {
            hips,
            spine,
            neck,
            head: Some(head),
            arms: [arm(left), arm(right)],
            legs: [leg(left), leg(right)],
        };
        (build.skeleton(), body)
    }

    fn sided(&self, name: &str, side: usize) -> String {
        let swap = self.mirror.iter().find(|(left, _)| side == 1 && name.contains(left));
        swap.map_or_else(|| name.to_string(), |(left, right)| name.replace(left, right))
    }
}
