//! Time labels, drawn with strokes: the sheet needs no font file for ten digits.

use inkrig_motion::glam::Vec2;
use tiny_skia::PathBuilder;

type Stroke = &'static [(f32, f32)];

/// Width and height of a digit's box; the point and the `s` are narrower and lower.
const DIGIT: Vec2 = Vec2::new(4.0, 7.0);
const GAP: f32 = 1.7;

/// Adds the strokes of `text` (digits, `.`, `:`, `s`, `cm`, spaces; others are left out), its upper left corner at `corner`,
/// digits `height` pixels high.
pub(crate) fn add_text(path: &mut PathBuilder, text: &str, corner: Vec2, height: f32) {
    let scale = height / DIGIT.y;
    let mut pen = corner;
    for letter in text.chars() {
        let (width, strokes) = glyph(letter);
        for stroke in strokes {
            for (index, &(x, y)) in stroke.iter().enumerate() {
                let place = pen + scale * Vec2::new(x, y);
                if index == 0 {
                    path.move_to(place.x, place.y);
                } else {
                    path.line_to(place.x, place.y);
                }
            }
        }
        pen.x += scale * (width + GAP);
    }
}

/// How a time is written.
pub(super) fn seconds(value: f64) -> String {
    let places = if value < 99.995 { 2 } else { 1 };
    format!("{value:.places$} s")
}

fn glyph(letter: char) -> (f32, &'static [Stroke]) {
    match letter {
        '0' => (4.0, ZERO),
        '1' => (4.0, &[&[(0.8, 1.3), (2.4, 0.0), (2.4, 7.0)]]),
        '2' => (4.0, TWO),
        '3' => (4.0, THREE),
        '4' => (4.0, &[&[(3.0, 7.0), (3.0, 0.0), (0.0, 5.0), (4.2, 5.0)]]),
        '5' => (4.0, FIVE),
        '6' => (4.0, SIX),
        '7' => (4.0, &[&[(0.0, 0.0), (4.0, 0.0), (1.4, 7.0)]]),
        '8' => (4.0, EIGHT),
        '9' => (4.0, NINE),
        '.' => (0.3, &[&[(0.1, 6.8), (0.2, 6.95)]]),
        ':' => (0.3, &[&[(0.1, 6.8), (0.2, 6.95)], &[(0.1, 3.2), (0.2, 3.35)]]),
        's' => (2.6, SECONDS),
        'c' => {
            (2.6, &[&[(2.6, 3.0), (1.4, 2.6), (0.3, 3.4), (0.0, 4.8), (0.3, 6.2), (1.4, 7.0), (2.6, 6.6)]])
        }
        'm' => (3.8, EM),
        _ => (0.4, &[]),
    }
}

const EM: &[Stroke] = &[
    &[(0.0, 7.0), (0.0, 2.7), (0.0, 3.7), (1.1, 2.7), (1.9, 3.5), (1.9, 7.0)],
    &[(1.9, 3.7), (3.0, 2.7), (3.8, 3.5), (3.8, 7.0)],
];

const ZERO: &[Stroke] = &[&[
    (2.0, 0.0),
    (3.0, 0.3),
    (3.7, 1.1),
    (4.0, 2.4),
    (4.0, 4.6),
    (3.7, 5.9),
    (3.0, 6.7),
    (2.0, 7.0),
    (1.0, 6.7),
    (0.3, 5.9),
    (0.0, 4.6),
    (0.0, 2.4),
    (0.3, 1.1),
    (1.0, 0.3),
    (2.0, 0.0),
]];
const TWO: &[Stroke] = &[&[
    (0.1, 1.8),
    (0.4, 0.8),
    (1.1, 0.2),
    (2.0, 0.0),
    (3.0, 0.2),
    (3.7, 0.8),
    (3.9, 1.8),
    (3.6, 2.8),
    (2.9, 3.8),
    (0.0, 7.0),
    (4.0, 7.0),
]];
const THREE: &[Stroke] = &[&[
    (0.1, 1.3),
    (0.8, 0.4),
    (2.0, 0.0),
    (3.0, 0.2),
    (3.7, 0.9),
    (3.8, 1.8),
    (3.4, 2.7),
    (2.6, 3.2),
    (1.5, 3.3),
    (2.7, 3.4),
    (3.6, 4.0),
    (4.0, 5.0),
    (3.8, 6.0),
    (3.1, 6.7),
    (2.0, 7.0),
    (0.8, 6.7),
    (0.0, 5.8),
]];
const FIVE: &[Stroke] = &[&[
    (3.6, 0.0),
    (0.6, 0.0),
    (0.3, 3.1),
    (1.1, 2.6),
    (2.1, 2.5),
    (3.2, 2.9),
    (3.9, 3.8),
    (4.0, 4.8),
    (3.7, 6.0),
    (2.9, 6.8),
    (1.9, 7.0),
    (0.8, 6.7),
    (0.0, 5.9),
]];
const SIX: &[Stroke] = &[&[
    (3.6, 0.7),
    (2.8, 0.1),
    (2.0, 0.0),
    (1.0, 0.4),
    (0.3, 1.5),
    (0.0, 3.2),
    (0.0, 4.7),
    (0.4, 6.1),
    (1.2, 6.8),
    (2.1, 7.0),
    (3.1, 6.7),
    (3.8, 5.8),
    (4.0, 4.7),
    (3.7, 3.6),
    (3.0, 2.9),
    (2.1, 2.7),
    (1.1, 2.9),
    (0.4, 3.6),
    (0.0, 4.7),
]];
const EIGHT: &[Stroke] = &[&[
    (2.0, 3.3),
    (0.9, 2.9),
    (0.3, 2.2),
    (0.3, 1.2),
    (0.9, 0.4),
    (2.0, 0.0),
    (3.1, 0.4),
    (3.7, 1.2),
    (3.7, 2.2),
    (3.1, 2.9),
    (2.0, 3.3),
    (0.8, 3.8),
    (0.1, 4.7),
    (0.1, 5.7),
    (0.8, 6.6),
    (2.0, 7.0),
    (3.2, 6.6),
    (3.9, 5.7),
    (3.9, 4.7),
    (3.2, 3.8),
    (2.0, 3.3),
]];
const NINE: &[Stroke] = &[&[
    (0.4, 6.3),
    (1.2, 6.9),
    (2.0, 7.0),
    (3.0, 6.6),
    (3.7, 5.5),
    (4.0, 3.8),
    (4.0, 2.3),
    (3.6, 0.9),
    (2.8, 0.2),
    (1.9, 0.0),
    (0.9, 0.3),
    (0.2, 1.2),
    (0.0, 2.3),
    (0.3, 3.4),
    (1.0, 4.1),
    (1.9, 4.3),
    (2.9, 4.1),
    (3.6, 3.4),
    (4.0, 2.3),
]];
const SECONDS: &[Stroke] = &[&[
    (2.5, 3.5),
    (2.0, 3.0),
    (1.3, 2.8),
    (0.5, 3.0),
    (0.1, 3.7),
    (0.4, 4.4),
    (1.3, 4.8),
    (2.2, 5.2),
    (2.6, 5.9),
    (2.2, 6.7),
    (1.3, 7.0),
    (0.5, 6.8),
    (0.0, 6.2),
]];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_short() {
        assert_eq!(seconds(1.254), "1.25 s");
        assert_eq!(seconds(99.999), "100.0 s");
    }

    #[test]
    fn every_letter_of_a_time_has_strokes() {
        for letter in "0123456789.s".chars() {
            assert!(!glyph(letter).1.is_empty(), "{letter}");
        }
        let mut path = PathBuilder::new();
        add_text(&mut path, "<script>", Vec2::ZERO, 10.0);
        assert!(path.finish().is_some(), "the s is drawn, the rest left out");
    }
}
