//! How somebody draws.

use super::character::{Dress, dressed};
use super::{Chance, Face, Family, Feet, Hands, Limbs, Proportions, Torso};
use inkrig_generate::schedule::Noise;

/// All choices of one drawing. Lengths are metres of a body of usual size.
#[derive(Debug, Clone, PartialEq)]
pub struct Style {
    /// Its family.
    pub family: Family,
    /// Lengths of the body's parts.
    pub proportions: Proportions,
    /// Width of the pen.
    pub pen: f32,
    /// How much lines taper at their ends, 0 to 1.
    pub taper: f32,
    /// How dark, 0 to 1.
    pub ink: f32,
    /// How often each line is drawn.
    pub repeats: usize,
    /// How far lines stray slowly.
    pub wobble: f32,
    /// How far they stray quickly.
    pub jitter: f32,
    /// How far ends run over (or fall short, below 0), at most.
    pub overshoot: f32,
    /// Share of lines with a gap.
    pub gaps: f64,
    /// The head's radius.
    pub head: f32,
    /// The head's height by its width.
    pub head_height: f32,
    /// Whether the head has corners.
    pub head_box: bool,
    /// What is on it.
    pub face: Face,
    /// The trunk.
    pub torso: Torso,
    /// Arms and legs.
    pub limbs: Limbs,
    /// Radius of a limb where it has one.
    pub limb: f32,
    /// Whether joints are drawn as balls.
    pub balls: bool,
    /// Whether lines join the shoulders and the hips.
    pub girdles: bool,
    /// Hands.
    pub hands: Hands,
    /// Feet.
    pub feet: Feet,
    /// Whether outlines hide what is behind them.
    pub hides: bool,
    /// How dark the insides of outlines are, if they are filled.
    pub fill: Option<f32>,
    /// What a [`Family::Character`] wears.
    pub dress: Option<Dress>,
}

impl Style {
    /// A drawing's style by chance.
    pub fn random(family: Family, noise: &mut Noise) -> Self {
        let mut style = Self::usual(family, noise);
        match family {
            Family::Stick => {
                style.limbs =
                    noise.pick(&[(Limbs::Line, 3.0), (Limbs::Segments, 1.0)]).unwrap_or(Limbs::Line);
                style.torso = Torso::Line;
            }
            Family::Pencil => {
                style.pen = noise.between(0.012, 0.03);
                style.ink = noise.between(0.45, 0.95);
                style.repeats = 1 + noise.below(3);
                style.taper = noise.between(0.0, 0.6);
                style.overshoot = noise.between(0.02, 0.08);
            }
            Family::Marker => {
                style.pen = noise.between(0.05, 0.09);
                style.torso = noise
                    .pick(&[(Torso::Line, 3.0), (Torso::Box, 1.0), (Torso::Ellipse, 1.0)])
                    .unwrap_or(Torso::Line);
            }
            Family::Gesture => {
                style.pen = noise.between(0.025, 0.07);
                style.taper = noise.between(0.3, 0.95);
                style.limbs = noise.pick(&[(Limbs::Curve, 4.0), (Limbs::Line, 1.0)]).unwrap_or(Limbs::Curve);
                style.torso = noise
                    .pick(&[(Torso::Line, 3.0), (Torso::Bean, 1.0), (Torso::TwoMasses, 1.0)])
                    .unwrap_or(Torso::Line);
                style.overshoot = noise.between(0.0, 0.08);
            }
            Family::Mannequin => {
                style.balls = noise.happens(0.6);
                style.limbs = noise
                    .pick(&[(Limbs::Capsules, 3.0), (Limbs::Line, 1.0), (Limbs::Segments, 1.0)])
                    .unwrap_or(Limbs::Capsules);
                style.torso = noise
                    .pick(&[
                        (Torso::TwoMasses, 3.0),
                        (Torso::Box, 1.0),
                        (Torso::Bean, 1.0),
                        (Torso::Ellipse, 1.0),
                    ])
                    .unwrap_or(Torso::Box);
                style.hides = noise.happens(0.5);
                style.pen = noise.between(0.015, 0.04);
            }
            Family::Outline => {
                style.limbs = Limbs::Capsules;
                style.limb = noise.between(0.035, 0.09);
                style.torso = noise
                    .pick(&[(Torso::Bean, 3.0), (Torso::Box, 2.0), (Torso::Ellipse, 1.0)])
                    .unwrap_or(Torso::Bean);
                style.hides = noise.happens(0.8);
                style.pen = noise.between(0.015, 0.05);
            }
            Family::Filled => {
                style.limbs = Limbs::Capsules;
                style.limb = noise.between(0.03, 0.08);
                style.torso = noise
                    .pick(&[(Torso::Bean, 3.0), (Torso::Box, 2.0), (Torso::Ellipse, 1.0)])
                    .unwrap_or(Torso::Bean);
                style.hides = true;
                style.fill = Some(noise.between(0.25, 1.0));
                style.pen = noise.between(0.015, 0.04);
            }
            Family::Naive => naive(&mut style, noise),
            Family::Character => dressed(&mut style, noise),
        }
        style
    }

    /// The same of somebody with stranger habits: bodies of other proportions, heads and pens of other sizes, other hands, lines that
    /// shake more. What has learned from such drawings, too, follows the lines of people whom it has not met.
    pub fn varied(family: Family, noise: &mut Noise) -> Self {
        let mut style = Self::random(family, noise);
        // Characters have their own proportions and hands.
        if style.dress.is_none() {
            let body = &mut style.proportions;
            for length in [&mut body.legs, &mut body.spine, &mut body.neck, &mut body.arms] {
                *length = noise.between(0.6, 1.6);
            }
            body.feet *= noise.between(0.7, 1.4);
            style.hands = noise
                .pick(&[(Hands::None, 2.0), (Hands::Ball, 1.5), (Hands::Fingers, 1.5), (Hands::Palm, 0.5)])
                .unwrap_or(Hands::None);
        }
        style.head *= noise.between(0.7, 1.5);
        style.head_height *= noise.between(0.85, 1.15);
        style.pen *= noise.between(0.65, 1.7);
        style.wobble *= noise.between(1.0, 1.7);
        style.jitter += if noise.happens(0.4) { noise.between(0.0, 0.008) } else { 0.0 };
        style
    }

    fn usual(family: Family, noise: &mut Noise) -> Self {
        let narrow = noise.happens(0.3);
        let proportions = Proportions {
            legs: noise.between(0.75, 1.3),
            calves: noise.between(0.85, 1.15),
            spine: noise.between(0.75, 1.3),
            neck: noise.between(0.8, 1.25),
            arms: noise.between(0.75, 1.3),
            forearms: noise.between(0.85, 1.2),
            shoulders: if narrow { noise.between(0.0, 0.4) } else { noise.between(0.7, 1.2) },
            hips: if noise.happens(0.35) { noise.between(0.0, 0.5) } else { noise.between(0.8, 1.4) },
            feet: noise.between(0.7, 1.4),
        };
        Self {
            family,
            proportions,
            pen: noise.between(0.02, 0.06),
            taper: if noise.happens(0.3) { noise.between(0.0, 0.5) } else { 0.0 },
            ink: noise.between(0.75, 1.0),
            repeats: if noise.happens(0.15) { 2 } else { 1 },
            wobble: noise.between(0.0, 0.02),
            jitter: if noise.happens(0.4) { noise.between(0.0, 0.006) } else { 0.0 },
            overshoot: noise.between(0.0, 0.04),
            gaps: if noise.happens(0.2) { 0.3 } else { 0.03 },
            head: noise.between(0.085, 0.16),
            head_height: noise.between(0.95, 1.4),
            head_box: noise.happens(0.04),
            face: noise
                .pick(&[
                    (Face::None, 4.0),
                    (Face::Nose, 1.5),
                    (Face::Cross, 1.5),
                    (Face::Eyes, 1.5),
                    (Face::Hair, 1.0),
                ])
                .unwrap_or(Face::None),
            torso: noise
                .pick(&[
                    (Torso::Line, 4.0),
                    (Torso::Ellipse, 1.0),
                    (Torso::Box, 1.0),
                    (Torso::Bean, 1.0),
                    (Torso::TwoMasses, 1.0),
                ])
                .unwrap_or(Torso::Line),
            limbs: noise
                .pick(&[(Limbs::Line, 4.0), (Limbs::Curve, 1.5), (Limbs::Segments, 1.5)])
                .unwrap_or(Limbs::Line),
            limb: noise.between(0.03, 0.07),
            balls: noise.happens(0.08),
            girdles: noise.happens(0.75),
            hands: noise
                .pick(&[(Hands::None, 4.0), (Hands::Ball, 2.0), (Hands::Fingers, 1.0)])
                .unwrap_or(Hands::None),
            feet: noise
                .pick(&[(Feet::Line, 4.0), (Feet::Wedge, 2.5), (Feet::None, 2.0)])
                .unwrap_or(Feet::Line),
            hides: false,
            fill: None,
            dress: None,
        }
    }
}

/// Large heads, short limbs and a felt pen that shakes, all at once; one by one they come in [`Style::varied`], too.
fn naive(style: &mut Style, noise: &mut Noise) {
    let old = style.proportions;
    style.proportions = Proportions {
        legs: noise.between(0.55, 0.8),
        arms: noise.between(0.6, 0.85),
        spine: noise.between(0.8, 1.5),
        feet: noise.between(1.2, 1.8),
        ..old
    };
    style.head = noise.between(0.17, 0.24);
    style.head_height = noise.between(0.8, 1.05);
    style.face = noise.pick(&[(Face::Eyes, 3.0), (Face::Hair, 1.0)]).unwrap_or(Face::Eyes);
    style.pen = noise.between(0.06, 0.1);
    style.wobble = noise.between(0.02, 0.035);
    style.jitter = noise.between(0.006, 0.012);
    style.torso =
        noise.pick(&[(Torso::Line, 1.0), (Torso::Box, 1.0), (Torso::Ellipse, 1.0)]).unwrap_or(Torso::Line);
    style.limbs = noise.pick(&[(Limbs::Line, 1.0), (Limbs::Curve, 1.0)]).unwrap_or(Limbs::Line);
    style.hands = noise.pick(&[(Hands::Ball, 1.0), (Hands::Fingers, 2.0)]).unwrap_or(Hands::Fingers);
    style.feet = noise.pick(&[(Feet::Line, 1.0), (Feet::Wedge, 1.0)]).unwrap_or(Feet::Line);
    style.gaps = 0.15;
}
