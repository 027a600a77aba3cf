//! What a frame says of its motion in space: joints that were moved by hand, and what holds between joints and the world.

use crate::calibrate::Calibration;
use crate::error::Problem;
use crate::exact::{Constraint, Cuboid, Rule};
use crate::joints::joint_named;
use crate::plan::Plan;
use inkrig_motion::glam::{Quat, Vec2, Vec3};
use inkrig_motion::humanml::{JOINTS, Joints, NAMES, PARENTS};
use inkrig_sketch::storyboard::{self, Frame, Stroke};
use std::ops::Range;

/// Planes and edits that are nearer to each other than this agree, metres.
const AGREE: f32 = 0.01;
/// A camera that sees less of a height than this share of it looks down too steeply.
const STEEP: f32 = 0.3;
/// Ends of a stroke that goes around a box are nearer than this share of its size, and it is at least so wide and high, metres.
const OPEN: f32 = 0.25;
const THIN: f32 = 0.02;
/// How deep a drawn box is where nobody says, metres.
const THICK: f64 = 0.5;

/// What is said of a clip in its own space.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Space {
    /// Frame, joint and place, metres.
    pub edits: Vec<(usize, usize, Vec3)>,
    /// Whether the first and the last pose stay as they were without edits.
    pub lock_ends: bool,
    /// What holds.
    pub constraints: Vec<Constraint>,
}

impl Space {
    /// Of a frame, for a body with these bones. `view`: how the scene is seen, where a figure tells.
    pub(crate) fn of(
        frame: &Frame,
        plan: &Plan,
        body: &Joints,
        view: Option<&Calibration>,
    ) -> Result<Self, Problem> {
        let frames = plan.frames;
        let mut edits: Vec<(usize, usize, Vec3)> = Vec::new();
        for edit in &frame.edits {
            let joint = joint_named(&edit.joint)?;
            let named = format!("the edit of {} at frame {}", NAMES[joint], edit.frame);
            if edit.frame >= frames {
                return Err(Problem::new(
                    format!("{named} is behind the clip's end: it has frames 0 to {}", frames - 1),
                    "Take an earlier frame, or give the storyboard's frame more seconds",
                ));
            }
            if frame.lock_ends && (edit.frame == 0 || edit.frame + 1 == frames) {
                return Err(Problem::new(
                    format!("{named} is at an end of the clip, which lock_ends keeps as it is"),
                    "Take a frame between, or leave lock_ends out",
                ));
            }
            edits.push((edit.frame, joint, Vec3::from_array(edit.at.map(|number| number as f32))));
        }
        let mut constraints = Vec::new();
        for constraint in &frame.constraints {
            let drawn = constraint
                .scene()
                .map(|scene| drawn(constraint, &frame.scene, scene, plan, view))
                .transpose()?;
            constraints.push(rule(constraint, frames, body, drawn.as_ref())?);
        }
        let space = Self { edits, lock_ends: frame.lock_ends, constraints };
        space.agrees()?;
        Ok(space)
    }

    /// Refuses what cannot be at once.
    fn agrees(&self) -> Result<(), Problem> {
        let overlap = |a: &Range<usize>, b: &Range<usize>| a.start < b.end && b.start < a.end;
        for (number, one) in self.constraints.iter().enumerate() {
            for other in
                self.constraints.iter().take(number).filter(|other| overlap(&one.frames, &other.frames))
            {
                let problem = match (&one.rule, &other.rule) {
                    (Rule::Plane(joint, normal, along), Rule::Plane(second, other, at)) => {
                        let level = normal.dot(*other);
                        let apart = (along - at * level.signum()).abs();
                        (joint == second && level.abs() > 0.999 && apart > AGREE).then(|| {
                            format!(
                                "{} is put on two planes that are {:.0} cm apart",
                                NAMES[*joint],
                                100.0 * apart
                            )
                        })
                    }
                    (Rule::Distance(joints, Some(long)), Rule::Distance(second, Some(other))) => {
                        let same = joints == second || [joints[1], joints[0]] == *second;
                        (same && (long - other).abs() > AGREE).then(|| {
                            let [a, b] = joints.map(|joint| NAMES[joint]);
                            format!("{a} and {b} are to be {long} m and {other} m apart")
                        })
                    }
                    _ => None,
                };
                if let Some(problem) = problem {
                    return Err(Problem::new(
                        format!(
                            "constraints {} and {} contradict each other: {problem}",
                            self.place(other),
                            number + 1
                        ),
                        "Leave one of them out, or give them other frames",
                    ));
                }
            }
            if let Rule::Plane(joint, normal, along) = one.rule {
                let own = self
                    .edits
                    .iter()
                    .filter(|(frame, edited, _)| *edited == joint && one.frames.contains(frame));
                for (frame, _, at) in own {
                    let off = (normal.dot(*at) - along).abs();
                    if off > AGREE {
                        return Err(Problem::new(
                            format!(
                                "the edit of {} at frame {frame} is {:.0} cm off the plane of constraint {}",
                                NAMES[joint],
                                100.0 * off,
                                number + 1
                            ),
                            "Move the edit onto the plane, or give the constraint other frames",
                        ));
                    }
                }
            }
        }
        Ok(())
    }

    fn place(&self, of: &Constraint) -> usize {
        self.constraints.iter().position(|other| std::ptr::eq(other, of)).map_or(0, |at| at + 1)
    }
}

/// What a stroke of the scene is set to: it lies as far away as the figure, and is seen as the clip begins.
enum Drawn {
    Level(f32),
    Box(Cuboid),
}

fn drawn(
    constraint: &storyboard::Constraint,
    scene: &[Stroke],
    number: usize,
    plan: &Plan,
    view: Option<&Calibration>,
) -> Result<Drawn, Problem> {
    let camera = &plan.camera;
    let what = format!("a constraint ({}) is set from stroke {number} of the scene", constraint.kind());
    let (Some(view), true) = (view, plan.placed && plan.key_frame() == 0) else {
        let todo = "Draw the figure where the clip begins, or give places in metres";
        return Err(Problem::new(format!("{what}, but no figure says where that is"), todo));
    };
    let up = camera.project(Vec3::Y).y;
    if up < STEEP {
        let todo = "Take a camera that looks less down, or give places in metres";
        return Err(Problem::new(format!("{what}, but from so high no height is seen"), todo));
    }
    let points = scene.get(number).map_or(&[][..], |stroke| &stroke.points);
    let places: Vec<Vec2> = points.iter().map(|point| view.picture(*point)).collect();
    let low = places.iter().copied().fold(Vec2::INFINITY, Vec2::min);
    let high = places.iter().copied().fold(Vec2::NEG_INFINITY, Vec2::max);
    let storyboard::Constraint::Box { thickness, .. } = constraint else {
        let mean = places.iter().map(|place| place.y).sum::<f32>() / places.len().max(1) as f32;
        return Ok(Drawn::Level(mean / up));
    };
    let ends = places.first().zip(places.last()).map_or(f32::INFINITY, |(a, b)| a.distance(*b));
    if ends > OPEN * (high - low).length() || (high - low).min_element() < THIN {
        let todo = "Draw around the face of the box, or give its corners in metres";
        return Err(Problem::new(format!("{what}, which does not go around anything"), todo));
    }
    let right = camera.view_from_world().row(0);
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    Ok(Drawn::Box(Cuboid {
        middle: right * middle.x + Vec3::Y * middle.y / up,
        half: Vec3::new(half.x, half.y / up, 0.5 * thickness.unwrap_or(THICK) as f32),
        turn: Quat::from_rotation_y((-right.z).atan2(right.x)),
    }))
}

fn rule(
    said: &storyboard::Constraint,
    frames: usize,
    body: &Joints,
    drawn: Option<&Drawn>,
) -> Result<Constraint, Problem> {
    let [first, last] = said.frames().unwrap_or([0, frames - 1]);
    if last >= frames {
        return Err(Problem::new(
            format!(
                "a constraint ({}) ends at frame {last}, but the clip has frames 0 to {}",
                said.kind(),
                frames - 1
            ),
            "Let it end earlier, or give the storyboard's frame more seconds",
        ));
    }
    let vector = |numbers: &[f64; 3]| Vec3::from_array(numbers.map(|number| number as f32));
    let rule = match said {
        storyboard::Constraint::Distance { joints: [a, b], metres, .. } => {
            let joints = [joint_named(a)?, joint_named(b)?];
            let most = reach(joints, body);
            if let Some(metres) = metres.filter(|metres| *metres as f32 > most) {
                let [a, b] = joints.map(|joint| NAMES[joint]);
                return Err(Problem::new(
                    format!(
                        "{a} and {b} cannot be {metres} m apart: a person of usual size reaches {most:.2} m"
                    ),
                    "Give a shorter distance",
                ));
            }
            Rule::Distance(joints, metres.map(|metres| metres as f32))
        }
        storyboard::Constraint::Plane { joint, height, normal, through, .. } => {
            let normal = normal.as_ref().map_or(Vec3::Y, vector).normalize_or(Vec3::Y);
            let height =
                if let Some(Drawn::Level(height)) = drawn { *height } else { height.unwrap_or(0.0) as f32 };
            let through = through.as_ref().map_or(Vec3::Y * height, vector);
            Rule::Plane(joint_named(joint)?, normal, normal.dot(through))
        }
        storyboard::Constraint::Box { joint, from, to, .. } => {
            let corner = |corner: &Option<[f64; 3]>| corner.as_ref().map_or(Vec3::ZERO, vector);
            let given = Cuboid::between(corner(from), corner(to));
            Rule::Box(joint_named(joint)?, if let Some(Drawn::Box(cuboid)) = drawn { *cuboid } else { given })
        }
        storyboard::Constraint::Balance { .. } => Rule::Balance,
    };
    Ok(Constraint { frames: first..last + 1, rule })
}

/// How far two joints can be apart at most, metres: all bones between them in one line.
fn reach([a, b]: [usize; 2], body: &Joints) -> f32 {
    let up = |joint: usize| {
        std::iter::successors(Some(joint), |joint| (*joint > 0).then(|| PARENTS[*joint])).collect::<Vec<_>>()
    };
    let (a, b) = (up(a), up(b));
    let bones = (0..JOINTS).filter(|joint| a.contains(joint) != b.contains(joint));
    bones.map(|joint| body[joint].length()).sum()
}

#[cfg(test)]
#[allow(clippy::panic, reason = "a test fails by panicking")]
mod tests {
    use super::*;
    use inkrig_motion::humanml::Camera;
    use inkrig_sketch::storyboard::read_storyboard;

    fn body() -> Joints {
        let mut body = [Vec3::Y * 0.25; JOINTS];
        body[0] = Vec3::ZERO;
        body
    }

    fn space(inside: &str) -> Result<Space, Problem> {
        let text = format!("{{\"inkrig_storyboard\": 1, \"frames\": [{{{inside}}}]}}");
        let board = read_storyboard(text.as_bytes()).unwrap();
        Space::of(&board.frames[0], &plan(), &body(), None)
    }

    fn plan() -> Plan {
        Plan::of_word(String::new(), 40, Camera::default())
    }

    #[test]
    fn a_floor_and_a_box_are_set_from_the_scene() {
        let text = r#"{"inkrig_storyboard": 1, "frames": [{"scene": [[[-50, 20], [50, 20]], [[0, 0], [40, 0], [40, 30], [0, 30], [1, 1]]],
            "constraints": [{"kind": "plane", "joint": "left_wrist", "scene": 0},
            {"kind": "box", "joint": "right_foot", "scene": 1, "thickness": 0.6}]}]}"#;
        let board = read_storyboard(text.as_bytes()).unwrap();
        let plan = plan();
        // A hundred units a metre; the canvas' origin is where the world's is seen.
        let view = Calibration { units: 100.0, pelvis: [0.0; 2], origin: Vec2::ZERO };
        let read = Space::of(&board.frames[0], &plan, &body(), Some(&view)).unwrap();
        let up = plan.camera.project(Vec3::Y).y;
        assert!(
            matches!(read.constraints[0].rule, Rule::Plane(20, Vec3::Y, height) if (height - 0.2 / up).abs() < 1e-5)
        );
        let Rule::Box(11, cuboid) = &read.constraints[1].rule else { panic!("{read:?}") };
        let corner = |x: f32, y: f32| cuboid.middle + cuboid.turn * (cuboid.half * Vec3::new(x, y, 0.0));
        for ((x, y), seen) in
            [((-1.0, -1.0), [0.0, 0.0]), ((1.0, -1.0), [0.4, 0.0]), ((1.0, 1.0), [0.4, 0.3])]
        {
            let place = plan.camera.project(corner(x, y));
            assert!(place.distance(Vec2::from(seen)) < 1e-5, "{place} {seen:?}");
        }
        assert!((cuboid.half.z - 0.3).abs() < 1e-6);
        let none = Space::of(&board.frames[0], &plan, &body(), None).unwrap_err();
        assert!(none.what.contains("no figure says where that is"), "{none:?}");
        let mut open = board.frames[0].clone();
        open.scene[1].points.truncate(3);
        let none = Space::of(&open, &plan, &body(), Some(&view)).unwrap_err();
        assert!(none.what.contains("does not go around anything"), "{none:?}");
    }

    #[test]
    fn what_is_said_in_space_is_understood() {
        let read = space(
            r#""edits": [{"joint": "Right Wrist", "frame": 12, "at": [0, 1, 0.5]}], "lock_ends": true,
            "constraints": [{"kind": "plane", "joint": "left_wrist", "normal": [0, 0, -2], "through": [5, 5, 0.5], "frames": [3, 9]},
            {"kind": "distance", "joints": ["left_wrist", "right_wrist"]}]"#,
        );
        let read = read.unwrap();
        assert!(read.lock_ends);
        assert_eq!(read.edits, [(12, 21, Vec3::new(0.0, 1.0, 0.5))]);
        assert_eq!(read.constraints[0], Constraint { frames: 3..10, rule: Rule::Plane(20, -Vec3::Z, -0.5) });
        let mut pose = [Vec3::ZERO; JOINTS];
        pose[20].x = 0.4;
        let measured = read.constraints[1].measured(&pose);
        assert_eq!(measured, Constraint { frames: 0..40, rule: Rule::Distance([20, 21], Some(0.4)) });
    }

    #[test]
    fn what_cannot_be_is_said() {
        let bar = |metres: &str, frames: &str| {
            format!(
                r#"{{"kind": "distance", "joints": ["left_wrist", "right_wrist"], "metres": {metres}, "frames": {frames}}}"#
            )
        };
        let floor = |height: &str| format!(r#"{{"kind": "plane", "joint": "head", "height": {height}}}"#);
        let all: [(String, &str); 8] = [
            (
                r#""edits": [{"joint": "hand", "frame": 0, "at": [0, 0, 0]}]"#.into(),
                "there is no joint \"hand\"",
            ),
            (
                r#""edits": [{"joint": "head", "frame": 40, "at": [0, 0, 0]}]"#.into(),
                "the edit of head at frame 40 is behind the clip's end: it has frames 0 to 39",
            ),
            (
                r#""lock_ends": true, "edits": [{"joint": "head", "frame": 39, "at": [0, 0, 0]}]"#.into(),
                "which lock_ends keeps",
            ),
            (
                r#""constraints": [{"kind": "balance", "frames": [0, 40]}]"#.into(),
                "a constraint (balance) ends at frame 40",
            ),
            // Two arms of four bones.
            (format!(r#""constraints": [{}]"#, bar("2.1", "[0, 9]")), "reaches 2.00 m"),
            (
                format!(r#""constraints": [{}, {}]"#, bar("1", "[0, 9]"), bar("0.5", "[9, 20]")),
                "constraints 1 and 2 contradict each other: left_wrist and right_wrist",
            ),
            (
                format!(r#""constraints": [{}, {}]"#, floor("0"), floor("0.5")),
                "head is put on two planes that are 50 cm apart",
            ),
            (
                format!(
                    r#""constraints": [{}], "edits": [{{"joint": "head", "frame": 5, "at": [0, 0.7, 0]}}]"#,
                    floor("0.5")
                ),
                "the edit of head at frame 5 is 20 cm off the plane of constraint 1",
            ),
        ];
        for (inside, part) in all {
            let said = space(inside.as_str()).unwrap_err();
            assert!(said.what.contains(part) && !said.todo.is_empty(), "{part}: {said:?}");
        }
        assert!(
            space(&format!(r#""constraints": [{}, {}]"#, bar("1", "[0, 9]"), bar("0.5", "[10, 20]"))).is_ok()
        );
    }
}
