//! A pose becomes marks.

use super::character::{self, Dress};
use super::pen::Pen;
use super::{Chance, Feet, Seen, Style};
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
        nearer: 0.0,
        pen: Pen { style, noise, width: 1.0, fill: style.fill },
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

pub(super) struct Figure<'a> {
    pub(super) at: [Vec2; 22],
    /// Where the drawing has them.
    pub(super) shown: [Vec2; 22],
    pub(super) depth: [f32; 22],
    pub(super) parts: Vec<(f32, Vec<Mark>)>,
    pub(super) missing: [bool; 22],
    /// How much nearer to the viewer the next parts are taken to be than they are, metres.
    pub(super) nearer: f32,
    pub(super) pen: Pen<'a>,
}

impl Figure<'_> {
    pub(super) fn style(&self) -> &Style {
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

    pub(super) fn part<T>(
        &mut self,
        joints: &[usize],
        draw: impl FnOnce(&mut Pen<'_>, &mut Vec<Mark>) -> T,
    ) -> T {
        let depth = joints.iter().map(|&joint| self.depth[joint]).sum::<f32>() / joints.len().max(1) as f32
            + self.nearer;
        let mut marks = Vec::new();
        let said = draw(&mut self.pen, &mut marks);
        self.parts.push((depth, marks));
        said
    }

    /// Of a character, how it is dressed; the next outline may be shaded then.
    pub(super) fn dress(&mut self) -> Option<Dress> {
        let dress = self.style().dress?;
        character::shade(dress, &mut self.pen);
        Some(dress)
    }

    /// Where the arms' line meets the spine.
    pub(super) fn top(&self) -> Vec2 {
        self.at[9].lerp(self.at[12], 0.65)
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
