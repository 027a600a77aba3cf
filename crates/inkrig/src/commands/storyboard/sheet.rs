//! A picture of a storyboard and what became of it: a row for each frame, first the drawing with the joints that were read, then
//! poses of its motion through the frame's camera, the drawn pose in red and drawn ways in green, joints that were put in space in orange, and
//! constraints in violet, with the largest miss of each below the drawing.

use super::Made;
use super::scene::{MIDDLE, Part, Scene, side};
use crate::sheet::{SheetError, digits};
use inkrig_motion::glam::Vec2;
use inkrig_sketch::storyboard::{Storyboard, Stroke as Line};
use inkrig_storyboard::{Goal, Source, Understood};
use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Rect, Stroke, Transform};

/// Pixels of a cell, and poses in a row.
const CELL: [f32; 2] = [210.0, 230.0];
const POSES: usize = 7;
/// The most rows of a sheet.
const MOST: usize = 60;
/// How high above the floor the middle of a cell is, in its heights.
pub(super) const MIDDLE_HEIGHT: f32 = 0.35;

pub(super) type Rgb = [u8; 3];
const INK: Rgb = [30, 30, 34];
const SCENE: Rgb = [190, 185, 175];
const WAY: Rgb = [0, 160, 190];
const SPEED: Rgb = [235, 130, 30];
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
    of_scene(&Scene::of_person(board, understood, made))
}

/// The same of any scene.
pub(super) fn of_scene(scene: &Scene<'_>) -> Result<Vec<u8>, SheetError> {
    let rows = scene.parts.len().min(MOST);
    let mut page = Page::new((CELL[0] * (POSES + 1) as f32) as u32, (CELL[1] * rows as f32) as u32)?;
    for (row, part) in scene.parts.iter().take(rows).enumerate() {
        let top = CELL[1] * row as f32;
        page.drawing(part, [0.0, top], CELL);
        for (number, kept) in part.constraints.iter().enumerate() {
            let miss = format!("{}: {:.1} cm", number + 1, 100.0 * kept.miss);
            let below = 14.0 * (part.constraints.len() - number) as f32;
            page.text(&miss, [8.0, top + CELL[1] - below], HELD);
        }
        for cell in 0..POSES {
            let at = part.begins + cell * part.frames.saturating_sub(1) / (POSES - 1);
            let Some((_, under)) = scene.seen(part, at) else { continue };
            let view = View {
                middle: under + Vec2::Y * MIDDLE_HEIGHT * scene.metres,
                corner: [CELL[0] * (cell + 1) as f32, top],
                size: CELL,
                metres: scene.metres,
            };
            page.moment(scene, part, at, &view, part.frames / (2 * (POSES - 1)));
        }
    }
    page.pixels.encode_png().map_err(|error| SheetError::Png(error.to_string()))
}

/// A cell and what of the picture it shows.
pub(super) struct View {
    pub(super) middle: Vec2,
    pub(super) corner: [f32; 2],
    pub(super) size: [f32; 2],
    /// From top to bottom.
    pub(super) metres: f32,
}

impl View {
    fn scale(&self) -> f32 {
        self.size[1] / self.metres
    }

    fn pixel(&self, place: Vec2) -> [f32; 2] {
        let off = (place - self.middle) * self.scale();
        [self.corner[0] + 0.5 * self.size[0] + off.x, self.corner[1] + 0.5 * self.size[1] - off.y]
    }
}

pub(super) struct Page {
    pub(super) pixels: Pixmap,
}

impl Page {
    /// White paper.
    pub(super) fn new(width: u32, height: u32) -> Result<Self, SheetError> {
        let failed = || SheetError::Png(format!("{width} x {height} pixels"));
        let mut pixels = Pixmap::new(width, height.max(1)).ok_or_else(failed)?;
        pixels.fill(Color::WHITE);
        Ok(Self { pixels })
    }

    /// White again.
    pub(super) fn clear(&mut self, [x, y]: [f32; 2], [width, height]: [f32; 2]) {
        if let Some(area) = Rect::from_xywh(x, y, width, height) {
            self.pixels.fill_rect(area, &paint([255; 3], 1.0), Transform::identity(), None);
        }
    }

    /// The drawing in its cell, with the joints that were read.
    pub(super) fn drawing(&mut self, part: &Part<'_>, corner: [f32; 2], size: [f32; 2]) {
        let frame = part.drawing;
        let all = || frame.strokes().chain(&frame.scene).flat_map(|stroke| &stroke.points);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in all() {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let covered = [0, 1].map(|axis| (high[axis] - low[axis]).max(1e-9));
        let room = size.map(|side| 0.9 * f64::from(side));
        let scale = (room[0] / covered[0]).min(room[1] / covered[1]);
        let pixel = |point: &[f64; 2]| {
            let off = [0, 1].map(|axis| scale * (point[axis] - 0.5 * (low[axis] + high[axis])));
            [corner[0] + 0.5 * size[0] + off[0] as f32, corner[1] + 0.5 * size[1] - off[1] as f32]
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
        for (joint, found) in part.figure.iter().flat_map(|figure| figure.joints.iter().enumerate()) {
            if let Some(found) = found {
                let radius = if found.pinned { 5.0 } else { 3.5 };
                self.dot(pixel(&found.at), radius, side(joint), found.confidence.clamp(0.25, 1.0));
            }
        }
    }

    /// The body at a frame, its ways in green, and what was drawn of its pose within so many frames in red.
    pub(super) fn moment(&mut self, scene: &Scene<'_>, part: &Part<'_>, at: usize, view: &View, near: usize) {
        let Some((flat, under)) = scene.seen(part, at) else { return };
        self.floor(view, under.y);
        let ways = || part.goals.iter().filter(|goal| matches!(goal.source, Source::Way | Source::Path));
        let mut joints: Vec<usize> = ways().map(|goal| goal.joint).collect();
        joints.sort_unstable();
        joints.dedup();
        for joint in joints {
            let own = || ways().filter(move |goal| goal.joint == joint);
            self.line(own().map(|goal| view.pixel(goal.at)), DRAWN, 2.0, 0.9);
            own()
                .filter(|goal| goal.frame == at)
                .for_each(|goal| self.dot(view.pixel(goal.at), 4.5, DRAWN, 1.0));
        }
        self.body(scene, view, &flat);
        for line in scene.marks(part, at) {
            self.line(line.into_iter().map(|place| view.pixel(place)), HELD, 2.0, 0.9);
        }
        let near = |goal: &Goal| goal.frame.abs_diff(at) <= near;
        let put = part.goals.iter().filter(|goal| goal.source == Source::Edit && near(goal));
        put.for_each(|goal| self.dot(view.pixel(goal.at), 5.0, PUT, 0.9));
        let drawn = part.goals.iter().filter(|goal| matches!(goal.source, Source::Pin | Source::Pose));
        drawn.filter(|goal| near(goal)).for_each(|goal| self.dot(view.pixel(goal.at), 3.0, KEY, 0.9));
    }

    fn floor(&mut self, view: &View, height: f32) {
        let [x, y] = view.pixel(Vec2::new(view.middle.x, height));
        let half = 0.4 * view.size[0];
        self.line([[x - half, y], [x + half, y]].into_iter(), [215, 215, 220], 1.0, 1.0);
    }

    fn body(&mut self, scene: &Scene<'_>, view: &View, flat: &[Vec2]) {
        let width = if scene.head.is_some() { 5.0 } else { 3.0 };
        for (from, to, colour) in &scene.bones {
            if let (Some(from), Some(to)) = (flat.get(*from), flat.get(*to)) {
                self.line([view.pixel(*from), view.pixel(*to)].into_iter(), *colour, width, 1.0);
            }
        }
        if let Some([neck, head]) = scene.head
            && let (Some(neck), Some(head)) = (flat.get(neck), flat.get(head))
        {
            let middle = *head + (*head - *neck).normalize_or(Vec2::Y) * 0.07;
            self.dot(view.pixel(middle), 0.09 * view.scale(), MIDDLE, 1.0);
        }
    }

    pub(super) fn line(
        &mut self,
        points: impl Iterator<Item = [f32; 2]>,
        colour: Rgb,
        width: f32,
        strength: f32,
    ) {
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
