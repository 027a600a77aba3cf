//! Drawing the cells.

use super::{
    SheetError, SheetOptions,
    capsule::{add_capsule, band, capsule},
    colours::{Colours, DARK, LIGHT, Rgb, colour, mix, plain},
    digits,
    layout::Grid,
    view::{Scene, View},
};
use crate::preview::normalised;
use inkrig_motion::capsules::{Limb, Side};
use inkrig_motion::glam::{Vec2, Vec3};
use tiny_skia::{
    FillRule, GradientStop, LineCap, LineJoin, LinearGradient, Paint, Path, PathBuilder, Pixmap, Point, Rect,
    SpreadMode, Stroke, Transform,
};

/// Draws all cells and writes the PNG: of one scene, or of several whose poses take turns.
pub(super) fn sheet(
    scenes: &[Scene],
    grid: &Grid,
    options: &SheetOptions<'_>,
) -> Result<Vec<u8>, SheetError> {
    let colours = if options.dark { &DARK } else { &LIGHT };
    let [width, height] = grid.size();
    let too_large = || SheetError::Png(format!("no memory for {width} x {height} pixels"));
    let mut page = Pixmap::new(width, height).ok_or_else(too_large)?;
    page.fill(colour(colours.page, 1.0));
    let markers = normalised(options.markers.unwrap_or_default(), 1);
    let most = scenes.iter().map(|scene| scene.poses.len()).max().unwrap_or(0);
    let cells = (0..most)
        .flat_map(|place| scenes.iter().filter_map(move |scene| Some((scene, scene.poses.get(place)?))));
    for (index, (scene, pose)) in cells.enumerate() {
        let camera = Camera::of(scene, grid);
        // A cell of its own, so that nothing reaches into the next one.
        let mut cell =
            Cell { pixels: Pixmap::new(grid.cell[0], grid.cell[1]).ok_or_else(too_large)?, colours, camera };
        cell.draw(scene, pose, &markers);
        let [x, y] = grid.corner(index);
        page.draw_pixmap(
            x as i32,
            y as i32,
            cell.pixels.as_ref(),
            &Default::default(),
            Transform::identity(),
            None,
        );
    }
    page.encode_png().map_err(|error| SheetError::Png(error.to_string()))
}

/// Pixels of a view: the same for every cell.
#[derive(Debug, Clone, Copy)]
struct Camera {
    /// Pixels a metre.
    scale: f32,
    /// The picture of the place on the ground where the character stands.
    ground: Vec2,
    width: f32,
    height: f32,
}

impl Camera {
    fn of(scene: &Scene, grid: &Grid) -> Self {
        let [width, height] = grid.cell.map(|side| side as f32);
        let label = Cell::label_height(height);
        let top = 1.2 * label;
        let room = Vec2::new(0.92 * width, height - top - 2.6 * label);
        let extent = (scene.high - scene.low).max(Vec2::splat(f32::MIN_POSITIVE));
        let scale = (room / extent).min_element();
        let middle = 0.5 * (scene.low + scene.high);
        let centre = Vec2::new(0.5 * width, top + 0.5 * room.y);
        let ground = centre + scale * Vec2::new(-middle.x, middle.y);
        Self { scale, ground, width, height }
    }

    fn pixel(&self, place: Vec3) -> Vec2 {
        self.ground + self.scale * Vec2::new(place.x, -place.y)
    }

    /// Whether a place is near enough to the cell to be worth drawing.
    fn near(&self, pixel: Vec2) -> bool {
        let far = 4.0 * (self.width + self.height);
        pixel.abs().max_element() < far
    }
}

struct Cell<'a> {
    pixels: Pixmap,
    colours: &'a Colours,
    camera: Camera,
}

impl Cell<'_> {
    fn draw(&mut self, scene: &Scene, pose: &View, markers: &[[f64; 2]]) {
        self.draw_card();
        self.draw_ground(scene, pose);
        self.draw_body(scene, pose);
        self.draw_label(pose.seconds);
        self.draw_marker(markers, pose.progress);
    }

    fn label_height(cell_height: f32) -> f32 {
        (0.038 * cell_height).max(7.0)
    }

    fn draw_card(&mut self) {
        let Camera { width, height, .. } = self.camera;
        let gap = (0.012 * width).max(1.0).round();
        if let Some(card) = Rect::from_xywh(gap, gap, width - 2.0 * gap, height - 2.0 * gap) {
            let paint = plain(self.colours.card, 1.0);
            self.pixels.fill_rect(card, &paint, Transform::identity(), None);
        }
    }

    fn draw_ground(&mut self, scene: &Scene, pose: &View) {
        let Camera { width, ground, .. } = self.camera;
        let mut line = PathBuilder::new();
        line.move_to(0.07 * width, ground.y);
        line.line_to(0.93 * width, ground.y);
        self.stroke(line.finish(), self.colours.line, (0.005 * width).max(1.0));
        let mut shadow = PathBuilder::new();
        for limb in &scene.body.limbs {
            self.add_limb(&mut shadow, limb, &pose.shadows);
        }
        self.fill(shadow.finish(), &plain(self.colours.shadow, 0.9));
        if let Some(heading) = pose.heading.map(|corners| corners.map(|place| self.camera.pixel(place))) {
            let mut arrow = PathBuilder::new();
            for (index, corner) in heading.iter().enumerate() {
                let add = if index == 0 { PathBuilder::move_to } else { PathBuilder::line_to };
                add(&mut arrow, corner.x, corner.y);
            }
            arrow.close();
            self.fill(arrow.finish(), &plain(self.colours.ink, 0.55));
        }
    }

    /// Limbs from the far to the near, each with a rim of the card's colour so that crossing limbs stay apart.
    fn draw_body(&mut self, scene: &Scene, pose: &View) {
        let depth = |limb: &Limb| match (pose.joints.get(limb.from), pose.joints.get(limb.to)) {
            (Some(from), Some(to)) => 0.5 * (from.z + to.z),
            _ => 0.0,
        };
        let mut order: Vec<(f32, &Limb)> = scene.body.limbs.iter().map(|limb| (depth(limb), limb)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (depth, limb) in order {
            let haze = (0.5 - 0.9 * depth / scene.body.size).clamp(0.0, 1.0) * 0.34;
            self.draw_limb(limb, &pose.joints, if scene.pale { 0.55 + 0.3 * haze } else { haze });
        }
    }

    fn draw_limb(&mut self, limb: &Limb, joints: &[Vec3], haze: f32) {
        let Some((from, from_radius, to, to_radius)) = self.outline(limb, joints) else { return };
        let rim = (0.004 * self.camera.width).max(0.8);
        // The links of a dense chain (a tail, a snake) are one body: their rims are at the sides only.
        let shape = if from.distance(to) > 1.5 * from_radius.max(to_radius) { capsule } else { band };
        self.fill(shape(from, from_radius + rim, to, to_radius + rim), &plain(self.colours.card, 0.85));
        let base = match limb.side {
            Side::Left => self.colours.left,
            Side::Right => self.colours.right,
            Side::Middle => self.colours.middle,
        };
        let tone = |target: Rgb, part: f32| mix(mix(base, target, part), self.colours.card, haze);
        let (light, dark) = (tone([255, 255, 255], 0.3), tone([0, 0, 0], 0.2));
        // Across the limb, from the side that looks to the light (upper left) to the other.
        let across = (to - from).normalize_or(Vec2::Y).perp();
        let across = if across.dot(Vec2::new(-0.5, -0.85)) < 0.0 { -across } else { across };
        let (middle, radius) = (0.5 * (from + to), from_radius.max(to_radius));
        let (bright, dim) = (middle + radius * across, middle - radius * across);
        let stops = vec![
            GradientStop::new(0.0, colour(light, 1.0)),
            GradientStop::new(0.55, colour(mix(base, self.colours.card, haze), 1.0)),
            GradientStop::new(1.0, colour(dark, 1.0)),
        ];
        let point = |place: Vec2| Point::from_xy(place.x, place.y);
        let shader =
            LinearGradient::new(point(bright), point(dim), stops, SpreadMode::Pad, Transform::identity());
        let mut paint = plain(mix(base, self.colours.card, haze), 1.0);
        if let Some(shader) = shader {
            paint.shader = shader;
        }
        self.fill(capsule(from, from_radius, to, to_radius), &paint);
    }

    fn draw_label(&mut self, seconds: f64) {
        let Camera { width, height, .. } = self.camera;
        let size = Self::label_height(height);
        let mut path = PathBuilder::new();
        let corner = Vec2::new(0.06 * width, height - 0.05 * width - 1.2 * size);
        digits::add_text(&mut path, &digits::seconds(seconds), corner, size);
        self.stroke(path.finish(), self.colours.ink, (0.13 * size).max(1.1));
    }

    fn draw_marker(&mut self, points: &[[f64; 2]], progress: f64) {
        if points.is_empty() {
            return;
        }
        let Camera { width, height, .. } = self.camera;
        let side = 0.2 * width.min(height);
        let corner = Vec2::new(0.95 * width - side, height - 0.05 * width - side);
        let right = points.iter().map(|point| point[0]).fold(0.0, f64::max);
        let place = |point: [f64; 2]| {
            corner + side * Vec2::new((1.0 - right + point[0]) as f32, (1.0 - point[1]) as f32)
        };
        let mut path = PathBuilder::new();
        for (index, &point) in points.iter().enumerate() {
            let place = place(point);
            let add = if index == 0 { PathBuilder::move_to } else { PathBuilder::line_to };
            add(&mut path, place.x, place.y);
        }
        self.stroke(path.finish(), self.colours.line, (0.008 * width).max(1.0));
        let nearest = (progress * (points.len() - 1) as f64).round() as usize;
        if let Some(&point) = points.get(nearest) {
            let dot = place(point);
            let radius = (0.015 * width).max(2.0);
            self.fill(PathBuilder::from_circle(dot.x, dot.y, radius), &plain(self.colours.dot, 1.0));
        }
    }

    fn add_limb(&self, path: &mut PathBuilder, limb: &Limb, joints: &[Vec3]) {
        if let Some((from, from_radius, to, to_radius)) = self.outline(limb, joints) {
            add_capsule(path, from, from_radius, to, to_radius);
        }
    }

    /// Ends and radii of a limb in pixels; `None` when it is far outside of the picture.
    fn outline(&self, limb: &Limb, joints: &[Vec3]) -> Option<(Vec2, f32, Vec2, f32)> {
        let [from, to] =
            [*joints.get(limb.from)?, *joints.get(limb.to)?].map(|joint| self.camera.pixel(joint));
        let radius = |metres: f32| (metres * self.camera.scale).max(0.6);
        let near = self.camera.near(from) && self.camera.near(to);
        near.then(|| (from, radius(limb.from_radius), to, radius(limb.to_radius)))
    }

    fn fill(&mut self, path: Option<Path>, paint: &Paint<'_>) {
        if let Some(path) = path {
            self.pixels.fill_path(&path, paint, FillRule::Winding, Transform::identity(), None);
        }
    }

    fn stroke(&mut self, path: Option<Path>, ink: Rgb, width: f32) {
        let stroke =
            Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        if let Some(path) = path {
            self.pixels.stroke_path(&path, &plain(ink, 1.0), &stroke, Transform::identity(), None);
        }
    }
}
