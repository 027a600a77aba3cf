//! The four-legged animal, a large hound: stands, walks, trots, gallops along a curve, slows down, stops and bows.
//!
//! Speed and heading come first; the gait says when feet stand, the path says where. Height and bend of the trunk
//! follow the gait's cycle, and the legs reach from the trunk to the feet.

mod hound;
mod paws;
mod settle;
mod swing;
mod trail;

use super::{
    ease::{Keys, gaussian, lag, window},
    figure::{FRAME_RATE, Pose, Rig, ahead, left_of, turn},
    gait::Gait,
};
use hound::{HIP_HEIGHT, SHOULDER_HEIGHT, TRUNK};
use inkrig_motion::{Clip, MotionError, glam::DVec3};
use paws::{Paths, Paw, Plant};
use std::f64::consts::TAU;

/// Length of the clip, seconds.
const LENGTH: f64 = 15.0;
/// The play bow at the end: down and up again, seconds.
const BOW: (f64, f64) = (12.3, 14.4);

/// The motion, 15 seconds.
///
/// # Errors
/// Never in practice: when a computed number is not finite.
pub fn clip() -> Result<Clip, MotionError> {
    let rig = hound::rig();
    let mut trunk = Trunk::new();
    trunk.settle(&rig);
    let poses: Vec<Pose<'_>> = (0..trunk.frames()).map(|frame| trunk.pose(&rig, frame)).collect();
    // The first pose, standing, becomes the rest pose.
    rig.clip_from(&poses)
}

/// Everything that varies over time, one value a frame.
struct Trunk {
    times: Vec<f64>,
    /// Where and when the legs stand, and from this and the trunk the paws of all frames.
    plants: [Vec<Plant>; 4],
    paws: [Vec<Paw>; 4],
    hips: Vec<DVec3>,
    /// Heading of the hips, of the chest, and of the head, which looks ahead of the curve; radians.
    headings: [Vec<f64>; 3],
    /// Pitch of the line from hips to shoulders, radians, nose down counts up.
    pitch: Vec<f64>,
    /// Bend of the back, radians: rounded counts up.
    flex: Vec<f64>,
    roll: Vec<f64>,
    /// Rise of the shoulders against their mean, metres.
    bounce: Vec<f64>,
    /// Nod of the neck, radians, down counts up.
    neck: Vec<f64>,
    /// How far into the bow, 0..=1.
    bow: Vec<f64>,
    /// Side to side and up and down of the tail's root, radians.
    wag: Vec<f64>,
    lift: Vec<f64>,
}

fn gait() -> Gait {
    Gait::new(
        LENGTH,
        &[
            (0.6, 0.0),
            (1.15, 0.3),
            (2.1, 0.9),
            (3.0, 0.95),
            (3.8, 2.1),
            (5.3, 2.4),
            (6.3, 4.7),
            (7.6, 5.1),
            (8.7, 4.3),
            (9.4, 2.5),
            (10.4, 2.0),
            (11.0, 0.9),
            (11.9, 0.0),
        ],
        &[(2.8, 0.0), (3.6, 1.0), (5.2, 1.0), (6.2, 2.0), (8.3, 2.0), (9.5, 1.0), (10.4, 1.0), (11.0, 0.0)],
        &[(0.55, 0.0), (0.85, 1.0), (11.55, 1.0), (11.95, 0.0)],
    )
}

impl Trunk {
    fn new() -> Self {
        let gait = gait();
        // A first turn to the left, then a wide curve that the gallop leans into, then back.
        let turning = Keys::new(&[
            (0.8, 0.0),
            (1.8, 0.35),
            (2.8, 0.0),
            (4.2, -0.1),
            (5.6, 0.25),
            (7.0, 0.5),
            (8.6, 0.6),
            (10.2, 0.3),
            (10.9, -0.35),
            (11.8, 0.0),
        ]);
        let paths = Paths::new(&gait, &turning, LENGTH);
        let times: Vec<f64> =
            (0..=(LENGTH * FRAME_RATE) as usize).map(|frame| frame as f64 / FRAME_RATE).collect();
        let series =
            |value: &dyn Fn(f64) -> f64| -> Vec<f64> { times.iter().map(|&time| value(time)).collect() };
        let bow = series(&|time| window(time, BOW.0, BOW.1, 0.75, 0.8));
        let speed = series(&|time| gait.speed(time));
        let (sink, pitching) =
            (series(&|time| heights(&gait, time).0), series(&|time| heights(&gait, time).1));
        let flex = series(&|time| bend(&gait, time));
        let turn_rate = series(&|time| turning.at(time) * (gait.speed(time) / 0.6).min(1.0));
        let mut hips = Vec::new();
        let mut pitch = Vec::new();
        let mut rise = Vec::new();
        for (frame, &time) in times.iter().enumerate() {
            let low = 0.06 * (speed[frame] / 2.4).min(1.0);
            let hind = HIP_HEIGHT - 0.7 * low + sink[frame] - 0.02 * bow[frame];
            let fore = SHOULDER_HEIGHT - low + pitching[frame] - 0.28 * bow[frame];
            let heading = paths.heading(time, -0.5 * TRUNK);
            let sway =
                left_of(heading) * 0.012 * gait.weights(time)[0] * (TAU * (gait.cycle(time) - 0.1)).sin();
            let back = ahead(heading) * (0.1 * bow[frame]);
            hips.push(paths.place(time, -0.5 * TRUNK) + sway - back + DVec3::Y * hind);
            pitch.push(((hind - HIP_HEIGHT - fore + SHOULDER_HEIGHT) / TRUNK).clamp(-1.0, 1.0).asin());
            rise.push(fore - SHOULDER_HEIGHT + low + 0.28 * bow[frame]);
        }
        let roll: Vec<f64> = (0..times.len())
            .map(|frame| {
                let walking = gait.weights(times[frame])[0];
                let cycle = gait.cycle(times[frame]);
                -0.045 * speed[frame] * turn_rate[frame] + 0.03 * walking * (TAU * (cycle - 0.35)).sin()
            })
            .collect();
        let nodding = series(&|time| {
            let [walk, trot, gallop] = gait.weights(time);
            let cycle = gait.cycle(time);
            // The head goes down as a fore leg takes the weight.
            0.07 * walk * (2.0 * TAU * (cycle - 0.5)).cos()
                + 0.03 * trot * (2.0 * TAU * (cycle - 0.3)).cos()
                + gallop * (0.3 + 0.12 * (TAU * (cycle - 0.6)).cos())
        });
        let standing = series(&|time| 1.0 - gait.weights(time).iter().sum::<f64>());
        let neck = (0..times.len())
            .map(|frame| nodding[frame] + 0.07 * speed[frame].min(2.4) - 0.06 * standing[frame])
            .collect();
        let wag = series(&|time| {
            let happy = window(time, BOW.0 - 0.2, LENGTH + 2.0, 0.6, 0.1);
            0.22 * (TAU * gait.cycle(time)).sin() * gait.weights(time)[0]
                + 0.1 * (TAU * gait.cycle(time)).sin() * gait.weights(time)[1]
                + 0.5 * happy * (TAU * 2.3 * time).sin()
                + 0.06 * (TAU * 0.4 * time).sin()
        });
        let lift =
            (0..times.len()).map(|i| 0.16 * speed[i].min(5.0) + 0.75 * bow[i] + 0.8 * pitch[i]).collect();
        let looking =
            |ahead: f64| lag(&series(&|time| paths.heading(time, 0.5 * TRUNK)), -ahead * FRAME_RATE);
        let glance = Keys::new(&[
            (0.0, 0.0),
            (0.15, 0.0),
            (0.5, 0.28),
            (1.1, 0.0),
            (11.7, 0.0),
            (12.2, -0.3),
            (12.8, 0.0),
            (14.2, 0.0),
            (14.7, 0.3),
        ]);
        let seen = gaussian(&looking(0.3), 5.0);
        Self {
            plants: [0, 1, 2, 3].map(|leg| paws::plants(&gait, &paths, leg)),
            paws: Default::default(),
            headings: [
                series(&|time| paths.heading(time, -0.5 * TRUNK)),
                series(&|time| paths.heading(time, 0.5 * TRUNK)),
                seen.iter().zip(&times).map(|(seen, &time)| seen + glance.at(time)).collect(),
            ],
            hips,
            pitch: gaussian(&pitch, 0.8),
            flex: flex.iter().zip(&bow).map(|(flex, bow)| flex - 0.25 * bow).collect(),
            roll: gaussian(&roll, 3.0),
            bounce: rise,
            neck,
            bow,
            wag,
            lift,
            times,
        }
    }

    fn frames(&self) -> usize {
        self.hips.len()
    }

    fn pose<'a>(&self, rig: &'a Rig, frame: usize) -> Pose<'a> {
        let mut pose = self.body(rig, frame);
        self.trail(&mut pose, frame);
        for leg in 0..4 {
            hound::leg(&mut pose, leg, &self.paws[leg][frame], self.bow[frame]);
        }
        pose
    }

    /// The pose of trunk, neck and head.
    fn body<'a>(&self, rig: &'a Rig, frame: usize) -> Pose<'a> {
        let mut pose = rig.rest();
        pose.root = self.hips[frame];
        let [hips, chest, head] = [0, 1, 2].map(|part: usize| self.headings[part][frame]);
        let (pitch, flex, roll) = (self.pitch[frame], self.flex[frame], self.roll[frame]);
        let rear = turn(hips, pitch - 0.5 * flex, roll);
        let front = turn(chest, pitch + 0.5 * flex, roll * 0.9);
        let nod = self.neck[frame] - 0.55 * self.bow[frame];
        let skull =
            turn(head, 0.35 * nod + 0.12 + 0.4 * self.bounce[frame] - 0.1 * self.bow[frame], roll * 0.3);
        // The neck evens out what the chest does, so that the eyes stay level.
        let neck = turn(0.6 * chest + 0.4 * head, nod + 0.25 * pitch, roll * 0.6);
        let turns = [
            ("Hips", rear),
            ("Spine", rear.slerp(front, 0.33)),
            ("Spine1", rear.slerp(front, 0.67)),
            ("Chest", front),
            ("Neck", neck),
            ("Neck1", neck.slerp(skull, 0.5)),
            ("Head", skull),
        ];
        for (name, rotation) in turns {
            if let Some(joint) = rig.find(name) {
                pose.set_world(joint, rotation);
            }
        }
        pose
    }
}

/// Rise of the hips and of the shoulders over their mean by the gait's cycle, metres.
fn heights(gait: &Gait, time: f64) -> (f64, f64) {
    let [walk, trot, gallop] = gait.weights(time);
    let cycle = gait.cycle(time);
    let half_duty = 0.5 * gait.duty(time);
    let wave = |per_cycle: f64, lowest: f64| -(TAU * per_cycle * (cycle - lowest)).cos();
    let both = 0.011 * trot * wave(2.0, half_duty);
    // In a gallop the hind legs carry first, then the fore legs: the trunk rocks.
    let hind = 0.008 * walk * wave(2.0, 0.0) + both + 0.036 * gallop * wave(1.0, 0.19);
    let fore = 0.01 * walk * wave(2.0, 0.2) + both + 0.036 * gallop * wave(1.0, 0.6);
    (hind, fore)
}

/// Bend of the back: rounded when the gallop gathers all legs below the body, hollow when it stretches.
fn bend(gait: &Gait, time: f64) -> f64 {
    let [_, _, gallop] = gait.weights(time);
    0.12 + gallop * 0.34 * (TAU * (gait.cycle(time) - 0.93)).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standing_paws_do_not_slide() {
        let rig = hound::rig();
        let mut trunk = Trunk::new();
        trunk.settle(&rig);
        let poses: Vec<Pose<'_>> = (0..trunk.frames()).map(|frame| trunk.pose(&rig, frame)).collect();
        let (mut standing, mut worst) = (0, 0.0_f64);
        for (leg, name) in ["LeftToe", "RightToe", "LeftFingers", "RightFingers"].into_iter().enumerate() {
            let joint = rig.find(name).unwrap();
            for frame in 1..poses.len() {
                if !(trunk.paws[leg][frame - 1].stands && trunk.paws[leg][frame].stands) {
                    continue;
                }
                standing += 1;
                let moved = poses[frame].world(joint).0.distance(poses[frame - 1].world(joint).0);
                worst = worst.max(moved * FRAME_RATE);
                // One centimetre a second.
                assert!(moved * FRAME_RATE < 0.01, "{name}, frame {frame}: {:.4} m/s", moved * FRAME_RATE);
            }
        }
        println!("a standing paw slides by at most {worst:.1e} m/s");
        assert!(standing > trunk.frames(), "{standing}");
    }
}
