//! The same motion faster or slower.

use inkrig_generate::schedule::Noise;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{Joints, bone_lengths, features, recover_positions, uniform};
use inkrig_motion::{Features, MotionError};

/// The highest speed, and the inverse of the lowest. Chosen, not searched for: a fall that is much faster or slower is none.
const MOST: f64 = 1.3;

/// A speed, evenly drawn on the scale on which twice is as far as half.
pub(super) fn speed(noise: &mut Noise) -> f64 {
    MOST.powf(2.0 * noise.uniform() - 1.0)
}

/// A clip at so many times its speed, a frame shorter than that alone would make it. `None` where less than a frame would be left.
pub(super) fn retimed(table: &Features, speed: f64) -> Result<Option<Features>, MotionError> {
    let poses = recover_positions(table)?;
    let Some(first) = poses.first() else { return Ok(None) };
    let count = ((poses.len() - 1) as f64 / speed) as usize + 1;
    if count < 2 {
        return Ok(None);
    }
    let moved: Vec<Joints> = (0..count).map(|frame| between(&poses, frame as f64 * speed)).collect();
    features(&uniform(&moved, &bone_lengths(first))).map(Some)
}

/// The pose at a moment, frames from the first: Catmull-Rom curves through the joints' places, which go on evenly beyond the ends. Bones
/// become a little shorter.
fn between(poses: &[Joints], moment: f64) -> Joints {
    let before = (moment as usize).min(poses.len().saturating_sub(2));
    let part = (moment - before as f64) as f32;
    let pose = |frame: usize| poses.get(frame);
    std::array::from_fn(|joint| {
        let (from, to) = (poses[before][joint], poses[before + 1][joint]);
        let earlier = before.checked_sub(1).and_then(pose).map_or(2.0 * from - to, |pose| pose[joint]);
        let later = pose(before + 2).map_or(2.0 * to - from, |pose| pose[joint]);
        curve([earlier, from, to, later], part)
    })
}

fn curve([a, b, c, d]: [Vec3; 4], part: f32) -> Vec3 {
    let (leaves, arrives) = ((c - a) * 0.5, (d - b) * 0.5);
    Vec3::from_array(std::array::from_fn(|axis| {
        let (from, to) = (b[axis], c[axis]);
        let bow = 2.0 * (from - to) + leaves[axis] + arrives[axis];
        let rest = to - from - leaves[axis] - bow;
        from + part * (leaves[axis] + part * (rest + part * bow))
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_motion::humanml::{Blocks, ground};

    /// Somebody with arms down who walks on at a metre a second and lifts a hand ever faster.
    fn walk(frames: usize) -> Features {
        let pose = |frame: usize| -> Joints {
            let time = frame as f32 / 20.0;
            std::array::from_fn(|joint| {
                let (side, high) = (joint as f32 % 3.0 - 1.0, 1.6 - 0.07 * joint as f32);
                let lifted = if joint == 20 { 0.2 * time * time } else { 0.0 };
                Vec3::new(0.1 * side + 0.01 * joint as f32, high + lifted, time)
            })
        };
        features(&ground(&(0..frames).map(pose).collect::<Vec<_>>())).unwrap()
    }

    #[test]
    fn at_its_own_speed_a_clip_stays_as_it_is() {
        let table = walk(30);
        let same = retimed(&table, 1.0).unwrap().unwrap();
        assert_eq!(same.frames() + 1, table.frames());
        let places = Blocks::PLACES;
        for row in 0..same.frames() {
            let pairs = same.row(row)[places.clone()].iter().zip(&table.row(row)[places.clone()]);
            // The hand's bone is as long as in the first frame.
            let other = pairs.enumerate().filter(|(at, _)| at / 3 + 1 != 20);
            assert!(other.map(|(_, (a, b))| (a - b).abs()).fold(0.0, f32::max) < 1e-4, "{row}");
        }
    }

    #[test]
    fn faster_is_shorter_and_goes_as_far() {
        let table = walk(41);
        let travelled = |table: &Features| -> f32 {
            (0..table.frames()).map(|row| table.row(row)[Blocks::TRAVEL.start + 1]).sum()
        };
        for (times, rows) in [(1.25, 31), (0.8, 48)] {
            let other = retimed(&table, times).unwrap().unwrap();
            assert_eq!(other.frames(), rows);
            for row in 0..rows {
                let step = other.row(row)[Blocks::TRAVEL.start + 1].abs();
                assert!((step - 0.05 * times as f32).abs() < 1e-4, "{times}: {row} goes {step}");
            }
            assert!((travelled(&other) - travelled(&table)).abs() < 0.1);
        }
        assert!(retimed(&walk(3), 1.3).unwrap().is_none());
    }

    #[test]
    fn curves_pass_through_and_do_not_bend_what_is_even() {
        let parabola = |x: f32| Vec3::new(x, x * x, 3.0);
        let points = [0.0, 1.0, 2.0, 3.0].map(parabola);
        assert_eq!(curve(points, 0.0), points[1]);
        assert!(curve(points, 1.0).distance(points[2]) < 1e-6);
        assert!(curve(points, 0.4).distance(parabola(1.4)) < 1e-6);
        let mut noise = Noise::new(3);
        assert!((0..200).map(|_| speed(&mut noise)).all(|speed| (1.0 / MOST..MOST).contains(&speed)));
    }
}
