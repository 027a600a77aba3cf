//! A picture of a storyboard and what became of it: a row for each frame, first the drawing with the joints that were read, then
//! poses of its motion through the frame's camera, the drawn pose in red and drawn ways in green, joints that were put in space in orange, and
//! constraints in violet, with the largest miss of each below the drawing.

use super::Made;
use super::marks::marks;
use crate::sheet::{SheetError, digits};
use inkrig_motion::glam::{Vec2, Vec3};
use inkrig_motion::humanml::{JOINTS, Joints, PARENTS};
use inkrig_motion::kinematics;
use inkrig_sketch::storyboard::{Frame, Storyboard, Stroke as Line};
use inkrig_storyboard::{Animation, Goal, Source, Understood};
use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform};

/// Pixels of a cell, and poses in a row.
const CELL: [f32; 2] = [210.0, 230.0];
const POSES: usize = 7;
/// The most rows of a sheet.
const MOST: usize = 60;
/// Metres that a cell shows from top to bottom.
const METRES: f32 = 2.3;

type Rgb = [u8; 3];
const INK: Rgb = [30, 30, 34];
const SCENE: Rgb = [190, 185, 175];
const WAY: Rgb = [0, 160, 190];
const SPEED: Rgb = [235, 130, 30];
const LEFT: Rgb = [200, 50, 40];
const RIGHT: Rgb = [40, 80, 200];
const MIDDLE: Rgb = [90, 90, 96];
const KEY: Rgb = [225, 60, 60];
const DRAWN: Rgb = [40, 160, 70];
const PUT: Rgb = [240, 140, 0];
const HELD: Rgb = [150, 60, 190];

/// Draws the sheet as PNG.
pub(in crate::commands) fn png(
    board: &Storyboard,
    understood: &[Understood],
    made: &Made,
) -> Result<Vec<u8>, SheetError> {
    let rows = understood.len().min(MOST);
    let (width, height) = ((CELL[0] * (POSES + 1) as f32) as u32, (CELL[1] * rows as f32) as u32);
    let failed = || SheetError::Png(format!("{width} x {height} pixels"));
    let mut page = Page { pixels: Pixmap::new(width, height.max(1)).ok_or_else(failed)? };
    page.pixels.fill(Color::WHITE);
    let motion = kinematics::positions(&made.animation.clip);
    let pose = |frame: usize| -> Option<Joints> {
        if frame < made.animation.clip.frames() { motion.frame(frame).try_into().ok() } else { None }
    };
    for (row, (frame, read)) in board.frames.iter().zip(understood).take(rows).enumerate() {
        let top = CELL[1] * row as f32;
        page.drawing(frame, read, [0.0, top]);
        let Animation { joined, goals, constraints, .. } = &made.animation;
        let (Some(clip), Some(start), Some((turn, _)), Some(goals)) =
            (made.clips.get(row), joined.starts.get(row), joined.placements.get(row), goals.get(row))
        else {
            continue;
        };
        let constraints = constraints.get(row).map(Vec::as_slice).unwrap_or_default();
        for (number, kept) in constraints.iter().enumerate() {
            let miss = format!("{}: {:.1} cm", number + 1, 100.0 * kept.miss);
            page.text(&miss, [8.0, top + CELL[1] - 14.0 * (constraints.len() - number) as f32], HELD);
        }
        let plan = &clip.plan;
        let back = turn.inverse();
        let seen = |place: Vec3| plan.camera.project(back * place);
        for cell in 0..POSES {
            let at = cell * plan.frames.saturating_sub(1) / (POSES - 1);
            let Some(pose) = pose(start + at) else { continue };
            let flat = pose.map(seen);
            let under = seen(Vec3::new(pose[0].x, 0.0, pose[0].z));
            let view = View { middle: under + Vec2::Y * 0.8, corner: [CELL[0] * (cell + 1) as f32, top] };
            page.floor(&view, under.y);
            for (joint, ..) in &plan.ways {
                let own = || goals.iter().filter(|goal| goal.source == Source::Way && goal.joint == *joint);
                page.line(own().map(|goal| view.pixel(goal.at)), DRAWN, 2.0, 0.9);
                own()
                    .filter(|goal| goal.frame == start + at)
                    .for_each(|goal| page.dot(view.pixel(goal.at), 4.5, DRAWN, 1.0));
            }
            page.body(&view, &flat, 1.0);
            for kept in constraints.iter().filter(|kept| kept.constraint.frames.contains(&(start + at))) {
                for line in marks(&kept.constraint.rule, &pose) {
                    page.line(line.into_iter().map(|place| view.pixel(seen(place))), HELD, 2.0, 0.9);
                }
            }
            let near = |goal: &Goal| goal.frame.abs_diff(start + at) * 2 * (POSES - 1) < plan.frames;
            let put = goals.iter().filter(|goal| goal.source == Source::Edit && near(goal));
            put.for_each(|goal| page.dot(view.pixel(goal.at), 5.0, PUT, 0.9));
            let drawn = goals.iter().filter(|goal| matches!(goal.source, Source::Pin | Source::Pose));
            drawn.filter(|goal| near(goal)).for_each(|goal| page.dot(view.pixel(goal.at), 3.0, KEY, 0.9));
        }
    }
    page.pixels.encode_png().map_err(|error| SheetError::Png(error.to_string()))
}

/// A cell and what of the picture it shows.
struct View {
    middle: Vec2,
    corner: [f32; 2],
}

impl View {
    fn pixel(&self, place: Vec2) -> [f32; 2] {
        let scale = CELL[1] / METRES;
        let off = place - self.middle;
        [self.corner[0] + 0.5 * CELL[0] + scale * off.x, self.corner[1] + 0.5 * CELL[1] - scale * off.y]
    }
}

struct Page {
    pixels: Pixmap,
}

impl Page {
    /// The drawing in its cell, with the joints that were read.
    fn drawing(&mut self, frame: &Frame, read: &Understood, corner: [f32; 2]) {
        let all = || frame.strokes().chain(&frame.scene).flat_map(|stroke| &stroke.points);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in all() {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let size = [0, 1].map(|axis| (high[axis] - low[axis]).max(1e-9));
        let room = [0.9 * f64::from(CELL[0]), 0.9 * f64::from(CELL[1])];
        let scale = (room[0] / size[0]).min(room[1] / size[1]);
        let pixel = |point: &[f64; 2]| {
            let off = [0, 1].map(|axis| scale * (point[axis] - 0.5 * (low[axis] + high[axis])));
            [corner[0] + 0.5 * CELL[0] + off[0] as f32, corner[1] + 0.5 * CELL[1] - off[1] as f32]
        };
        let mut draw = |strokes: &mut dyn Iterator<Item = &Line>, colour: Rgb, width: f32| {
            for stroke in strokes {
                self.line(stroke.points.iter().map(pixel), colour, width, 1.0);
            }
        };
        draw(&mut frame.scene.iter(), SCENE, 2.0);
        draw(&mut frame.body.iter(), INK, 2.5);
        draw(&mut frame.trajectories.iter().map(|way| &way.points), WAY, 2.5);
        draw(&mut frame.speed_lines.iter(), SPEED, 1.5);
        draw(&mut frame.lettering.iter(), MIDDLE, 1.5);
        for (joint, found) in read.figure.iter().flat_map(|figure| figure.joints.iter().enumerate()) {
            if let Some(found) = found {
                let radius = if found.pinned { 5.0 } else { 3.5 };
                self.dot(pixel(&found.at), radius, side(joint), found.confidence.clamp(0.25, 1.0));
            }
        }
    }

    fn floor(&mut self, view: &View, height: f32) {
        let [x, y] = view.pixel(Vec2::new(view.middle.x, height));
        self.line([[x - 0.4 * CELL[0], y], [x + 0.4 * CELL[0], y]].into_iter(), [215, 215, 220], 1.0, 1.0);
    }

    fn body(&mut self, view: &View, flat: &[Vec2; JOINTS], strength: f32) {
        for joint in 1..JOINTS {
            let (Some(&parent), Some(&own)) = (PARENTS.get(joint), flat.get(joint)) else { continue };
            let Some(&from) = flat.get(parent) else { continue };
            self.line([view.pixel(from), view.pixel(own)].into_iter(), side(joint), 5.0, strength);
        }
        let head = flat[15] + (flat[15] - flat[12]).normalize_or(Vec2::Y) * 0.07;
        self.dot(view.pixel(head), 0.09 * CELL[1] / METRES, MIDDLE, strength);
    }

    fn line(&mut self, points: impl Iterator<Item = [f32; 2]>, colour: Rgb, width: f32, strength: f32) {
        let mut path = PathBuilder::new();
        for (number, [x, y]) in points.enumerate() {
            if number == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        let stroke =
            Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        if let Some(path) = path.finish() {
            let paint = paint(colour, strength);
            self.pixels.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
        }
    }

    fn text(&mut self, text: &str, corner: [f32; 2], colour: Rgb) {
        let mut path = PathBuilder::new();
        digits::add_text(&mut path, text, corner.into(), 9.0);
        let stroke = Stroke { width: 1.2, line_cap: LineCap::Round, ..Stroke::default() };
        if let Some(path) = path.finish() {
            self.pixels.stroke_path(&path, &paint(colour, 1.0), &stroke, Transform::identity(), None);
        }
    }

    fn dot(&mut self, [x, y]: [f32; 2], radius: f32, colour: Rgb, strength: f32) {
        if let Some(path) = PathBuilder::from_circle(x, y, radius) {
            let paint = paint(colour, strength);
            self.pixels.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), None);
        }
    }
}

fn paint([red, green, blue]: Rgb, strength: f32) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(red, green, blue, (255.0 * strength) as u8);
    paint
}

fn side(joint: usize) -> Rgb {
    match joint {
        1 | 4 | 7 | 10 | 13 | 16 | 18 | 20 => LEFT,
        2 | 5 | 8 | 11 | 14 | 17 | 19 | 21 => RIGHT,
        _ => MIDDLE,
    }
}
