//! Figures with a body and clothes: how they are put together, and what is drawn on them.

use super::pen::{Pen, ellipse, smooth};
use super::{Chance, Face, Feet, Hands, Limbs, Proportions, Style, Torso};
use inkrig_generate::readers::ink::Mark;
use inkrig_generate::schedule::Noise;
use inkrig_motion::glam::Vec2;

/// What grows or sits on a head.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hair {
    /// Nothing.
    None,
    /// A jagged line.
    Spikes,
    /// A tail on each side.
    Tails,
    /// Down on both sides.
    Long,
    /// The upper part of the head, filled.
    Cap,
    /// A cone or a box.
    Hat,
}

/// What is on the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clothes {
    /// Nothing.
    None,
    /// A line around the hips.
    Belt,
    /// A skirt that hides the upper legs.
    Skirt,
    /// Dots from the neck down.
    Buttons,
    /// Lines across.
    Stripes,
}

/// What makes a stick figure a character. Shares are 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dress {
    /// How wide the trunk is at the shoulders and at the hips, as multiples of the usual.
    pub girth: [f32; 2],
    /// How far the head's edge is above the neck, metres.
    pub throat: f32,
    /// On the head.
    pub hair: Hair,
    /// On the body.
    pub clothes: Clothes,
    /// Share of parts that are shaded.
    pub shaded: f64,
    /// Share of limbs with lines across.
    pub striped: f64,
    /// Whether the trunk hides where limbs begin.
    pub over: bool,
    /// Whether the eyes are outlined.
    pub eyes: bool,
}

/// Turns a usual style into a character's.
pub(super) fn dressed(style: &mut Style, noise: &mut Noise) {
    style.proportions = Proportions {
        legs: noise.between(0.4, 1.1),
        calves: noise.between(0.85, 1.15),
        spine: noise.between(0.75, 1.4),
        neck: noise.between(0.5, 1.2),
        arms: noise.between(0.6, 1.2),
        forearms: noise.between(0.85, 1.15),
        shoulders: noise.between(0.8, 1.5),
        hips: noise.between(0.8, 1.9),
        feet: noise.between(0.8, 1.6),
    };
    style.pen = noise.between(0.012, 0.055);
    style.ink = noise.between(0.5, 1.0);
    style.wobble = noise.between(0.0, 0.028);
    style.head = noise.between(0.12, 0.28);
    style.head_height = noise.between(0.8, 1.3);
    style.face = noise.pick(&[(Face::Eyes, 5.0), (Face::None, 1.0), (Face::Nose, 0.5)]).unwrap_or(Face::Eyes);
    style.torso =
        noise.pick(&[(Torso::Box, 3.0), (Torso::Bean, 3.0), (Torso::Ellipse, 2.0)]).unwrap_or(Torso::Bean);
    style.limbs = noise
        .pick(&[(Limbs::Tubes, 5.0), (Limbs::Capsules, 2.0), (Limbs::Line, 1.0), (Limbs::Curve, 0.5)])
        .unwrap_or(Limbs::Tubes);
    style.limb = noise.between(0.025, 0.11);
    style.hands = noise
        .pick(&[(Hands::Palm, 3.0), (Hands::Ball, 3.0), (Hands::Fingers, 1.5), (Hands::None, 1.5)])
        .unwrap_or(Hands::Ball);
    style.feet =
        noise.pick(&[(Feet::Wedge, 5.0), (Feet::Line, 1.0), (Feet::None, 0.5)]).unwrap_or(Feet::Wedge);
    style.hides = noise.happens(0.85);
    style.balls = false;
    let hair = [
        (Hair::None, 2.0),
        (Hair::Spikes, 1.5),
        (Hair::Tails, 1.0),
        (Hair::Long, 1.0),
        (Hair::Cap, 1.5),
        (Hair::Hat, 1.0),
    ];
    let clothes = [
        (Clothes::None, 3.0),
        (Clothes::Belt, 1.5),
        (Clothes::Skirt, 1.5),
        (Clothes::Buttons, 1.0),
        (Clothes::Stripes, 1.0),
    ];
    style.dress = Some(Dress {
        girth: [noise.between(0.75, 1.5), noise.between(0.8, 2.2)],
        throat: if noise.happens(0.4) { noise.between(0.02, 0.1) } else { noise.between(-0.05, 0.02) },
        hair: noise.pick(&hair).unwrap_or(Hair::None),
        clothes: noise.pick(&clothes).unwrap_or(Clothes::None),
        shaded: if noise.happens(0.45) { noise.between(0.0, 1.0).into() } else { 0.0 },
        striped: if noise.happens(0.12) { 0.8 } else { 0.0 },
        over: noise.happens(0.6),
        eyes: noise.happens(0.35),
    });
}

/// The next outline is shaded, or not.
pub(super) fn shade(dress: Dress, pen: &mut Pen<'_>) {
    pen.fill = pen.noise.happens(dress.shaded).then(|| pen.noise.between(0.1, 1.0));
}

/// An outline around two bones, from one side of where they begin to the other: not closed.
pub(super) fn tube(way: [Vec2; 3], radii: [f32; 3]) -> Vec<Vec2> {
    let [a, b, c] = way;
    let (first, last) = ((b - a).normalize_or(Vec2::NEG_Y), (c - b).normalize_or(Vec2::NEG_Y));
    let sides = [first.perp(), (first + last).normalize_or(first).perp(), last.perp()];
    let side = |sign: f32| [0, 1, 2].map(|at| way[at] + sign * radii[at] * sides[at]);
    let (left, mut right) = (side(1.0), side(-1.0));
    right.reverse();
    let tip = c + last * radii[2] * 0.8;
    smooth(&[&left[..], &[tip], &right].concat(), false)
}

/// A few lines across a bone.
pub(super) fn stripes(pen: &mut Pen<'_>, [from, to]: [Vec2; 2], radius: f32, marks: &mut Vec<Mark>) {
    let side = (to - from).normalize_or(Vec2::Y).perp() * radius;
    let count = 1 + pen.noise.below(3);
    for at in 1..=count {
        let middle = from.lerp(to, at as f32 / (count + 1) as f32);
        pen.line(&[middle + side, middle - side], marks);
    }
}

/// A palm at the end of an arm, with fingers.
pub(super) fn palm(pen: &mut Pen<'_>, at: Vec2, along: Vec2, marks: &mut Vec<Mark>) {
    let size = pen.noise.between(0.035, 0.08);
    let middle = at + along * size * pen.noise.between(0.3, 1.0);
    let count = 2 + pen.noise.below(4);
    let spread = pen.noise.between(0.7, 1.3);
    for finger in 0..count {
        let turn = spread * (2.0 * finger as f32 / (count - 1) as f32 - 1.0);
        let way = Vec2::from_angle(turn).rotate(along);
        let long = size * pen.noise.between(0.4, 0.8);
        let around = ellipse(middle + way * size, way, long, size * 0.3);
        pen.outline(&around, marks);
    }
    pen.outline(&ellipse(middle, along, size, size * 0.85), marks);
}

/// Hair or a hat on a head of this height and width.
pub(super) fn hair(
    pen: &mut Pen<'_>,
    hair: Hair,
    middle: Vec2,
    [up, high, wide]: [Vec2; 3],
    marks: &mut Vec<Mark>,
) {
    let edge = |turn: f32, far: f32| middle + (high * turn.cos() + wide * turn.sin()) * far;
    match hair {
        Hair::None => {}
        Hair::Spikes => {
            let count = 4 + pen.noise.below(5);
            let (from, far) = (pen.noise.between(0.5, 1.2), pen.noise.between(1.15, 1.5));
            let mut around: Vec<Vec2> = (0..=2 * count)
                .map(|at| {
                    let turn = from * (at as f32 / count as f32 - 1.0);
                    edge(turn, if at % 2 == 0 { 0.97 } else { far * pen.noise.between(0.9, 1.1) })
                })
                .collect();
            if pen.noise.happens(0.5) {
                pen.fill = Some(pen.noise.between(0.5, 1.0));
                around.push(edge(0.0, pen.noise.between(0.55, 0.95)));
                pen.outline(&around, marks);
            } else {
                pen.line(&around, marks);
            }
        }
        Hair::Tails => {
            let (turn, far) = (pen.noise.between(0.7, 1.4), pen.noise.between(1.4, 2.0));
            let drop = up * pen.noise.between(-1.2, 0.3) * high.length();
            for side in [-1.0, 1.0] {
                let (root, tip) = (edge(side * turn, 1.0), edge(side * turn, far) + drop);
                let bow = root.lerp(tip, 0.5) + up * 0.4 * high.length();
                let thick = up * pen.noise.between(0.1, 0.3) * high.length();
                let around = smooth(&[root, bow, tip, bow - thick, root - thick], false);
                pen.outline(&around, marks);
            }
        }
        Hair::Long => {
            let drop = up * pen.noise.between(0.5, 1.6) * high.length();
            let out = pen.noise.between(1.0, 1.3);
            for side in [-1.0, 1.0] {
                let way = [edge(0.2 * side, 1.02), edge(1.3 * side, out), edge(1.6 * side, out) - drop];
                pen.line(&smooth(&way, false), marks);
            }
        }
        Hair::Cap => {
            let low = pen.noise.between(0.7, 1.4);
            let mut around: Vec<Vec2> =
                (0..=10).map(|at| edge(low * (0.2 * at as f32 - 1.0), 1.04)).collect();
            around.push(edge(0.0, pen.noise.between(0.0, 0.6)));
            pen.fill = Some(pen.noise.between(0.3, 1.0));
            pen.outline(&around, marks);
        }
        Hair::Hat => {
            let (brim, tall) = (pen.noise.between(0.8, 1.3), pen.noise.between(1.3, 2.2));
            let top = if pen.noise.happens(0.5) { 0.0 } else { 0.7 };
            let (low, peak) = (middle + high * 0.75, middle + high * tall);
            let around = [low - wide * brim, peak - wide * top, peak + wide * top, low + wide * brim];
            pen.outline(&around, marks);
        }
    }
}

/// Eyes with an outline and a dot.
pub(super) fn eyes(pen: &mut Pen<'_>, middle: Vec2, [up, high, wide]: [Vec2; 3], marks: &mut Vec<Mark>) {
    let size = pen.noise.between(0.12, 0.25) * wide.length();
    for side in [-0.38, 0.38] {
        let at = middle + wide * side + high * 0.15;
        let tall = size * pen.noise.between(0.9, 1.5);
        pen.outline(&ellipse(at, up, tall, size), marks);
        pen.line(&[at, at + up * 0.3 * size], marks);
    }
}

/// Clothes on a trunk from the pelvis to the neck, `wide` half the width at the hips; a skirt reaches down by `legs`.
pub(super) fn clothes(
    pen: &mut Pen<'_>,
    clothes: Clothes,
    [pelvis, neck]: [Vec2; 2],
    wide: Vec2,
    legs: f32,
    marks: &mut Vec<Mark>,
) {
    let up = (neck - pelvis).normalize_or(Vec2::Y);
    match clothes {
        Clothes::None => {}
        Clothes::Belt => {
            let at = pelvis.lerp(neck, pen.noise.between(-0.05, 0.25));
            let bow = up * pen.noise.between(-0.05, 0.05);
            pen.line(&smooth(&[at - wide, at + bow, at + wide], false), marks);
        }
        Clothes::Skirt => {
            let waist = pelvis.lerp(neck, pen.noise.between(0.05, 0.35));
            let hem = pelvis - up * legs * pen.noise.between(0.3, 0.9);
            let far = pen.noise.between(1.1, 2.0);
            let around = [waist - wide, waist + wide, hem + wide * far, hem - wide * far];
            pen.outline(&around, marks);
            for at in 0..pen.noise.below(5) {
                let across = wide * (0.45 * at as f32 - 0.9);
                pen.line(&[hem.lerp(waist, 0.7) + across, hem + across * far], marks);
            }
        }
        Clothes::Buttons => {
            for at in 0..2 + pen.noise.below(3) {
                let at = pelvis.lerp(neck, 0.85 - 0.2 * at as f32);
                pen.line(&[at, at + up * 0.008], marks);
            }
        }
        Clothes::Stripes => {
            let count = 1 + pen.noise.below(4);
            for at in 1..=count {
                let at = pelvis.lerp(neck, at as f32 / (count + 1) as f32);
                pen.line(&[at - wide * 0.9, at + wide * 0.9], marks);
            }
        }
    }
}
