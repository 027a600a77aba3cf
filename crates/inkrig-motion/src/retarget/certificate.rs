//! How exact a motion on another character is: measured on the result, in numbers that can be held against limits.

use super::{RetargetError, Retargeted};
use crate::kinematics::{self, Positions};
use crate::rig::{Humanoid, Part, Side};
use crate::{Clip, Skeleton};

/// Limbs whose directions are compared: the part and the one at its end.
const LIMBS: [(Part, Part); 4] = [
    (Part::UpperArm, Part::LowerArm),
    (Part::LowerArm, Part::Hand),
    (Part::UpperLeg, Part::LowerLeg),
    (Part::LowerLeg, Part::Foot),
];

/// What was measured of a motion on another character.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// Length of the target over that of the source.
    pub scale: f32,
    /// Target joints that turn with the source: name, and name of the source joint that leads it most.
    pub pairs: Vec<(String, String)>,
    /// Target joints that keep their rest, end sites not among them.
    pub unmapped: Vec<String>,
    /// Degrees between the limbs of source and target, over all frames of all limbs that both have.
    pub direction: Spread,
    /// The same for each limb.
    pub limbs: Vec<LimbDirection>,
    /// How often a foot stood in the source.
    pub contacts: usize,
    /// Millimetres over the ground from frame to frame, of feet that stand: of ankle and ball, the one that stood
    /// stiller in the source.
    pub slide: Spread,
    /// Millimetres of the lowest mapped joint below the ground, over all frames; 0 where none is below.
    pub penetration: Spread,
}

/// How well one limb points where the source's does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimbDirection {
    /// Which.
    pub part: Part,
    /// Which of the two.
    pub side: Side,
    /// Degrees over all frames.
    pub degrees: Spread,
}

/// A handful of numbers for many; all 0 for none.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Spread {
    /// How many there are.
    pub count: usize,
    /// Their mean.
    pub mean: f64,
    /// The value that 95 of 100 do not exceed.
    pub p95: f64,
    /// The largest.
    pub max: f64,
}

/// What a certificate is held against.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CertificateLimits {
    /// Most degrees for the 95th percentile of [`Certificate::direction`]. Default: 5.
    pub direction_degrees: f64,
    /// Most millimetres a frame for the largest of [`Certificate::slide`]. Default: 5.
    pub slide_mm: f64,
    /// Most millimetres for the largest of [`Certificate::penetration`]. Default: 20.
    pub penetration_mm: f64,
}

impl Default for CertificateLimits {
    fn default() -> Self {
        Self { direction_degrees: 5.0, slide_mm: 5.0, penetration_mm: 20.0 }
    }
}

/// A limit that a result does not keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Broken {
    /// What was measured, with its unit.
    pub what: &'static str,
    /// What it is.
    pub value: f64,
    /// What it may be.
    pub limit: f64,
}

impl Certificate {
    /// Measures a result against the motion that it was made of.
    ///
    /// # Errors
    /// When one of the two is not a two-legged body: not for what [`retarget`](super::retarget) gave for `source`.
    pub fn of(source: &Clip, moved: &Retargeted) -> Result<Self, RetargetError> {
        let target = moved.clip.skeleton();
        let from = Humanoid::find(source.skeleton()).map_err(RetargetError::Source)?;
        let onto = Humanoid::find(target).map_err(RetargetError::Target)?;
        let (a, b) = (kinematics::positions(source), kinematics::positions(&moved.clip));
        let frames = a.frames().min(b.frames());
        let (limbs, all) = directions(&from, &onto, &a, &b, frames);
        let name = |skeleton: &Skeleton, joint: usize| {
            skeleton.joints().get(joint).map(|joint| joint.name.clone()).unwrap_or_default()
        };
        let led: Vec<usize> = moved.pairs.iter().map(|pair| pair.0).collect();
        let rests = |(index, joint): (usize, &crate::Joint)| {
            (!joint.end_site && !led.contains(&index)).then(|| joint.name.clone())
        };
        let depths = (0..frames).map(|frame| {
            let heights = led.iter().filter_map(|&joint| b.frame(frame).get(joint)).map(|place| place.y);
            f64::from((moved.ground - heights.fold(f32::INFINITY, f32::min)).max(0.0)) * 1e3
        });
        Ok(Self {
            scale: moved.scale,
            pairs: (moved.pairs.iter())
                .map(|&(own, other)| (name(target, own), name(source.skeleton(), other)))
                .collect(),
            unmapped: target.joints().iter().enumerate().filter_map(rests).collect(),
            direction: Spread::of(all),
            limbs,
            contacts: moved.contacts.len(),
            slide: Spread::of(slides(&from, &onto, moved, &a, &b)),
            penetration: Spread::of(depths.collect()),
        })
    }

    /// The limits that are not kept.
    pub fn broken(&self, limits: &CertificateLimits) -> Vec<Broken> {
        [
            (
                "direction of the limbs, degrees, 95th percentile",
                self.direction.p95,
                limits.direction_degrees,
            ),
            ("slide of standing feet, mm a frame, largest", self.slide.max, limits.slide_mm),
            ("depth below the ground, mm, largest", self.penetration.max, limits.penetration_mm),
        ]
        .into_iter()
        // What cannot be compared is not kept.
        .filter(|(_, value, limit)| !matches!(value.partial_cmp(limit), Some(order) if order.is_le()))
        .map(|(what, value, limit)| Broken { what, value, limit })
        .collect()
    }
}

impl Spread {
    /// Of values in any order.
    pub fn of(mut values: Vec<f64>) -> Self {
        values.sort_unstable_by(f64::total_cmp);
        let Some(last) = values.len().checked_sub(1) else { return Self::default() };
        Self {
            count: values.len(),
            mean: values.iter().sum::<f64>() / values.len() as f64,
            p95: values[(0.95 * last as f64).ceil() as usize],
            max: values[last],
        }
    }
}

/// Degrees between limbs that both bodies have: of each, and of all together.
fn directions(
    from: &Humanoid,
    onto: &Humanoid,
    a: &Positions,
    b: &Positions,
    frames: usize,
) -> (Vec<LimbDirection>, Vec<f64>) {
    let (mut limbs, mut all) = (Vec::new(), Vec::new());
    for (part, end) in LIMBS {
        for side in Side::BOTH {
            let ends = |body: &Humanoid| Some((body.joint(part, side)?, body.joint(end, side)?));
            let (Some(own), Some(other)) = (ends(from), ends(onto)) else { continue };
            let degrees: Vec<f64> = (0..frames)
                .map(|frame| {
                    let bone = |positions: &Positions, (begin, end): (usize, usize)| {
                        let places = positions.frame(frame);
                        (places[end] - places[begin]).as_dvec3()
                    };
                    bone(a, own).angle_between(bone(b, other)).to_degrees()
                })
                // A bone without length points nowhere.
                .filter(|degrees| degrees.is_finite())
                .collect();
            all.extend_from_slice(&degrees);
            limbs.push(LimbDirection { part, side, degrees: Spread::of(degrees) });
        }
    }
    (limbs, all)
}

/// Steps over the ground of what stands, millimetres: of ankle and ball, the one that stood stiller in the source.
fn slides(from: &Humanoid, onto: &Humanoid, moved: &Retargeted, a: &Positions, b: &Positions) -> Vec<f64> {
    let mut steps = Vec::new();
    for &(side, first, last) in &moved.contacts {
        let (Some(own), Some(other)) = (from.legs.get(side), onto.legs.get(side)) else { continue };
        let points = [(own.foot, other.foot), (own.toes, other.toes)];
        let points: Vec<(usize, usize)> = points.into_iter().filter_map(|(a, b)| Some((a?, b?))).collect();
        for frame in first + 1..=last.min(a.frames().min(b.frames()) - 1) {
            let step = |positions: &Positions, joint: usize| {
                (positions.frame(frame)[joint] - positions.frame(frame - 1)[joint]).with_y(0.0).length()
            };
            let stillest = points.iter().min_by(|x, y| step(a, x.0).total_cmp(&step(a, y.0)));
            steps.extend(stillest.map(|&(_, joint)| 1e3 * f64::from(step(b, joint))));
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_of_many_numbers() {
        let spread = Spread::of((1..=100).rev().map(f64::from).collect());
        assert_eq!(spread, Spread { count: 100, mean: 50.5, p95: 96.0, max: 100.0 });
        assert_eq!(Spread::of(vec![]), Spread::default());
    }
}
