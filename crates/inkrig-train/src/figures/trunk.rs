//! Trunks.

use super::character::{self, Clothes, Dress};
use super::figure::Figure;
use super::pen::{ellipse, smooth};
use super::{Chance, Torso};
use inkrig_motion::glam::Vec2;

impl Figure<'_> {
    pub(super) fn trunk(&mut self) {
        let at = self.at;
        let top = self.top();
        let up = (at[12] - at[0]).normalize_or(Vec2::Y);
        let across = |a: usize, b: usize| (0.5 * (at[a] - at[b]).dot(up.perp())).abs();
        let (mut chest, mut hips) = (across(16, 17).max(0.09), across(1, 2).max(0.07));
        let torso = self.style().torso;
        let dress = self.dress();
        if let Some(Dress { girth: [high, low], over, .. }) = dress {
            (chest, hips) = (chest * high, hips * low);
            // Drawn after what begins there, but for arms in front of it.
            self.nearer = if over { 0.12 } else { 0.0 };
        }
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
        if let Some(Dress { clothes, .. }) = dress {
            self.dress();
            let legs = (at[4] - at[1]).length().max((at[5] - at[2]).length());
            let wide = up.perp() * hips * 1.2 * more;
            self.nearer += if clothes == Clothes::Skirt { 0.25 } else { 0.01 };
            self.part(&[0, 9], |pen, marks| {
                character::clothes(pen, clothes, [at[0], at[12]], wide, legs, marks);
            });
        }
        self.nearer = 0.0;
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
}
