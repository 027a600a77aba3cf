//! Thin lines as a graph of pixels, and ways along them.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Gaps of so many pixels are jumped, at so much more than their length.
const JUMP: f32 = 9.0;
const JUMP_COST: f32 = 1.5;
/// More gaps than this are no figure's.
const MOST_JUMPS: usize = 40;
/// More pixels of lines than this are no figure.
const MOST: usize = 4000;

/// Pixels of lines, with who is beside whom.
#[derive(Debug)]
pub(super) struct Lines {
    pub places: Vec<[f32; 2]>,
    beside: Vec<Vec<(usize, f32)>>,
    /// In how many directions lines leave each pixel.
    leaving: Vec<usize>,
    /// Where the neck leaves the head.
    pub neck: usize,
}

impl Lines {
    /// Of thinned lines, as far as they hang together with the head, over small gaps.
    pub(super) fn new(lines: &[bool], width: usize, head: [f32; 2], radius: f32) -> Option<Self> {
        let pixels: Vec<usize> = (0..lines.len()).filter(|&at| lines[at]).collect();
        if pixels.len() < 20 || pixels.len() > MOST {
            return None;
        }
        let places: Vec<[f32; 2]> =
            pixels.iter().map(|&at| [(at % width) as f32 + 0.5, (at / width) as f32 + 0.5]).collect();
        let mut number = vec![usize::MAX; lines.len()];
        pixels.iter().enumerate().for_each(|(own, &at)| number[at] = own);
        let mut beside: Vec<Vec<(usize, f32)>> = vec![Vec::new(); places.len()];
        for (own, &at) in pixels.iter().enumerate() {
            let around = [at + 1, at + width - 1, at + width, at + width + 1];
            for next in around {
                let other = number.get(next).copied().unwrap_or(usize::MAX);
                if other != usize::MAX {
                    let length = apart(places[own], places[other]);
                    beside[own].push((other, length));
                    beside[other].push((own, length));
                }
            }
        }
        let leaving = pixels.iter().map(|&at| leaving(lines, width, at)).collect();
        let mut lines = Self { places, beside, leaving, neck: 0 };
        lines.jump_gaps();
        let off = |at: &usize| apart(lines.places[*at], head);
        lines.neck = (0..lines.places.len()).min_by(|a, b| off(a).total_cmp(&off(b)))?;
        (off(&lines.neck) < 2.0 * radius + 12.0).then_some(lines)
    }

    /// Ends, and where lines meet; close ones once.
    pub(super) fn ends_and_meetings(&self) -> (Vec<usize>, Vec<usize>) {
        let (mut ends, mut meetings): (Vec<usize>, Vec<usize>) = (Vec::new(), Vec::new());
        for (at, leaving) in self.leaving.iter().enumerate() {
            let into = match leaving {
                0 | 1 => &mut ends,
                2 => continue,
                _ => &mut meetings,
            };
            if into.iter().all(|&other| apart(self.places[other], self.places[at]) > 4.0) {
                into.push(at);
            }
        }
        (ends, meetings)
    }

    /// How far every pixel is along the lines, and where the way came from.
    pub(super) fn ways(&self, from: usize) -> (Vec<f32>, Vec<usize>) {
        let mut far = vec![f32::INFINITY; self.places.len()];
        let mut before = vec![usize::MAX; self.places.len()];
        let mut open = BinaryHeap::from([Open { far: 0.0, at: from }]);
        far[from] = 0.0;
        while let Some(Open { far: own, at }) = open.pop() {
            if own > far[at] {
                continue;
            }
            for &(next, length) in &self.beside[at] {
                if own + length < far[next] {
                    far[next] = own + length;
                    before[next] = at;
                    open.push(Open { far: own + length, at: next });
                }
            }
        }
        (far, before)
    }

    /// Joins parts that hang together, each to the nearest of the others, where the gap is small.
    fn jump_gaps(&mut self) {
        for _ in 0..MOST_JUMPS {
            let (far, _) = self.ways(0);
            let (mut best, mut own) = (JUMP, None);
            let outside: Vec<usize> = (0..self.places.len()).filter(|&at| far[at].is_infinite()).collect();
            for &other in &outside {
                for at in (0..self.places.len()).filter(|&at| far[at].is_finite()) {
                    let gap = apart(self.places[at], self.places[other]);
                    if gap < best {
                        (best, own) = (gap, Some((at, other)));
                    }
                }
            }
            let Some((a, b)) = own else { return };
            self.beside[a].push((b, best * JUMP_COST));
            self.beside[b].push((a, best * JUMP_COST));
        }
    }
}

/// How often paper turns to line on the way around a pixel.
fn leaving(lines: &[bool], width: usize, at: usize) -> usize {
    let around = |turn: usize| {
        let (x, y) = [(1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1), (0, 0)][turn % 8];
        // Lines keep a pixel from the border.
        (at + y * width + x).checked_sub(width + 1).is_some_and(|at| lines.get(at).copied().unwrap_or(false))
    };
    (0..8).filter(|&turn| !around(turn) && around(turn + 1)).count()
}

/// How far two places are apart.
pub(super) fn apart(a: [f32; 2], b: [f32; 2]) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// A pixel whose way is known so far; the nearest comes first.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Open {
    far: f32,
    at: usize,
}

impl Eq for Open {}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.far.total_cmp(&self.far).then(other.at.cmp(&self.at))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
