//! Drawings as ink: pictures of paper, or lines.

use crate::error::CliError;
use crate::{jpeg, load};
use inkrig_generate::readers::ink::{Ink, Mark, Placement};
use std::path::Path;
use tiny_skia::Pixmap;

/// Pixels of the longer side when lines are drawn.
const SIDE: f64 = 640.0;
/// Pixels of paper around them.
const MARGIN: f64 = 40.0;
/// Width of the pen, as a share of the longer side.
const PEN: f64 = 1.0 / 70.0;
/// A picture of more pixels is not read.
const MOST_PIXELS: u64 = 64 << 20;

/// Reads a drawing: PNG, JPEG, or a curve's file.
///
/// # Errors
/// When it is not there, too large, of an unknown kind or not understood.
pub(crate) fn ink(path: &Path) -> Result<Ink, CliError> {
    match load::extension(path).as_deref() {
        Some("png" | "jpg" | "jpeg") => picture(path),
        Some("svg" | "json" | "csv") => lines(path),
        _ => Err(CliError::Kind {
            path: path.to_path_buf(),
            known: "known drawings: .png, .jpg, .svg, .json, .csv",
        }),
    }
}

fn picture(path: &Path) -> Result<Ink, CliError> {
    let (width, height, pixels) = colours(path)?;
    let bright = pixels.chunks_exact(3).map(|pixel| {
        let part = |at: usize| f32::from(pixel[at]);
        (0.3 * part(0) + 0.59 * part(1) + 0.11 * part(2)) / 255.0
    });
    Ok(Ink::of_brightness(&bright.collect::<Vec<f32>>(), width, height))
}

/// The pixels of a PNG or JPEG, red, green and blue, with their width and height.
///
/// # Errors
/// When it is not there, too large or not understood.
pub(crate) fn colours(path: &Path) -> Result<(usize, usize, Vec<u8>), CliError> {
    if matches!(load::extension(path).as_deref(), Some("jpg" | "jpeg")) {
        let wrong = |what| CliError::Picture { path: path.to_path_buf(), what };
        let read = jpeg::decode(&load::drawing(path)?, MOST_PIXELS as usize).map_err(wrong)?;
        return Ok((read.width, read.height, read.pixels));
    }
    let pixmap = pixmap(path)?;
    let pixels = on_paper(&pixmap).flat_map(|pixel| pixel.map(|part| part as u8)).collect();
    Ok((pixmap.width() as usize, pixmap.height() as usize, pixels))
}

/// Red, green and blue from 0 to 255 of each pixel. Colours are multiplied by their cover already; the rest is white paper.
fn on_paper(pixmap: &Pixmap) -> impl Iterator<Item = [f32; 3]> + '_ {
    pixmap.pixels().iter().map(|pixel| {
        let white = 255.0 - f32::from(pixel.alpha());
        [pixel.red(), pixel.green(), pixel.blue()].map(|part| f32::from(part) + white)
    })
}

fn pixmap(path: &Path) -> Result<Pixmap, CliError> {
    let bytes = load::drawing(path)?;
    let wrong = |what: String| CliError::Picture { path: path.to_path_buf(), what };
    if bytes.starts_with(b"\xff\xd8\xff") {
        return Err(wrong("is no PNG but a JPEG: give it a name that ends in .jpg".into()));
    }
    if !bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        return Err(wrong("is no PNG: it does not begin like one".into()));
    }
    // The size stands at a fixed place; it is looked at before room is made.
    let number = |at: usize| -> u64 {
        let bytes = bytes.get(at..at + 4).and_then(|bytes| bytes.first_chunk::<4>().copied());
        bytes.map_or(0, |bytes| u64::from(u32::from_be_bytes(bytes)))
    };
    if number(16).saturating_mul(number(20)) > MOST_PIXELS {
        return Err(wrong("has more pixels than 8192 x 8192; save it smaller".into()));
    }
    Pixmap::decode_png(&bytes).map_err(|error| wrong(format!("is no PNG that can be read ({error})")))
}

fn lines(path: &Path) -> Result<Ink, CliError> {
    let curve = load::curve(path)?;
    let bounds = curve.bounds();
    let [wide, high] = bounds.size();
    let longer = wide.max(high).max(1e-9);
    let scale = SIDE / longer;
    let place = |point: &[f64; 2]| {
        [
            ((point[0] - bounds.min[0]) / longer) as f32,
            ((point[1] - bounds.min[1]) / longer) as f32,
            PEN as f32,
        ]
    };
    let stroke = |points: &[[f64; 2]]| Mark::Stroke { points: points.iter().map(place).collect(), ink: 1.0 };
    let marks: Vec<Mark> = curve.strokes().map(stroke).collect();
    let size = |length: f64| (length * scale + 2.0 * MARGIN).ceil() as usize;
    let mut ink = Ink::new(size(wide), size(high));
    let origin = [MARGIN as f32, (MARGIN + high * scale) as f32];
    ink.draw(&marks, &Placement { scale: SIDE as f32, origin });
    Ok(ink)
}
