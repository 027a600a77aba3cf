//! The drawn curves: each in the format it shows.

use inkrig_sketch::{Curve, SketchError, shapes, to_csv, to_json, to_svg};

/// Points of a curve that has one a frame: ten seconds at 30 frames a second.
const SAMPLES: usize = 300;

/// A lap in two seconds: about as fast as an animal's gait changes, so that the drawing asks for movement.
const EIGHT_LAPS: usize = 5;

/// File names and bytes of all curves.
///
/// # Errors
/// Never in practice: when a shape is refused.
pub fn files() -> Result<Vec<(&'static str, String)>, SketchError> {
    Ok(vec![
        ("spiral.json", to_json(&shapes::growing_circles(5, SAMPLES)?)),
        ("eight.csv", to_csv(&shapes::figure_of_eight(EIGHT_LAPS, SAMPLES)?)),
        ("wave.svg", to_svg(&growing(&shapes::wave(6, 240)?)?)),
        ("heart.json", to_json(&drawn(&shapes::heart(180)?)?)),
    ])
}

/// The curve with heights that grow evenly from a sixth on its left to all on its right.
fn growing(curve: &Curve) -> Result<Curve, SketchError> {
    let grown = curve.points().iter().map(|&[x, y]| {
        let part = 0.5 * (x + 1.0);
        [x, rounded(y * (1.0 + 5.0 * part) / 6.0, 1e6)]
    });
    Curve::new(grown.collect())
}

/// The curve as a hand would draw it in 6 seconds: slow where it bends, quick where it is straight.
fn drawn(curve: &Curve) -> Result<Curve, SketchError> {
    const SECONDS: f64 = 6.0;
    let points = curve.points();
    let mut passed = vec![0.0];
    let mut time = 0.0;
    for index in 1..points.len() {
        let step =
            |from: usize, to: usize| [points[to][0] - points[from][0], points[to][1] - points[from][1]];
        let now = step(index - 1, index);
        let next = step(index, (index + 1).min(points.len() - 1));
        let bend = (now[0] * next[1] - now[1] * next[0]).atan2(now[0] * next[0] + now[1] * next[1]).abs();
        let length = now[0].hypot(now[1]);
        // The power law of drawing (Lacquaniti 1983): angular speed grows with curvature to the power 2/3.
        let curvature = bend / length.max(1e-9);
        time += length * (curvature + 0.5).cbrt();
        passed.push(time);
    }
    let scale = SECONDS / time;
    curve.clone().with_seconds(passed.iter().map(|passed| rounded(passed * scale, 1e4)).collect())
}

/// The nearest of `steps` values to the unit.
fn rounded(value: f64, steps: f64) -> f64 {
    // Adding 0 turns -0 into 0.
    (value * steps).round() / steps + 0.0
}
