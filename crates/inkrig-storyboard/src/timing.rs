//! When a joint is where on its line: by the pen's own time, or by a speed that goes with the joint and the word; lines of
//! speed make it quicker where they are.

use crate::page::distance;
use inkrig_generate::text::{VERBS, actions_in};
use inkrig_motion::humanml::FRAME_RATE;
use inkrig_sketch::storyboard::Stroke;

/// How much quicker a line of speed makes the piece of way beside it.
const QUICKER: f64 = 0.25;
/// Pieces that a way is measured in.
const PIECES: usize = 256;
/// Frames of the shortest way.
pub(crate) const LEAST: usize = 4;
/// And no more: far beyond what a model can make, so that a pen's time cannot ask for memory without end.
const MOST: usize = 20_000;

/// A way as it is travelled: arc length over time, canvas units and seconds.
#[derive(Debug, Clone)]
pub(crate) struct Timed {
    /// Even in arc length.
    points: Vec<[f64; 2]>,
    /// When each is passed, from 0.
    seconds: Vec<f64>,
}

/// Times a line. `speed`: canvas units a second where the pen has no time.
pub(crate) fn timed(line: &Stroke, speed: f64, beside: &[&Stroke]) -> Timed {
    let lengths = cumulative(&line.points);
    let total = lengths.last().copied().unwrap_or(0.0);
    let pen = line.seconds.as_ref().filter(|times| span(times) > 0.0);
    let even: Vec<f64> = (0..=PIECES).map(|at| total * at as f64 / PIECES as f64).collect();
    let axis = |axis: usize| line.points.iter().map(|point| point[axis]).collect::<Vec<f64>>();
    let (across, up) = (axis(0), axis(1));
    let place = |length: &f64| [interpolate(&lengths, &across, *length), interpolate(&lengths, &up, *length)];
    let points: Vec<[f64; 2]> = even.iter().map(place).collect();
    // A pen that rests at one place takes time there: the time of a length is when the pen comes to it.
    let plain: Vec<f64> = even
        .iter()
        .map(|length| match pen {
            Some(times) => interpolate(&lengths, times, *length) - times.first().copied().unwrap_or(0.0),
            None => length / speed.max(f64::MIN_POSITIVE),
        })
        .collect();
    let mut factors = vec![1.0; PIECES];
    for dash in beside {
        let near = |end: Option<&[f64; 2]>| {
            let end = end?;
            let nearest = |at: &usize| distance(points[*at], *end);
            (0..points.len()).min_by(|a, b| nearest(a).total_cmp(&nearest(b)))
        };
        let (Some(a), Some(b)) = (near(dash.points.first()), near(dash.points.last())) else { continue };
        let (from, to) = (a.min(b).saturating_sub(PIECES / 32), (a.max(b) + PIECES / 32).min(PIECES));
        factors[from..to].iter_mut().for_each(|factor| *factor += QUICKER);
    }
    let mut seconds = vec![0.0];
    let mut passed = 0.0;
    for (pair, factor) in plain.windows(2).zip(&factors) {
        passed += (pair[1] - pair[0]).max(0.0) / factor;
        seconds.push(passed);
    }
    Timed { points, seconds }
}

impl Timed {
    /// How long it takes, seconds.
    pub(crate) fn seconds(&self) -> f64 {
        self.seconds.last().copied().unwrap_or(0.0)
    }

    /// How many frames it takes, at least [`LEAST`]; none more than [`MOST`], which no model makes.
    pub(crate) fn frames(&self) -> usize {
        let seconds = self.seconds.last().copied().unwrap_or(0.0);
        ((seconds * FRAME_RATE).round() as usize).clamp(LEAST, MOST)
    }

    /// A point a frame, from the first to the last.
    pub(crate) fn points(&self, frames: usize) -> Vec<[f64; 2]> {
        let whole = self.seconds.last().copied().unwrap_or(0.0);
        let numbers: Vec<f64> = (0..self.points.len()).map(|at| at as f64).collect();
        (0..frames)
            .map(|frame| {
                let time = whole * frame as f64 / (frames.max(2) - 1) as f64;
                let place = interpolate(&self.seconds, &numbers, time);
                let (at, part) = (place.floor() as usize, place.fract());
                let (a, b) = (self.points[at.min(PIECES)], self.points[(at + 1).min(PIECES)]);
                [a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]
            })
            .collect()
    }
}

/// Metres a second that a joint usually goes with while it is shown.
pub(crate) fn usual_speed(joint: usize, word: &str) -> f32 {
    let is = |names: &[&str]| {
        actions_in(word).into_iter().any(|at| VERBS.get(at).is_some_and(|verb| names.contains(&verb.name)))
    };
    let quick = is(&["run", "kick", "punch", "throw", "jump", "slash", "flip", "dribble"]);
    match joint {
        0 | 3 | 12 | 15 if is(&["run"]) => 2.8,
        0 | 3 | 12 | 15 if is(&["sit down", "stand up", "crouch", "bend", "crawl", "sneak"]) => 0.5,
        0 | 3 | 12 | 15 => 1.1,
        4 | 5 | 7 | 8 | 10 | 11 if quick => 2.2,
        4 | 5 | 7 | 8 | 10 | 11 => 1.1,
        _ if quick => 2.0,
        _ => 1.1,
    }
}

fn span(times: &[f64]) -> f64 {
    times.last().copied().unwrap_or(0.0) - times.first().copied().unwrap_or(0.0)
}

fn cumulative(points: &[[f64; 2]]) -> Vec<f64> {
    let mut lengths = vec![0.0];
    let mut passed = 0.0;
    for pair in points.windows(2) {
        passed += distance(pair[0], pair[1]);
        lengths.push(passed);
    }
    lengths
}

/// The value at `x`, between those at rising places.
fn interpolate(places: &[f64], values: &[f64], x: f64) -> f64 {
    let after = places.partition_point(|place| *place < x);
    let value = |at: usize| values.get(at).or(values.last()).copied().unwrap_or(0.0);
    let Some(before) = after.checked_sub(1) else { return value(0) };
    let (Some(&from), Some(&to)) = (places.get(before), places.get(after)) else { return value(before) };
    let part = if to > from { (x - from) / (to - from) } else { 0.0 };
    value(before) + part * (value(after) - value(before))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(seconds: Option<f64>) -> Stroke {
        let points: Vec<[f64; 2]> = (0..=50).map(|at| [f64::from(at) * 0.04, 0.0]).collect();
        let seconds = seconds.map(|all| (0..=50).map(|at| 7.0 + all * f64::from(at) / 50.0).collect());
        Stroke { points, seconds, pressure: None }
    }

    #[test]
    fn twice_as_fast_takes_half_the_frames() {
        for seconds in [0.6, 1.0, 1.7] {
            let slow = timed(&line(Some(2.0 * seconds)), 1.0, &[]).frames();
            let fast = timed(&line(Some(seconds)), 1.0, &[]).frames();
            assert!((slow as f64 / 2.0 - fast as f64).abs() <= 1.0, "{slow} {fast}");
        }
        // Without the pen's time the speed says how long.
        assert_eq!(timed(&line(None), 1.0, &[]).frames(), 40);
        assert_eq!(timed(&line(None), 2.0, &[]).frames(), 20);
    }

    #[test]
    fn denser_lines_of_speed_are_faster_and_only_where_they_are() {
        let dash = |from: f64, to: f64| Stroke::new(vec![[from, 0.1], [to, 0.1]]);
        let dashes: Vec<Stroke> = (0..6).map(|_| dash(1.2, 1.9)).collect();
        let mut before = usize::MAX;
        for count in [0, 1, 2, 4, 6] {
            let beside: Vec<&Stroke> = dashes.iter().take(count).collect();
            let frames = timed(&line(None), 1.0, &beside).frames();
            assert!(frames < before, "{count}: {frames} {before}");
            before = frames;
        }
        let beside: Vec<&Stroke> = dashes.iter().collect();
        let points = timed(&line(None), 1.0, &beside).points(20);
        let steps: Vec<f64> = points.windows(2).map(|pair| pair[1][0] - pair[0][0]).collect();
        assert!(steps[15] > 1.8 * steps[2], "{steps:?}");
        assert!(points[0][0].abs() < 1e-9 && (points[19][0] - 2.0).abs() < 1e-9);
    }
}
