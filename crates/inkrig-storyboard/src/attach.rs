//! Which joint a drawn line is the way of, and at which end of it the figure stands (section 3 of the paper).

use crate::calibrate::Calibration;
use crate::error::Problem;
use crate::figure::Figure;
use crate::joints::joint_named;
use crate::page::distance;
use inkrig_generate::text::{VERBS, actions_in};
use inkrig_motion::humanml::{JOINTS, NAMES};
use inkrig_sketch::storyboard::{End, Frame, Trajectory};

/// Joints whose ways are usually drawn. They win over others that are a little nearer.
const USUAL: [usize; 6] = [0, 10, 11, 15, 20, 21];
/// How much nearer another joint has to be: a length, metres.
const NEARER: f64 = 0.12;
/// How much more of that the pelvis has where the word is of the whole body, metres: hands often rest beside it.
const WHOLE: f64 = 0.15;
/// Such words.
const WHOLE_BODY: [&str; 14] = [
    "walk", "run", "jog", "jump", "skip", "crawl", "crouch", "sit down", "stand up", "climb", "sneak",
    "march", "limp", "step",
];
/// A line that begins and ends farther than this from every joint touches nothing, metres.
const REACH: f64 = 0.3;
/// Ends that differ by less than this share of the line in how near they are say nothing of where the figure is.
const UNDECIDED: f64 = 0.15;

/// Whose way a line is.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    /// Which of the frame's trajectories.
    pub trajectory: usize,
    /// The joint.
    pub joint: usize,
    /// Where on the line the figure is drawn.
    pub figure: End,
}

/// Attaches all lines of a frame; they agree on where the figure is.
pub(crate) fn attach(
    frame: &Frame,
    word: &str,
    figure: &Figure,
    scale: &Calibration,
) -> Result<Vec<Way>, Problem> {
    let is_whole = |at: usize| VERBS.get(at).is_some_and(|verb| WHOLE_BODY.contains(&verb.name));
    let whole = actions_in(word).into_iter().any(is_whole);
    let mut found = Vec::new();
    for (number, line) in frame.trajectories.iter().enumerate() {
        found.push(nearest(number, line, figure, scale, whole)?);
    }
    let said = |end: End| found.iter().find(|way| way.sure && way.figure == end);
    if let (Some(starts), Some(ends)) = (said(End::Start), said(End::End)) {
        return Err(Problem::new(
            format!(
                "trajectory {} starts at the figure ({}), but trajectory {} ends there ({})",
                starts.trajectory + 1,
                name(starts.joint),
                ends.trajectory + 1,
                name(ends.joint)
            ),
            "Draw both away from it or both towards it, or say \"figure\": \"start\" or \"end\" at the trajectories",
        ));
    }
    let common = found.iter().find(|way| way.sure).map_or(End::Start, |way| way.figure);
    let way = |way: Near| Way {
        trajectory: way.trajectory,
        joint: way.joint,
        figure: if way.sure { way.figure } else { common },
    };
    let ways: Vec<Way> = found.into_iter().map(way).collect();
    for (at, way) in ways.iter().enumerate() {
        if let Some(other) = ways.iter().skip(at + 1).find(|other| other.joint == way.joint) {
            return Err(Problem::new(
                format!(
                    "trajectories {} and {} are both of {}",
                    way.trajectory + 1,
                    other.trajectory + 1,
                    name(way.joint)
                ),
                "Join them to one line, put one into a frame of its own, or name another \"joint\"",
            ));
        }
    }
    Ok(ways)
}

struct Near {
    trajectory: usize,
    joint: usize,
    figure: End,
    sure: bool,
}

fn nearest(
    trajectory: usize,
    line: &Trajectory,
    figure: &Figure,
    scale: &Calibration,
    whole: bool,
) -> Result<Near, Problem> {
    let number = trajectory + 1;
    let about =
        |problem: Problem| Problem { what: format!("trajectory {number}: {}", problem.what), ..problem };
    let points = &line.points.points;
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return Err(Problem::new(format!("trajectory {number} has no point"), "Leave it out"));
    };
    let length: f64 = points.windows(2).map(|pair| distance(pair[0], pair[1])).sum();
    if length < 0.03 * scale.units {
        return Err(Problem::new(
            format!("trajectory {number} is a dot"),
            "Draw a line from the joint to where it goes, or leave it out",
        ));
    }
    let reach = |joint: usize, end: [f64; 2]| {
        figure.at(joint).map_or(f64::INFINITY, |at| distance(at, end) / scale.units)
    };
    // Nearness, with an advantage for joints whose ways are usually drawn.
    let score = |joint: usize, end: [f64; 2]| {
        let usual = if USUAL.contains(&joint) { NEARER } else { 0.0 };
        reach(joint, end) - usual - if whole && joint == 0 { WHOLE } else { 0.0 }
    };
    let named = line.joint.as_deref().map(joint_named).transpose().map_err(about)?;
    let best = |end: [f64; 2]| {
        let nearest = (0..JOINTS).min_by(|a, b| score(*a, end).total_cmp(&score(*b, end)));
        let joint = named.or(nearest).unwrap_or(0);
        (joint, score(joint, end))
    };
    let ((start_joint, start), (end_joint, end)) = (best(*first), best(*last));
    let decided = line.figure.unwrap_or(if end < start { End::End } else { End::Start });
    let (joint, at) = if decided == End::Start { (start_joint, *first) } else { (end_joint, *last) };
    let away = reach(joint, at);
    if named.is_none() && away > REACH {
        let todo = format!(
            "Begin it at a joint, end it at one, or name one: \"joint\": \"{}\", the nearest",
            name(joint)
        );
        let what = format!(
            "trajectory {number} touches nothing: {} is {:.0} cm away, measured on a person of usual size",
            name(joint),
            100.0 * away
        );
        return Err(Problem::new(what, todo));
    }
    let apart = (start - end).abs();
    let sure = line.figure.is_some() || apart >= UNDECIDED * length / scale.units;
    Ok(Near { trajectory, joint, figure: decided, sure })
}

fn name(joint: usize) -> &'static str {
    NAMES.get(joint).copied().unwrap_or_default()
}
