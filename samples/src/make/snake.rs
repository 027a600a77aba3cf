//! The snake: winds ahead with growing bends, stops and rears its head, and hurries on.
//!
//! The body follows the head: every joint lies on the line that the head has drawn on the ground, so that nothing
//! slides sideways. The line is a serpenoid curve (Hirose 1993), whose heading swings as a sine of the length.

use super::{
    ease::{Keys, gaussian, min_jerk, window},
    figure::{FRAME_RATE, Pose, Rig, turn},
};
use inkrig_motion::{
    Clip, MotionError,
    glam::{DQuat, DVec3},
};
use std::f64::consts::TAU;

/// Length of the clip, seconds.
const LENGTH: f64 = 11.0;
const SEGMENT: f64 = 0.078;
/// From the root back to the first joint of the tail, metres. Short, because it turns with the root's front segment.
const JOIN: f64 = 0.02;
/// Joints from the root to the head, and from the root to the tail's tip.
const FRONT: usize = 12;
const BACK: usize = 12;
/// Length of one bend to both sides along the body, metres.
const WAVE: f64 = 0.9;
/// Height of the body's middle over the ground, metres.
const BELLY: f64 = 0.03;
/// When the head is raised, seconds.
const REARING: (f64, f64) = (5.2, 8.9);
/// Step of the line on the ground, metres.
const FINE: f64 = 0.002;

/// The motion, 11 seconds.
///
/// # Errors
/// Never in practice: when a computed number is not finite.
pub fn clip() -> Result<Clip, MotionError> {
    let rig = rig();
    let line = Line::new();
    let times: Vec<f64> =
        (0..=(LENGTH * FRAME_RATE) as usize).map(|frame| frame as f64 / FRAME_RATE).collect();
    let passed = passed(&times);
    let poses: Vec<Pose<'_>> =
        times.iter().zip(&passed).map(|(&time, &passed)| pose(&rig, &line, time, passed)).collect();
    rig.clip(&poses)
}

/// 24 joints and 3 tips, 1.9 m long when straight, facing +z. The root is in the middle of the body.
fn rig() -> Rig {
    let mut rig = Rig::default();
    rig.joint("Hips", "", [0.0, BELLY, 0.0]);
    let mut parent = "Hips".to_owned();
    for index in 1..=FRONT {
        let name = if index == FRONT { "Head".to_owned() } else { format!("Spine{index}") };
        rig.joint(&name, &parent, [0.0, 0.0, SEGMENT]);
        parent = name;
    }
    rig.end("Head", [0.0, 0.0, 0.09]);
    rig.joint("Jaw", "Head", [0.0, -0.012, 0.015]);
    rig.end("Jaw", [0.0, -0.005, 0.065]);
    parent = "Hips".to_owned();
    for index in 1..BACK {
        let name = format!("Tail{index}");
        let back = if index == 1 { JOIN } else { SEGMENT };
        rig.joint(&name, &parent, [0.0, 0.0, -back]);
        parent = name;
    }
    rig.end(&parent, [0.0, 0.0, -SEGMENT]);
    rig
}

/// Metres passed at each time.
fn passed(times: &[f64]) -> Vec<f64> {
    let speed = Keys::new(&[
        (0.0, 0.25),
        (1.0, 0.35),
        (3.2, 0.75),
        (4.4, 0.65),
        (5.6, 0.0),
        (8.1, 0.0),
        (9.3, 1.05),
        (LENGTH, 0.8),
    ]);
    let mut passed = 0.0;
    (times.iter())
        .map(|&time| {
            let now = passed;
            passed += speed.at(time + 0.5 / FRAME_RATE) / FRAME_RATE;
            now
        })
        .collect()
}

/// Heading along the line that the head draws, every [`FINE`] metres, and the places it leads to. Length 0 is the
/// root's place at the first frame; the line begins a body's length before.
struct Line {
    headings: Vec<f64>,
    places: Vec<DVec3>,
}

const BEFORE: f64 = 1.6;

impl Line {
    fn new() -> Self {
        // From flat bends to wide ones and, for the hurry at the end, to middling ones.
        let swing = Keys::new(&[(-1.6, 0.22), (0.9, 0.3), (3.0, 1.0), (3.9, 0.95), (4.8, 0.5), (7.0, 0.42)]);
        let drift = Keys::new(&[(-1.6, 0.0), (1.5, 0.0), (3.5, 0.5), (5.0, 0.2), (7.0, -0.3)]);
        let (mut headings, mut places, mut place) = (Vec::new(), Vec::new(), DVec3::new(0.0, BELLY, -BEFORE));
        for step in 0..(9.0 / FINE) as usize {
            let length = step as f64 * FINE - BEFORE;
            let heading = swing.at(length) * (TAU * length / WAVE).sin() + drift.at(length);
            headings.push(heading);
            places.push(place);
            place += turn(heading, 0.0, 0.0) * DVec3::Z * FINE;
        }
        Self { headings: gaussian(&headings, 8.0), places }
    }

    fn find(&self, length: f64) -> (usize, usize, f64) {
        let place = ((length + BEFORE) / FINE).clamp(0.0, self.headings.len() as f64 - 1.0);
        let low = place.floor() as usize;
        (low, (low + 1).min(self.headings.len() - 1), place - low as f64)
    }

    fn heading(&self, length: f64) -> f64 {
        let (low, high, between) = self.find(length);
        self.headings[low] + between * (self.headings[high] - self.headings[low])
    }

    fn place(&self, length: f64) -> DVec3 {
        let (low, high, between) = self.find(length);
        self.places[low].lerp(self.places[high], between)
    }

    /// Headings of the segments from the tail's tip to the head's when the root is at `length` and every joint lies on
    /// the line.
    fn segments(&self, length: f64) -> Vec<f64> {
        let mut headings = Vec::new();
        let mut here = length;
        here -= JOIN;
        for _ in 1..BACK {
            let next = self.step(here, -1.0);
            headings.push(self.between(next, here));
            here = next;
        }
        headings.reverse();
        here = length;
        for _ in 0..=FRONT {
            let next = self.step(here, 1.0);
            headings.push(self.between(here, next));
            here = next;
        }
        headings
    }

    fn between(&self, from: f64, to: f64) -> f64 {
        let along = self.place(to) - self.place(from);
        along.x.atan2(along.z)
    }

    /// Where on the line the next joint lies, one segment away as the crow flies: bisection.
    fn step(&self, from: f64, way: f64) -> f64 {
        let (mut near, mut far) = (SEGMENT, 1.5 * SEGMENT);
        for _ in 0..40 {
            let middle = 0.5 * (near + far);
            let apart = self.place(from + way * middle).distance(self.place(from));
            if apart < SEGMENT { near = middle } else { far = middle }
        }
        from + way * 0.5 * (near + far)
    }
}

fn pose<'a>(rig: &'a Rig, line: &Line, time: f64, passed: f64) -> Pose<'a> {
    let mut pose = rig.rest();
    pose.root = line.place(passed);
    let raised = window(time, REARING.0, REARING.1, 1.2, 1.0);
    // The raised part sways, looks to both sides, and draws back a little before it goes down.
    let look = Keys::new(&[(5.6, 0.0), (6.3, 0.55), (7.0, -0.6), (7.6, 0.2), (8.2, 0.0)]).at(time);
    let late = Keys::new(&[(5.75, 0.0), (6.5, 0.55), (7.2, -0.6), (7.8, 0.2), (8.4, 0.0)]).at(time);
    let draw = Keys::new(&[(7.3, 0.0), (7.9, 1.0), (8.35, 0.0)]).at(time);
    let crest = line.heading(passed + (FRONT as f64 - 5.5) * SEGMENT);
    let headings = line.segments(passed);
    let mut rotations = vec![DQuat::IDENTITY; FRONT + BACK];
    for (index, rotation) in rotations.iter_mut().enumerate() {
        // Segment `index` reaches from joint to joint; segment BACK - 1 is the first ahead of the root.
        let ahead = index as f64 - BACK as f64 + 1.5;
        let heading = headings[index];
        // The front six segments rise in an S: up, then level for the head.
        let up = ahead - (FRONT as f64 - 7.0);
        let rise = if up > 0.0 { min_jerk(up / 2.5) } else { 0.0 };
        let level = min_jerk((up - 4.2) / 2.6);
        let pitch = -raised * (1.28 * rise * (1.0 - level) + 0.22 * draw * rise - 0.08 * level)
            - 0.1 * (1.0 - raised) * level * (0.6 + 0.4 * (TAU * 0.5 * time).sin());
        // While reared, its bends give way to one sway that runs up from the neck to the head.
        let part = raised * rise;
        let sway = crest + (late + (look - late) * level) * (0.35 + 0.65 * level);
        // Ahead of the neck the head looks where the body goes, not to every side.
        let steady = 0.55 * level * (1.0 - raised);
        let straight = line.heading(passed + (ahead - 0.25 * WAVE / SEGMENT) * SEGMENT);
        let flat = heading + steady * 0.5 * (straight - heading);
        *rotation = turn(flat + part * (sway - flat), pitch, 0.0);
    }
    let named = |name: &str| rig.find(name);
    pose.local[0] = rotations[BACK - 1];
    for index in 1..=FRONT {
        let name = if index == FRONT { "Head".to_owned() } else { format!("Spine{index}") };
        if let Some(joint) = named(&name) {
            pose.set_world(joint, rotations[BACK - 1 + index]);
        }
    }
    if let Some(jaw) = named("Jaw") {
        let open = window(time, 7.6, 8.6, 0.35, 0.4);
        pose.local[jaw] = DQuat::from_rotation_x(0.03 + 0.45 * open);
    }
    // A joint of the tail turns what lies behind it; the tail's first joint turns its first segment.
    for index in 1..BACK {
        if let Some(joint) = named(&format!("Tail{index}")) {
            pose.set_world(joint, rotations[BACK - 1 - index]);
        }
    }
    pose
}
