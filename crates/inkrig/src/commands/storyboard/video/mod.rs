//! A moving picture: on the left the drawing of the frame that is played, on the right its motion.

mod gif;
mod matroska;
mod webm;

use super::scene::{Part, Scene};
use super::sheet::{MIDDLE_HEIGHT, Page, View};
use crate::console::Console;
use crate::error::CliError;
use crate::load;
use inkrig_motion::glam::Vec2;
use std::path::Path;

/// Pixels of each of both halves, and of a picture.
const CELL: [f32; 2] = [340.0, 360.0];
const SIZE: [usize; 2] = [2 * CELL[0] as usize, CELL[1] as usize];
/// Pictures a second.
const RATE: usize = 20;
/// The most pictures: two minutes.
const MOST: usize = 120 * RATE;
/// A drawn pose is shown around its moment, seconds.
const KEY_SECONDS: f64 = 0.15;

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Gif,
    WebM,
}

/// Says early whether a moving picture of this name can be made.
///
/// # Errors
/// When its name says that it is of no kind that is written.
pub(super) fn check(path: &Path) -> Result<(), CliError> {
    kind(path).map(|_| ())
}

fn kind(path: &Path) -> Result<Kind, CliError> {
    match load::extension(path).as_deref() {
        Some("gif") => Ok(Kind::Gif),
        Some("webm") => Ok(Kind::WebM),
        _ => {
            let known = "moving pictures are .webm and .gif; others can be made of these: \
                         ffmpeg -i kick.webm kick.mp4";
            Err(CliError::Kind { path: path.into(), known })
        }
    }
}

/// Draws all pictures, as the kind of file that the name says; warns where it was cut short.
///
/// # Errors
/// When it was stopped, or a picture cannot be made.
pub(super) fn video(
    path: &Path,
    scene: &Scene<'_>,
    console: &Console,
    warnings: &mut Vec<String>,
) -> Result<Vec<u8>, CliError> {
    let kind = kind(path)?;
    let rate = RATE as f64;
    let wanted = (scene.frames as f64 / scene.frame_rate * rate).ceil().max(1.0) as usize;
    let count = wanted.min(MOST);
    if count < wanted {
        warnings.push(format!(
            "the moving picture ends after {:.0} s of {:.0}",
            MOST as f64 / rate,
            wanted as f64 / rate
        ));
    }
    let pictures = Pictures::new(scene, count);
    match kind {
        Kind::Gif => gif::write(&pictures, console),
        Kind::WebM => webm::write(&pictures, console),
    }
}

/// The pictures of a motion, each of which is drawn when it is asked for.
struct Pictures<'a> {
    count: usize,
    scene: &'a Scene<'a>,
    views: Vec<View>,
}

impl<'a> Pictures<'a> {
    fn new(scene: &'a Scene<'a>, count: usize) -> Self {
        Self { count, scene, views: scene.parts.iter().map(|part| view(scene, part)).collect() }
    }

    fn draw(&self, number: usize) -> Result<Page, CliError> {
        let scene = self.scene;
        let mut page = Page::new(SIZE[0] as u32, SIZE[1] as u32)?;
        let at = (number as f64 / RATE as f64 * scene.frame_rate).round() as usize;
        let at = at.min(scene.frames.saturating_sub(1));
        let part = scene.part_at(at);
        let place = scene.parts.iter().position(|own| part.is_some_and(|part| std::ptr::eq(own, part)));
        if let (Some(part), Some(view)) = (part, place.and_then(|place| self.views.get(place))) {
            page.moment(scene, part, at, view, (KEY_SECONDS * scene.frame_rate).round() as usize);
            // Over what of the motion may reach into the drawing's half.
            page.clear([0.0, 0.0], CELL);
            page.drawing(part, [0.0, 0.0], CELL);
            page.line([[CELL[0], 0.0], [CELL[0], CELL[1]]].into_iter(), [225, 225, 228], 1.0, 1.0);
        }
        Ok(page)
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_written_is_said_by_the_name() {
        assert_eq!(kind(Path::new("a.GIF")).unwrap(), Kind::Gif);
        assert_eq!(kind(Path::new("b/a.webm")).unwrap(), Kind::WebM);
        assert!(kind(Path::new("a.mp4")).is_err() && kind(Path::new("webm")).is_err());
    }
}
