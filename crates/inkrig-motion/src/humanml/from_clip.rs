//! The 22 joints of anybody's clip.

use super::{FRAME_RATE, JOINTS, Joints};
use crate::rig::{Arm, Humanoid, Leg};
use crate::{Clip, Skeleton, kinematics};
use glam::Vec3;

/// Where the spine joints of the body stand between pelvis and neck, as shares of the way.
const SPINE: [(usize, f32); 3] = [(3, 0.233), (6, 0.492), (9, 0.598)];

/// Where a collar stands between neck and shoulder, and how far below that line, in shares of its length.
const COLLAR: (f32, f32) = (0.35, 0.1);

/// The joints of a clip at [`FRAME_RATE`], in place, as a body of 22 joints: positions in between are interpolated.
///
/// Spine joints are spread along the line that the clip's own spine makes; collars of skeletons that have none, or
/// have them at the neck, stand a third of the way to the shoulder; toes of skeletons without are the foot's tip.
///
/// # Panics
/// When `body` was not found in the clip's skeleton.
pub fn from_clip(clip: &Clip, body: &Humanoid) -> Vec<Joints> {
    let positions = kinematics::positions(clip);
    let tips = Tips::of(clip.skeleton(), body);
    let own: Vec<Joints> =
        (0..clip.frames()).map(|frame| joints(positions.frame(frame), body, &tips)).collect();
    let step = clip.frame_rate() / FRAME_RATE;
    let count = ((clip.frames() - 1) as f64 / step + 1e-6).floor() as usize + 1;
    let at = |index: usize| {
        let place = index as f64 * step;
        let low = (place.floor() as usize).min(own.len() - 1);
        let high = (low + 1).min(own.len() - 1);
        let part = (place - low as f64) as f32;
        std::array::from_fn(|joint| own[low][joint].lerp(own[high][joint], part))
    };
    (0..count).map(at).collect()
}

/// What hangs on a hand, a foot or a head, for skeletons that name no joint there.
struct Tips {
    hands: [Option<usize>; 2],
    toes: [Option<usize>; 2],
}

impl Tips {
    fn of(skeleton: &Skeleton, body: &Humanoid) -> Self {
        let child = |of: usize| skeleton.joints().iter().position(|joint| joint.parent == Some(of));
        let hand = |arm: Option<Arm>| arm.and_then(|arm| arm.hand.or_else(|| child(arm.lower)));
        let toes = |leg: Leg| leg.toes.or_else(|| leg.foot.and_then(child));
        Self { hands: body.arms.map(hand), toes: body.legs.map(toes) }
    }
}

fn joints(places: &[Vec3], body: &Humanoid, tips: &Tips) -> Joints {
    let mut out = [Vec3::ZERO; JOINTS];
    let hips = body.legs.map(|leg| places[leg.upper]);
    let middle = 0.5 * (hips[0] + hips[1]);
    let pelvis = 0.5 * (middle + places[body.hips]);
    out[0] = pelvis;
    let shoulders = body.arms.map(|arm| arm.map(|arm| places[arm.upper]));
    let above = match shoulders {
        [Some(left), Some(right)] => 0.5 * (left + right),
        [Some(one), None] | [None, Some(one)] => one,
        [None, None] => pelvis + 0.5 * Vec3::Y,
    };
    let neck = body.neck.first().map_or(above, |&joint| places[joint]);
    let head = body.head.map_or(neck + 0.2 * (neck - pelvis), |joint| places[joint]);
    (out[12], out[15]) = (neck, head);
    let line: Vec<Vec3> =
        std::iter::once(pelvis).chain(body.spine.iter().map(|&joint| places[joint])).chain([neck]).collect();
    for (joint, share) in SPINE {
        out[joint] = along(&line, share);
    }
    let down = (pelvis - neck).normalize_or_zero();
    for (index, (arm, hand)) in body.arms.iter().zip(tips.hands).enumerate() {
        let shoulder = shoulders[index].unwrap_or(neck);
        let across = shoulder - neck;
        let own = arm.and_then(|arm| arm.clavicle).map(|clavicle| places[clavicle]);
        // A collar bone that begins at the neck says nothing of where the collar is.
        let own = own.filter(|own| (*own - neck).dot(across) > 0.15 * across.length_squared());
        out[13 + index] = own.unwrap_or(neck + COLLAR.0 * across + COLLAR.1 * across.length() * down);
        out[16 + index] = shoulder;
        let elbow = arm.map_or(shoulder, |arm| places[arm.lower]);
        out[18 + index] = elbow;
        out[20 + index] = hand.map_or(elbow, |hand| places[hand]);
    }
    for (index, (leg, toes)) in body.legs.iter().zip(tips.toes).enumerate() {
        out[1 + index] = hips[index];
        out[4 + index] = places[leg.lower];
        let ankle = leg.foot.map_or(places[leg.lower], |foot| places[foot]);
        out[7 + index] = ankle;
        out[10 + index] = toes.map_or(ankle, |toes| places[toes]);
    }
    out
}

/// The point at a share of the length of a line.
fn along(line: &[Vec3], share: f32) -> Vec3 {
    let total: f32 = line.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    let mut left = share * total;
    for pair in line.windows(2) {
        let length = pair[0].distance(pair[1]);
        if left <= length && length > 0.0 {
            return pair[0].lerp(pair[1], left / length);
        }
        left -= length;
    }
    line.last().copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_of_a_bent_line() {
        let line = [Vec3::ZERO, Vec3::X, Vec3::X + 3.0 * Vec3::Y];
        assert_eq!(along(&line, 0.25), Vec3::X);
        assert_eq!(along(&line, 0.5), Vec3::new(1.0, 1.0, 0.0));
        assert_eq!(along(&[Vec3::Z; 3], 0.5), Vec3::Z);
    }
}
