//! Knees and elbows: how far they bend back, how far they bend at all, and how far to a side.

use super::poses;
use crate::Clip;
use crate::retarget::Retargeted;
use crate::rig::{Humanoid, Part, Side};
use glam::Vec3;

/// Anatomical ranges, degrees, from clinical tables of active motion with some room for how markers are placed: knees
/// 0 to 150, elbows 0 to 150.
const BACK: f64 = 10.0;
const BENT: f64 = 165.0;
/// To a side of the plane that it mostly bends in. Elbows seem to bend sideways as the upper arm twists.
const ASIDE: f64 = 25.0;
/// Below this a joint is straight, and no side can be told, degrees.
const STRAIGHT: f64 = 15.0;

/// How a knee or an elbow bends over all frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hinge {
    /// [`Part::LowerArm`] for an elbow, [`Part::LowerLeg`] for a knee.
    pub part: Part,
    /// Which of the two.
    pub side: Side,
    /// Of the result.
    pub result: Range,
    /// Of the source.
    pub source: Range,
}

/// How far a joint goes, degrees; none is below 0.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Range {
    /// Against the way that it mostly bends.
    pub back: f64,
    /// The way that it mostly bends.
    pub bent: f64,
    /// Out of the plane that it mostly bends in, for the frames in which it is bent; 95 of 100 frames are below.
    pub aside: f64,
}

impl Range {
    /// Degrees beyond what a body can do: 10 back, 165 bent, 25 aside.
    pub fn beyond(&self) -> f64 {
        (self.back - BACK).max(self.bent - BENT).max(self.aside - ASIDE).max(0.0)
    }
}

impl Hinge {
    /// Degrees beyond the range of a body, more than the source's joint is.
    pub fn beyond(&self) -> f64 {
        (self.result.beyond() - self.source.beyond()).max(0.0)
    }
}

/// Knees and elbows of two people.
pub(super) fn hinges(source: &Clip, moved: &Retargeted) -> Vec<Hinge> {
    let facts = &moved.facts;
    let (Some(from), Some(onto)) = (facts.from.humanoid(), facts.onto.humanoid()) else { return Vec::new() };
    let (own, other) = (ranges(source, from), ranges(&moved.clip, onto));
    let pair = |(source, result): (Option<Range>, Option<Range>), (part, side)| {
        Some(Hinge { part, side, result: result?, source: source? })
    };
    own.into_iter().zip(other).zip(joints()).filter_map(|(ranges, joint)| pair(ranges, joint)).collect()
}

fn joints() -> [(Part, Side); 4] {
    [
        (Part::LowerArm, Side::Left),
        (Part::LowerArm, Side::Right),
        (Part::LowerLeg, Side::Left),
        (Part::LowerLeg, Side::Right),
    ]
}

/// The range of each; `None` for one that the body does not have, or that is never bent.
fn ranges(clip: &Clip, body: &Humanoid) -> [Option<Range>; 4] {
    // The axis about which each bends, frame by frame, as long as the sine of the angle, in the upper bone's frame.
    let mut bends: [Vec<(Vec3, f64)>; 4] = Default::default();
    poses(clip, |_, pose| {
        for ((part, side), bends) in joints().into_iter().zip(&mut bends) {
            let parts = if part == Part::LowerArm {
                (Part::UpperArm, Part::LowerArm, Part::Hand)
            } else {
                (Part::UpperLeg, Part::LowerLeg, Part::Foot)
            };
            let joint = |part: Part| body.joint(part, side);
            let (Some(upper), Some(lower), Some(end)) = (joint(parts.0), joint(parts.1), joint(parts.2))
            else {
                continue;
            };
            let at = |joint: usize| pose.positions[joint];
            let above = (at(lower) - at(upper)).normalize_or_zero();
            let below = (at(end) - at(lower)).normalize_or_zero();
            let axis = pose.rotations[upper].conjugate() * above.cross(below);
            bends.push((axis, f64::from(above.dot(below).clamp(-1.0, 1.0).acos().to_degrees())));
        }
    });
    bends.map(|bends| range(&bends))
}

fn range(bends: &[(Vec3, f64)]) -> Option<Range> {
    let most = bends.iter().map(|bend| bend.0).sum::<Vec3>().try_normalize()?;
    let mut range = Range::default();
    let mut aside = Vec::new();
    for &(axis, degrees) in bends {
        let along = f64::from(axis.normalize_or_zero().dot(most).clamp(-1.0, 1.0));
        if along < 0.0 {
            range.back = range.back.max(degrees * -along);
        } else {
            range.bent = range.bent.max(degrees);
        }
        if degrees > STRAIGHT && along >= 0.0 {
            // As far as the lower bone leaves the plane.
            let sine = (1.0 - along * along).max(0.0).sqrt() * degrees.to_radians().sin().abs();
            aside.push(sine.asin().to_degrees());
        }
    }
    range.aside = super::Spread::of(aside).p95;
    Some(range)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_knee_that_bends_back_is_seen() {
        let bend = |degrees: f64| (Vec3::X * degrees.to_radians().sin() as f32, degrees.abs());
        let knee = range(&[bend(60.0), bend(30.0), bend(-20.0)]).unwrap();
        assert!((knee.back - 20.0).abs() < 1e-3 && (knee.bent - 60.0).abs() < 1e-3, "{knee:?}");
        assert!((knee.beyond() - 10.0).abs() < 1e-3);
        let aside = (Vec3::Z * 0.8, 60.0);
        assert!(range(&[bend(60.0), bend(60.0), bend(60.0), aside]).unwrap().aside > 25.0);
        assert_eq!(range(&[]), None);
    }
}
