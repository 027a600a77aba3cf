//! A rough drawing of a clip: a figure in somebody's style, lines of a hand that trembles, the word.

use inkrig_generate::readers::ink::Mark;
use inkrig_generate::schedule::Noise;
use inkrig_motion::glam::Vec2;
use inkrig_motion::humanml::{Camera, FRAME_RATE, Joints};
use inkrig_sketch::storyboard::{Frame, FrameCamera, Stroke, Trajectory};
use inkrig_train::evaluation::EvaluationWindow;
use inkrig_train::figures::{Family, Proportions, Style, draw, seen};

/// Joints whose ways people draw: pelvis, toes, head, wrists.
const DRAWN: [usize; 6] = [0, 10, 11, 15, 20, 21];
/// Canvas units a metre.
const UNITS: f32 = 100.0;
/// Styles whose lines are strokes.
const FAMILIES: [Family; 4] = [Family::Stick, Family::Pencil, Family::Marker, Family::Gesture];
/// How far a joint has to go on the picture to be worth a line, metres.
const FAR: f32 = 0.25;
/// How far a line strays slowly from the joint's way, and from point to point, metres.
const STRAYS: f32 = 0.01;
const TREMBLES: f32 = 0.002;

/// A drawing, and what it was drawn of.
pub(super) struct Drawing {
    pub(super) frame: Frame,
    pub(super) camera: Camera,
    /// Whose ways the trajectories are.
    pub(super) joints: Vec<usize>,
}

/// Draws the first or the last pose of a clip, and the ways of one or two joints from it or to it.
pub(super) fn draw_window(window: &EvaluationWindow, seed: u64) -> Drawing {
    let mut noise = Noise::new(seed ^ 0x626f_6172_6473);
    let between = |noise: &mut Noise, low: f64, high: f64| low + (high - low) * noise.uniform();
    let (pitch, yaw) = (between(&mut noise, 15.0, 30.0), between(&mut noise, 30.0, 45.0));
    let camera = Camera::new(pitch.to_radians() as f32, yaw.to_radians() as f32);
    let family = FAMILIES[(noise.uniform() * 4.0) as usize % FAMILIES.len()];
    let ends = noise.uniform() < 0.5;
    let two = noise.uniform() < 0.5;
    // The size of a figure says how far its lines go: proportions are a person's.
    let style = Style { proportions: Proportions::default(), ..Style::random(family, &mut noise) };
    let key = if ends { window.joints.len().saturating_sub(1) } else { 0 };
    let mut frame = Frame {
        word: window.actions.first().cloned().unwrap_or_default(),
        camera: FrameCamera { pitch_degrees: pitch, yaw_degrees: yaw },
        ..Frame::default()
    };
    if let Some(pose) = window.joints.get(key) {
        let origin = camera.project(pose[0]);
        let drawn = draw(&seen(pose, &camera, 0.0), &style, &mut noise);
        let lines = drawn.marks.iter().filter_map(|mark| match mark {
            Mark::Stroke { points, .. } if points.len() > 1 => Some(points),
            _ => None,
        });
        frame.body = lines
            .map(|line| {
                Stroke::new(line.iter().map(|[x, y, _]| canvas(origin + Vec2::new(*x, *y))).collect())
            })
            .collect();
    }
    let mut far: Vec<(f32, usize)> = DRAWN
        .into_iter()
        .map(|joint| (length(&window.joints, joint, &camera), joint))
        .filter(|(length, _)| *length > FAR)
        .collect();
    far.sort_by(|a, b| b.0.total_cmp(&a.0));
    let joints: Vec<usize> = far.into_iter().map(|(_, joint)| joint).take(if two { 2 } else { 1 }).collect();
    for joint in &joints {
        frame.trajectories.push(Trajectory {
            points: way(&window.joints, *joint, &camera, &mut noise),
            ..Trajectory::default()
        });
    }
    Drawing { frame, camera, joints }
}

fn canvas(at: Vec2) -> [f64; 2] {
    [f64::from(UNITS * at.x), f64::from(UNITS * at.y)]
}

fn length(motion: &[Joints], joint: usize, camera: &Camera) -> f32 {
    let step = |pair: &[Joints]| match pair {
        [a, b] => camera.project(a[joint]).distance(camera.project(b[joint])),
        _ => 0.0,
    };
    motion.windows(2).map(step).sum()
}

/// A joint's way as a hand draws it, with the pen's time.
fn way(motion: &[Joints], joint: usize, camera: &Camera, noise: &mut Noise) -> Stroke {
    let mut waves = || {
        let (speed, begin) = (0.1 + 0.3 * noise.uniform() as f32, 6.0 * noise.uniform() as f32);
        move |at: usize| STRAYS * (speed * at as f32 + begin).sin()
    };
    let (across, up) = (waves(), waves());
    let points = motion.iter().enumerate().map(|(at, pose)| {
        let tremor = TREMBLES * Vec2::new(noise.normal(), noise.normal());
        canvas(camera.project(pose[joint]) + Vec2::new(across(at), up(at)) + tremor)
    });
    let points: Vec<[f64; 2]> = points.collect();
    // As many frames as the clip has.
    let (count, last) = (points.len() as f64, points.len().saturating_sub(1).max(1) as f64);
    let seconds = (0..points.len()).map(|at| at as f64 / last * count / FRAME_RATE).collect();
    Stroke { points, seconds: Some(seconds), pressure: None }
}
