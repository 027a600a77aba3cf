//! Which lines are trunk, arms and legs: the choice whose lengths are most like a body's.

use super::StrokeGraph;
use super::head::Head;
use super::walk::{Lines, apart};
use crate::readers::sketch::KEY_POINTS;

/// Lengths by that of the trunk, shoulders to pelvis.
const ARM: f32 = 1.3;
const LEG: f32 = 2.0;
const NECK: f32 = 0.35;
/// Ends and meetings that are looked at, at most.
const MOST: usize = 20;

/// A trunk, two hands, two feet, with what it costs to take them for that.
struct Body {
    cost: f32,
    shoulders: usize,
    pelvis: usize,
    hands: [usize; 2],
    feet: [usize; 2],
}

/// The best match. `None` where there are too few lines.
pub(super) fn match_body(lines: &Lines, head: &Head) -> Option<StrokeGraph> {
    let (mut ends, mut meetings) = lines.ends_and_meetings();
    let (from_neck, _) = lines.ways(lines.neck);
    ends.retain(|&at| from_neck[at].is_finite() && from_neck[at] > 1.5 * head.radius);
    meetings.retain(|&at| from_neck[at].is_finite());
    if ends.len() < 2 || meetings.is_empty() {
        return None;
    }
    // Far ends are limbs; near ones are fingers and overrun lines.
    ends.sort_by(|a, b| from_neck[*b].total_cmp(&from_neck[*a]));
    ends.truncate(MOST);
    meetings.truncate(MOST);
    let ways: Vec<(Vec<f32>, Vec<usize>)> = meetings.iter().map(|&at| lines.ways(at)).collect();
    let mut best: Option<(Body, usize, usize)> = None;
    for (high, &shoulders) in meetings.iter().enumerate() {
        for (low, &pelvis) in meetings.iter().enumerate() {
            let trunk = ways[high].0[pelvis];
            if high == low
                || !trunk.is_finite()
                || trunk < head.radius
                || from_neck[pelvis] < from_neck[shoulders]
            {
                continue;
            }
            let along = |length: f32, usual: f32| (length.max(1.0) / (usual * trunk)).ln().powi(2);
            let hand =
                |at: usize| along(ways[high].0[at], ARM) + 2.0 * closer(ways[low].0[at], ways[high].0[at]);
            let foot =
                |at: usize| along(ways[low].0[at], LEG) + 2.0 * closer(ways[high].0[at], ways[low].0[at]);
            let Some((hands, arms)) = cheapest(&ends, None, &hand) else { continue };
            let Some((feet, legs)) = cheapest(&ends, Some(hands), &foot) else { continue };
            let upright = (lines.places[shoulders][1] - lines.places[pelvis][1]).max(0.0) / trunk;
            let cost = arms
                + legs
                + 0.5 * along(from_neck[shoulders].max(0.1 * trunk), NECK).min(2.0)
                + (trunk / (3.2 * head.radius)).ln().powi(2)
                + upright;
            if best.as_ref().is_none_or(|(body, _, _)| cost < body.cost) {
                best = Some((Body { cost, shoulders, pelvis, hands, feet }, high, low));
            }
        }
    }
    let (body, high, low) = best?;
    Some(key_points(lines, head, &body, &ways[high].1, &ways[low].1))
}

/// A cost where a limb is nearer to the wrong end of the trunk.
fn closer(to_other: f32, to_own: f32) -> f32 {
    if to_other < to_own { 1.0 } else { 0.0 }
}

/// Two ends for a pair of limbs. One end may serve for both where there is no other, at a price.
fn cheapest(
    ends: &[usize],
    without: Option<[usize; 2]>,
    cost: &dyn Fn(usize) -> f32,
) -> Option<([usize; 2], f32)> {
    let mut order: Vec<(f32, usize)> = ends
        .iter()
        .filter(|at| without.is_none_or(|taken| !taken.contains(at)))
        .map(|&at| (cost(at), at))
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    match order[..] {
        [first, second, ..] => Some(([first.1, second.1], first.0 + second.0)),
        [only] => Some(([only.1, only.1], 2.0 * only.0 + 1.5)),
        [] => None,
    }
}

fn key_points(lines: &Lines, head: &Head, body: &Body, up: &[usize], low: &[usize]) -> StrokeGraph {
    let place = |at: usize| lines.places[at];
    let between =
        |a: [f32; 2], b: [f32; 2], share: f32| [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
    let (shoulders, pelvis) = (place(body.shoulders), place(body.pelvis));
    let trunk = apart(shoulders, pelvis).max(1.0);
    let mut places = [[0.0; 2]; KEY_POINTS];
    places[0] = pelvis;
    places[3] = between(pelvis, shoulders, 0.25);
    places[10] = between(shoulders, head.middle, 0.25);
    places[13] = head.middle;
    // The limb on the right of the picture is a left one.
    let sides = |ends: [usize; 2]| {
        let [a, b] = ends;
        if place(a)[0] >= place(b)[0] { [a, b] } else { [b, a] }
    };
    for (side, hand) in sides(body.hands).into_iter().enumerate() {
        let way = way(lines, up, body.shoulders, hand);
        let (elbow, _) = corner(&way);
        places[14 + side] = elbow;
        places[16 + side] = place(hand);
        // Collars lie a little way along the arm.
        places[11 + side] = along(&way, 0.25 * trunk);
    }
    for (side, foot) in sides(body.feet).into_iter().enumerate() {
        let way = way(lines, low, body.pelvis, foot);
        let (knee, ankle) = corner(&way);
        places[4 + side] = knee;
        places[6 + side] = ankle;
        places[8 + side] = place(foot);
        places[1 + side] = along(&way, 0.15 * trunk);
    }
    let fit = (-0.5 * body.cost).exp().clamp(0.0, 1.0);
    StrokeGraph { places, confidence: [fit; KEY_POINTS] }
}

/// The way from a meeting to an end.
fn way(lines: &Lines, before: &[usize], from: usize, to: usize) -> Vec<[f32; 2]> {
    let mut way = vec![lines.places[to]];
    let mut at = to;
    while at != from && before[at] != usize::MAX {
        at = before[at];
        way.push(lines.places[at]);
    }
    way.reverse();
    way
}

fn lengths(way: &[[f32; 2]]) -> Vec<f32> {
    let mut sum = 0.0;
    let steps = way.windows(2).map(|pair| {
        sum += apart(pair[0], pair[1]);
        sum
    });
    std::iter::once(0.0).chain(steps).collect()
}

/// The place so far along a way.
fn along(way: &[[f32; 2]], far: f32) -> [f32; 2] {
    let at = lengths(way).iter().position(|length| *length >= far).unwrap_or(way.len() - 1);
    way[at]
}

/// Elbow or knee, and the end of the lower bone: the last bit of a leg that turns off is a foot.
fn corner(way: &[[f32; 2]]) -> ([f32; 2], [f32; 2]) {
    let lengths = lengths(way);
    let whole = lengths.last().copied().unwrap_or(0.0);
    let index = |share: f32| lengths.iter().position(|length| *length >= share * whole).unwrap_or(0);
    let (first, last) = (index(0.3), index(0.7));
    let (from, to) = (way[0], way[way.len() - 1]);
    // Half way, unless a corner stands out from the straight line.
    let chord = apart(from, to).max(1.0);
    let out = |at: usize| {
        let [x, y] = way[at];
        ((to[0] - from[0]) * (y - from[1]) - (to[1] - from[1]) * (x - from[0])).abs() / chord
    };
    let best = (first..=last).max_by(|a, b| out(*a).total_cmp(&out(*b))).unwrap_or(first);
    let middle = if out(best) > 0.06 * whole { best } else { index(0.5) };
    // A foot: the last eighth turned by more than 40 degrees from what was before it.
    let ankle = index(0.87);
    let turn = |a: [f32; 2], b: [f32; 2], c: [f32; 2]| {
        let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
        (u[0] * v[0] + u[1] * v[1]) / (u[0].hypot(u[1]) * v[0].hypot(v[1])).max(1e-3)
    };
    let is_foot = turn(way[middle], way[ankle], to) < 0.77;
    (way[middle], if is_foot { way[ankle] } else { to })
}
