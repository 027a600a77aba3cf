//! A tail that is longer than the source's does not go through the ground.

use super::super::figure::Figure;
use super::super::transfer::Moved;
use super::settle::tilt;
use crate::Skeleton;

/// Turns a tail up at its root, as far as its lowest joint is below the ground.
pub(super) fn lift(moved: &mut Moved, target: &Skeleton, onto: &Figure, ground: f32) {
    let Some(tail) = onto.quadruped().map(|body| &body.tail).filter(|tail| tail.len() > 1) else { return };
    let mut hangs = vec![false; target.len()];
    for (index, joint) in target.joints().iter().enumerate() {
        hangs[index] = index == tail[0] || joint.parent.is_some_and(|parent| hangs[parent]);
    }
    for frame in 0..moved.turns.len() {
        // Another joint may be the lowest after a turn.
        for _ in 0..4 {
            let now = moved.places(frame, target);
            let lowest = tail[1..].iter().copied().min_by(|&a, &b| now[a].y.total_cmp(&now[b].y));
            let Some(lowest) = lowest.filter(|&joint| now[joint].y < ground) else { break };
            let turn = tilt(now[lowest] - now[tail[0]], ground - now[lowest].y);
            for (own, _) in moved.turns[frame].iter_mut().zip(&hangs).filter(|(_, hangs)| **hangs) {
                *own = (turn * *own).normalize();
            }
        }
    }
}
