//! Heads and faces.

use super::character::{self, Dress};
use super::figure::Figure;
use super::pen::{ellipse, smooth};
use super::{Chance, Face};
use inkrig_motion::glam::Vec2;

impl Figure<'_> {
    pub(super) fn head(&mut self) {
        let style = self.style().clone();
        let (neck, joint) = (self.at[12], self.at[15]);
        let up = (joint - neck).normalize_or(Vec2::Y);
        let (width, height) = (style.head, style.head * style.head_height);
        let above = self.pen.noise.between(0.0, 0.25);
        let mut middle = joint + up * height * above;
        if let Some(Dress { throat, .. }) = self.dress() {
            middle = neck + up * (height + throat);
            self.shown[15] = middle - up * height * above;
        }
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
                Face::Eyes if towards > -0.2 && style.dress.is_some_and(|dress| dress.eyes) => {
                    character::eyes(pen, middle, [up, up * height, side * width], marks);
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
            if let Some(Dress { hair, .. }) = style.dress {
                character::hair(pen, hair, middle, [up, up * height, side * width], marks);
            }
        });
    }
}
