//! What a frame asks of a skeleton that no reader of figures knows: a word, and ways of its joints.

use super::super::{Library, NO_TAKE};
use crate::error::{Problem, StoryboardError};
use crate::timing::timed;
use inkrig_motion::glam::Vec2;
use inkrig_motion::humanml::Camera;
use inkrig_motion::{Clip, Skeleton};
use inkrig_sketch::limits::MAX_STORYBOARD_SECONDS;
use inkrig_sketch::storyboard::{Frame, Stroke};

/// Seconds of a frame of which nothing says how long it is.
const USUAL_SECONDS: f64 = 3.0;
/// Frames are no longer, seconds.
const MOST_SECONDS: f64 = MAX_STORYBOARD_SECONDS;
/// Joints that are offered where a name is not known.
const OFFERED: usize = 8;

/// A frame for a skeleton that is no person's.
#[derive(Debug, Clone, PartialEq)]
pub struct CreatureFrame {
    /// What is done; may be empty.
    pub word: String,
    /// How long, seconds.
    pub seconds: f64,
    /// What it is seen through.
    pub camera: Camera,
    /// Ways of joints.
    pub ways: Vec<CreatureWay>,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// The way of a joint, places evenly over time, canvas units.
#[derive(Debug, Clone, PartialEq)]
pub struct CreatureWay {
    /// Number of the joint in the skeleton.
    pub joint: usize,
    /// Whether it carries the whole body.
    pub travels: bool,
    /// How long it takes, seconds; it begins with the frame.
    pub seconds: f64,
    /// Places, at least two.
    pub points: Vec<Vec2>,
}

/// Understands frame `number` (from 1) for the skeleton of a library.
///
/// # Errors
/// [`StoryboardError::Frame`] when it names a joint that is not there, two ways are of one joint, or nothing is asked for.
pub fn read_creature(
    frame: &Frame,
    number: usize,
    library: &Library,
) -> Result<CreatureFrame, StoryboardError> {
    read(frame, library).map_err(|problem| problem.of_frame(number))
}

fn read(frame: &Frame, library: &Library) -> Result<CreatureFrame, Problem> {
    let clip = library.examples.first().map(|example| &example.clip);
    let clip = clip.ok_or_else(|| Problem::new("there is no example", "Give clips"))?;
    let mut notes = Vec::new();
    if !frame.body.is_empty() {
        notes.push(
            "the drawn body is not read: the examples are no person's. Its ways and word count".to_owned(),
        );
    }
    if !frame.pins.is_empty() {
        notes.push("pins are not met: they need a figure, which only people have".to_owned());
    }
    if !frame.edits.is_empty() || !frame.constraints.is_empty() {
        notes.push("edits and constraints are not met: they are for people".to_owned());
    }
    if frame.path.is_some() {
        notes.push(
            "no path is taken over: that is for people. Without a way a clip's own goes on from there"
                .to_owned(),
        );
    }
    if frame.take > 0 {
        notes.push(NO_TAKE.to_owned());
    }
    let word = frame.word.trim().to_owned();
    if word.is_empty() && frame.trajectories.is_empty() {
        return Err(Problem::new(
            "it has no trajectory and no word",
            "Draw a way or type a word, or delete it",
        ));
    }
    let seconds = frame.seconds.unwrap_or(USUAL_SECONDS);
    let mut ways: Vec<CreatureWay> = Vec::new();
    for (at, line) in frame.trajectories.iter().enumerate() {
        let about = |problem: Problem| Problem {
            what: format!("trajectory {}: {}", at + 1, problem.what),
            ..problem
        };
        let joint = match &line.joint {
            Some(said) => joint_of(clip, said).map_err(about)?,
            None => clip.travel_joint(),
        };
        if ways.iter().any(|way| way.joint == joint) {
            return Err(Problem::new(
                format!(
                    "trajectory {} is of {}, which has one already",
                    at + 1,
                    name(clip.skeleton(), joint)
                ),
                "Put it into a frame of its own, or name another \"joint\"",
            ));
        }
        let length: f64 =
            line.points.points.windows(2).map(|pair| crate::page::distance(pair[0], pair[1])).sum();
        if !(length.is_finite() && length > 0.0) {
            return Err(Problem::new(
                format!("trajectory {} is a dot", at + 1),
                "Draw a line, or leave it out",
            ));
        }
        let dashes: Vec<&Stroke> = if at == 0 { frame.speed_lines.iter().collect() } else { Vec::new() };
        let timed = timed(&line.points, length / seconds, &dashes);
        let drawn = timed.seconds();
        let own = if frame.seconds.is_some() { drawn.min(seconds) } else { drawn };
        if own < drawn {
            notes.push(format!(
                "trajectory {} takes {drawn:.1} s as it is drawn; it is made to fit the frame's {seconds:.1} s",
                at + 1
            ));
        } else if own > MOST_SECONDS {
            return Err(Problem::new(
                format!(
                    "trajectory {} lasts {own:.1} s, but at most {MOST_SECONDS:.0} s are made of a frame",
                    at + 1
                ),
                "Make it shorter, or two frames of it",
            ));
        }
        let count = (own * 60.0).ceil().clamp(8.0, 4000.0) as usize;
        let points = timed.points(count).iter().map(|[x, y]| Vec2::new(*x as f32, *y as f32)).collect();
        ways.push(CreatureWay { joint, travels: joint == clip.travel_joint(), seconds: own, points });
    }
    let longest = ways.iter().map(|way| way.seconds).fold(0.0, f64::max);
    let seconds = if frame.seconds.is_some() || ways.is_empty() { seconds } else { longest };
    let camera = Camera::new(
        frame.camera.pitch_degrees.to_radians() as f32,
        frame.camera.yaw_degrees.to_radians() as f32,
    );
    Ok(CreatureFrame { word, seconds: seconds.clamp(0.2, MOST_SECONDS), camera, ways, notes })
}

pub(super) fn name(skeleton: &Skeleton, joint: usize) -> String {
    skeleton.joints().get(joint).map(|joint| joint.name.clone()).unwrap_or_default()
}

/// The joint of a name: as the file has it, else without regard to case, blanks and signs; `root` and `pelvis` are what travels.
fn joint_of(clip: &Clip, said: &str) -> Result<usize, Problem> {
    let plain = |text: &str| {
        text.chars()
            .filter(|letter| letter.is_alphanumeric())
            .flat_map(char::to_lowercase)
            .collect::<String>()
    };
    let skeleton = clip.skeleton();
    let own = skeleton
        .find(said)
        .or_else(|| skeleton.joints().iter().position(|joint| plain(&joint.name) == plain(said)));
    if let Some(joint) = own {
        return Ok(joint);
    }
    if ["root", "pelvis", "hips", "body"].contains(&plain(said).as_str()) {
        return Ok(clip.travel_joint());
    }
    let said: String = said.chars().take(40).collect();
    let mut names: Vec<&str> =
        skeleton.joints().iter().filter(|joint| !joint.end_site).map(|joint| joint.name.as_str()).collect();
    names.truncate(OFFERED);
    Err(Problem::new(
        format!("the examples' skeleton has no joint {said:?}"),
        format!("Its joints begin with {}; without \"joint\" a way is of the whole body", names.join(", ")),
    ))
}
