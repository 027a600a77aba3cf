//! What a frame says of its motion in space: joints that were moved by hand, and what holds between joints and the world.

use crate::error::Problem;
use crate::exact::{Constraint, Cuboid, Rule};
use crate::joints::joint_named;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{JOINTS, Joints, NAMES, PARENTS};
use inkrig_sketch::storyboard::{self, Frame};
use std::ops::Range;

/// Planes and edits that are nearer to each other than this agree, metres.
const AGREE: f32 = 0.01;

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
    /// Of a frame whose clip has so many frames, for a body with these bones.
    pub(crate) fn of(frame: &Frame, frames: usize, body: &Joints) -> Result<Self, Problem> {
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
            constraints.push(rule(constraint, frames, body)?);
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

fn rule(said: &storyboard::Constraint, frames: usize, body: &Joints) -> Result<Constraint, Problem> {
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
            let through = through.as_ref().map_or(Vec3::Y * height.unwrap_or(0.0) as f32, vector);
            Rule::Plane(joint_named(joint)?, normal, normal.dot(through))
        }
        storyboard::Constraint::Box { joint, from, to, .. } => {
            Rule::Box(joint_named(joint)?, Cuboid::between(vector(from), vector(to)))
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
mod tests {
    use super::*;
    use inkrig_sketch::storyboard::read_storyboard;

    fn body() -> Joints {
        let mut body = [Vec3::Y * 0.25; JOINTS];
        body[0] = Vec3::ZERO;
        body
    }

    fn space(inside: &str) -> Result<Space, Problem> {
        let text = format!("{{\"inkrig_storyboard\": 1, \"frames\": [{{{inside}}}]}}");
        let board = read_storyboard(text.as_bytes()).unwrap();
        Space::of(&board.frames[0], 40, &body())
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
