//! What else is on a page.

use super::Chance;
use inkrig_generate::readers::ink::Mark;
use inkrig_generate::schedule::Noise;

/// Marks that are no part of the figure, around its bounds (left, bottom, right, top).
pub(super) fn clutter(bounds: [f32; 4], pen: f32, noise: &mut Noise) -> Vec<Mark> {
    let [left, bottom, right, top] = bounds;
    let (wide, high) = (right - left, top - bottom);
    let mut marks = Vec::new();
    let mut line = |points: Vec<[f32; 2]>, ink: f32| {
        let points = points.into_iter().map(|[x, y]| [x, y, pen * 0.8]).collect();
        marks.push(Mark::Stroke { points, ink });
    };
    if noise.happens(0.5) {
        // The floor.
        let y = bottom + noise.between(-0.04, 0.06) * high;
        let tilt = noise.between(-0.05, 0.05) * wide;
        let (from, to) = (left - noise.between(0.0, 0.2) * wide, right + noise.between(0.0, 0.2) * wide);
        line(vec![[from, y - tilt], [to, y + tilt]], noise.between(0.4, 1.0));
    }
    for _ in 0..noise.below(4) {
        // Short marks beside the figure: arrows, speed lines, scribbles.
        let beside = noise.happens(0.5);
        let x = if beside {
            left - noise.between(0.0, 0.15) * wide
        } else {
            right + noise.between(0.0, 0.15) * wide
        };
        let y = bottom + noise.between(0.0, 1.0) * high;
        let (mut at, mut turn) = ([x, y], noise.between(0.0, std::f32::consts::TAU));
        let mut points = vec![at];
        for _ in 0..2 + noise.below(5) {
            turn += noise.between(-0.9, 0.9);
            at = [at[0] + 0.06 * turn.cos(), at[1] + 0.06 * turn.sin()];
            points.push(at);
        }
        line(points, noise.between(0.4, 1.0));
    }
    for _ in 0..noise.below(6) {
        // Specks.
        let at = [left + noise.between(-0.1, 1.1) * wide, bottom + noise.between(-0.1, 1.1) * high];
        line(vec![at, [at[0] + 0.01, at[1]]], noise.between(0.2, 0.9));
    }
    marks
}
