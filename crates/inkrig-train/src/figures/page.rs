//! Marks on paper, as a scanner or a camera shows them.

use super::clutter::clutter;
use super::{Chance, Drawn};
use inkrig_generate::readers::ink::{Ink, Mark, Placement};
use inkrig_generate::readers::sketch::{KEY_POINTS, MARGIN, SIDE};
use inkrig_generate::schedule::Noise;

/// What a picture is taken under.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// Margin around the ink, as a share of its longer side: least and most.
    pub margin: [f32; 2],
    /// Share of pages with other marks.
    pub clutter: f64,
    /// Share of pages that are blurred, grainy, unevenly lit or partly erased.
    pub worn: f64,
}

impl Conditions {
    /// As the reader is taught.
    pub const LEARNED: Self = Self { margin: [0.04, 0.22], clutter: 0.2, worn: 0.5 };
    /// As the reader crops.
    pub const READ: Self = Self { margin: [MARGIN, MARGIN], clutter: 0.2, worn: 0.5 };
}

/// A picture of a figure, and what is to be read.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// [`SIDE`] x [`SIDE`] pixels.
    pub ink: Ink,
    /// Key points in pixels, where the drawing has them.
    pub places: [[f32; 2]; KEY_POINTS],
    /// Those where the pose has them, which the drawing need not show.
    pub captured: [[f32; 2]; KEY_POINTS],
    /// Whether they are drawn.
    pub drawn: [bool; KEY_POINTS],
    /// Neck to pelvis in space, pixels.
    pub torso: f32,
}

/// Puts a drawing on paper.
pub fn picture(drawn: &Drawn, conditions: &Conditions, noise: &mut Noise) -> Picture {
    let mut bounds = bounds(&drawn.marks);
    let mut marks = drawn.marks.clone();
    if noise.happens(conditions.clutter) {
        marks.extend(clutter(bounds, 0.03, noise));
        bounds = self::bounds(&marks);
    }
    let [left, bottom, right, top] = bounds;
    let longer = (right - left).max(top - bottom).max(0.1);
    let [least, most] = conditions.margin;
    let whole = longer * (1.0 + 2.0 * noise.between(least, most));
    let free = [whole - (right - left), whole - (top - bottom)];
    let off = [0, 1].map(|axis| free[axis] * (0.5 + 0.5 * noise.between(-1.0, 1.0) * (most - least)));
    let scale = SIDE as f32 / whole;
    let placement =
        Placement { scale, origin: [(off[0] - left) * scale, SIDE as f32 - (off[1] - bottom) * scale] };
    let mut ink = Ink::new(SIDE, SIDE);
    ink.draw(&marks, &placement);
    if noise.happens(conditions.worn) {
        wear(&mut ink, noise);
    }
    Picture {
        ink,
        places: drawn.key_points.map(|place| placement.pixel(place)),
        captured: drawn.captured.map(|place| placement.pixel(place)),
        drawn: drawn.drawn,
        torso: drawn.torso * scale,
    }
}

/// Left, bottom, right, top of all marks.
pub(crate) fn bounds(marks: &[Mark]) -> [f32; 4] {
    let mut bounds = [f32::INFINITY, f32::INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY];
    let mut take = |x: f32, y: f32, half: f32| {
        bounds[0] = bounds[0].min(x - half);
        bounds[1] = bounds[1].min(y - half);
        bounds[2] = bounds[2].max(x + half);
        bounds[3] = bounds[3].max(y + half);
    };
    for mark in marks {
        match mark {
            Mark::Stroke { points, .. } => points.iter().for_each(|[x, y, width]| take(*x, *y, 0.5 * width)),
            Mark::Area { outlines, .. } => outlines.iter().flatten().for_each(|[x, y]| take(*x, *y, 0.0)),
        }
    }
    if bounds[0].is_finite() { bounds } else { [-1.0, -1.0, 1.0, 1.0] }
}

pub(crate) fn wear(ink: &mut Ink, noise: &mut Noise) {
    let (width, height) = (ink.width, ink.height);
    if noise.happens(0.12) {
        // Somebody used the eraser.
        let at = [width, height].map(|size| noise.between(0.2, 0.8) * size as f32);
        let size = noise.between(3.0, 9.0);
        for (place, pixel) in ink.pixels.iter_mut().enumerate() {
            let off = ((place % width) as f32 - at[0]).hypot((place / width) as f32 - at[1]);
            *pixel *= ((off - size) / 2.0).clamp(0.15, 1.0);
        }
    }
    if noise.happens(0.6) {
        for _ in 0..=noise.below(2) {
            blur(ink);
        }
    }
    let gain = noise.between(0.6, 1.3);
    let grain = if noise.happens(0.5) { noise.between(0.0, 0.12) } else { 0.0 };
    let (paper, slope) = (noise.between(0.0, 0.08), [noise.between(-0.06, 0.06), noise.between(-0.06, 0.06)]);
    for (place, pixel) in ink.pixels.iter_mut().enumerate() {
        let x = (place % width) as f32 / width as f32 - 0.5;
        let y = (place / width) as f32 / height as f32 - 0.5;
        let mut light = paper + slope[0] * x + slope[1] * y;
        if grain > 0.0 {
            light += grain * (noise.uniform() as f32 - 0.5);
        }
        *pixel = (*pixel * gain + light).clamp(0.0, 1.0);
    }
}

/// A soft lens: a quarter, a half, a quarter, in both directions.
fn blur(ink: &mut Ink) {
    let (width, height) = (ink.width, ink.height);
    let before = ink.pixels.clone();
    for y in 0..height {
        for x in 1..width - 1 {
            let at = y * width + x;
            ink.pixels[at] = 0.25 * (before[at - 1] + before[at + 1]) + 0.5 * before[at];
        }
    }
    let before = ink.pixels.clone();
    for at in width..width * (height - 1) {
        ink.pixels[at] = 0.25 * (before[at - width] + before[at + width]) + 0.5 * before[at];
    }
}
