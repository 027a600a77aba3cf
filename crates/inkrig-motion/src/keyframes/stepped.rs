//! A motion whose poses are held.

use super::{Interpolation, Key, KeyedClip, RotationForm, Track};
use crate::Clip;

/// Holds every pose for `step` frames (1 or more, fractions allowed: holds are then of both neighbouring lengths). At the
/// frames `given` a hold begins with exactly that pose, in place of one that would begin less than half a step away.
/// A last key keeps the length: it repeats what is held. Rotations are quaternions.
pub fn stepped(clip: &Clip, step: f64, given: &[usize]) -> KeyedClip {
    let starts = starts(clip.frames(), step, given);
    let rate = clip.frame_rate();
    let last = clip.frames() - 1;
    let frames: Vec<(usize, usize)> = (starts.iter().map(|&start| (start, start)))
        .chain(starts.last().filter(|&&start| start < last).map(|&start| (last, start)))
        .collect();
    let joints = clip.skeleton().joints();
    let rotations = (0..joints.len()).map(|joint| {
        let mut before = glam::Quat::IDENTITY;
        let keys = frames.iter().map(|&(frame, shown)| {
            let now = clip.rotations(shown)[joint];
            before = if before.dot(now) < 0.0 { -now } else { now };
            Key { frame, value: before.to_array(), slope_in: [0.0; 4], slope_out: [0.0; 4] }
        });
        Track { joint, keys: moving(keys.collect()) }
    });
    let translations = clip.translations().iter().map(|track| {
        let keys = frames.iter().map(|&(frame, shown)| Key {
            frame,
            value: track.values[shown].to_array(),
            slope_in: [0.0; 3],
            slope_out: [0.0; 3],
        });
        Track { joint: track.joint, keys: moving(keys.collect()) }
    });
    KeyedClip {
        skeleton: clip.skeleton().clone(),
        frame_rate: rate,
        frames: clip.frames(),
        interpolation: Interpolation::Step,
        form: RotationForm::Quaternion,
        rotations: rotations.collect(),
        translations: translations.collect(),
    }
}

/// Frames at which a hold begins, the first frame first.
fn starts(frames: usize, step: f64, given: &[usize]) -> Vec<usize> {
    let step = if step.is_finite() { step.max(1.0) } else { 1.0 };
    let count = ((frames - 1) as f64 / step).floor() as usize + 1;
    let near = |start: usize| given.iter().any(|&given| (given as f64 - start as f64).abs() < 0.5 * step);
    let grid = (0..count).map(|hold| (hold as f64 * step).round() as usize);
    let mut starts: Vec<usize> = grid.filter(|&start| start == 0 || !near(start)).collect();
    starts.extend_from_slice(given);
    starts.retain(|&start| start < frames);
    starts.sort_unstable();
    starts.dedup();
    starts
}

/// One key for what never changes.
fn moving<const N: usize>(mut keys: Vec<Key<N>>) -> Vec<Key<N>> {
    if keys.windows(2).all(|pair| pair[0].value == pair[1].value) {
        keys.truncate(1);
    }
    keys
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Joint, Skeleton, TranslationTrack};
    use glam::{Quat, Vec3};
    use std::sync::Arc;

    #[test]
    fn holds_are_even_and_given_poses_begin_one() {
        assert_eq!(starts(10, 2.0, &[]), [0, 2, 4, 6, 8]);
        assert_eq!(starts(11, 2.5, &[]), [0, 3, 5, 8, 10]);
        assert_eq!(starts(10, 4.0, &[5]), [0, 5, 8]);
        assert_eq!(starts(10, 4.0, &[6, 99]), [0, 4, 6, 8]);
        assert_eq!(starts(1, 5.0, &[]), [0]);
        assert_eq!(starts(4, f64::NAN, &[]), [0, 1, 2, 3]);
    }

    #[test]
    fn a_held_motion_has_the_poses_of_its_keys() {
        let skeleton = Arc::new(
            Skeleton::new(vec![Joint::new("root", None, Vec3::ZERO), Joint::new("arm", Some(0), Vec3::Y)])
                .unwrap(),
        );
        let turn = |frame: usize| Quat::from_rotation_x(0.1 * frame as f32);
        let rotations = (0..6).flat_map(|frame| [turn(frame), Quat::IDENTITY]).collect();
        let values = (0..6).map(|frame| Vec3::X * frame as f32).collect();
        let clip = Clip::new(skeleton, 24.0, rotations, vec![TranslationTrack { joint: 0, values }]).unwrap();
        let keyed = stepped(&clip, 2.0, &[]);
        let held = keyed.clip().unwrap();
        let xs: Vec<f32> = held.track(0).unwrap().iter().map(|value| value.x).collect();
        assert_eq!(xs, [0.0, 0.0, 2.0, 2.0, 4.0, 4.0]);
        assert!((0..6).all(|frame| held.rotations(frame)[0] == clip.rotations(frame / 2 * 2)[0]));
        // Frames 0, 2, 4 and the last, of a rotation and a translation; the arm never turns.
        let count = keyed.count();
        assert_eq!((count.channels, count.keys, count.dense), (2, 8, 12));
    }
}
