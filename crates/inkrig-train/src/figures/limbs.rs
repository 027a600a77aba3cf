//! Arms and legs.

use super::character::{self, Dress};
use super::figure::Figure;
use super::pen::{Pen, capsule, ellipse};
use super::{Chance, Feet, Hands, Limbs, Torso};
use inkrig_generate::readers::ink::Mark;
use inkrig_motion::glam::Vec2;

impl Figure<'_> {
    pub(super) fn arm(&mut self, side: usize) {
        let [shoulder, elbow, wrist] = [16 + side, 18 + side, 20 + side];
        let style = self.style();
        let from_spine = style.torso == Torso::Line && !(style.girdles && style.proportions.shoulders > 0.5);
        let begin = from_spine.then(|| self.top());
        self.limb(begin, [shoulder, elbow, wrist], 0.8);
        if self.missing[wrist] {
            return;
        }
        let (at, along) = (self.at[wrist], (self.at[wrist] - self.at[elbow]).normalize_or(Vec2::NEG_Y));
        self.dress();
        match self.style().hands {
            Hands::None => {}
            Hands::Ball => {
                let size = self.pen.noise.between(0.025, 0.06);
                let around = ellipse(at + along * size, along, size * 1.2, size);
                self.part(&[wrist], |pen, marks| pen.outline(&around, marks));
            }
            Hands::Palm => self.part(&[wrist], |pen, marks| character::palm(pen, at, along, marks)),
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

    pub(super) fn leg(&mut self, side: usize) {
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
        let large = if self.dress().is_some() { 0.09 } else { 0.045 };
        self.shown[toes] = self.part(&[ankle, toes], |pen, marks| {
            if wedge || capsules && pen.noise.happens(0.5) {
                let size = pen.noise.between(0.02, large);
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
        let dress = self.dress();
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
            Limbs::Tubes => {
                // Without a forearm or a shank it ends at the joint.
                let around = if lower {
                    character::tube([a, a.lerp(b, 0.5), b], [size; 3])
                } else {
                    character::tube([a, b, c], [size, size * 0.9, size * 0.7])
                };
                self.part(&joints, |pen, marks| {
                    pen.inside(&around, marks);
                    pen.line(&around, marks);
                });
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
        if let Some(Dress { striped, .. }) = dress
            && self.pen.noise.happens(striped)
        {
            self.part(&joints, |pen, marks| {
                let bones = [[a, b], [b, c]].into_iter().take(if lower { 1 } else { 2 });
                bones.for_each(|bone| character::stripes(pen, bone, size * 0.85, marks));
            });
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
