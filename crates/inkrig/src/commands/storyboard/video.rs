//! A moving picture: on the left the drawing of the frame that is played, on the right its motion, as GIF.

use super::scene::{Part, Scene};
use super::sheet::{MIDDLE_HEIGHT, Page, View};
use crate::console::Console;
use crate::error::CliError;
use crate::load;
use crate::sheet::SheetError;
use gif::{DisposalMethod, Encoder, Frame, Repeat};
use inkrig_motion::glam::Vec2;
use std::path::Path;

/// Pixels of each of both halves.
const CELL: [f32; 2] = [340.0, 360.0];
/// Pictures a second; hundredths of a second are what a GIF counts.
const RATE: f64 = 20.0;
const HUNDREDTHS: u16 = 5;
/// The most pictures: two minutes.
const MOST: usize = 2400;
/// Colours are told apart by so many bits of each of red, green and blue.
const BITS: usize = 5;
const COLOURS: usize = 1 << (3 * BITS);
/// Colours of a picture that may be used.
const PALETTE: usize = 256;
/// The palette is made of every so many pictures.
const LOOKED_AT: usize = 10;
/// A drawn pose is shown around its moment, seconds.
const KEY_SECONDS: f64 = 0.15;

/// Says early whether a moving picture of this name can be made.
///
/// # Errors
/// When its name says that it is no GIF.
pub(super) fn check(path: &Path) -> Result<(), CliError> {
    if load::extension(path).as_deref() == Some("gif") {
        return Ok(());
    }
    let known =
        "moving pictures are .gif; WebM is not written, as encoders of it are larger than this whole program";
    Err(CliError::Kind { path: path.into(), known })
}

/// Draws all pictures; says when it was cut short.
///
/// # Errors
/// When it was stopped, or a picture cannot be made.
pub(super) fn gif(
    scene: &Scene<'_>,
    console: &Console,
    warnings: &mut Vec<String>,
) -> Result<Vec<u8>, CliError> {
    let wanted = (scene.frames as f64 / scene.frame_rate * RATE).ceil().max(1.0) as usize;
    let count = wanted.min(MOST);
    if count < wanted {
        warnings.push(format!(
            "the moving picture ends after {:.0} s of {:.0}",
            MOST as f64 / RATE,
            wanted as f64 / RATE
        ));
    }
    let views: Vec<View> = scene.parts.iter().map(|part| view(scene, part)).collect();
    let picture = |number: usize| picture(scene, &views, number);
    let mut seen = vec![0_u32; COLOURS];
    for number in (0..count).step_by(LOOKED_AT) {
        picture(number)?.iter().for_each(|colour| seen[usize::from(*colour)] += 1);
    }
    let (palette, nearest) = palette(&seen);
    let (width, height) = (2 * CELL[0] as u16, CELL[1] as u16);
    let mut bytes = Vec::new();
    let wrong = |cause: gif::EncodingError| CliError::from(SheetError::Png(cause.to_string()));
    {
        let mut encoder = Encoder::new(&mut bytes, width, height, &palette).map_err(wrong)?;
        encoder.set_repeat(Repeat::Infinite).map_err(wrong)?;
        let bar = console.bar("drawing the moving picture");
        let mut before: Option<Vec<u8>> = None;
        for number in 0..count {
            if bar.at(number, count).is_break() {
                break;
            }
            let now: Vec<u8> = picture(number)?.iter().map(|colour| nearest[usize::from(*colour)]).collect();
            encoder.write_frame(&changed(before.as_deref(), &now, width, height)).map_err(wrong)?;
            before = Some(now);
        }
        bar.finish()?;
    }
    Ok(bytes)
}

/// One view of all of a part's motion.
fn view(scene: &Scene<'_>, part: &Part<'_>) -> View {
    let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    for frame in part.begins..(part.begins + part.frames).min(scene.frames) {
        let Some((flat, under)) = scene.seen(part, frame) else { continue };
        for place in flat.iter().chain([&under]) {
            (low, high) = (low.min(*place), high.max(*place));
        }
    }
    for goal in &part.goals {
        (low, high) = (low.min(goal.at), high.max(goal.at));
    }
    let size = if low.x <= high.x { high - low } else { Vec2::ZERO };
    let metres = (1.15 * size.y).max(1.15 * size.x * CELL[1] / CELL[0]).max(scene.metres);
    let middle = if low.x <= high.x { 0.5 * (low + high) } else { Vec2::Y * MIDDLE_HEIGHT * metres };
    View { middle, corner: [CELL[0], 0.0], size: CELL, metres }
}

/// A picture in few bits a pixel.
fn picture(scene: &Scene<'_>, views: &[View], number: usize) -> Result<Vec<u16>, CliError> {
    let mut page = Page::new(2 * CELL[0] as u32, CELL[1] as u32)?;
    let at = ((number as f64 / RATE * scene.frame_rate).round() as usize).min(scene.frames.saturating_sub(1));
    let part = scene.part_at(at);
    let place = scene.parts.iter().position(|own| part.is_some_and(|part| std::ptr::eq(own, part)));
    if let (Some(part), Some(view)) = (part, place.and_then(|place| views.get(place))) {
        page.moment(scene, part, at, view, (KEY_SECONDS * scene.frame_rate).round() as usize);
        // Over what of the motion may reach into the drawing's half.
        page.clear([0.0, 0.0], CELL);
        page.drawing(part, [0.0, 0.0], CELL);
        page.line([[CELL[0], 0.0], [CELL[0], CELL[1]]].into_iter(), [225, 225, 228], 1.0, 1.0);
    }
    let few = |part: u8| u16::from(part >> (8 - BITS));
    let pixels = page.pixels.pixels().iter();
    Ok(pixels
        .map(|pixel| few(pixel.red()) << (2 * BITS) | few(pixel.green()) << BITS | few(pixel.blue()))
        .collect())
}

/// The colours that are most there, and for each colour the nearest of them.
fn palette(seen: &[u32]) -> (Vec<u8>, Vec<u8>) {
    let parts = |colour: usize| [2, 1, 0].map(|place| (colour >> (place * BITS)) & ((1 << BITS) - 1));
    let mut common: Vec<usize> = (0..seen.len()).filter(|colour| seen[*colour] > 0).collect();
    common.sort_by_key(|colour| (std::cmp::Reverse(seen[*colour]), *colour));
    common.truncate(PALETTE);
    let full = |part: usize| (part * 255 / ((1 << BITS) - 1)) as u8;
    let palette = common.iter().flat_map(|colour| parts(*colour).map(full)).collect();
    let nearest = (0..seen.len()).map(|colour| {
        let own = parts(colour);
        let away = |other: &usize| -> usize {
            parts(*other).iter().zip(own).map(|(a, b)| a.abs_diff(b).pow(2)).sum()
        };
        let best = common.iter().enumerate().min_by_key(|(_, other)| away(other));
        best.map_or(0, |(place, _)| place as u8)
    });
    (palette, nearest.collect())
}

/// The part of a picture in which it differs from the one before.
fn changed(before: Option<&[u8]>, now: &[u8], width: u16, height: u16) -> Frame<'static> {
    let wide = usize::from(width);
    let differs = |at: usize| before.is_none_or(|before| before.get(at) != now.get(at));
    let (mut left, mut right, mut top, mut bottom) = (wide, 0, usize::from(height), 0);
    for at in (0..now.len()).filter(|at| differs(*at)) {
        let (x, y) = (at % wide, at / wide);
        (left, right, top, bottom) = (left.min(x), right.max(x + 1), top.min(y), bottom.max(y + 1));
    }
    if left >= right {
        // Nothing has changed: a frame has at least a pixel.
        (left, right, top, bottom) = (0, 1, 0, 1);
    }
    let rows = (top..bottom).flat_map(|y| now[y * wide + left..y * wide + right].iter().copied());
    Frame {
        delay: HUNDREDTHS,
        dispose: DisposalMethod::Keep,
        left: left as u16,
        top: top as u16,
        width: (right - left) as u16,
        height: (bottom - top) as u16,
        buffer: rows.collect::<Vec<u8>>().into(),
        ..Frame::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_has_changed_is_written() {
        let mut now = vec![0; 12];
        let before = now.clone();
        now[6] = 3;
        let frame = changed(Some(&before), &now, 4, 3);
        assert_eq!(
            (frame.left, frame.top, frame.width, frame.height, &frame.buffer[..]),
            (2, 1, 1, 1, &[3][..])
        );
        assert_eq!(changed(None, &now, 4, 3).buffer.len(), 12);
        assert_eq!(changed(Some(&now), &now, 4, 3).buffer.len(), 1);
    }

    #[test]
    fn colours_that_are_not_in_the_palette_become_the_nearest() {
        let mut seen = vec![0; COLOURS];
        (seen[0], seen[COLOURS - 1]) = (5, 9);
        let (palette, nearest) = palette(&seen);
        assert_eq!(palette, [255, 255, 255, 0, 0, 0]);
        assert_eq!((nearest[1], nearest[COLOURS - 2]), (1, 0));
        assert!(check(Path::new("a.webm")).is_err() && check(Path::new("a.GIF")).is_ok());
    }
}
