//! Storyboards on paper: a scanned or painted page becomes frames of strokes. Colours say what lines are, boxes or empty columns
//! where one panel ends; lines are thinned and followed.

mod panels;
mod trace;

use crate::page::distance;
use inkrig_generate::readers::ink::Ink;
use inkrig_sketch::storyboard::{Frame, Kind, Storyboard, Stroke, kind_of_colour};
use panels::panels;
use trace::trace;

/// Ink above this is a line.
const LINE: f32 = 0.45;
/// A faint line, as of a light grey floor, has at least so much, and stands alone: the rims of dark lines are faint, too.
const FAINT: f32 = 0.15;
/// Pixels between a faint line and a dark one.
const ALONE: usize = 3;
/// The paper is as bright as this share of all pixels.
const PAPER: f32 = 0.9;
/// A way that ends so near to another's middle meets it, pixels.
const MEETS: f64 = 16.0;
/// Specks of fewer pixels are dirt.
const SPECK: usize = 14;

/// A picture of a page: rows from the top, red, green and blue of each pixel.
#[derive(Debug, Clone, Copy)]
pub struct Picture<'a> {
    /// Pixels of a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `3 * width * height` numbers.
    pub pixels: &'a [u8],
}

/// Reads a page. Places are pixels, y up; the word is there as lettering only. `None` where the page is bare, or the numbers are
/// not those of a picture.
///
/// A painted line has no direction: trajectories begin at their end that is nearer to the body.
pub fn storyboard_of_picture(picture: &Picture<'_>) -> Option<Storyboard> {
    let kinds = kinds(picture)?;
    let (width, height) = (picture.width, picture.height);
    let mut frames = Vec::new();
    for panel in panels(&kinds, width) {
        let [left, top, right, bottom] = panel;
        let mut frame = Frame::default();
        for kind in [Kind::Body, Kind::Trajectory, Kind::Speed, Kind::Scene, Kind::Lettering] {
            let wide = right - left;
            let mask = (top..bottom).flat_map(|y| {
                kinds[y * width + left..y * width + right].iter().map(|own| *own == Some(kind))
            });
            let mut mask: Vec<bool> = mask.collect();
            without_specks(&mut mask, wide);
            let ink: Vec<bool> = (top..bottom)
                .flat_map(|y| kinds[y * width + left..y * width + right].iter().map(Option::is_some))
                .collect();
            for line in trace(mask, &ink, wide) {
                let place = |[x, y]: [f64; 2]| [x + left as f64, (height - top) as f64 - y];
                frame.add(kind, Stroke::new(line.into_iter().map(place).collect()));
            }
        }
        begin_at_the_body(&mut frame);
        go_back(&mut frame);
        if !frame.body.is_empty() || !frame.trajectories.is_empty() || !frame.lettering.is_empty() {
            frames.push(frame);
        }
    }
    if frames.is_empty() { None } else { Some(Storyboard { title: String::new(), frames }) }
}

/// What every pixel is a line of.
fn kinds(picture: &Picture<'_>) -> Option<Vec<Option<Kind>>> {
    let (width, height) = (picture.width, picture.height);
    if picture.pixels.len() != width.checked_mul(height)?.checked_mul(3)? || picture.pixels.is_empty() {
        return None;
    }
    let white: Vec<f32> = (0..3)
        .map(|part| {
            let mut counts = [0_usize; 256];
            picture.pixels.iter().skip(part).step_by(3).for_each(|value| counts[usize::from(*value)] += 1);
            let wanted = (PAPER * (width * height) as f32) as usize;
            let mut passed = 0;
            let at = counts.iter().position(|count| {
                passed += count;
                passed > wanted
            });
            at.unwrap_or(255).max(32) as f32
        })
        .collect();
    // A coloured line is dark in one of its parts, however bright it looks.
    let darkest: Vec<f32> = picture
        .pixels
        .chunks_exact(3)
        .map(|pixel| {
            pixel.iter().zip(&white).map(|(value, white)| f32::from(*value) / white).fold(1.0, f32::min)
        })
        .collect();
    let ink = Ink::of_brightness(&darkest, width, height);
    let beside_a_line = near(&ink.pixels.iter().map(|ink| *ink > LINE).collect::<Vec<_>>(), width);
    let kinds = picture.pixels.chunks_exact(3).zip(ink.pixels.iter().zip(&beside_a_line)).map(
        |(pixel, (ink, rim))| {
            let part = |at: usize| (255.0 * f32::from(pixel[at]) / white[at]).min(255.0) as u8;
            let least = if *rim { LINE } else { FAINT };
            if *ink > least { kind_of_colour([part(0), part(1), part(2)]) } else { None }
        },
    );
    Some(kinds.collect())
}

/// Pixels at most [`ALONE`] away from one of a mask, along rows and columns.
fn near(mask: &[bool], width: usize) -> Vec<bool> {
    let spread = |mask: &[bool], step: usize, same: &dyn Fn(usize, usize) -> bool| {
        let mut out = mask.to_vec();
        for at in (0..mask.len()).filter(|at| mask[*at]) {
            for away in 1..=ALONE {
                for other in [at.checked_sub(away * step), at.checked_add(away * step)].into_iter().flatten()
                {
                    if other < out.len() && same(at, other) {
                        out[other] = true;
                    }
                }
            }
        }
        out
    };
    let across = spread(mask, 1, &|a, b| a / width == b / width);
    spread(&across, width, &|_, _| true)
}

/// Takes away pieces of few pixels.
fn without_specks(mask: &mut [bool], width: usize) {
    let mut seen = vec![false; mask.len()];
    for start in 0..mask.len() {
        if !mask[start] || seen[start] {
            continue;
        }
        let mut piece = vec![start];
        seen[start] = true;
        let mut next = 0;
        while let Some(&at) = piece.get(next) {
            next += 1;
            for other in around(at, width, mask.len()) {
                if mask[other] && !seen[other] {
                    seen[other] = true;
                    piece.push(other);
                }
            }
        }
        if piece.len() < SPECK {
            piece.into_iter().for_each(|at| mask[at] = false);
        }
    }
}

/// The up to eight pixels around one.
fn around(at: usize, width: usize, length: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (at % width, at / width);
    let rows = y.saturating_sub(1)..=y + 1;
    rows.flat_map(move |row| {
        (x.saturating_sub(1)..=(x + 1).min(width - 1)).map(move |column| row * width + column)
    })
    .filter(move |other| *other != at && *other < length)
}

fn begin_at_the_body(frame: &mut Frame) {
    let body: Vec<[f64; 2]> = frame.body.iter().flat_map(|stroke| stroke.points.iter().copied()).collect();
    let away = |point: Option<&[f64; 2]>| {
        let at = point.copied().unwrap_or_default();
        body.iter().map(|own| distance(*own, at)).fold(f64::INFINITY, f64::min)
    };
    for way in &mut frame.trajectories {
        let points = &mut way.points.points;
        if away(points.last()) < away(points.first()) {
            points.reverse();
        }
    }
}

/// A way that ends on the middle of another is that way, gone back over its own line: a foot that kicks and comes down again.
fn go_back(frame: &mut Frame) {
    let ways = &mut frame.trajectories;
    // One goes back once: else teeth of a comb would double it again and again.
    let mut back = vec![false; ways.len()];
    let mut number = 0;
    while number < ways.len() {
        let own = ways[number].points.points.clone();
        let meets = |end: Option<&[f64; 2]>| {
            let end = end?;
            ways.iter().enumerate().filter(|(other, _)| *other != number && !back[*other]).find_map(
                |(other, way)| {
                    let points = &way.points.points;
                    let inner = points.len() / 8..points.len() - points.len() / 8;
                    let at = inner
                        .min_by(|a, b| distance(points[*a], *end).total_cmp(&distance(points[*b], *end)))?;
                    (distance(points[at], *end) < MEETS).then_some((other, at))
                },
            )
        };
        let found = match (meets(own.first()), meets(own.last())) {
            (Some(found), None) => Some((found, own)),
            (None, Some(found)) => Some((found, own.into_iter().rev().collect())),
            _ => None,
        };
        match found {
            Some(((other, at), rest)) => {
                let points = &mut ways[other].points.points;
                let again: Vec<[f64; 2]> = points[at..].iter().rev().skip(1).copied().collect();
                points.extend(again);
                points.extend(rest);
                back[other] = true;
                ways.remove(number);
                back.remove(number);
            }
            None => number += 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_sketch::storyboard::{Stroke, Trajectory};

    /// A page with lines: from, to, colour, each three pixels thick.
    fn page(lines: &[([f32; 2], [f32; 2], [u8; 3])]) -> Vec<u8> {
        let mut pixels = vec![250_u8; 3 * 300 * 200];
        for (from, to, colour) in lines {
            for step in 0..=600 {
                let t = step as f32 / 600.0;
                let (x, y) = (from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1]));
                for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
                    let at = 3 * ((y as i32 + dy) as usize * 300 + (x as i32 + dx) as usize);
                    pixels[at..at + 3].copy_from_slice(colour);
                }
            }
        }
        pixels
    }

    const BLACK: [u8; 3] = [20, 20, 20];
    const CYAN: [u8; 3] = [0, 180, 200];

    fn read(pixels: &[u8]) -> Storyboard {
        storyboard_of_picture(&Picture { width: 300, height: 200, pixels }).unwrap()
    }

    #[test]
    fn colours_become_strokes_and_crossing_lines_go_straight_on() {
        let cross = [([40.0, 100.0], [140.0, 110.0], BLACK), ([90.0, 40.0], [95.0, 160.0], BLACK)];
        let way = ([260.0, 60.0], [150.0, 100.0], CYAN);
        let board = read(&page(&[cross[0], cross[1], way]));
        let [frame] = &board.frames[..] else { panic!("{board:?}") };
        assert_eq!((frame.body.len(), frame.trajectories.len()), (2, 1), "{frame:?}");
        let line = &frame.trajectories[0].points.points;
        assert!(line[0][0] < 160.0 && line.last().unwrap()[0] > 250.0, "it begins at the body: {line:?}");
        assert!((line[0][1] - 100.0).abs() < 5.0 && (line.last().unwrap()[1] - 140.0).abs() < 5.0, "y is up");
        let length = |stroke: &Stroke| distance(stroke.points[0], *stroke.points.last().unwrap());
        assert!(frame.body.iter().all(|stroke| length(stroke) > 90.0), "{frame:?}");
    }

    #[test]
    fn boxes_and_empty_columns_are_panels() {
        let framed = |left: f32| {
            let (right, top, bottom) = (left + 120.0, 20.0, 180.0);
            vec![
                ([left, top], [right, top], BLACK),
                ([right, top], [right, bottom], BLACK),
                ([right, bottom], [left, bottom], BLACK),
                ([left, bottom], [left, top], BLACK),
                ([left + 60.0, 50.0], [left + 70.0, 150.0], BLACK),
            ]
        };
        let board = read(&page(&[framed(10.0), framed(160.0)].concat()));
        let strokes: Vec<usize> = board.frames.iter().map(|frame| frame.body.len()).collect();
        assert_eq!(strokes, [1, 1], "the boxes are no body");
        assert!(board.frames[0].body[0].points[0][0] < 100.0, "from left to right");
        let board =
            read(&page(&[([60.0, 40.0], [70.0, 150.0], BLACK), ([220.0, 50.0], [230.0, 150.0], BLACK)]));
        assert_eq!(board.frames.len(), 2);
        assert!(storyboard_of_picture(&Picture { width: 10, height: 10, pixels: &[255; 300] }).is_none());
        assert!(storyboard_of_picture(&Picture { width: 10, height: 10, pixels: &[255; 30] }).is_none());
    }

    #[test]
    fn a_comb_does_not_double_itself() {
        let line = |points: &[[f64; 2]]| Trajectory {
            points: Stroke::new(points.to_vec()),
            ..Trajectory::default()
        };
        let spine: Vec<[f64; 2]> = (0..1000).map(|at| [f64::from(at), 0.0]).collect();
        let tooth = |at: i32| {
            let x = 300.0 + 10.0 * f64::from(at);
            (0..20).map(|step| [x, 1.0 + 20.0 * f64::from(step)]).collect::<Vec<_>>()
        };
        let mut frame = Frame { trajectories: vec![line(&spine)], ..Frame::default() };
        frame.trajectories.extend((0..40).map(|at| line(&tooth(at))));
        go_back(&mut frame);
        let points: usize = frame.trajectories.iter().map(|way| way.points.points.len()).sum();
        assert!(frame.trajectories.len() == 40 && points < 3000, "{} {points}", frame.trajectories.len());
    }
}
