//! A hand that draws: it trembles slowly, rounds corners and runs over a little.

use inkrig_sketch::storyboard::Stroke;

/// Canvas units a metre.
pub(super) const UNITS: f64 = 200.0;

/// Random numbers of a drawing.
#[derive(Debug, Clone)]
pub(super) struct Hand {
    state: u64,
}

impl Hand {
    pub(super) fn new(seed: u64) -> Self {
        Self { state: seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03 }
    }

    /// From -1 to 1.
    pub(super) fn chance(&mut self) -> f64 {
        self.state =
            self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    }

    /// A line through places (metres): rounded, trembling, on the canvas.
    pub(super) fn line(&mut self, through: &[[f64; 2]]) -> Stroke {
        let path = rounded(through);
        self.drawn(&path, 0.008)
    }

    /// Straight from place to place, corners and all.
    pub(super) fn corners(&mut self, through: &[[f64; 2]]) -> Stroke {
        let mut path = Vec::new();
        for pair in through.windows(2) {
            let steps = (distance(pair[0], pair[1]) / 0.02).ceil().max(1.0) as usize;
            path.extend((0..steps).map(|step| between(pair[0], pair[1], step as f64 / steps as f64)));
        }
        path.extend(through.last());
        self.drawn(&path, 0.006)
    }

    /// A round that almost closes.
    pub(super) fn round(&mut self, middle: [f64; 2], radius: f64) -> Stroke {
        let start = 1.2 + 0.5 * self.chance();
        let wide = radius * (1.0 + 0.06 * self.chance());
        let path: Vec<[f64; 2]> = (0..=36)
            .map(|at| {
                let angle = start + f64::from(at) / 36.0 * (std::f64::consts::TAU + 0.12);
                [middle[0] + wide * angle.cos(), middle[1] + radius * 1.08 * angle.sin()]
            })
            .collect();
        self.drawn(&path, 0.004)
    }

    fn drawn(&mut self, path: &[[f64; 2]], tremble: f64) -> Stroke {
        let waves: Vec<[f64; 4]> = (0..3)
            .map(|wave| {
                [6.0 + 7.0 * f64::from(wave), self.chance(), 3.0 * self.chance(), 3.0 * self.chance()]
            })
            .collect();
        let mut passed = 0.0;
        let mut before = path.first().copied().unwrap_or_default();
        let points = path
            .iter()
            .map(|point| {
                passed += distance(before, *point);
                before = *point;
                let off = |phase: usize| -> f64 {
                    waves
                        .iter()
                        .map(|wave| {
                            tremble * wave[1] * (wave[0] * passed + wave[phase]).sin() / wave[0] * 6.0
                        })
                        .sum()
                };
                [rounding(UNITS * (point[0] + off(2))), rounding(UNITS * (point[1] + off(3)))]
            })
            .collect();
        Stroke::new(points)
    }
}

/// The same line with a pen's time: slow at its ends, in so many seconds.
pub(super) fn in_time(line: Stroke, seconds: f64) -> Stroke {
    let last = line.points.len().saturating_sub(1).max(1) as f64;
    let times = (0..line.points.len()).map(|at| {
        let part = at as f64 / last;
        // The inverse of a smooth step, near enough.
        let eased = 0.5 + (2.0 * part - 1.0).abs().powf(1.4).copysign(2.0 * part - 1.0) * 0.5;
        rounding(seconds * eased * 100.0) / 100.0
    });
    Stroke { seconds: Some(times.collect()), ..line }
}

fn rounding(number: f64) -> f64 {
    (number * 10.0).round() / 10.0
}

/// Catmull-Rom through all places.
fn rounded(through: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let at = |index: isize| {
        let last = through.len().saturating_sub(1) as isize;
        through.get(index.clamp(0, last) as usize).copied().unwrap_or_default()
    };
    let mut path = Vec::new();
    for piece in 0..through.len().saturating_sub(1) as isize {
        let [a, b, c, d] = [at(piece - 1), at(piece), at(piece + 1), at(piece + 2)];
        let steps = (distance(b, c) / 0.02).ceil().max(2.0) as usize;
        for step in 0..steps {
            let t = step as f64 / steps as f64;
            let along = |axis: usize| {
                let (a, b, c, d) = (a[axis], b[axis], c[axis], d[axis]);
                0.5 * (2.0 * b
                    + (c - a) * t
                    + (2.0 * a - 5.0 * b + 4.0 * c - d) * t * t
                    + (3.0 * b - a - 3.0 * c + d) * t * t * t)
            };
            path.push([along(0), along(1)]);
        }
    }
    path.extend(through.last());
    path
}

fn between(a: [f64; 2], b: [f64; 2], t: f64) -> [f64; 2] {
    [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
