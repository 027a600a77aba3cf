//! From the canvas to metres: how large the figure is drawn, and where the floor is.

use crate::figure::Figure;
use inkrig_motion::glam::Vec2;
use inkrig_motion::humanml::{Camera, Joints};

/// Bones that the size is told by: two joints, the joints whose bones lie between, and how much they count.
const BONES: [(usize, usize, &[usize], f32); 9] = [
    (0, 12, &[3, 6, 9, 12], 3.0),
    (1, 4, &[4], 2.0),
    (2, 5, &[5], 2.0),
    (4, 7, &[7], 2.0),
    (5, 8, &[8], 2.0),
    (18, 20, &[20], 1.0),
    (19, 21, &[21], 1.0),
    (12, 15, &[15], 0.5),
    (0, 15, &[3, 6, 9, 12, 15], 1.0),
];
/// A line on the picture is at most as long as its bone, mostly shorter: this share of all lines is shorter than drawn
/// bones that lie in the picture.
const SHARE: f32 = 0.7;
/// Ankles of a figure that stands, metres above the floor.
const ANKLE: f32 = 0.08;
/// Ankles that differ by more than this on the picture, metres, are not both on the floor.
const BOTH_STAND: f32 = 0.35;

/// Where the canvas lies on the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Calibration {
    /// Canvas units a metre.
    pub(crate) units: f64,
    /// The pelvis on the canvas.
    pub(crate) pelvis: [f64; 2],
    /// The pelvis on the picture.
    pub(crate) origin: Vec2,
}

impl Calibration {
    /// A canvas place on the picture.
    pub(crate) fn picture(&self, at: [f64; 2]) -> Vec2 {
        let along = |axis: usize| ((at[axis] - self.pelvis[axis]) / self.units) as f32;
        self.origin + Vec2::new(along(0), along(1))
    }

    /// By the figure's bones; `None` where it has none of those that tell.
    pub(crate) fn of(figure: &Figure, body: &Joints, camera: &Camera) -> Option<Self> {
        let length = |joint: usize| body.get(joint).map_or(0.0, |bone| bone.length());
        let mut ratios: Vec<(f32, f32)> = BONES
            .iter()
            .filter_map(|(from, to, bones, weight)| {
                let (a, b) = (figure.joints[*from]?, figure.joints[*to]?);
                let long: f32 = bones.iter().map(|joint| length(*joint)).sum();
                let drawn = (a.at[0] - b.at[0]).hypot(a.at[1] - b.at[1]) as f32;
                let sure = a.confidence.min(b.confidence).max(0.1);
                (long > 0.0 && drawn > 0.0).then_some((drawn / long, weight * sure))
            })
            .collect();
        ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
        let all: f32 = ratios.iter().map(|(_, weight)| weight).sum();
        let mut passed = 0.0;
        let units = ratios.iter().find_map(|(ratio, weight)| {
            passed += weight;
            (passed >= SHARE * all).then_some(*ratio)
        })?;
        let pelvis = figure.at(0).or_else(|| {
            let (left, right) = (figure.at(1)?, figure.at(2)?);
            Some([0.5 * (left[0] + right[0]), 0.5 * (left[1] + right[1])])
        })?;
        // Legs that stand say how high the pelvis is; the lower of two that differ much is the one that stands.
        let leg = length(4) + length(7);
        let tallest = leg + 0.5 * length(1) + ANKLE;
        let upright = camera.project(inkrig_motion::glam::Vec3::Y).y.max(0.3);
        let drops: Vec<f32> = [7, 8]
            .iter()
            .filter_map(|ankle| Some(((pelvis[1] - figure.at(*ankle)?[1]) as f32) / units))
            .collect();
        let drop = match drops[..] {
            [a, b] if (a - b).abs() < BOTH_STAND => 0.5 * (a + b),
            [a, b] => a.max(b),
            [a] => a,
            _ => upright * leg,
        };
        let height = (drop / upright + ANKLE).clamp(0.2, tallest);
        let origin = camera.project(inkrig_motion::glam::Vec3::Y * height);
        Some(Self { units: f64::from(units), pelvis, origin })
    }
}
