//! Poses of a stick figure, set by hand: where its parts point.

use inkrig_motion::glam::DVec3;
use inkrig_sketch::storyboard::FrameCamera;

/// Where a part points: degrees forward from hanging down, and degrees out to its side.
pub(super) type Way = (f64, f64);

/// A pose. The figure faces +z, its left is at +x.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pose {
    /// Degrees that the trunk leans forward and to its left.
    pub(super) lean: (f64, f64),
    /// Thigh and shin, left and right.
    pub(super) legs: [[Way; 2]; 2],
    /// Upper arm and forearm, left and right.
    pub(super) arms: [[Way; 2]; 2],
    /// Metres of the lowest foot above the floor.
    pub(super) above: f64,
}

/// Joints of the figure in space, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed {
    pub(super) pelvis: DVec3,
    pub(super) neck: DVec3,
    pub(super) head: DVec3,
    /// Hip, knee, ankle, toe; left and right.
    pub(super) legs: [[DVec3; 4]; 2],
    /// Shoulder, elbow, wrist; left and right.
    pub(super) arms: [[DVec3; 3]; 2],
}

const SPINE: f64 = 0.5;
const NECK: f64 = 0.13;
const HIP: f64 = 0.08;
const SHOULDER: f64 = 0.16;
const LEG: [f64; 2] = [0.39, 0.41];
const ARM: [f64; 2] = [0.27, 0.25];
const FOOT: f64 = 0.14;
const ANKLE: f64 = 0.07;

impl Pose {
    /// Arms and legs hang.
    pub(super) const STAND: Self = Self {
        lean: (0.0, 0.0),
        legs: [[(4.0, 5.0), (0.0, 5.0)], [(-2.0, 5.0), (-6.0, 5.0)]],
        arms: [[(0.0, 14.0), (10.0, 10.0)], [(0.0, 14.0), (10.0, 10.0)]],
        above: 0.0,
    };

    /// The joints, the pelvis above the origin.
    pub(super) fn placed(&self) -> Placed {
        let (forward, side) = (self.lean.0.to_radians(), self.lean.1.to_radians());
        let up = DVec3::new(side.sin(), side.cos() * forward.cos(), side.cos() * forward.sin()).normalize();
        let neck = up * SPINE;
        let chain = |from: DVec3, ways: [Way; 2], lengths: [f64; 2], left: bool| {
            let one = from + direction(ways[0], left) * lengths[0];
            [from, one, one + direction(ways[1], left) * lengths[1]]
        };
        let across = |half: f64, left: bool| DVec3::X * if left { half } else { -half };
        let mut legs = [[DVec3::ZERO; 4]; 2];
        let mut arms = [[DVec3::ZERO; 3]; 2];
        for (index, left) in [(0, true), (1, false)] {
            let [hip, knee, ankle] = chain(across(HIP, left) - DVec3::Y * 0.06, self.legs[index], LEG, left);
            // The foot stands at a right angle to the shin, but never points far down.
            let shin = (ankle - knee).normalize();
            let toe = DVec3::new(0.0, (-0.35_f64).max(shin.z.min(0.5) * 0.8), -shin.y).normalize();
            legs[index] = [hip, knee, ankle, ankle + toe * FOOT];
            arms[index] = chain(neck + across(SHOULDER, left) - up * 0.05, self.arms[index], ARM, left);
        }
        let lowest =
            legs.iter().map(|leg| (leg[2].y - ANKLE).min(leg[3].y - 0.02)).fold(f64::INFINITY, f64::min);
        let lift = DVec3::Y * (self.above - lowest);
        Placed {
            pelvis: lift,
            neck: neck + lift,
            head: neck + up * NECK + DVec3::Z * 0.03 + lift,
            legs: legs.map(|leg| leg.map(|joint| joint + lift)),
            arms: arms.map(|arm| arm.map(|joint| joint + lift)),
        }
    }
}

fn direction((forward, out): Way, left: bool) -> DVec3 {
    let (forward, out) = (forward.to_radians(), out.to_radians());
    let side = if left { out.sin() } else { -out.sin() };
    DVec3::new(side, -out.cos() * forward.cos(), out.cos() * forward.sin())
}

/// A place on the picture of a camera, metres.
pub(super) fn seen(camera: &FrameCamera, place: DVec3) -> [f64; 2] {
    let (pitch, yaw) = (camera.pitch_degrees.to_radians(), camera.yaw_degrees.to_radians());
    let x = place.x * yaw.cos() + place.z * yaw.sin();
    let depth = place.z * yaw.cos() - place.x * yaw.sin();
    [x, place.y * pitch.cos() - depth * pitch.sin()]
}
