//! A hand that draws lines.

use super::{Chance, Style};
use inkrig_generate::readers::ink::Mark;
use inkrig_generate::schedule::Noise;
use inkrig_motion::glam::Vec2;
use std::f32::consts::TAU;

/// Metres between the points of a line.
const STEP: f32 = 0.04;

/// Draws marks in a style.
pub(super) struct Pen<'a> {
    pub style: &'a Style,
    pub noise: &'a mut Noise,
    /// Width of the next lines, as a multiple of the style's.
    pub width: f32,
    /// How dark the insides of the next outlines are, if they are filled.
    pub fill: Option<f32>,
}

impl Pen<'_> {
    /// A line through places, with all that the hand does to it. Gives where it came through each of them, the mean over repeats.
    pub(super) fn line(&mut self, way: &[Vec2], marks: &mut Vec<Mark>) -> Vec<Vec2> {
        let mut shown = vec![Vec2::ZERO; way.len()];
        for repeat in 0..self.style.repeats {
            let ink =
                if repeat == 0 { self.style.ink } else { self.style.ink * self.noise.between(0.4, 1.0) };
            let mut way = way.to_vec();
            self.run_over(&mut way);
            let stray = self.style.wobble * if repeat == 0 { 1.0 } else { 1.6 };
            let line = self.stroke(&way, stray, ink, marks);
            let share = 1.0 / self.style.repeats.max(1) as f32;
            for (shown, at) in shown.iter_mut().zip(places_in_dense(&way)) {
                *shown += share * line.get(at).copied().unwrap_or_default();
            }
        }
        shown
    }

    /// A closed line; its ends overlap or miss each other a little.
    pub(super) fn outline(&mut self, around: &[Vec2], marks: &mut Vec<Mark>) {
        let Some(&first) = around.first() else { return };
        self.inside(around, marks);
        for repeat in 0..self.style.repeats {
            let ink =
                if repeat == 0 { self.style.ink } else { self.style.ink * self.noise.between(0.4, 1.0) };
            let turn = self.noise.below(around.len());
            let mut way: Vec<Vec2> =
                around.iter().cycle().skip(turn).take(around.len() + 1).copied().collect();
            if self.noise.happens(0.3) {
                let more: Vec<Vec2> = way.iter().skip(1).take(around.len() / 8).copied().collect();
                way.extend(more);
            }
            if way.is_empty() {
                way.push(first);
            }
            self.stroke(&way, self.style.wobble * 0.6, ink, marks);
        }
    }

    /// What an outline holds: ink, or paper that hides what was drawn before.
    pub(super) fn inside(&mut self, around: &[Vec2], marks: &mut Vec<Mark>) {
        if let Some(fill) = self.fill {
            let ink = fill * self.noise.between(0.85, 1.0);
            self.area(around, ink, marks);
        } else if self.style.hides {
            self.area(around, 0.0, marks);
        }
    }

    pub(super) fn area(&mut self, around: &[Vec2], ink: f32, marks: &mut Vec<Mark>) {
        let outline = around.iter().map(Vec2::to_array).collect();
        marks.push(Mark::Area { outlines: vec![outline], ink });
    }

    /// Ends go a little too far, or fall a little short.
    fn run_over(&mut self, way: &mut [Vec2]) {
        let most = self.style.overshoot;
        if let [first, second, ..] = way {
            *first += (*first - *second).normalize_or_zero() * self.noise.between(-0.6 * most, most);
        }
        if let [.., before, last] = way {
            *last += (*last - *before).normalize_or_zero() * self.noise.between(-0.6 * most, most);
        }
    }

    /// One stroke; gives the places that it went through, those of [`dense`].
    fn stroke(&mut self, way: &[Vec2], stray: f32, ink: f32, marks: &mut Vec<Mark>) -> Vec<Vec2> {
        let points = dense(way);
        let waves = self.waves(stray);
        let length = (points.len() as f32 - 1.0).max(1.0);
        let (jitter, taper) = (self.style.jitter, self.style.taper);
        let width = self.style.pen * self.width * self.noise.between(0.85, 1.15);
        let swell = self.noise.between(0.3, 0.7);
        let mut line: Vec<[f32; 3]> = Vec::with_capacity(points.len());
        for (at, point) in points.iter().enumerate() {
            let along = at as f32 * STEP;
            let mut off = Vec2::ZERO;
            for (way, rate, phase) in &waves {
                off += *way * (rate * along + phase).sin();
            }
            if jitter > 0.0 {
                off += Vec2::new(self.noise.between(-jitter, jitter), self.noise.between(-jitter, jitter));
            }
            let share = at as f32 / length;
            let bow = if share < swell { share / swell } else { (1.0 - share) / (1.0 - swell) };
            let width = width * (1.0 - taper * (1.0 - bow.clamp(0.0, 1.0)));
            let point = *point + off;
            line.push([point.x, point.y, width]);
        }
        let went = line.iter().map(|[x, y, _]| Vec2::new(*x, *y)).collect();
        if self.noise.happens(self.style.gaps) && line.len() > 5 {
            let first = 1 + self.noise.below(line.len() - 4);
            let end = (first + 1 + self.noise.below(3)).min(line.len() - 1);
            let rest = line.split_off(end);
            line.truncate(first + 1);
            marks.push(Mark::Stroke { points: rest, ink });
        }
        marks.push(Mark::Stroke { points: line, ink });
        went
    }

    /// Slow straying: directions with how quickly and from where they swing.
    fn waves(&mut self, stray: f32) -> [(Vec2, f32, f32); 3] {
        [0.8_f32, 2.0, 5.0].map(|rate| {
            let size = stray * 0.6 / rate.sqrt().max(1.0);
            let way = Vec2::from_angle(self.noise.between(0.0, TAU)) * size * self.noise.between(0.3, 1.4);
            (way, TAU * rate * self.noise.between(0.6, 1.5), self.noise.between(0.0, TAU))
        })
    }
}

/// The same way with a point every few centimetres.
fn dense(way: &[Vec2]) -> Vec<Vec2> {
    let mut points: Vec<Vec2> = way.first().copied().into_iter().collect();
    for pair in way.windows(2) {
        let count = pieces(pair);
        points.extend((1..=count).map(|at| pair[0].lerp(pair[1], at as f32 / count as f32)));
    }
    points
}

/// Where the places of a way are among those of [`dense`].
fn places_in_dense(way: &[Vec2]) -> impl Iterator<Item = usize> {
    let ends = way.windows(2).scan(0, |at, pair| {
        *at += pieces(pair);
        Some(*at)
    });
    std::iter::once(0).chain(ends)
}

fn pieces(pair: &[Vec2]) -> usize {
    let [from, to] = pair else { return 0 };
    ((*to - *from).length() / STEP).ceil().clamp(1.0, 200.0) as usize
}

/// A smooth way through places (Catmull and Rom).
pub(super) fn smooth(through: &[Vec2], closed: bool) -> Vec<Vec2> {
    let count = through.len();
    if count < 3 {
        return through.to_vec();
    }
    let at = |index: isize| {
        let index =
            if closed { index.rem_euclid(count as isize) } else { index.clamp(0, count as isize - 1) };
        through[index as usize]
    };
    let pieces = if closed { count } else { count - 1 };
    let mut out = Vec::with_capacity(pieces * 6 + 1);
    for piece in 0..pieces as isize {
        let [a, b, c, d] = [-1, 0, 1, 2].map(|by| at(piece + by));
        for step in 0..6 {
            let t = step as f32 / 6.0;
            let (t2, t3) = (t * t, t * t * t);
            out.push(
                0.5 * (2.0 * b
                    + (c - a) * t
                    + (2.0 * a - 5.0 * b + 4.0 * c - d) * t2
                    + (3.0 * b - a - 3.0 * c + d) * t3),
            );
        }
    }
    if !closed {
        out.push(at(count as isize - 1));
    }
    out
}

/// An ellipse with its axes along `up` and across it.
pub(super) fn ellipse(middle: Vec2, up: Vec2, height: f32, width: f32) -> Vec<Vec2> {
    let across = up.perp();
    let corner = |at: usize| {
        let (sin, cos) = (at as f32 / 20.0 * TAU).sin_cos();
        middle + up * (cos * height) + across * (sin * width)
    };
    (0..20).map(corner).collect()
}

/// An outline around a bone, with a radius at each end.
pub(super) fn capsule(from: Vec2, to: Vec2, first: f32, last: f32) -> Vec<Vec2> {
    let along = (to - from).normalize_or(Vec2::Y);
    let cap = |middle: Vec2, radius: f32, start: f32| {
        (0..=6).map(move |at| {
            let turn = Vec2::from_angle(start + at as f32 / 6.0 * 0.5 * TAU);
            middle + turn.rotate(along) * radius
        })
    };
    cap(to, last, -0.25 * TAU).chain(cap(from, first, 0.25 * TAU)).collect()
}
