//! Ways over the ground that a frame takes over from what was made of an earlier one: it goes on as the frame before it ends, or goes an
//! earlier way again. A generated path is a condition of the next motion, as in figure 13 of the paper.

use crate::error::Problem;
use crate::exact::{Goal, Source};
use crate::ground::height;
use crate::plan::{Plan, seen};
use inkrig_generate::guidance::Ask;
use inkrig_motion::glam::{Quat, Vec2, Vec3};
use inkrig_motion::humanml::{Camera, Joints};
use inkrig_sketch::storyboard::FramePath;
use inkrig_sketch::{Ends, smooth};

/// The sway of a body over its feet is no part of its path: it is smoothed over so many frames, as a standard deviation.
const SWAY: f64 = 5.0;
/// Frames at the end of a motion that say how fast it goes on, and where to.
const LAST: usize = 16;
/// And how much it turns.
const TURNING: usize = 30;
/// What goes less far than this from frame to frame stands, metres.
const STILL: f32 = 0.01;
/// The sharpest turns that are gone on with: radians a frame, about a quarter round in a second, and the radius of a circle, metres.
const SHARPEST: f32 = 0.08;
const NARROWEST: f32 = 1.0;

impl Plan {
    /// The frame that its path is taken from, from 1, where there is one. `number`: its own, from 1.
    pub fn path_of(&self, number: usize) -> Option<usize> {
        match self.follows? {
            FramePath::Continue => number.checked_sub(1),
            FramePath::Of(frame) => Some(frame as usize),
        }
    }

    /// The same with the path that it takes over from a motion: of the frame that [`path_of`](Self::path_of) names, in that clip's
    /// own space.
    pub fn along(&self, motion: &[Joints]) -> Self {
        let path = match self.follows {
            Some(FramePath::Continue) => gone_on(motion, self.frames),
            Some(FramePath::Of(_)) => again(motion, self.frames),
            None => return self.clone(),
        };
        let drawn = self.keypose.as_ref().and_then(|(key, joints)| {
            Some((*key, joints.iter().find(|(joint, ..)| *joint == 0).map(|(_, at, _)| *at)?))
        });
        let high = match drawn {
            Some((_, at)) => height(&self.camera, at),
            None => motion.iter().map(|pose| pose[0].y).sum::<f32>() / motion.len().max(1) as f32,
        };
        let path: Vec<Vec3> = path.into_iter().map(|at| Vec3::new(at.x, high, at.y)).collect();
        // A figure at the end of its way stands where the path ends.
        let mut plan = match drawn.and_then(|(key, at)| Some((at, path.get(key)?))).filter(|_| !self.placed) {
            Some((at, place)) => Plan { placed: true, ..self.moved(seen(&self.camera, *place) - at) },
            None => self.clone(),
        };
        // Lines of limbs were drawn beside a figure that stays: they go with the body.
        let camera = plan.camera;
        let place = |frame: usize| path.get(frame).map_or(Vec2::ZERO, |at| seen(&camera, *at));
        let from = place(plan.key_frame());
        for (_, first, places) in &mut plan.ways {
            places.iter_mut().enumerate().for_each(|(at, own)| *own += place(*first + at) - from);
        }
        Plan { path: Some(path), ..plan }
    }

    /// Where in the world its path has the pelvis.
    pub(crate) fn on_path(&self) -> Vec<Ask> {
        let places = self.path.iter().flatten().enumerate();
        places.map(|(frame, place)| Ask { frame, joint: 0, place: *place }).collect()
    }

    /// How far each place of its path is from where a motion has it, over the ground, metres.
    pub(crate) fn off_path(&self, motion: &[Joints]) -> Vec<Vec2> {
        let pairs = self.path.iter().flatten().zip(motion);
        pairs.map(|(place, pose)| flat(pose[0] - *place)).collect()
    }
}

/// A goal for every place of a path, in the motion that its clip was turned and shifted into. How high the pelvis is does not count.
pub(crate) fn goals(plan: &Plan, start: usize, (turn, shift): (Quat, Vec3)) -> impl Iterator<Item = Goal> {
    plan.path.iter().flatten().enumerate().map(move |(frame, place)| Goal {
        frame: start + frame,
        joint: 0,
        axes: [Vec3::X, Vec3::Z],
        at: flat(turn * *place + shift),
        away: None,
        source: Source::Path,
    })
}

/// Looks straight down, so that only what lies over the ground counts.
pub(crate) fn from_above() -> Camera {
    Camera::new(std::f32::consts::FRAC_PI_2, 0.0)
}

/// Whether frame `number` can have the path that it asks for.
pub(crate) fn check(path: Option<FramePath>, number: usize, own: bool) -> Result<(), Problem> {
    let Some(path) = path else { return Ok(()) };
    if own {
        return Err(Problem::new(
            "its pelvis has a trajectory, and it takes over another frame's path: it cannot go both ways",
            "Leave out \"path\", or the trajectory",
        ));
    }
    match path {
        FramePath::Continue if number < 2 => Err(Problem::new(
            "it is to go on along the path of the frame before, but it is the first",
            "Leave out \"path\", draw a trajectory of the pelvis, or move the frame behind another",
        )),
        FramePath::Of(frame) if frame as usize >= number => Err(Problem::new(
            format!("it is to go the way of frame {frame}, which is not made before it"),
            if number < 2 {
                "Leave out \"path\", or move the frame behind that one".to_owned()
            } else {
                format!("Name a frame from 1 to {}, or say \"path\": \"continue\"", number - 1)
            },
        )),
        _ => Ok(()),
    }
}

/// The angle about the vertical that +z is turned to, by hips and shoulders.
pub(crate) fn facing(pose: &Joints) -> f32 {
    let across = (pose[1] - pose[2]).normalize_or_zero() + (pose[16] - pose[17]).normalize_or_zero();
    (-across.z).atan2(across.x)
}

fn flat(place: Vec3) -> Vec2 {
    Vec2::new(place.x, place.z)
}

/// The pelvis over the ground without sway.
fn steady(motion: &[Joints]) -> Vec<Vec2> {
    let plain: Vec<[f64; 2]> =
        motion.iter().map(|pose| [f64::from(pose[0].x), f64::from(pose[0].z)]).collect();
    let soft = smooth(&plain, SWAY, Ends::Open).unwrap_or(plain);
    soft.iter().map(|[x, z]| Vec2::new(*x as f32, *z as f32)).collect()
}

/// How a path goes on at its end: metres a frame, the angle that +z is turned to, and its change a frame.
fn leaving(path: &[Vec2]) -> (f32, f32, f32) {
    let last = &path[path.len().saturating_sub(LAST)..];
    let velocity = slope(last);
    if velocity.length() < STILL {
        return (0.0, 0.0, 0.0);
    }
    let wide = &path[path.len().saturating_sub(TURNING)..];
    let (first, second) = wide.split_at(wide.len() / 2);
    let turned = slope(first).angle_to(slope(second));
    let turn = if turned.is_finite() { -turned / second.len().max(1) as f32 } else { 0.0 };
    let most = SHARPEST.min(velocity.length() / NARROWEST);
    let turn = turn.clamp(-most, most);
    let middle = 0.5 * last.len() as f32;
    (velocity.length(), velocity.x.atan2(velocity.y) + turn * middle, turn)
}

/// The mean step of places, by least squares.
fn slope(places: &[Vec2]) -> Vec2 {
    let middle = 0.5 * (places.len().max(1) - 1) as f32;
    let (sum, squares) =
        places.iter().enumerate().fold((Vec2::ZERO, 0.0_f32), |(sum, squares), (at, place)| {
            let t = at as f32 - middle;
            (sum + t * *place, squares + t * t)
        });
    sum / squares.max(f32::MIN_POSITIVE)
}

/// Goes on from a place, so many frames with that one.
fn onward(mut at: Vec2, (speed, mut angle, turn): (f32, f32, f32), frames: usize) -> Vec<Vec2> {
    (0..frames)
        .map(|_| {
            let here = at;
            angle += turn;
            at += speed * Vec2::new(angle.sin(), angle.cos());
            here
        })
        .collect()
}

/// As a motion ends, seen from where it ends.
fn gone_on(motion: &[Joints], frames: usize) -> Vec<Vec2> {
    let (speed, angle, turn) = leaving(&steady(motion));
    let heading = motion.last().map_or(0.0, facing);
    onward(Vec2::ZERO, (speed, angle - heading, turn), frames)
}

/// As a motion goes, and on from there where it is shorter.
fn again(motion: &[Joints], frames: usize) -> Vec<Vec2> {
    let path = steady(motion);
    let (Some(first), Some(last)) = (path.first().copied(), path.last().copied()) else {
        return vec![Vec2::ZERO; frames];
    };
    let more = (frames + 1).saturating_sub(path.len());
    let own = path.iter().copied().take(frames);
    own.chain(onward(last, leaving(&path), more).into_iter().skip(1)).map(|at| at - first).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A figure that goes round by so much a frame, swaying.
    fn motion(frames: usize, speed: f32, turn: f32, sway: f32) -> Vec<Joints> {
        let pose: Joints = std::array::from_fn(|joint| match joint {
            1 | 16 => Vec3::new(0.2, 1.0, 0.0),
            2 | 17 => Vec3::new(-0.2, 1.0, 0.0),
            _ => Vec3::Y,
        });
        let mut at = Vec3::ZERO;
        (0..frames)
            .map(|frame| {
                let heading = Quat::from_rotation_y(turn * frame as f32);
                let aside = Vec3::X * sway * (frame as f32 * std::f32::consts::TAU / 21.0).sin();
                let here = pose.map(|joint| heading * (joint + aside) + at);
                at += heading * (speed * Vec3::Z);
                here
            })
            .collect()
    }

    #[test]
    fn what_goes_on_goes_as_fast_and_turns_as_much() {
        let wrap = |angle: f32| angle.sin().atan2(angle.cos());
        for (speed, turn, sway) in
            [(0.06, 0.0, 0.0), (0.06, 0.02, 0.0), (0.12, -0.04, 0.0), (0.06, 0.01, 0.02)]
        {
            let path = gone_on(&motion(60, speed, turn, sway), 40);
            let steps: Vec<Vec2> = path.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let angle = |step: Vec2| step.x.atan2(step.y);
            let turned = wrap(angle(steps[38]) - angle(steps[0])) / 38.0;
            let slack = 0.002 + 0.3 * sway;
            assert_eq!((path.len(), path[0]), (40, Vec2::ZERO));
            assert!(steps.iter().all(|step| (step.length() / speed - 1.0).abs() < 0.06), "{speed} {turn}");
            assert!((turned - turn).abs() < slack, "{turned} is not {turn}");
            assert!(angle(steps[0]).abs() < 0.03 + 8.0 * sway, "it begins ahead: {}", angle(steps[0]));
        }
        assert!(gone_on(&motion(60, 0.002, 0.0, 0.02), 40).iter().all(|at| *at == Vec2::ZERO), "it stands");
        for short in 0..4 {
            assert!(gone_on(&motion(short, 0.1, 0.0, 0.0), 9).iter().all(|at| at.is_finite()));
            assert!(again(&motion(short, 0.1, 0.0, 0.0), 9).iter().all(|at| at.is_finite()));
        }
    }

    #[test]
    fn a_way_again_is_that_way_and_goes_on_where_it_is_short() {
        let round = motion(60, 0.06, 0.02, 0.0);
        for frames in [20, 60, 90] {
            let path = again(&round, frames);
            assert_eq!((path.len(), path[0]), (frames, Vec2::ZERO));
            let longer = motion(frames.max(60), 0.06, 0.02, 0.0);
            for (at, (own, pose)) in path.iter().zip(&longer).enumerate() {
                assert!(own.distance(flat(pose[0])) < 0.05, "{frames}, {at}: {own} {}", pose[0]);
            }
        }
    }

    #[test]
    fn only_earlier_frames_lead() {
        let said = |path, number, own| check(Some(path), number, own).unwrap_err();
        assert!(check(None, 1, true).is_ok());
        assert!(check(Some(FramePath::Continue), 2, false).is_ok());
        assert!(check(Some(FramePath::Of(1)), 3, false).is_ok());
        assert!(said(FramePath::Continue, 1, false).what.contains("it is the first"));
        assert!(said(FramePath::Of(3), 3, false).todo.contains("from 1 to 2"));
        assert!(said(FramePath::Of(1), 1, false).todo.contains("behind that one"));
        assert!(said(FramePath::Continue, 2, true).what.contains("cannot go both ways"));
    }
}
