//! A word in somebody's hand.

use super::Font;
use crate::figures::{Chance, bounds, wear};
use inkrig_generate::readers::ink::{Ink, Mark, Placement};
use inkrig_generate::readers::word::{HEIGHT, WIDTH, fit};
use inkrig_generate::schedule::Noise;
use std::f32::consts::TAU;

/// Which letters are large.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Case {
    /// None.
    Small,
    /// The first.
    First,
    /// All.
    Large,
}

/// A word as a line that the reader sees: [`HEIGHT`] x [`WIDTH`] pixels. Letters stray, the line leans and bends, the pen is of any
/// width, the paper may be worn.
pub fn write_word(word: &str, case: Case, font: &Font, noise: &mut Noise) -> Ink {
    let marks = marks(word, case, font, noise);
    let [left, bottom, right, top] = bounds(&marks);
    // People do not crop as exactly as programs.
    let around = noise.between(0.0, 0.12) * (top - bottom);
    let placed = fit([1000.0 * (right - left + around), 1000.0 * (top - bottom + around)]);
    let scale = 1000.0 * placed.scale;
    let shift = if noise.happens(0.3) { noise.between(0.0, 30.0) } else { 0.0 };
    let free = (WIDTH as f32 - 3.0 - scale * (right - left)).max(0.0);
    let origin = [
        placed.origin[0] + shift.min(free) + scale * (0.5 * around - left),
        placed.origin[1] + scale * (0.5 * around + top),
    ];
    let mut ink = Ink::new(WIDTH, HEIGHT);
    ink.draw(&marks, &Placement { scale, origin });
    if noise.happens(0.4) {
        wear(&mut ink, noise);
    }
    ink
}

fn marks(word: &str, case: Case, font: &Font, noise: &mut Noise) -> Vec<Mark> {
    let lean = noise.between(-0.2, 0.35) * f32::from(u8::from(noise.happens(0.6)));
    let stretch = noise.between(0.75, 1.3);
    let (tilt, bow) = (noise.between(-0.06, 0.06), noise.between(-0.15, 0.15));
    let spacing = noise.between(-0.05, 0.25) * f32::from(u8::from(noise.happens(0.6)));
    let unsteady = noise.between(0.0, 1.0);
    let pen = noise.between(0.08, 0.34);
    let bold = if font.single_line { pen } else { noise.between(-0.12, 0.16) };
    // A slow wave that bends all letters alike.
    let waves: [[f32; 4]; 2] = std::array::from_fn(|_| {
        [noise.between(0.0, 0.05), noise.between(0.0, 0.05), noise.between(0.5, 2.5), noise.between(0.0, TAU)]
    });
    let mut marks = Vec::new();
    let mut pen_at = 0.0;
    let length = word.chars().count().max(1) as f32;
    for (number, letter) in word.chars().enumerate() {
        let large = case == Case::Large || case == Case::First && number == 0;
        let letter = if letter == '-' { ' ' } else { letter };
        let letter = if large { letter.to_ascii_uppercase() } else { letter.to_ascii_lowercase() };
        let Some(glyph) = font.glyph(letter) else { continue };
        let size = 1.0 + unsteady * noise.between(-0.1, 0.1);
        let (sin, cos) = (unsteady * noise.between(-0.09, 0.09)).sin_cos();
        let up = unsteady * noise.between(-0.12, 0.12);
        let place = |[x, y]: [f32; 2]| -> [f32; 2] {
            let (x, y) = (size * (cos * x - sin * y), size * (sin * x + cos * y) + up);
            let (x, y) = (stretch * (pen_at + x + lean * y), y);
            let along = x / length - 0.3;
            let mut off = [0.0, tilt * x + bow * along * along * 4.0];
            for [wide, high, rate, phase] in waves {
                off[0] += wide * (rate * y * 2.0 + phase).sin();
                off[1] += high * (rate * x + phase).sin();
            }
            [x + off[0], y + off[1]]
        };
        let lines: Vec<Vec<[f32; 2]>> =
            glyph.lines.iter().map(|line| line.iter().map(|at| place(*at)).collect()).collect();
        if !font.single_line {
            marks.push(Mark::Area { outlines: lines.clone(), ink: 1.0 });
        }
        // Along an outline the pen makes letters bolder.
        if bold > 0.02 {
            let stroke = |line: Vec<[f32; 2]>| Mark::Stroke {
                points: line.into_iter().map(|[x, y]| [x, y, bold]).collect(),
                ink: 1.0,
            };
            marks.extend(lines.into_iter().map(stroke));
        }
        pen_at += glyph.advance * size + spacing + unsteady * noise.between(-0.03, 0.06);
    }
    marks
}
