//! Hips as high as the legs are long: bones of other proportions make a leg that points as the source's longer or
//! shorter than the scaled one, and the hips go with those legs that stand, so that knees need not give way.

use super::super::figure::Figure;
use super::super::transfer::Moved;
use super::{EASE, Ground, lift};
use crate::Skeleton;
use glam::{Quat, Vec3};

/// Raises and lowers the hips; an animal's trunk is tilted too, so that fore and hind legs both reach the ground.
pub(super) fn settle(
    moved: &mut Moved,
    target: &Skeleton,
    from: &Figure,
    onto: &Figure,
    ground: &Ground<'_>,
) {
    let trunk = trunk(target, onto, ground.led);
    let ease = (EASE * ground.rate).round().max(1.0);
    let count = onto.legs.len().min(from.legs.len());
    for frame in 0..moved.turns.len() {
        let now = moved.places(frame, target);
        let lifts: Vec<(f32, f32)> = (0..count)
            .map(|leg| {
                let contacts = ground.standing.contacts.iter().filter(|contact| contact.0 == leg);
                let stands = contacts.map(|&(_, first, last)| ground.share(frame, (first, last), ease));
                let weight = stands.fold(0.0, f32::max);
                (weight, lift(leg, (&from.legs[leg], &onto.legs[leg]), &now, frame, ground))
            })
            .collect();
        // With one leg that fades out the hips go back to where they would be.
        let raise = |lifts: &[(f32, f32)]| {
            let weight: f32 = lifts.iter().map(|lift| lift.0).sum();
            lifts.iter().map(|lift| lift.0 * lift.1).sum::<f32>() / weight.max(1.0)
        };
        let Some(trunk) = trunk.as_ref().filter(|_| count == 4) else {
            moved.hips[frame].y += raise(&lifts);
            continue;
        };
        let (hind, fore) = (raise(&lifts[..2]), raise(&lifts[2..]));
        let middle = |places: &[Vec3], first: usize| {
            0.5 * (places[onto.legs[first].upper] + places[onto.legs[first + 1].upper])
        };
        let back = middle(&now, 2) - middle(&now, 0);
        let tilt = tilt(back, fore - hind);
        for (turn, _) in moved.turns[frame].iter_mut().zip(trunk).filter(|(_, own)| **own) {
            *turn = (tilt * *turn).normalize();
        }
        let goal = onto.middle(&now) + Vec3::Y * 0.5 * (hind + fore);
        let tilted = moved.places(frame, target);
        moved.hips[frame] += goal - onto.middle(&tilted);
    }
}

/// The turn in its own upright plane that raises a trunk's front end.
pub(super) fn tilt(trunk: Vec3, raise: f32) -> Quat {
    let (long, axis) = (trunk.length(), trunk.with_y(0.0).cross(Vec3::Y));
    let (Some(axis), true) = (axis.try_normalize(), long > 0.0) else { return Quat::IDENTITY };
    let angle = |height: f32| (height / long).clamp(-0.95, 0.95).asin();
    Quat::from_axis_angle(axis, angle(trunk.y + raise) - angle(trunk.y))
}

/// Joints of an animal's trunk, with what hangs on them and does not turn by itself.
fn trunk(target: &Skeleton, onto: &Figure, led: &[usize]) -> Option<Vec<bool>> {
    let body = onto.quadruped()?;
    let girdles = body.hind.iter().chain(&body.fore).flat_map(|leg| leg.girdle.iter().copied());
    let own: Vec<usize> =
        std::iter::once(body.hips).chain(body.spine.iter().copied()).chain(girdles).collect();
    let mut trunk = vec![false; target.len()];
    for (index, joint) in target.joints().iter().enumerate() {
        let above = joint.parent.is_some_and(|parent| trunk[parent]);
        trunk[index] = own.contains(&index) || (above && !led.contains(&index));
    }
    Some(trunk)
}
