//! What somebody would draw of a motion: points on the picture of a camera, of a body that is not quite the motion's.

use super::conditions::Drawn;
use super::stage::network;
use crate::TrainError;
use inkrig_generate::guidance::{Ask, View};
use inkrig_generate::sampling::{Conditions, Request, Semantics};
use inkrig_generate::schedule::Noise;
use inkrig_motion::glam::{Vec2, Vec3};
use inkrig_motion::humanml::{Camera, Joints, PARENTS, Statistics, augment};
use serde::{Deserialize, Serialize};

/// From where training looks, and how its drawings differ from the motion. Degrees, metres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Drawing {
    /// From and to, downwards.
    pub pitch: (f32, f32),
    /// From and to, around.
    pub yaw: (f32, f32),
    /// Deviation of normal noise on every point.
    pub noise: f32,
    /// From and to, size of the figure of a key pose; 1 and 1 for its own.
    pub scale: (f32, f32),
    /// Share of key poses whose figure has other proportions.
    pub proportions_share: f64,
    /// From and to, factors of spine, neck, arms and legs.
    pub proportions: (f32, f32),
    /// From and to, factor of the shoulders' width.
    pub shoulders: (f32, f32),
    /// Whether points of trajectories have noise as well.
    pub trajectories_too: bool,
}

impl Default for Drawing {
    /// As in the paper.
    fn default() -> Self {
        Self {
            pitch: (0.0, 30.0),
            yaw: (-45.0, 45.0),
            noise: 0.02,
            scale: (0.8, 1.2),
            proportions_share: 0.5,
            proportions: (0.6, 1.6),
            shoulders: (0.7, 1.2),
            trajectories_too: true,
        }
    }
}

impl Drawing {
    /// Whether all is in its range.
    pub(super) fn fits(&self) -> bool {
        let range = |(from, to): (f32, f32), least: f32, most: f32| from >= least && to >= from && to <= most;
        range(self.pitch, -90.0, 90.0)
            && range(self.yaw, -180.0, 180.0)
            && (0.0..=1.0).contains(&self.noise)
            && range(self.scale, 0.1, 10.0)
            && (0.0..=1.0).contains(&self.proportions_share)
            && range(self.proportions, 0.1, 10.0)
            && range(self.shoulders, 0.1, 10.0)
    }

    /// What a sample is asked for, as it is drawn.
    pub(super) fn of(
        &self,
        drawn: &Drawn,
        places: &Statistics,
        noise: &mut Noise,
    ) -> Result<Conditions, TrainError> {
        let camera =
            Camera::new(between(self.pitch, noise).to_radians(), between(self.yaw, noise).to_radians());
        let on_trajectory = if self.trajectories_too { self.noise } else { 0.0 };
        let shaken = |point: Vec2, deviation: f32, noise: &mut Noise| {
            (point + deviation * Vec2::new(noise.normal(), noise.normal())).extend(0.0)
        };
        let asks = drawn.asked.iter().map(|&(frame, joint)| {
            let point = camera.project(drawn.joints[frame][joint]);
            Ask { frame, joint, place: shaken(point, on_trajectory, noise) }
        });
        let trajectory: Vec<Ask> = asks.collect();
        let keypose = drawn.frame.map(|frame| {
            let mut pose = drawn.joints[frame];
            if noise.uniform() < self.proportions_share {
                let four = [0; 4].map(|_| between(self.proportions, noise));
                pose = proportioned(&pose, four, between(self.shoulders, noise));
            }
            let scale = between(self.scale, noise);
            // The figure grows from where it stands.
            let foot = camera.project(Vec3::new(pose[0].x, 0.0, pose[0].z));
            let flat = pose.map(|joint| {
                let point = foot + scale * (camera.project(joint) - foot);
                shaken(point, self.noise, noise)
            });
            (frame, augment(&flat))
        });
        let request = Request {
            frames: drawn.joints.len(),
            text: Vec::new(),
            view: View::Plane(camera),
            trajectory,
            keypose,
        };
        Conditions::new(&request, places, Semantics::Paper).map_err(network)
    }
}

/// The same pose of a body whose spine, neck, arms and legs are longer or shorter by factors, and whose shoulders are wider; it stands as
/// high as before.
fn proportioned(pose: &Joints, [spine, neck, arms, legs]: [f32; 4], shoulders: f32) -> Joints {
    let factor = |joint: usize| match joint {
        3 | 6 | 9 => spine,
        12 | 15 => neck,
        13 | 14 | 16 | 17 => shoulders,
        18..=21 => arms,
        4 | 5 | 7 | 8 => legs,
        _ => 1.0,
    };
    let mut out = *pose;
    for joint in 1..pose.len() {
        let parent = PARENTS[joint];
        out[joint] = out[parent] + factor(joint) * (pose[joint] - pose[parent]);
    }
    let lowest = |pose: &Joints| pose.iter().map(|joint| joint.y).fold(f32::INFINITY, f32::min);
    let up = Vec3::Y * (lowest(pose) - lowest(&out));
    out.map(|joint| joint + up)
}

fn between((from, to): (f32, f32), noise: &mut Noise) -> f32 {
    from + (to - from) * noise.uniform() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn() -> Drawn {
        let pose = |frame: usize| -> Joints {
            std::array::from_fn(|joint| Vec3::new(0.1 * joint as f32, 0.05 * joint as f32, frame as f32))
        };
        let joints: Vec<Joints> = (0..5).map(pose).collect();
        let asked = vec![(1, 10), (2, 10)];
        let request =
            Request { frames: 5, text: Vec::new(), view: View::Space, trajectory: Vec::new(), keypose: None };
        let places = Statistics::new(vec![0.0; 66], vec![1.0; 66]).unwrap();
        let conditions = Conditions::new(&request, &places, Semantics::Paper).unwrap();
        let (trajectory, keypose) = Default::default();
        Drawn { joints, asked, frame: Some(3), places: Vec::new(), trajectory, keypose, conditions }
    }

    #[test]
    fn without_changes_a_drawing_is_the_projection() {
        let still = Drawing {
            pitch: (20.0, 20.0),
            yaw: (30.0, 30.0),
            noise: 0.0,
            scale: (1.0, 1.0),
            proportions_share: 0.0,
            ..Drawing::default()
        };
        let places = Statistics::new(vec![0.0; 66], vec![1.0; 66]).unwrap();
        let seen = still.of(&drawn(), &places, &mut Noise::new(1)).unwrap();
        let (trajectory, keypose) = (seen.trajectory(), seen.keypose().unwrap());
        let camera = Camera::default();
        let point = camera.project(drawn().joints[2][10]);
        assert_eq!((trajectory.len(), trajectory[1].0), (2, 2));
        assert!((trajectory[1].1[30] - point.x).abs() < 1e-5 && (trajectory[1].1[31] - point.y).abs() < 1e-5);
        let pose = augment(&drawn().joints[3]);
        let (root, head) = (camera.project(pose[0]), camera.project(pose[15]));
        assert_eq!(keypose.0, 3);
        assert!((keypose.1[45] - (head.x - root.x)).abs() < 1e-4);
        // Scale, noise and proportions change it.
        let other = Drawing::default().of(&drawn(), &places, &mut Noise::new(2)).unwrap();
        assert!(other.keypose().unwrap().1 != keypose.1);
    }

    #[test]
    fn legs_grow_and_feet_stay_on_the_ground() {
        let pose = drawn().joints[0];
        let long = proportioned(&pose, [1.0, 1.0, 1.0, 1.5], 1.0);
        let bone = |pose: &Joints, joint: usize| pose[joint].distance(pose[PARENTS[joint]]);
        assert!((bone(&long, 4) - 1.5 * bone(&pose, 4)).abs() < 1e-5);
        assert!((bone(&long, 18) - bone(&pose, 18)).abs() < 1e-5);
        let lowest = |pose: &Joints| pose.iter().map(|joint| joint.y).fold(f32::INFINITY, f32::min);
        assert!((lowest(&long) - lowest(&pose)).abs() < 1e-5);
        assert!(proportioned(&pose, [1.0; 4], 1.0).iter().zip(&pose).all(|(a, b)| a.distance(*b) < 1e-5));
        assert!(Drawing::default().fits() && !Drawing { pitch: (9.0, 2.0), ..Drawing::default() }.fits());
    }
}
