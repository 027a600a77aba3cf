//! A pose as it is seen, in the proportions of whoever is drawn.

use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{Camera, JOINTS, Joints, PARENTS};

/// A pose in the camera's axes: x to the right, y up, z towards the viewer, metres.
pub type Seen = Joints;

/// Lengths of the parts as multiples of the pose's own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proportions {
    /// Both bones of the legs.
    pub legs: f32,
    /// The lower bone alone, on top of that.
    pub calves: f32,
    /// Pelvis to chest.
    pub spine: f32,
    /// Chest to head.
    pub neck: f32,
    /// Both bones of the arms.
    pub arms: f32,
    /// The lower bone alone, on top of that.
    pub forearms: f32,
    /// Distance of the shoulders; 0 where arms begin at the spine.
    pub shoulders: f32,
    /// Distance of the hips; 0 where legs begin at the pelvis.
    pub hips: f32,
    /// Ankle to toes.
    pub feet: f32,
}

impl Default for Proportions {
    fn default() -> Self {
        Self {
            legs: 1.0,
            calves: 1.0,
            spine: 1.0,
            neck: 1.0,
            arms: 1.0,
            forearms: 1.0,
            shoulders: 1.0,
            hips: 1.0,
            feet: 1.0,
        }
    }
}

/// A pose through a camera, turned on the paper by `roll` radians.
pub fn seen(joints: &Joints, camera: &Camera, roll: f32) -> Seen {
    let (sin, cos) = roll.sin_cos();
    let pelvis = joints[0];
    joints.map(|joint| {
        let p = camera.view_from_world() * (joint - pelvis);
        Vec3::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y, p.z)
    })
}

impl Proportions {
    /// The pose with these lengths.
    pub fn apply(&self, pose: &Seen) -> Seen {
        let mut out = *pose;
        for joint in 1..JOINTS {
            let parent = PARENTS[joint];
            let bone = pose[joint] - pose[parent];
            out[joint] = out[parent] + bone * self.factor(joint);
        }
        // Narrow shoulders close in on the top of the spine, not on the chest.
        let top = out[9].lerp(out[12], 0.65);
        for (collar, shoulder, elbow, wrist) in [(13, 16, 18, 20), (14, 17, 19, 21)] {
            let moved = [collar, shoulder].map(|joint| top + (out[joint] - top) * self.shoulders);
            let by = moved[1] - out[shoulder];
            [out[collar], out[shoulder]] = moved;
            out[elbow] += by;
            out[wrist] += by;
        }
        out
    }

    fn factor(&self, joint: usize) -> f32 {
        match joint {
            1 | 2 => self.hips,
            3 | 6 | 9 => self.spine,
            4 | 5 => self.legs,
            7 | 8 => self.legs * self.calves,
            10 | 11 => self.feet,
            12 | 15 => self.neck,
            18 | 19 => self.arms,
            20 | 21 => self.arms * self.forearms,
            _ => 1.0,
        }
    }
}
