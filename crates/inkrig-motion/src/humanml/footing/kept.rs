//! Joints that were asked to be somewhere.

use super::Pose;
use super::smoother::{Little, smooth};
use crate::MotionError;
use crate::humanml::JOINTS;
use glam::{DVec3, Vec3};

/// The time over which a motion goes back to what it was for a kept joint, seconds.
const EASE: f64 = 0.5;

/// A joint that was asked to be at a place at one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kept {
    /// From 0.
    pub frame: usize,
    /// From 0 to 21.
    pub joint: usize,
    /// World axes, metres.
    pub place: Vec3,
}

/// What is kept at each frame.
pub(super) struct Pins {
    joints: Vec<Vec<(usize, DVec3)>>,
}

impl Pins {
    pub(super) fn of(kept: &[Kept], frames: usize) -> Result<Self, MotionError> {
        let mut joints = vec![Vec::new(); frames];
        for pin in kept {
            if pin.joint >= JOINTS {
                let what = "the joints up to a kept one";
                return Err(MotionError::Length { what, expected: JOINTS, got: pin.joint.saturating_add(1) });
            }
            if !pin.place.is_finite() {
                let what = "the place of a kept joint";
                return Err(MotionError::NotFinite { what, joint: pin.joint, frame: pin.frame });
            }
            if let Some(own) = joints.get_mut(pin.frame) {
                own.push((pin.joint, pin.place.as_dvec3()));
            }
        }
        Ok(Self { joints })
    }

    /// Whether any joint, or any of some, is kept at a frame.
    pub(super) fn any(&self, frame: usize, of: Option<&[usize]>) -> bool {
        let own = self.joints.get(frame);
        own.is_some_and(|own| own.iter().any(|(joint, _)| of.is_none_or(|of| of.contains(joint))))
    }

    /// Where there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.joints.iter().all(Vec::is_empty)
    }

    /// How far all kept joints of a frame have to go up to be where they were asked to be, in the mean; none without.
    fn missing_height(&self, frame: usize, pose: &Pose) -> Option<f64> {
        let own = self.joints.get(frame).filter(|own| !own.is_empty())?;
        Some(own.iter().map(|(joint, place)| place.y - pose[*joint].y).sum::<f64>() / own.len() as f64)
    }

    /// Limits how far the body is raised: at kept frames it goes no farther than brings their joints nearer, and eases into that.
    pub(super) fn limit_heights(&self, raise: &mut [f64], poses: &[Pose], rate: f64) {
        let limited = |(frame, raise): (usize, &f64)| {
            let missing = self.missing_height(frame, &poses[frame])?;
            Some(raise.clamp(missing.min(0.0), missing.max(0.0)) - raise)
        };
        let changes: Vec<Option<f64>> = raise.iter().enumerate().map(limited).collect();
        let back = eased(&changes, rate);
        raise.iter_mut().zip(back).for_each(|(raise, back)| *raise += back);
    }
}

/// The weight at which a value is exact beside a stiffness.
pub(super) fn exact(stiffness: f64) -> f64 {
    1e6 * stiffness.max(1.0)
}

/// A smooth curve through what is given, nothing far away from it.
pub(super) fn eased(given: &[Option<f64>], rate: f64) -> Vec<f64> {
    if given.iter().all(Option::is_none) {
        return vec![0.0; given.len()];
    }
    let values: Vec<f64> = given.iter().map(|given| given.unwrap_or(0.0)).collect();
    let stiff = Little::Jerk.stiffness(EASE, rate);
    let weight = |given: &Option<f64>| if given.is_some() { exact(stiff) } else { 1.0 };
    smooth(&values, &given.iter().map(weight).collect::<Vec<_>>(), Little::Jerk, stiff)
}
