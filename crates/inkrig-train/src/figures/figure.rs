//! A pose becomes marks.

use super::pen::{Pen, capsule, ellipse, smooth};
use super::{Chance, Face, Feet, Hands, Limbs, Seen, Style, Torso};
use inkrig_generate::readers::ink::Mark;
use inkrig_generate::readers::sketch::{JOINT_OF_KEY_POINT, KEY_POINTS};
use inkrig_generate::schedule::Noise;
use inkrig_motion::glam::{Vec2, Vec3};

/// A drawing and what it shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// Strokes and areas in their order; metres, y up.
    pub marks: Vec<Mark>,
    /// Where the key points are in what is drawn: at the end of a line that runs over, on the bend of a limb that strays or curves.
    pub key_points: [[f32; 2]; KEY_POINTS],
    /// Where the pose has them.
    pub captured: [[f32; 2]; KEY_POINTS],
    /// Whether they can be seen in the drawing.
    pub drawn: [bool; KEY_POINTS],
    /// Neck to pelvis in space, metres.
    pub torso: f32,
}

/// Draws a pose, already seen by a camera, in a style.
pub fn draw(pose: &Seen, style: &Style, noise: &mut Noise) -> Drawn {
    let pose = style.proportions.apply(pose);
    let mut figure = Figure {
        at: pose.map(Vec3::truncate),
        shown: pose.map(Vec3::truncate),
        depth: pose.map(|joint| joint.z),
        parts: Vec::new(),
        missing: [false; 22],
        pen: Pen { style, noise, width: 1.0 },
    };
    figure.leave_out();
    figure.trunk();
    figure.head();
    for side in 0..2 {
        figure.arm(side);
        figure.leg(side);
    }
    figure.finish()
}

struct Figure<'a> {
    at: [Vec2; 22],
    /// Where the drawing has them.
    shown: [Vec2; 22],
    depth: [f32; 22],
    parts: Vec<(f32, Vec<Mark>)>,
    missing: [bool; 22],
    pen: Pen<'a>,
}

impl Figure<'_> {
    fn style(&self) -> &Style {
        self.pen.style
    }

    /// Some drawings are not finished.
    fn leave_out(&mut self) {
        if self.style().feet == Feet::None {
            self.missing[10] = true;
            self.missing[11] = true;
        }
        for side in 0..2 {
            if self.pen.noise.happens(0.025) {
                self.missing[20 + side] = true;
            }
            if self.pen.noise.happens(0.01) {
                self.missing[7 + side] = true;
                self.missing[10 + side] = true;
            }
        }
        if self.pen.noise.happens(0.01) {
            for joint in [4, 5, 7, 8, 10, 11] {
                self.missing[joint] = true;
            }
        }
    }

    fn part<T>(&mut self, joints: &[usize], draw: impl FnOnce(&mut Pen<'_>, &mut Vec<Mark>) -> T) -> T {
        let depth = joints.iter().map(|&joint| self.depth[joint]).sum::<f32>() / joints.len().max(1) as f32;
        let mut marks = Vec::new();
        let said = draw(&mut self.pen, &mut marks);
        self.parts.push((depth, marks));
        said
    }

    /// Where the arms' line meets the spine.
    fn top(&self) -> Vec2 {
        self.at[9].lerp(self.at[12], 0.65)
    }

    fn trunk(&mut self) {
        let at = self.at;
        let top = self.top();
        let up = (at[12] - at[0]).normalize_or(Vec2::Y);
        let across = |a: usize, b: usize| (0.5 * (at[a] - at[b]).dot(up.perp())).abs();
        let (chest, hips) = (across(16, 17).max(0.09), across(1, 2).max(0.07));
        let torso = self.style().torso;
        // Lines of the spine run from the pelvis to the neck, some to the head.
        let spine = smooth(&[at[0], at[3], at[6], at[9], at[12]], false);
        let more = 1.0 + self.pen.noise.between(0.0, 0.35);
        match torso {
            Torso::Line => {
                self.part(&[0, 9], |pen, marks| pen.line(&spine, marks));
            }
            Torso::Ellipse => {
                let (middle, height) = (at[0].lerp(at[12], 0.5), 0.5 * (at[12] - at[0]).length() + 0.03);
                let around = ellipse(middle, up, height.max(0.08), chest * 0.85 * more);
                self.part(&[0, 9], |pen, marks| pen.outline(&around, marks));
            }
            Torso::Box => {
                let side = up.perp();
                let (high, low) = (at[12].lerp(at[9], 0.25), at[0] - up * 0.04);
                let corners = [
                    high + side * chest * more,
                    high - side * chest * more,
                    low - side * hips * 1.2 * more,
                    low + side * hips * 1.2 * more,
                ];
                self.part(&[0, 9], |pen, marks| pen.outline(&corners, marks));
            }
            Torso::Bean => {
                let side = up.perp();
                let (high, low) = (at[12].lerp(at[9], 0.1), at[0] - up * 0.07);
                let waist = at[3].lerp(at[6], 0.5);
                let around = [
                    high,
                    top + side * chest * more,
                    waist + side * 0.8 * hips.max(0.8 * chest),
                    at[0] + side * hips * 1.3 * more,
                    low,
                    at[0] - side * hips * 1.3 * more,
                    waist - side * 0.8 * hips.max(0.8 * chest),
                    top - side * chest * more,
                ];
                let around = smooth(&around, true);
                self.part(&[0, 9], |pen, marks| pen.outline(&around, marks));
            }
            Torso::TwoMasses => {
                let ribs = (at[12] - at[6]).normalize_or(up);
                let upper = ellipse(at[9], ribs, 0.13 * more, chest * 0.8);
                let lower = ellipse(at[0], up, 0.07 * more, hips * 1.3);
                self.part(&[0, 3], |pen, marks| pen.outline(&lower, marks));
                self.part(&[0, 9], |pen, marks| pen.line(&spine, marks));
                self.part(&[9], |pen, marks| pen.outline(&upper, marks));
            }
        }
        let line = torso == Torso::Line;
        if line && self.style().girdles {
            if self.style().proportions.shoulders > 0.5 {
                let bend = top.lerp(0.5 * (at[16] + at[17]), self.pen.noise.between(0.0, 1.0));
                self.part(&[16, 17], |pen, marks| pen.line(&[at[16], bend, at[17]], marks));
            }
            if self.style().proportions.hips > 0.5 {
                self.part(&[1, 2], |pen, marks| pen.line(&[at[1], at[0], at[2]], marks));
            }
        }
    }

    fn head(&mut self) {
        let style = self.style().clone();
        let (neck, joint) = (self.at[12], self.at[15]);
        let up = (joint - neck).normalize_or(Vec2::Y);
        let (width, height) = (style.head, style.head * style.head_height);
        let middle = joint + up * height * self.pen.noise.between(0.0, 0.25);
        // Where the face looks: across hips and shoulders, to the side of the chest.
        let across = |axis: fn(Vec2) -> f32| axis(self.at[16] - self.at[17] + self.at[1] - self.at[2]);
        let depth = self.depth[16] - self.depth[17] + self.depth[1] - self.depth[2];
        let (right, length) = (across(|v| v.x), across(|v| v.x).hypot(depth).max(1e-3));
        // How far the face is turned to the right of the picture, and to the viewer, -1 to 1.
        let (turned, towards) = (-depth / length, right / length);
        let around = if style.head_box {
            let side = up.perp() * width;
            vec![
                middle + up * height + side,
                middle + up * height - side,
                middle - up * height - side,
                middle - up * height + side,
            ]
        } else {
            ellipse(middle, up, height, width)
        };
        let edge = middle - up * height;
        let far = (neck - edge).dot(up) < 0.0;
        self.part(&[15, 15, 12], |pen, marks| {
            if far {
                pen.line(&[neck, edge], marks);
            }
            pen.outline(&around, marks);
            pen.width = 0.6;
            let side = -up.perp();
            match style.face {
                Face::None => {}
                Face::Nose => {
                    let from = middle + side * turned * width * 0.85;
                    if turned.abs() > 0.3 || towards > 0.0 {
                        pen.line(&[from, from + side * turned.signum() * width * 0.5], marks);
                    }
                }
                Face::Cross if towards > -0.2 => {
                    let bow = side * turned * width * 0.7;
                    let down = smooth(&[middle + up * height, middle + bow, middle - up * height], false);
                    pen.line(&down, marks);
                    let level = middle + up * height * 0.1;
                    pen.line(
                        &[
                            level - side * width * 0.9,
                            level + bow * 0.2 - up * height * 0.1,
                            level + side * width * 0.9,
                        ],
                        marks,
                    );
                }
                Face::Eyes if towards > -0.2 => {
                    for eye in [-0.35, 0.35] {
                        let place = middle
                            + side * (turned * 0.6 + eye * towards.max(0.3)) * width
                            + up * height * 0.15;
                        let dot = pen.noise.between(0.004, 0.02);
                        pen.line(&[place, place + up * dot], marks);
                    }
                    let mouth = middle + side * turned * 0.5 * width - up * height * 0.4;
                    let half = side * width * 0.3 * towards.max(0.4);
                    pen.line(&[mouth - half, mouth - up * 0.02, mouth + half], marks);
                }
                Face::Cross | Face::Eyes | Face::Hair => {
                    // Seen from behind, or with hair: strokes over the back of the head.
                    for _ in 0..5 + pen.noise.below(6) {
                        let turn = pen.noise.between(-1.2, 1.2) - turned * 0.7;
                        let out = Vec2::from_angle(turn).rotate(up);
                        let long = pen.noise.between(0.9, 1.35);
                        pen.line(&[middle + out * height * 0.75, middle + out * height * long], marks);
                    }
                }
            }
            pen.width = 1.0;
        });
    }

    fn arm(&mut self, side: usize) {
        let [shoulder, elbow, wrist] = [16 + side, 18 + side, 20 + side];
        let style = self.style();
        let from_spine = style.torso == Torso::Line && !(style.girdles && style.proportions.shoulders > 0.5);
        let begin = from_spine.then(|| self.top());
        self.limb(begin, [shoulder, elbow, wrist], 0.8);
        if self.missing[wrist] {
            return;
        }
        let (at, along) = (self.at[wrist], (self.at[wrist] - self.at[elbow]).normalize_or(Vec2::NEG_Y));
        match self.style().hands {
            Hands::None => {}
            Hands::Ball => {
                let size = self.pen.noise.between(0.025, 0.06);
                let around = ellipse(at + along * size, along, size * 1.2, size);
                self.part(&[wrist], |pen, marks| pen.outline(&around, marks));
            }
            Hands::Fingers => self.part(&[wrist], |pen, marks| {
                pen.width = 0.7;
                for _ in 0..3 + pen.noise.below(3) {
                    let way = Vec2::from_angle(pen.noise.between(-0.7, 0.7)).rotate(along);
                    let tip = at + way * pen.noise.between(0.05, 0.1);
                    pen.line(&[at, tip], marks);
                }
                pen.width = 1.0;
            }),
        }
    }

    fn leg(&mut self, side: usize) {
        let [hip, knee, ankle, toes] = [1 + side, 4 + side, 7 + side, 10 + side];
        let style = self.style();
        let from_pelvis = style.torso == Torso::Line && !(style.girdles && style.proportions.hips > 0.5);
        let begin = from_pelvis.then_some(self.at[0]);
        self.limb(begin, [hip, knee, ankle], 1.0);
        if self.missing[ankle] || self.missing[toes] {
            return;
        }
        let (from, to) = (self.at[ankle], self.at[toes]);
        let wedge = self.style().feet == Feet::Wedge;
        let capsules = self.style().limbs == Limbs::Capsules;
        self.shown[toes] = self.part(&[ankle, toes], |pen, marks| {
            if wedge || capsules && pen.noise.happens(0.5) {
                let size = pen.noise.between(0.02, 0.045);
                let around = capsule(from, to, size * 1.3, size * 0.8);
                pen.outline(&around, marks);
                to
            } else {
                pen.line(&[from, to], marks).last().copied().unwrap_or(to)
            }
        });
    }

    /// An arm or a leg of two bones.
    fn limb(&mut self, begin: Option<Vec2>, joints: [usize; 3], thick: f32) {
        let [a, b, c] = joints.map(|joint| self.at[joint]);
        let upper = self.missing[joints[1]];
        let lower = self.missing[joints[2]];
        if upper {
            return;
        }
        let (size, balls) = (self.style().limb * thick, self.style().balls);
        match self.style().limbs {
            Limbs::Capsules => {
                if let Some(begin) = begin {
                    self.part(&joints[..1], |pen, marks| pen.line(&[begin, a], marks));
                }
                let around = capsule(a, b, size, size * 0.8);
                self.part(&joints[..2], |pen, marks| pen.outline(&around, marks));
                if !lower {
                    let around = capsule(b, c, size * 0.8, size * 0.55);
                    self.part(&joints[1..], |pen, marks| pen.outline(&around, marks));
                }
            }
            kind => {
                let whole: Vec<Vec2> = begin.into_iter().chain([a, b]).chain((!lower).then_some(c)).collect();
                let shown = self.part(&joints, |pen, marks| match kind {
                    Limbs::Curve => corners(&pen.line(&rounded(&whole), marks)),
                    Limbs::Segments => segments(pen, &whole, marks),
                    _ => pen.line(&whole, marks),
                });
                self.show(joints, &shown[usize::from(begin.is_some())..], lower);
            }
        }
        if balls {
            for (at, joint) in [a, b, c].into_iter().zip(joints).take(if lower { 2 } else { 3 }) {
                let around = ellipse(at, Vec2::Y, size * 0.8, size * 0.8);
                self.part(&[joint], |pen, marks| pen.outline(&around, marks));
            }
        }
    }

    /// A limb's elbow or knee is where its line bends, its end where the line ends, unless a hand or a foot says where that is.
    fn show(&mut self, [_, middle, end]: [usize; 3], shown: &[Vec2], lower: bool) {
        let held = match end {
            20 | 21 => self.style().hands != Hands::None,
            _ => !self.missing[end + 3],
        };
        if let Some(at) = shown.get(1) {
            self.shown[middle] = *at;
        }
        if let Some(at) = shown.get(2).filter(|_| !lower && !held) {
            self.shown[end] = *at;
        }
    }

    fn finish(mut self) -> Drawn {
        // Far parts first; among equals in the order of drawing.
        self.parts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let spine = self.at[12] - self.at[0];
        Drawn {
            marks: self.parts.into_iter().flat_map(|(_, marks)| marks).collect(),
            key_points: JOINT_OF_KEY_POINT.map(|joint| self.shown[joint].to_array()),
            captured: JOINT_OF_KEY_POINT.map(|joint| self.at[joint].to_array()),
            drawn: JOINT_OF_KEY_POINT.map(|joint| !self.missing[joint]),
            torso: spine.extend(self.depth[12] - self.depth[0]).length(),
        }
    }
}

/// A stroke for each bone. Where two meet they cross, so that is where the joint is seen, however far they run over.
fn segments(pen: &mut Pen<'_>, way: &[Vec2], marks: &mut Vec<Mark>) -> Vec<Vec2> {
    let mut shown = way.to_vec();
    for (at, bone) in way.windows(2).enumerate() {
        if let ([.., last], Some(end)) = (&pen.line(bone, marks)[..], shown.get_mut(at + 1)) {
            *end = if at + 2 == way.len() { *last } else { *end };
        }
    }
    shown
}

/// Begin, bends and end of a [`rounded`] line: of a bend the middle, which is where the drawn limb turns.
fn corners(line: &[Vec2]) -> Vec<Vec2> {
    let [first, bends @ .., last] = line else { return line.to_vec() };
    let bends = bends.chunks_exact(6).map(|bend| 0.5 * (bend[2] + bend[3]));
    std::iter::once(*first).chain(bends).chain(std::iter::once(*last)).collect()
}

/// Corners become bends that stay near the corner.
fn rounded(way: &[Vec2]) -> Vec<Vec2> {
    let mut out: Vec<Vec2> = way.first().copied().into_iter().collect();
    for corner in way.windows(3) {
        let (before, after) = (corner[1].lerp(corner[0], 0.35), corner[1].lerp(corner[2], 0.35));
        // A parabola from a third before the corner to a third behind it.
        out.extend((0..=5).map(|at| {
            let t = at as f32 / 5.0;
            before.lerp(corner[1], t).lerp(corner[1].lerp(after, t), t)
        }));
    }
    out.extend(way.last().copied());
    out
}
