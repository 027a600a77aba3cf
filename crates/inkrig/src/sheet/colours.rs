//! Colours of a sheet.

use tiny_skia::{Color, Paint};

/// sRGB.
pub(super) type Rgb = [u8; 3];

/// What the parts of a cell are painted with.
pub(super) struct Colours {
    pub(super) page: Rgb,
    pub(super) card: Rgb,
    pub(super) line: Rgb,
    pub(super) shadow: Rgb,
    pub(super) ink: Rgb,
    pub(super) dot: Rgb,
    pub(super) left: Rgb,
    pub(super) right: Rgb,
    pub(super) middle: Rgb,
}

/// Blue is left and red is right, as on an animator's controls.
pub(super) const LIGHT: Colours = Colours {
    page: [236, 238, 241],
    card: [252, 252, 253],
    line: [205, 209, 216],
    shadow: [231, 233, 237],
    ink: [82, 88, 99],
    dot: [214, 72, 60],
    left: [66, 122, 208],
    right: [214, 92, 70],
    middle: [128, 136, 150],
};

pub(super) const DARK: Colours = Colours {
    page: [15, 17, 21],
    card: [26, 29, 35],
    line: [62, 67, 78],
    shadow: [18, 20, 25],
    ink: [168, 175, 187],
    dot: [255, 118, 100],
    left: [92, 148, 235],
    right: [236, 118, 94],
    middle: [156, 164, 178],
};

pub(super) fn mix(from: Rgb, to: Rgb, part: f32) -> Rgb {
    let mixed =
        |index: usize| f32::from(from[index]) + (f32::from(to[index]) - f32::from(from[index])) * part;
    [mixed(0) as u8, mixed(1) as u8, mixed(2) as u8]
}

pub(super) fn colour(rgb: Rgb, alpha: f32) -> Color {
    let mut colour = Color::from_rgba8(rgb[0], rgb[1], rgb[2], 255);
    colour.set_alpha(alpha);
    colour
}

pub(super) fn plain(rgb: Rgb, alpha: f32) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(colour(rgb, alpha));
    paint
}
