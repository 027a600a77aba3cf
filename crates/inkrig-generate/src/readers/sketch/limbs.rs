//! Which of its likely places each joint of a limb takes, so that both arms, and both legs, are limbs of one figure.
//!
//! Every heat map speaks for itself: where left and right can be told only by guessing, a knee may be taken from one leg and its ankle from the
//! other, or one leg twice. So of every joint a few places are kept, and those are taken that are likely together: bones that do
//! not cross bare paper, none much longer than the trunk, and no two joints at one place.

use super::{KEY_POINTS, Reading, SIDE};
use crate::readers::ink::Ink;

/// Places of a joint that are looked at.
const MODES: usize = 4;
/// The least share of a map's heat that a place is looked at for.
const LEAST: f32 = 0.01;
/// Ways of one limb that are compared with those of the other.
const WAYS: usize = 64;
/// Darkness of ink.
const INK: f32 = 0.3;
/// What speaks against a bone, by the longest stretch of bare paper on it, in torsos, and by what it is longer than one; both as
/// logarithms, like the heat.
const BARE: f32 = 1.0;
const LONG: f32 = 2.0;
/// The most that speaks against one: what is nearly sure stays, whatever its bones look like.
const MOST: f32 = 1.5;
/// What speaks against the same joint of both sides being at one place, which is nearer than this share of the torso.
const SAME: f32 = 0.5;
const NEAR: f32 = 0.12;

/// Legs and arms, left and right, from the body outwards.
const LIMBS: [[&[usize]; 2]; 2] = [[&[1, 4, 6, 8], &[2, 5, 7, 9]], [&[11, 14, 16], &[12, 15, 17]]];

/// A place and its share of the heat.
type Mode = ([f32; 2], f32);

/// A limb: what speaks for it, and which mode each of its joints takes.
struct Way {
    score: f32,
    modes: Vec<usize>,
}

/// Takes other places for joints of limbs where they are likelier together; `maps` are logarithms of shares.
pub(super) fn together(maps: &[Vec<f32>], ink: &Ink, reading: &mut Reading) {
    let modes: Vec<Vec<Mode>> = maps.iter().map(|map| modes(map)).collect();
    if modes.len() < KEY_POINTS || modes.iter().any(Vec::is_empty) {
        return;
    }
    let page = Page { ink, torso: apart(reading.places[0], reading.places[10]).max(0.1 * SIDE as f32) };
    for sides in LIMBS {
        let [left, right] = sides.map(|limb| ways(limb, &modes, reading, &page));
        let mut best: Option<(f32, &Way, &Way)> = None;
        for a in &left {
            for b in &right {
                let most = a.score + b.score;
                if best.is_some_and(|(score, _, _)| most <= score) {
                    // Both are in the order of their scores.
                    break;
                }
                let place = |limb: &[usize], way: &Way, at: usize| modes[limb[at]][way.modes[at]].0;
                let same = (1..sides[0].len()).filter(|&at| {
                    let drawn = sides.iter().all(|limb| drawn(reading, limb[at]));
                    drawn && apart(place(sides[0], a, at), place(sides[1], b, at)) < NEAR * page.torso
                });
                let score = most - SAME * same.count() as f32;
                if best.is_none_or(|(other, _, _)| score > other) {
                    best = Some((score, a, b));
                }
            }
        }
        let Some((_, left, right)) = best else { continue };
        for (limb, way) in sides.into_iter().zip([left, right]) {
            for (&point, &mode) in limb.iter().zip(&way.modes) {
                (reading.places[point], reading.confidence[point]) = modes[point][mode];
            }
        }
    }
}

/// What is not drawn lies nowhere: its map says nothing, and it has no bone.
fn drawn(reading: &Reading, point: usize) -> bool {
    reading.drawn[point] > 0.5
}

/// The likeliest ways of a limb, best first.
fn ways(limb: &[usize], modes: &[Vec<Mode>], reading: &Reading, page: &Page<'_>) -> Vec<Way> {
    let mut ways = vec![Way { score: 0.0, modes: Vec::new() }];
    for (at, &point) in limb.iter().enumerate() {
        let before = at.checked_sub(1).map(|before| limb[before]);
        let before = before.filter(|before| drawn(reading, *before) && drawn(reading, point));
        let own = if drawn(reading, point) { &modes[point][..] } else { &modes[point][..1] };
        let mut longer: Vec<Way> = Vec::with_capacity(ways.len() * own.len());
        for way in &ways {
            for (mode, (place, share)) in own.iter().enumerate() {
                let from = before.zip(way.modes.last()).map(|(before, mode)| modes[before][*mode].0);
                let bone = from.map_or(0.0, |from| page.against(from, *place));
                let mut modes = way.modes.clone();
                modes.push(mode);
                longer.push(Way { score: way.score + share.max(1e-4).ln() - bone, modes });
            }
        }
        longer.sort_by(|a, b| b.score.total_cmp(&a.score));
        longer.truncate(WAYS);
        ways = longer;
    }
    ways
}

struct Page<'a> {
    ink: &'a Ink,
    /// Neck to pelvis, pixels.
    torso: f32,
}

impl Page<'_> {
    /// What speaks against a bone between two places.
    fn against(&self, from: [f32; 2], to: [f32; 2]) -> f32 {
        let length = apart(from, to);
        let steps = (length as usize).clamp(1, 2 * SIDE);
        let (mut bare, mut longest) = (0_usize, 0_usize);
        for at in 0..=steps {
            let share = at as f32 / steps as f32;
            let on = self.inked([0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis])));
            bare = if on { 0 } else { bare + 1 };
            longest = longest.max(bare);
        }
        let bare = (longest as f32 * length / steps as f32 / self.torso).min(1.0);
        (BARE * bare + LONG * (length / self.torso - 1.0).max(0.0)).min(MOST)
    }

    /// Whether there is ink at a place or beside it.
    fn inked(&self, [x, y]: [f32; 2]) -> bool {
        let dark = |(right, down): (f32, f32)| {
            let (x, y) = (x + right, y + down);
            let inside = x >= 0.0 && y >= 0.0 && x < self.ink.width as f32 && y < self.ink.height as f32;
            let pixel =
                inside.then(|| self.ink.pixels.get(y as usize * self.ink.width + x as usize)).flatten();
            pixel.is_some_and(|pixel| *pixel > INK)
        };
        [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)].into_iter().any(dark)
    }
}

/// The hottest places of a map, the hottest first; there is always one.
fn modes(map: &[f32]) -> Vec<Mode> {
    let mut map = map.to_vec();
    let mut found = Vec::with_capacity(MODES);
    while found.len() < MODES {
        let (place, share) = super::decode::hottest(&map);
        if share < LEAST && !found.is_empty() {
            break;
        }
        found.push((place, share));
        super::decode::cool(&mut map);
    }
    found
}

fn apart([x, y]: [f32; 2], [a, b]: [f32; 2]) -> f32 {
    (x - a).hypot(y - b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::readers::ink::{Mark, Placement};
    use crate::readers::sketch::{CELLS, decode};

    /// A heat map with some places and their shares, cells.
    fn warm(heat: &mut [f32], point: usize, places: &[([f32; 2], f32)]) {
        for cell in 0..CELLS * CELLS {
            let bell = |&([x, y], share): &([f32; 2], f32)| {
                let (dx, dy) = ((cell % CELLS) as f32 + 0.5 - x, (cell / CELLS) as f32 + 0.5 - y);
                share * (-0.5 * (dx * dx + dy * dy) / 0.25).exp()
            };
            heat[cell * KEY_POINTS + point] = (places.iter().map(bell).sum::<f32>() + 1e-9).ln();
        }
    }

    #[test]
    fn a_leg_is_not_read_twice_nor_put_together_of_two() {
        let mut heat = vec![0.0; CELLS * CELLS * KEY_POINTS];
        let (mut one, mut other) = ([[0.0; 2]; 4], [[0.0; 2]; 4]);
        for at in 0..4 {
            one[at] = [22.0 + 2.0 * at as f32, 20.0 + 5.0 * at as f32];
            other[at] = [18.0 - 2.0 * at as f32, 20.0 + 5.0 * at as f32];
        }
        for point in 0..KEY_POINTS {
            warm(&mut heat, point, &[([20.0, if point == 10 { 10.0 } else { 20.0 }], 1.0)]);
        }
        // The hips are known; both knees are rather taken for the one, the ankles for the other.
        for (at, (left, right)) in [(1, 2), (4, 5), (6, 7), (8, 9)].into_iter().enumerate() {
            let more = [0.9, 0.55, 0.45, 0.5][at];
            warm(&mut heat, left, &[(one[at], more), (other[at], 1.0 - more)]);
            let more = [0.1, 0.52, 0.45, 0.5][at];
            warm(&mut heat, right, &[(one[at], more), (other[at], 1.0 - more)]);
        }
        let presence = vec![4.0; KEY_POINTS];
        let mut ink = Ink::new(SIDE, SIDE);
        let cell = (SIDE / CELLS) as f32;
        let line = |way: [[f32; 2]; 4]| Mark::Stroke {
            points: way.map(|[x, y]| [cell * x, -cell * y, 3.0]).to_vec(),
            ink: 1.0,
        };
        ink.draw(&[line(one), line(other)], &Placement { scale: 1.0, origin: [0.0, 0.0] });
        let reading = decode(&heat, &presence, &ink);
        let off = |point: usize, [x, y]: [f32; 2]| apart(reading.places[point], [cell * x, cell * y]);
        for (at, (left, right)) in [(1, 2), (4, 5), (6, 7), (8, 9)].into_iter().enumerate() {
            assert!(off(left, one[at]) < 2.0, "{at}: {:?}", reading.places[left]);
            assert!(off(right, other[at]) < 2.0, "{at}: {:?}", reading.places[right]);
        }
        assert!((reading.confidence[6] - 0.45).abs() < 0.02, "{}", reading.confidence[6]);

        // Sure joints stay where they are, though a line leads elsewhere.
        warm(&mut heat, 6, &[([5.0, 5.0], 0.98), (one[2], 0.02)]);
        let reading = decode(&heat, &presence, &ink);
        assert!(apart(reading.places[6], [20.0, 20.0]) < 2.0, "{:?}", reading.places[6]);
    }

    #[test]
    fn a_hand_that_is_not_drawn_does_not_push_the_other_away() {
        let mut heat = vec![0.0; CELLS * CELLS * KEY_POINTS];
        for point in 0..KEY_POINTS {
            warm(&mut heat, point, &[([20.0, if point == 10 { 10.0 } else { 20.0 }], 1.0)]);
        }
        warm(&mut heat, 16, &[([25.0, 20.0], 0.55), ([20.0, 25.0], 0.45)]);
        warm(&mut heat, 17, &[([25.0, 20.0], 1.0)]);
        let paper = Ink::new(SIDE, SIDE);
        let hand = |right: f32| {
            let mut presence = vec![4.0; KEY_POINTS];
            presence[17] = right;
            decode(&heat, &presence, &paper).places[16]
        };
        assert!(apart(hand(-4.0), [100.0, 80.0]) < 2.0, "{:?}", hand(-4.0));
        assert!(apart(hand(4.0), [80.0, 100.0]) < 2.0, "{:?}", hand(4.0));
    }

    #[test]
    fn no_heat_and_no_paper_are_no_panic() {
        let numbers = CELLS * CELLS * KEY_POINTS;
        let short = Ink { width: SIDE, height: SIDE, pixels: vec![0.0; 5] };
        for heat in
            [vec![], vec![f32::NAN; numbers], vec![f32::INFINITY; numbers], vec![0.0; 7], vec![0.0; numbers]]
        {
            for ink in [&Ink::new(1, 1), &short] {
                let reading = decode(&heat, &[], ink);
                assert!(
                    reading.places.iter().flatten().all(|along| along.is_finite()),
                    "{:?}",
                    reading.places
                );
            }
        }
    }
}
