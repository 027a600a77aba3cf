//! A motion along another way over the ground.

use super::line::Line;
use super::low_pass::low_pass_numbers;
use super::placement::{GroundMove, move_over_ground};
use super::spine::Spine;
use super::{GroundPath, Trajectory, TravelOptions, angle_of, direction, size_of, turned, wrapped};
use crate::{Clip, MotionError};
use glam::DVec2;

/// Corners of a path are rounded over this many sizes of the character to either side, where nothing was said.
const CORNER: f64 = 0.2;
/// Chords of a path that is made here are this long, in sizes of the character.
const CHORD: f64 = 0.02;
/// Most of them.
const MOST_CHORDS: f64 = 50_000.0;

/// Where a motion shall go.
#[derive(Debug, Clone, PartialEq)]
pub enum Route {
    /// Straight ahead: from where the motion begins towards where it ends, or as it sets out when it comes back.
    Straight,
    /// An even curve that begins as the motion does and turns by this angle in all, radians, to the left when
    /// positive.
    Arc(f64),
    /// Its own way, bent evenly by this angle in all, radians, to the left when positive.
    Bend(f64),
    /// A given path.
    Path(GroundPath),
}

/// How a path is followed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PathOptions {
    /// How travel is told from sway.
    pub travel: TravelOptions,
    /// Metres in one unit of a [`Route::Path`], which then lies where its coordinates say. `None`: the path is made as
    /// long as the motion travels, and begins where the motion begins.
    pub metres_per_unit: Option<f64>,
    /// Corners of a [`Route::Path`] are rounded over about so many metres to either side. `None`: a fifth of the
    /// character's size.
    pub corner_metres: Option<f64>,
}

/// A motion that follows a path, and how well.
#[derive(Debug, Clone, PartialEq)]
pub struct Followed {
    /// The motion.
    pub clip: Clip,
    /// Metres in one unit of the path; 1 for the other routes.
    pub metres_per_unit: f64,
    /// Length of the path, metres.
    pub path_metres: f64,
    /// How far the motion travels, metres: the same before and after.
    pub travelled_metres: f64,
    /// Mean distance of the motion's way (without sway) from the path, metres. Beyond the end of an open path the
    /// way goes on straight; nothing was drawn there, so it does not count.
    pub mean_distance: f64,
    /// Largest of these distances, metres.
    pub max_distance: f64,
}

/// Moves a motion to another way over the ground. Timing, speed along the way, height and all poses stay; the body
/// turns with the path as it did with its own way (who walked sideways still does), and sway across is kept. Nothing
/// is done to keep the feet from sliding where the new way is more or less curved: see
/// [`Contacts`](super::Contacts) to measure it.
///
/// A path that is longer than the motion travels is followed as far as that goes. Beyond the end of a shorter one, the
/// motion goes around again when the path is closed, and else on straight.
///
/// # Errors
/// - [`MotionError::Still`] when the motion does not travel.
/// - [`MotionError::Path`] when an option is not finite or the path has no length that counts.
pub fn follow_path(clip: &Clip, route: &Route, options: &PathOptions) -> Result<Followed, MotionError> {
    let size = size_of(clip.skeleton());
    let trajectory = Trajectory::of(clip, &options.travel);
    let spine = Spine::of(&trajectory, size)?;
    let travelled = spine.travelled();
    let (scale, raw, line) = lines(route, &spine, size, options)?;
    let half = 0.5 * options.travel.smoothing_seconds.clamp(0.0, 60.0) * clip.frame_rate();
    let places: Vec<((DVec2, f64), (DVec2, f64))> =
        spine.progress.iter().map(|&way| (spine.line.at(way), line.at(way))).collect();
    let turns: Vec<f64> = places.iter().map(|(own, new)| new.1 - own.1).collect();
    let first = turns.first().map_or(0.0, |turn| turn - wrapped(*turn));
    let turns = low_pass_numbers(&turns, half.round() as usize);
    let moves: Vec<GroundMove> = (places.iter().zip(turns))
        .map(|(((from, _), (to, _)), turn)| GroundMove { turn: turn - first, from: *from, to: *to })
        .collect();
    let (mut sum, mut count, mut max_distance) = (0.0, 0.0_f64, 0.0_f64);
    for ((step, place), way) in moves.iter().zip(&trajectory.path).zip(&spine.progress) {
        if !raw.covers(*way) {
            continue;
        }
        let distance = raw.distance(step.of(*place), *way, size);
        sum += distance;
        count += 1.0;
        max_distance = max_distance.max(distance);
    }
    Ok(Followed {
        clip: move_over_ground(clip, trajectory.joint, &moves)?,
        metres_per_unit: scale,
        path_metres: raw.length(),
        travelled_metres: travelled,
        mean_distance: sum / count.max(1.0),
        max_distance,
    })
}

/// Metres in a unit; the path as it is; the path as it is followed.
fn lines(
    route: &Route,
    spine: &Spine,
    size: f64,
    options: &PathOptions,
) -> Result<(f64, Line, Line), MotionError> {
    let wrong = |what: String| MotionError::Path { what };
    let travelled = spine.travelled();
    let (start, own_angle) = spine.line.at(0.0);
    let line = match route {
        Route::Path(path) => {
            let from = options.metres_per_unit.is_none().then_some(start);
            let scale = options.metres_per_unit.unwrap_or(travelled / path.length());
            let length = path.length() * scale;
            if !(length.is_finite() && scale > 0.0) {
                return Err(wrong(format!("a unit of {scale} m is not usable; give a length above 0")));
            }
            if length < STEP_OF_PATH * size {
                return Err(wrong(format!(
                    "it is {length:.3} m long, too short for a character of {size:.2} m; its unit may be longer than {scale} m"
                )));
            }
            let corner = options.corner_metres.unwrap_or(CORNER * size);
            if !(corner.is_finite() && corner >= 0.0) {
                return Err(wrong(format!("corners cannot be rounded over {corner} m; give 0 or more")));
            }
            let (raw, smooth) = path.lines(scale, from, size, corner);
            return Ok((scale, raw, smooth));
        }
        Route::Straight => {
            let chord = spine.line.at(travelled).0 - start;
            let ahead = if chord.length() > 0.25 * travelled { angle_of(chord) } else { own_angle };
            arc(start, ahead, 0.0, travelled, size)
        }
        Route::Arc(angle) => arc(start, own_angle, finite(*angle)?, travelled, size),
        Route::Bend(angle) => bent(spine, finite(*angle)?),
    };
    Ok((1.0, line.clone(), line))
}

/// Paths shorter than this many sizes of the character are taken for a wrong unit.
const STEP_OF_PATH: f64 = 0.1;

fn finite(angle: f64) -> Result<f64, MotionError> {
    /// A hundred rounds.
    const MOST: f64 = 100.0 * std::f64::consts::TAU;
    if angle.abs() <= MOST {
        return Ok(angle);
    }
    let degrees = angle.to_degrees();
    Err(MotionError::Path { what: format!("a turn of {degrees} degrees is not usable; give up to 36000") })
}

/// A curve of even curvature.
fn arc(start: DVec2, ahead: f64, angle: f64, length: f64, size: f64) -> Line {
    let count = (length / (CHORD * size)).ceil().max(angle.abs() * 20.0).clamp(2.0, MOST_CHORDS) as usize;
    let ways: Vec<f64> = (0..=count).map(|index| length * index as f64 / count as f64).collect();
    let points = (ways.iter())
        .map(|way| {
            // The chord of an arc: twice the radius times the sine of half its angle.
            let half = 0.5 * angle * way / length;
            let shorter = if half.abs() < 1e-9 { 1.0 } else { half.sin() / half };
            start + way * shorter * direction(ahead + half)
        })
        .collect();
    Line::new(ways, points, false, None)
}

/// A way that turns more and more away from its own.
fn bent(spine: &Spine, angle: f64) -> Line {
    let length = spine.line.length();
    let mut place = spine.points[0];
    let mut points = vec![place];
    let mut hints = vec![0.0];
    for (pair, ways) in spine.points.windows(2).zip(spine.arc.windows(2)) {
        let middle = 0.5 * (ways[0] + ways[1]);
        place += turned(pair[1] - pair[0], angle * middle / length);
        points.push(place);
        // The way's own turns are to the side that it took.
        hints.push(spine.line.at(ways[1]).1 - spine.line.at(ways[0]).1);
    }
    Line::new(spine.arc.clone(), points, false, Some(&hints))
}
