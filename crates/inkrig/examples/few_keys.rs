//! Draws docs/few-keys.png: a joint's turn over time with a key a frame, with few keys and their tangents, and held on twos:
//! `cargo run --release -p inkrig --example few_keys -- MOTION.bvh JOINT FILE.png`.

#![allow(clippy::print_stdout, reason = "an example prints its figures")]

use inkrig::formats::{ImportOptions, read_bvh};
use inkrig::motion::keyframes::{SparseOptions, deviation, sparse, stepped};
use inkrig::motion::{Clip, lead_in, time};
use std::error::Error;
use tiny_skia::{Color, FillRule, LineCap, Paint, PathBuilder, Pixmap, Stroke, Transform};

const WIDTH: f32 = 1200.0;
const ROW: f32 = 190.0;
const MARGIN: f32 = 24.0;
/// Moments a frame at which curves are drawn.
const FINE: usize = 16;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [motion, joint, file] = arguments.as_slice() else {
        return Err("give a motion, a joint and the file to write".into());
    };
    let clip = read_bvh(&std::fs::read(motion)?, &ImportOptions::default())?.clip;
    // A rest pose before the motion would only be a step in the picture.
    let clip = time::trim(&clip, lead_in::rest_pose_frames(&clip)..clip.frames())?;
    let joint = clip.skeleton().find(joint).ok_or("the motion has no such joint")?;
    let few = sparse(&clip, &SparseOptions::default());
    let held = stepped(&clip, clip.frame_rate() / 12.0, &[]);
    let (count, apart) = (few.count(), deviation(&clip, &few.clip()?)?);
    println!(
        "{} of {} keys; {:.3} mm, {:.3} degrees; held: {}",
        count.keys,
        count.dense,
        1e3 * apart.metres,
        apart.radians.to_degrees(),
        held.count().keys
    );
    let frames = |track: usize| few.rotations[track].keys.iter().map(|key| key.frame).collect::<Vec<_>>();
    let dense = turn(&clip, joint);
    let bounds = dense.iter().fold((f32::MAX, f32::MIN), |(low, high), y| (low.min(*y), high.max(*y)));
    let mut page = Page {
        picture: Pixmap::new(WIDTH as u32, (3.0 * ROW) as u32).ok_or("no memory")?,
        bounds,
        last: (clip.frames() - 1) as f32,
    };
    page.picture.fill(Color::WHITE);
    let all: Vec<(f32, f32)> = dense.iter().enumerate().map(|(frame, y)| (frame as f32, *y)).collect();
    page.line(0, &all, 1.5, [160, 165, 175]);
    all.iter().for_each(|&point| page.dot(0, point, 3.0, [90, 96, 106]));
    let fine = turn(&few.sampled(FINE)?, joint);
    let at = |sample: usize| (sample as f32 / FINE as f32, fine[sample]);
    page.line(1, &all, 3.0, [214, 217, 222]);
    page.line(1, &(0..fine.len()).map(at).collect::<Vec<_>>(), 1.5, [30, 90, 190]);
    for frame in frames(joint) {
        let (x, y) = at(frame * FINE);
        for step in [-1_i32, 1] {
            let near = (frame * FINE) as i32 + step;
            if let Some(value) = usize::try_from(near).ok().and_then(|near| fine.get(near)) {
                let slope = (value - y) * FINE as f32;
                let end = (x + 1.4 * step as f32, y + 1.4 * slope);
                page.line(1, &[(x, y), end], 1.2, [240, 150, 30]);
                page.dot(1, end, 2.2, [240, 150, 30]);
            }
        }
        page.dot(1, (x, y), 4.5, [30, 90, 190]);
    }
    let steps = turn(&held.sampled(FINE)?, joint);
    page.line(2, &all, 3.0, [214, 217, 222]);
    let points = steps.iter().enumerate().map(|(sample, y)| (sample as f32 / FINE as f32, *y));
    page.line(2, &points.collect::<Vec<_>>(), 1.5, [208, 50, 40]);
    for key in &held.rotations[joint].keys {
        page.dot(2, (key.frame as f32, steps[key.frame * FINE]), 4.5, [208, 50, 40]);
    }
    std::fs::write(file, page.picture.encode_png()?)?;
    Ok(())
}

/// How far a joint has turned about x, degrees, at every frame.
fn turn(clip: &Clip, joint: usize) -> Vec<f32> {
    let x = |frame: usize| clip.rotations(frame)[joint].to_scaled_axis().x.to_degrees();
    (0..clip.frames()).map(x).collect()
}

struct Page {
    picture: Pixmap,
    bounds: (f32, f32),
    last: f32,
}

impl Page {
    fn place(&self, row: usize, (x, y): (f32, f32)) -> (f32, f32) {
        let (low, high) = self.bounds;
        let part = (y - low) / (high - low).max(1e-6);
        let x = MARGIN + x / self.last * (WIDTH - 2.0 * MARGIN);
        (x, (row as f32 + 1.0) * ROW - MARGIN - part * (ROW - 2.0 * MARGIN))
    }

    fn line(&mut self, row: usize, points: &[(f32, f32)], width: f32, ink: [u8; 3]) {
        let mut builder = PathBuilder::new();
        for (index, point) in points.iter().enumerate() {
            let (x, y) = self.place(row, *point);
            if index == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
        }
        let stroke = Stroke { width, line_cap: LineCap::Round, ..Stroke::default() };
        if let Some(path) = builder.finish() {
            self.picture.stroke_path(&path, &paint(ink), &stroke, Transform::identity(), None);
        }
    }

    fn dot(&mut self, row: usize, point: (f32, f32), radius: f32, ink: [u8; 3]) {
        let (x, y) = self.place(row, point);
        if let Some(dot) = PathBuilder::from_circle(x, y, radius) {
            self.picture.fill_path(&dot, &paint(ink), FillRule::Winding, Transform::identity(), None);
        }
    }
}

fn paint([r, g, b]: [u8; 3]) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, 255);
    paint
}
