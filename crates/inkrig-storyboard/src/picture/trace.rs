//! Lines of pixels become strokes: thinned, followed from end to end, and straight on where they cross.

use super::around;
use crate::page::distance;
use inkrig_generate::readers::graph::thin;

/// Pieces shorter than this that begin at a crossing come from thinning, pixels.
const SPUR: f64 = 9.0;
/// How far back a piece's direction is taken, points.
const BACK: usize = 9;
/// Two pieces are one line where the cosine of their bend is below this: they go on within 50 degrees.
const STRAIGHT: f64 = -0.64;
/// More pieces than this are a texture: they stay apart.
const MOST: usize = 300;
/// A line that goes under another colour comes out again within so many pixels.
const HIDDEN: f64 = 40.0;
/// So much of the way between has to be ink of some colour.
const COVERED: f64 = 0.8;
/// Points on each side that a place is the mean of.
const SMOOTH: usize = 2;

/// Strokes of a mask, pixels from the left and from the top. `ink`: pixels of lines of any colour, under which a line may go on.
pub(super) fn trace(mut mask: Vec<bool>, ink: &[bool], width: usize) -> Vec<Vec<[f64; 2]>> {
    if width < 3 || mask.len() < 3 * width {
        return Vec::new();
    }
    thin(&mut mask, width);
    let pieces = pieces(&mask, width);
    let hidden = |a: [f64; 2], b: [f64; 2]| {
        let steps = distance(a, b).ceil().max(1.0) as usize;
        let covered = (0..=steps).filter(|step| {
            let t = *step as f64 / steps as f64;
            let [x, y] = [0, 1].map(|axis| a[axis] + t * (b[axis] - a[axis]));
            ink.get(y.max(0.0) as usize * width + x.max(0.0) as usize).copied().unwrap_or(false)
        });
        covered.count() as f64 >= COVERED * (steps + 1) as f64
    };
    let joined = join(pieces, &hidden);
    joined.into_iter().filter(|line| line.len() > 3).map(|line| smoothed(&line)).collect()
}

/// Neighbours along the line: a diagonal one counts only where no other leads there.
fn steps(mask: &[bool], width: usize, at: usize) -> Vec<usize> {
    let near: Vec<usize> = around(at, width, mask.len()).filter(|other| mask[*other]).collect();
    let straight = |other: usize| other % width == at % width || other / width == at / width;
    let beside = |a: usize, b: usize| (a % width).abs_diff(b % width) + (a / width).abs_diff(b / width) == 1;
    let kept =
        |other: &usize| straight(*other) || !near.iter().any(|step| straight(*step) && beside(*step, *other));
    near.iter().copied().filter(kept).collect()
}

/// Runs between ends and crossings, and rounds.
fn pieces(mask: &[bool], width: usize) -> Vec<Vec<[f64; 2]>> {
    let place = |at: usize| [(at % width) as f64 + 0.5, (at / width) as f64 + 0.5];
    let lines: Vec<usize> = (0..mask.len()).filter(|at| mask[*at]).collect();
    let node = |at: usize| steps(mask, width, at).len() != 2;
    let mut done = vec![false; mask.len()];
    let mut out = Vec::new();
    let mut follow = |start: usize, first: usize, done: &mut Vec<bool>| {
        let mut line = vec![start, first];
        while let [.., before, at] = line[..] {
            if node(at) || at == start {
                break;
            }
            done[at] = true;
            let next = steps(mask, width, at)
                .into_iter()
                .find(|next| *next != before && (node(*next) || !done[*next]));
            match next {
                Some(next) => line.push(next),
                None => break,
            }
        }
        out.push(line.into_iter().map(place).collect());
    };
    for &start in lines.iter().filter(|at| node(**at)) {
        for first in steps(mask, width, start) {
            // A run between two crossings that touch is met from both.
            if !done[first] && (!node(first) || start < first) {
                follow(start, first, &mut done);
            }
        }
    }
    for &start in &lines {
        if !done[start] && !node(start) {
            done[start] = true;
            if let Some(first) = steps(mask, width, start).into_iter().find(|first| !done[*first]) {
                follow(start, first, &mut done);
            }
        }
    }
    out
}

/// Joins pieces that go on straight where they meet or under another colour, and leaves out short spurs where they meet.
fn join(pieces: Vec<Vec<[f64; 2]>>, hidden: &dyn Fn([f64; 2], [f64; 2]) -> bool) -> Vec<Vec<[f64; 2]>> {
    if pieces.len() > MOST {
        return pieces;
    }
    let length = |line: &[[f64; 2]]| line.windows(2).map(|pair| distance(pair[0], pair[1])).sum::<f64>();
    let ends: Vec<[[f64; 2]; 2]> =
        pieces.iter().filter_map(|line| Some([*line.first()?, *line.last()?])).collect();
    let meets = |own: usize, end: usize| {
        let at = ends[own][end];
        let others =
            ends.iter().enumerate().flat_map(|(number, both)| both.iter().map(move |place| (number, place)));
        others.filter(|(number, place)| *number != own && distance(**place, at) < 3.0).count()
    };
    let spur = |own: usize, line: &[[f64; 2]]| {
        length(line) < SPUR
            && (meets(own, 0) >= 2) != (meets(own, 1) >= 2)
            && meets(own, 0) * meets(own, 1) == 0
    };
    let mut lines: Vec<Vec<[f64; 2]>> = pieces
        .iter()
        .enumerate()
        .filter(|(own, line)| !spur(*own, line))
        .map(|(_, line)| line.clone())
        .collect();
    // The straightest pair first; short runs inside a crossing may be skipped over.
    loop {
        let mut best: Option<(f64, usize, bool, usize, bool)> = None;
        for a in 0..lines.len() {
            for b in a + 1..lines.len() {
                for (a_end, b_end) in [(false, false), (false, true), (true, false), (true, true)] {
                    let (Some(one), Some(other)) = (leaving(&lines[a], a_end), leaving(&lines[b], b_end))
                    else {
                        continue;
                    };
                    let apart = distance(one.0, other.0);
                    if apart > HIDDEN {
                        continue;
                    }
                    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
                    let bend = dot(one.1, other.1);
                    let between = [0, 1].map(|axis| (other.0[axis] - one.0[axis]) / apart.max(1e-9));
                    let met = apart <= 4.5
                        || (dot(one.1, between) < STRAIGHT
                            && dot(other.1, between) > -STRAIGHT
                            && hidden(one.0, other.0));
                    // Of two that are as straight, the nearer goes on.
                    let bend = bend + 0.01 * apart;
                    if bend < STRAIGHT && met && best.is_none_or(|best| bend < best.0) {
                        best = Some((bend, a, a_end, b, b_end));
                    }
                }
            }
        }
        let Some((_, a, a_end, b, b_end)) = best else { break };
        let mut second = lines.swap_remove(b);
        let Some(first) = lines.get_mut(a) else { break };
        // The first ends where the second begins.
        if !a_end {
            first.reverse();
        }
        if b_end {
            second.reverse();
        }
        first.extend(second.into_iter().skip(1));
    }
    lines
}

/// An end of a line, and the direction from it into the line.
fn leaving(line: &[[f64; 2]], end: bool) -> Option<([f64; 2], [f64; 2])> {
    let (at, inner) = if end {
        (line.last()?, line.get(line.len().saturating_sub(1 + BACK)).or(line.first())?)
    } else {
        (line.first()?, line.get(BACK).or(line.last())?)
    };
    let off = [inner[0] - at[0], inner[1] - at[1]];
    let length = off[0].hypot(off[1]);
    (length > 1.0).then(|| (*at, [off[0] / length, off[1] / length]))
}

/// Pixels' steps taken out, ends kept, every other point.
fn smoothed(line: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let last = line.len() - 1;
    let mean = |at: usize| {
        let reach = SMOOTH.min(at).min(last - at);
        let near = &line[at - reach..=at + reach];
        [0, 1].map(|axis| near.iter().map(|point| point[axis]).sum::<f64>() / near.len() as f64)
    };
    (0..=last).filter(|at| at % 2 == 0 || *at == last).map(mean).collect()
}
