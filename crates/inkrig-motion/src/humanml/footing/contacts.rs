//! When feet stand.

use super::Pose;
use glam::DVec3;

/// Hip, knee, ankle and toe, left and right.
pub(super) const LEGS: [[usize; 4]; 2] = [[1, 4, 7, 10], [2, 5, 8, 11]];
/// How high an ankle may be over the floor on a foot that stands flat, and how high it is when that cannot be seen, metres.
const HEEL: std::ops::RangeInclusive<f64> = 0.03..=0.1;
const USUAL_HEEL: f64 = 0.05;
/// Of the feet that stand still, the share whose ankles are lower over their toes: they are not flat.
const LOW_HEELS: f64 = 0.1;
/// Slower than this, metres a second, ankle and toe are still.
const STILL: f64 = 0.4;

/// A foot that moves so quickly, metres a second, or is so high, metres, as likely swings as it stands.
const QUICK: f64 = 0.7;
const HIGH: f64 = 0.08;
/// A foot does not carry a leg whose knee is lower than this, metres.
const KNEELS: f64 = 0.15;
/// The most that speed or height count.
const MOST: f64 = 4.0;
/// Costs: of a foot that swings; of a body on no foot that is not in the air; of putting a foot down or lifting it; of a
/// network's opinion.
const SWING: f64 = 1.0;
const NOTHING: f64 = 1.5;
const CHANGE: f64 = 2.0;
const OPINION: f64 = 0.5;

/// The time that it takes to put a foot down or to lift it, seconds.
const SETTLE: f64 = 0.1;

/// Left and right, for every frame.
pub(super) type Planted = Vec<[bool; 2]>;

/// How high the ankle is over the toe of a foot that stands flat, metres: as seen where feet are still.
pub(super) fn heel(poses: &[Pose], rate: f64) -> f64 {
    let mut heights = Vec::new();
    for pair in poses.windows(2) {
        for [_, _, ankle, toe] in LEGS {
            let still =
                [ankle, toe].iter().all(|joint| pair[0][*joint].distance(pair[1][*joint]) * rate < STILL);
            let over = pair[0][ankle].y - pair[0][toe].y;
            heights.extend((still && HEEL.contains(&over)).then_some(over));
        }
    }
    heights.sort_unstable_by(f64::total_cmp);
    let at = (LOW_HEELS * heights.len() as f64) as usize;
    heights.get(at).filter(|_| heights.len() > 3).copied().unwrap_or(USUAL_HEEL)
}

/// Which feet stand at each frame: of all the ways in which they might the likeliest (Viterbi), by how high and how quick they are, what a
/// network says, and that feet do not change their minds. In the air none does.
pub(super) fn planted(
    poses: &[Pose],
    contacts: &[[f32; 4]],
    airborne: &[bool],
    (rate, heel): (f64, f64),
) -> Planted {
    const STATES: usize = 4;
    let stands = |state: usize, foot: usize| state & (1 << foot) != 0;
    let (mut costs, mut from) = ([0.0_f64; STATES], Vec::with_capacity(poses.len()));
    for frame in 0..poses.len() {
        let own: [f64; 2] = [0, 1].map(|foot| cost(poses, contacts, foot, frame, (rate, heel)));
        // Another part carries the body: nobody need stand.
        let carried = carried_by_feet(&poses[frame], heel);
        let (mut next, mut best) = ([f64::INFINITY; STATES], [0; STATES]);
        for state in 0..STATES {
            if state != 0 && airborne[frame] {
                continue;
            }
            let alone = if state == 0 && carried && !airborne[frame] { NOTHING } else { 0.0 };
            let of = |foot: usize| if stands(state, foot) { own[foot] } else { SWING };
            for (before, cost) in costs.iter().enumerate() {
                let changes = (state ^ before).count_ones();
                let changes = if frame == 0 { 0.0 } else { CHANGE * f64::from(changes) };
                let total = cost + changes + alone + of(0) + of(1);
                if total < next[state] {
                    (next[state], best[state]) = (total, before);
                }
            }
        }
        costs = next;
        from.push(best);
    }
    let mut state = (0..STATES).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or(0);
    let mut planted = vec![[false; 2]; poses.len()];
    for frame in (0..poses.len()).rev() {
        planted[frame] = [stands(state, 0), stands(state, 1)];
        state = from[frame][state];
    }
    planted
}

/// How much is against a foot standing at a frame.
fn cost(poses: &[Pose], contacts: &[[f32; 4]], foot: usize, frame: usize, (rate, heel): (f64, f64)) -> f64 {
    let square = |value: f64| (value * value).min(MOST);
    let knee = poses[frame][LEGS[foot][1]];
    if knee.y < KNEELS {
        return 2.0 * MOST;
    }
    let height = height(&poses[frame], foot, heel).abs();
    let around = frame.saturating_sub(1)..(frame + 1).min(poses.len().saturating_sub(1));
    let steps = around.clone().map(|at| step(&poses[at], &poses[at + 1], foot, heel).length());
    let speed = steps.sum::<f64>() * rate / around.len().max(1) as f64;
    let said = contacts.get(frame).map_or(0.5, |row| 0.5 * f64::from(row[2 * foot] + row[2 * foot + 1]));
    let said = if said.is_finite() { said.clamp(0.0, 1.0) } else { 0.5 };
    square(speed / QUICK) + square(height / HIGH) + OPINION * (1.0 - 2.0 * said)
}

/// The height of a foot's sole over the floor.
pub(super) fn height(pose: &Pose, foot: usize, heel: f64) -> f64 {
    let [_, _, ankle, toe] = LEGS[foot];
    pose[toe].y.min(pose[ankle].y - heel)
}

/// How far what a foot stands on goes to the next frame: its toe, or its heel while the toe is up.
pub(super) fn step(now: &Pose, next: &Pose, foot: usize, heel: f64) -> DVec3 {
    let [_, _, ankle, toe] = LEGS[foot];
    let toe_is_up = |pose: &Pose| pose[toe].y > pose[ankle].y - heel + 0.02;
    let joint = if toe_is_up(now) && toe_is_up(next) { ankle } else { toe };
    next[joint] - now[joint]
}

/// Whether the lowest part of a body is one of its feet, or nearly.
pub(super) fn carried_by_feet(pose: &Pose, heel: f64) -> bool {
    height(pose, 0, heel).min(height(pose, 1, heel)) < super::floor::lowest(pose, heel) + 0.05
}

/// How surely a foot stands at each frame of a contact, from 0 at the frames in which it is put down or lifted to 1 inside of it.
pub(super) fn settled((first, last): (usize, usize), count: usize, rate: f64) -> Vec<f64> {
    let settle = (SETTLE * rate).max(1e-9);
    let share = |frame: usize| {
        // The motion's own ends are no edges.
        let begun = if first == 0 { settle } else { (frame - first) as f64 };
        let left = if last + 1 == count { settle } else { (last - frame) as f64 };
        (begun.min(left) / settle).min(1.0)
    };
    (first..=last).map(share).collect()
}
