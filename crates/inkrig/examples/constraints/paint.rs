//! What the pictures are put together of: poses, lines, dots and frames.

use inkrig::motion::glam::{Quat, Vec3};
use inkrig::motion::{Clip, Takes, TranslationTrack, time};
use inkrig::sheet::{SheetOptions, contact_sheet};
use std::error::Error;
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, PixmapPaint, PixmapRef, Rect, Stroke,
    Transform,
};

pub(crate) type Rgb = [u8; 3];
pub(crate) type Fallible<T> = Result<T, Box<dyn Error>>;

pub(crate) const GREY: Rgb = [150, 156, 166];
pub(crate) const LIGHT: Rgb = [224, 227, 232];
pub(crate) const BLUE: Rgb = [30, 90, 190];
pub(crate) const RED: Rgb = [208, 50, 40];
pub(crate) const ORANGE: Rgb = [240, 150, 30];
pub(crate) const BLACK: Rgb = [30, 32, 38];

pub(crate) struct Page {
    pixels: Pixmap,
}

/// A part of a page in pixels, with the coordinates that are drawn in it; y upwards.
#[derive(Clone, Copy)]
pub(crate) struct Area {
    pub(crate) corner: [f32; 2],
    pub(crate) size: [f32; 2],
    pub(crate) low: [f64; 2],
    pub(crate) high: [f64; 2],
}

impl Area {
    /// The same scale along both axes, so that all points fit.
    pub(crate) fn even(corner: [f32; 2], size: [f32; 2], points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let (mut low, mut high) = ([f64::MAX; 2], [f64::MIN; 2]);
        for point in points {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let room =
            [0, 1].map(|axis: usize| (high[axis] - low[axis]).max(1e-6) / f64::from(size[axis] - 24.0));
        let unit = room[0].max(room[1]);
        let middle = [0, 1].map(|axis: usize| 0.5 * (low[axis] + high[axis]));
        let half = [0, 1].map(|axis: usize| 0.5 * unit * f64::from(size[axis]));
        Self {
            corner,
            size,
            low: [middle[0] - half[0], middle[1] - half[1]],
            high: [middle[0] + half[0], middle[1] + half[1]],
        }
    }

    /// Moves it so that a point is in the middle, at the same scale.
    pub(crate) fn centre(&mut self, point: [f64; 2]) {
        for ((low, high), middle) in self.low.iter_mut().zip(&mut self.high).zip(point) {
            let half = 0.5 * (*high - *low);
            (*low, *high) = (middle - half, middle + half);
        }
    }

    pub(crate) fn pixel(&self, point: [f64; 2]) -> [f32; 2] {
        let part = |axis: usize| ((point[axis] - self.low[axis]) / (self.high[axis] - self.low[axis])) as f32;
        [self.corner[0] + part(0) * self.size[0], self.corner[1] + (1.0 - part(1)) * self.size[1]]
    }
}

impl Page {
    pub(crate) fn new(width: u32, height: u32) -> Fallible<Self> {
        let mut pixels = Pixmap::new(width, height).ok_or("no memory")?;
        pixels.fill(Color::WHITE);
        Ok(Self { pixels })
    }

    pub(crate) fn save(&self, folder: &std::path::Path, name: &str) -> Fallible<()> {
        let bytes = self.pixels.encode_png()?;
        println!("{name}.png: {} kB", bytes.len() / 1000);
        Ok(std::fs::write(folder.join(name).with_extension("png"), bytes)?)
    }

    pub(crate) fn line(&mut self, area: &Area, points: &[[f64; 2]], width: f32, ink: Rgb) {
        let mut path = PathBuilder::new();
        for (index, point) in points.iter().enumerate() {
            let [x, y] = area.pixel(*point);
            if index == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        self.stroke(path, width, ink);
    }

    /// A line whose pieces are red where `far` is 0 and pale where it is beyond 1.2. Steps of labels are left out.
    pub(crate) fn heat_line(&mut self, area: &Area, points: &[[f64; 2]], far: &[f64], width: f32) {
        for (pair, far) in points.windows(2).zip(far) {
            if width < 10.0 || pair[0][1] == pair[1][1] {
                self.line(area, pair, width, heat((far / 1.2) as f32));
            }
        }
    }

    pub(crate) fn dot(&mut self, area: &Area, point: [f64; 2], radius: f32, ink: Rgb) {
        let [x, y] = area.pixel(point);
        if let Some(path) = PathBuilder::from_circle(x, y, radius) {
            self.pixels.fill_path(&path, &paint(ink), FillRule::Winding, Transform::identity(), None);
        }
    }

    pub(crate) fn ring(&mut self, area: &Area, point: [f64; 2], radius: f32, ink: Rgb) {
        let [x, y] = area.pixel(point);
        let mut path = PathBuilder::new();
        path.push_circle(x, y, radius);
        self.stroke(path, 3.0, ink);
    }

    pub(crate) fn fill(&mut self, corner: [f32; 2], size: [f32; 2], ink: Rgb) {
        if let Some(rect) = Rect::from_xywh(corner[0], corner[1], size[0], size[1]) {
            self.pixels.fill_rect(rect, &paint(ink), Transform::identity(), None);
        }
    }

    pub(crate) fn frame(&mut self, corner: [f32; 2], size: [f32; 2], ink: Rgb) {
        if let Some(rect) = Rect::from_xywh(corner[0] + 2.0, corner[1] + 2.0, size[0] - 4.0, size[1] - 4.0) {
            let mut path = PathBuilder::new();
            path.push_rect(rect);
            self.stroke(path, 4.0, ink);
        }
    }

    /// Cells of one size, row by row, of which only one figure's worth is copied to each place.
    pub(crate) fn figures(&mut self, figures: &Figures, places: &[(usize, [f32; 2])]) -> Fallible<()> {
        let [width, height] = figures.cell;
        for &(index, [x, y]) in places {
            let rect = tiny_skia::IntRect::from_xywh((index as u32 * width) as i32, 0, width, height);
            let cell = figures.strip.clone_rect(rect.ok_or("no such figure")?).ok_or("no such figure")?;
            let cell: PixmapRef<'_> = cell.as_ref();
            self.pixels.draw_pixmap(
                x as i32,
                y as i32,
                cell,
                &PixmapPaint::default(),
                Transform::identity(),
                None,
            );
        }
        Ok(())
    }

    fn stroke(&mut self, path: PathBuilder, width: f32, ink: Rgb) {
        let stroke =
            Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        if let Some(path) = path.finish() {
            self.pixels.stroke_path(&path, &paint(ink), &stroke, Transform::identity(), None);
        }
    }
}

/// Poses of one character at one scale, side by side.
pub(crate) struct Figures {
    strip: Pixmap,
    pub(crate) cell: [u32; 2],
}

impl Figures {
    /// Frames of clips of one skeleton, each turned to the viewer.
    pub(crate) fn of(poses: &[(&Clip, usize)], cell: [u32; 2]) -> Fallible<Self> {
        let turned: Fallible<Vec<Clip>> = poses.iter().map(|&(clip, frame)| to_viewer(clip, frame)).collect();
        let takes = Takes::join(&turned?)?;
        let frames: Vec<usize> = (0..poses.len()).collect();
        let options =
            SheetOptions { columns: poses.len(), frames: Some(&frames), cell, ..SheetOptions::default() };
        let mut strip = Pixmap::decode_png(&contact_sheet(takes.clip(), &options)?)?;
        // The times of the joined clip mean nothing.
        let label = (0.038 * cell[1] as f32).max(7.0) * 1.2 + 0.05 * cell[0] as f32;
        for index in 0..poses.len() {
            let x = index as f32 * cell[0] as f32 + 3.0;
            let rect = Rect::from_xywh(x, cell[1] as f32 - label - 1.0, 0.5 * cell[0] as f32, label - 2.0);
            if let Some(rect) = rect {
                strip.fill_rect(rect, &paint([252, 252, 253]), Transform::identity(), None);
            }
        }
        Ok(Self { strip, cell })
    }
}

fn to_viewer(clip: &Clip, frame: usize) -> Fallible<Clip> {
    let one = time::trim(clip, frame..frame + 1)?;
    let joint = one.travel_joint();
    let ahead = one.rotations(0)[joint] * Vec3::Z;
    let mut rotations = one.rotations(0).to_vec();
    rotations[joint] = Quat::from_rotation_y(-ahead.x.atan2(ahead.z)) * rotations[joint];
    let tracks: Vec<TranslationTrack> = one.translations().to_vec();
    Ok(Clip::new(one.skeleton().clone(), 30.0, rotations, tracks)?)
}

fn paint(ink: Rgb) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(ink[0], ink[1], ink[2], 255);
    paint
}

/// From near (red) to far (pale blue).
pub(crate) fn heat(part: f32) -> Rgb {
    let stops = [[200.0, 30.0, 20.0], [245.0, 170.0, 50.0], [170.0, 195.0, 225.0], [205.0, 218.0, 236.0_f32]];
    let place = part.clamp(0.0, 0.999) * 3.0;
    let (below, rest) = (place as usize, place.fract());
    [0, 1, 2].map(|c: usize| (stops[below][c] + (stops[below + 1][c] - stops[below][c]) * rest) as u8)
}

/// A colour over white.
pub(crate) fn mixed(ink: Rgb, part: f32) -> Rgb {
    ink.map(|value| (255.0 + (f32::from(value) - 255.0) * part) as u8)
}
