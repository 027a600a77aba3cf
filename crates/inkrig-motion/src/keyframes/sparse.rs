//! A motion as few keys with tangents.

use super::block::{numbers, thin};
use super::body::Allowed;
use super::fit::Knot;
use super::reference::{Reference, references};
use super::{Interpolation, Key, KeyedClip, RotationForm, Track};
use crate::Clip;

/// How near few keys keep to a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct SparseOptions {
    /// How far any joint or end site may be from its place in the world, metres.
    pub metres: f64,
    /// How far any rotation, local to its parent, may be off, radians.
    pub radians: f64,
    /// Frames at which every channel that changes gets a key with exactly the clip's pose; others are not looked at.
    pub given: Vec<usize>,
    /// The numbers that get curves.
    pub form: RotationForm,
}

impl Default for SparseOptions {
    /// A millimetre and half a degree, quaternions.
    fn default() -> Self {
        Self {
            metres: 1e-3,
            radians: 0.5_f64.to_radians(),
            given: Vec::new(),
            form: RotationForm::Quaternion,
        }
    }
}

/// Frames that are looked at together; all channels have a key where two parts meet.
const PART: usize = 1024;

/// What rounding to the numbers of a [`Key`] may add to an error, as a part of it.
const ROUNDING: f64 = 0.005;

/// Fits few keys on whole frames to a clip, with cubic splines between them.
///
/// Both tolerances hold on every frame. Places count in the world: what all joints above add up to. Half way between two
/// frames the curve is nowhere more than two and a half times as far from the straight way between them, or from the spline of one key a
/// frame whose slopes (Catmull-Rom) do not swing beyond a frame's neighbours. The first and the last frame are exact. Keys
/// have one slope on both sides where the tolerance allows it.
///
/// From the roots on, each channel gets the fewest keys that serve, and of those the ones that leave the smallest errors
/// (shortest path over the frames; the slopes of a piece by reweighted least squares). What it leaves undone at the joints
/// below is given to them as their aim, so that errors do not add up along a chain. Then keys are taken out, or one put in
/// place of two, wherever values and slopes of the keys around can be found with which the whole body stays where it should
/// be: a key need not stand on the motion, only near it.
pub fn sparse(clip: &Clip, options: &SparseOptions) -> KeyedClip {
    let references = references(clip);
    let mut given = options.given.clone();
    given.sort_unstable();
    let allowed = Allowed {
        metres: (1.0 - ROUNDING) * options.metres.max(1e-9),
        radians: (1.0 - ROUNDING) * options.radians.max(1e-9),
    };
    let last = clip.frames() - 1;
    let parts = last.div_ceil(PART).max(1);
    let cuts: Vec<usize> = (0..=parts).map(|part| part * last / parts).collect();
    let mut knots: Vec<Vec<Knot>> = vec![Vec::new(); references.len()];
    for cut in cuts.windows(2) {
        let &[first, last] = cut else { continue };
        let part = thin(clip.skeleton(), &references, (first, last), (&given, options.form), allowed, &knots);
        for (all, part) in knots.iter_mut().zip(part) {
            // The first of a part is the last of the one before.
            if let (Some(last), Some(first)) = (all.last_mut(), part.first()) {
                last.slope_out = first.slope_out;
            }
            all.extend(part.into_iter().skip(usize::from(!all.is_empty())));
        }
    }
    let pairs = || references.iter().zip(&knots);
    let rate = clip.frame_rate();
    KeyedClip {
        skeleton: clip.skeleton().clone(),
        frame_rate: rate,
        frames: clip.frames(),
        interpolation: Interpolation::Spline,
        form: options.form,
        rotations: pairs()
            .filter(|(r, _)| r.turns)
            .map(|(r, knots)| track(r, knots, rate, options.form))
            .collect(),
        translations: pairs()
            .filter(|(r, _)| !r.turns)
            .map(|(r, knots)| track(r, knots, rate, options.form))
            .collect(),
    }
}

fn track<const N: usize>(reference: &Reference, knots: &[Knot], rate: f64, form: RotationForm) -> Track<N> {
    let short = |numbers: &[f64; 4], factor: f64| std::array::from_fn(|i| (numbers[i] * factor) as f32);
    let key = |knot: &Knot| Key {
        frame: knot.frame,
        value: short(&knot.value, 1.0),
        slope_in: short(&knot.slope_in, rate),
        slope_out: short(&knot.slope_out, rate),
    };
    let mut keys: Vec<Key<N>> = knots.iter().map(key).collect();
    if keys.is_empty() {
        let still = reference.samples.first().copied().unwrap_or_default();
        let still = if reference.turns { numbers(form, &still, [0.0; 4]) } else { still };
        keys.push(Key { frame: 0, value: short(&still, 1.0), slope_in: [0.0; N], slope_out: [0.0; N] });
    }
    Track { joint: reference.joint, keys }
}

#[cfg(test)]
mod tests {
    use super::super::deviation;
    use super::*;
    use crate::{Joint, Skeleton, TranslationTrack};
    use glam::{Quat, Vec3};
    use std::sync::Arc;

    /// A travelling arm of two bones; the angles of its two joints at a frame.
    fn arm(frames: usize, angles: impl Fn(usize) -> (f32, f32)) -> Clip {
        let skeleton = Arc::new(
            Skeleton::new(vec![
                Joint::new("shoulder", None, Vec3::ZERO),
                Joint::new("elbow", Some(0), Vec3::X * 0.4),
                Joint::end("elbow_end", 1, Vec3::X * 0.4),
            ])
            .unwrap(),
        );
        let rotations = (0..frames).flat_map(|frame| {
            let (a, b) = angles(frame);
            [Quat::from_rotation_z(a), Quat::from_rotation_y(b), Quat::IDENTITY]
        });
        let values = (0..frames).map(|frame| Vec3::Z * 0.01 * frame as f32).collect();
        let track = TranslationTrack { joint: 0, values };
        Clip::new(skeleton, 60.0, rotations.collect(), vec![track]).unwrap()
    }

    fn swinging(frames: usize) -> Clip {
        arm(frames, |frame| ((frame as f32 * 0.1).sin(), 0.7 * (frame as f32 * 0.23).cos()))
    }

    fn holds(clip: &Clip, keyed: &KeyedClip) {
        let apart = deviation(clip, &keyed.clip().unwrap()).unwrap();
        assert!(apart.metres <= 1e-3 && apart.radians <= 0.5_f64.to_radians(), "{apart:?}");
    }

    #[test]
    fn a_smooth_motion_takes_few_keys_and_a_straight_one_two() {
        let clip = swinging(240);
        let keyed = sparse(&clip, &SparseOptions::default());
        holds(&clip, &keyed);
        let [shoulder, elbow, end] = keyed.rotations.as_slice() else { panic!() };
        assert!((4..30).contains(&shoulder.keys.len()), "{}", shoulder.keys.len());
        assert!((4..45).contains(&elbow.keys.len()), "{}", elbow.keys.len());
        assert_eq!((end.keys.len(), keyed.count().channels), (1, 3));
        let travel = &keyed.translations[0].keys;
        assert_eq!((travel[0].frame, travel.last().unwrap().frame), (0, 239));
        assert!(travel.len() <= 3, "{travel:?}");
    }

    #[test]
    fn less_tolerance_takes_more_keys() {
        let clip = swinging(240);
        let keys = |metres| sparse(&clip, &SparseOptions { metres, ..SparseOptions::default() }).count().keys;
        assert!(keys(1e-4) > keys(1e-3) && keys(1e-3) > keys(1e-2));
    }

    #[test]
    fn given_frames_are_keys_and_exact() {
        let clip = swinging(200);
        let given = vec![120, 37, 5000];
        let keyed =
            sparse(&clip, &SparseOptions { given, metres: 0.05, radians: 0.2, ..SparseOptions::default() });
        let written = keyed.clip().unwrap();
        for frame in [0, 37, 120, 199] {
            for track in keyed.rotations.iter().filter(|track| track.keys.len() > 1) {
                assert!(track.keys.iter().any(|key| key.frame == frame), "{frame}");
            }
            for (a, b) in clip.rotations(frame).iter().zip(written.rotations(frame)) {
                assert!((*a - *b).length().min((*a + *b).length()) < 3e-7, "{frame}: {a} {b}");
            }
            assert_eq!(clip.track(0).unwrap()[frame], written.track(0).unwrap()[frame]);
        }
    }

    /// Angles about the axes of a file with z up, past the upright and through whole turns.
    #[test]
    fn angles_do_as_well_as_quaternions() {
        let clip = arm(2 * PART, |frame| (frame as f32 * 0.05, 2.0 * (frame as f32 * 0.03).sin()));
        let axes = Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
        let form = RotationForm::Angles { axes };
        let keyed = sparse(&clip, &SparseOptions { form, ..SparseOptions::default() });
        holds(&clip, &keyed);
        // As far as it turned between two keys, and never back by a whole turn.
        for pair in keyed.rotations[0].keys.windows(2) {
            let turned = (pair[1].value[1] - pair[0].value[1]).abs();
            let own = 0.05 * (pair[1].frame - pair[0].frame) as f32;
            assert!((turned - own).abs() < 0.1, "{turned} in place of {own}");
        }
        let turned = keyed.rotations[0].keys.last().unwrap().value;
        assert!((turned[1].abs() - 0.05 * 2047.0).abs() < 0.1, "{turned:?}");
        assert!(5 * keyed.count().keys < keyed.count().dense, "{:?}", keyed.count());
    }

    /// Still, a jump within one frame, still: between frames the elbow stays near the straight way.
    #[test]
    fn a_jump_does_not_swing_over() {
        let clip = arm(60, |frame| (if frame < 30 { 0.0 } else { 1.0 }, 0.0));
        let keyed = sparse(&clip, &SparseOptions::default());
        holds(&clip, &keyed);
        let fine = keyed.sampled(8).unwrap();
        for sample in 0..fine.frames() {
            let angle = 2.0 * fine.rotations(sample)[0].z.atan2(fine.rotations(sample)[0].w);
            // Two and a half times half a degree.
            assert!((-0.0219..=1.0219).contains(&angle), "{sample}: {angle}");
        }
    }

    #[test]
    fn long_motions_are_whole_where_their_parts_meet() {
        let clip = swinging(2 * PART + 100);
        let keyed = sparse(&clip, &SparseOptions::default());
        holds(&clip, &keyed);
        for track in &keyed.rotations {
            assert!(track.keys.windows(2).all(|pair| pair[0].frame < pair[1].frame));
        }
        assert!(10 * keyed.count().keys < 2 * keyed.count().dense);
    }

    #[test]
    fn the_shortest_clips_stay_what_they_are() {
        for frames in 1..5 {
            let clip = swinging(frames);
            let keyed = sparse(&clip, &SparseOptions::default());
            holds(&clip, &keyed);
            assert_eq!(keyed.frames, frames);
        }
    }
}
