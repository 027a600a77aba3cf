//! Time: resampling and trimming.

use crate::{Clip, MotionError, TranslationTrack};
use glam::Quat;
use std::ops::Range;

/// The clip at exactly another frame rate over the same time. When the old rate is a multiple of the new one, frames
/// are picked and nothing is interpolated; otherwise rotations are slerped along the shorter arc and translations
/// interpolated linearly. The first frame stays; the last is the last that fits.
///
/// # Errors
/// When `frame_rate` is outside [`Clip::FRAME_RATES`].
pub fn resample(clip: &Clip, frame_rate: f64) -> Result<Clip, MotionError> {
    if !Clip::FRAME_RATES.contains(&frame_rate) {
        return Err(MotionError::FrameRate(frame_rate));
    }
    let ratio = clip.frame_rate() / frame_rate;
    if ratio.round() >= 1.0 && (ratio / ratio.round() - 1.0).abs() < 1e-6 {
        let frames: Vec<usize> = (0..clip.frames()).step_by(ratio.round() as usize).collect();
        return pick(clip, &frames, frame_rate);
    }
    let places: Vec<f64> =
        (0..resampled_frames(clip, frame_rate)).map(|index| index as f64 * ratio).collect();
    sample_at(clip, &places, frame_rate)
}

/// The clip at about another frame rate, for comparing motions: as [`resample`], but where the old rate is nearly a
/// multiple of the new one (to a thousandth, as 59.94 of 30) frames are picked, and the result's rate is what that
/// gives.
///
/// # Errors
/// When `frame_rate` is outside [`Clip::FRAME_RATES`].
pub fn decimate(clip: &Clip, frame_rate: f64) -> Result<Clip, MotionError> {
    match whole_ratio(clip.frame_rate(), frame_rate) {
        Some(step) => {
            let frames: Vec<usize> = (0..clip.frames()).step_by(step).collect();
            pick(clip, &frames, clip.frame_rate() / step as f64)
        }
        None => resample(clip, frame_rate),
    }
}

/// How many frames the clip has at another frame rate, without making them.
pub fn resampled_frames(clip: &Clip, frame_rate: f64) -> usize {
    ((clip.frames() - 1) as f64 * frame_rate / clip.frame_rate() + 1e-6).floor() as usize + 1
}

/// How many frames of `rate` make one frame of `slower`, when that is a whole number to a thousandth.
pub fn whole_ratio(rate: f64, slower: f64) -> Option<usize> {
    let ratio = rate / slower;
    let whole = ratio.round();
    (whole >= 1.0 && (ratio / whole - 1.0).abs() < 1e-3).then_some(whole as usize)
}

/// The poses of `clip` at places in time given in frames (fractions allowed, clamped to the clip), played at
/// `frame_rate`.
///
/// # Errors
/// When there is no place, one is not finite, or the rate is not usable.
pub fn sample_at(clip: &Clip, places: &[f64], frame_rate: f64) -> Result<Clip, MotionError> {
    let last = clip.frames() - 1;
    let mut spots = Vec::with_capacity(places.len());
    for (frame, place) in places.iter().enumerate() {
        if !place.is_finite() {
            return Err(MotionError::NotFinite { what: "a place in time", joint: 0, frame });
        }
        let place = place.clamp(0.0, last as f64);
        let low = (place.floor() as usize).min(last);
        spots.push((low, (low + 1).min(last), (place - low as f64) as f32));
    }
    let mut rotations = Vec::with_capacity(places.len() * clip.skeleton().len());
    for &(low, high, part) in &spots {
        let pairs = clip.rotations(low).iter().zip(clip.rotations(high));
        rotations.extend(pairs.map(|(&from, &to)| slerp(from, to, part)));
    }
    let translations = (clip.translations().iter())
        .map(|track| TranslationTrack {
            joint: track.joint,
            values: spots
                .iter()
                .map(|&(low, high, part)| track.values[low].lerp(track.values[high], part))
                .collect(),
        })
        .collect();
    Clip::new(clip.skeleton().clone(), frame_rate, rotations, translations)
}

/// A part of the clip: `range` in frames, its end cut to the clip's. All of it comes back the same to the bit.
///
/// # Errors
/// When nothing of the clip lies in the range.
pub fn trim(clip: &Clip, range: Range<usize>) -> Result<Clip, MotionError> {
    let frames: Vec<usize> = (range.start..range.end.min(clip.frames())).collect();
    if frames.is_empty() {
        return Err(MotionError::EmptyRange { start: range.start, end: range.end, frames: clip.frames() });
    }
    // All of it is the same to the bit. Made anew, rotations would be brought to length 1 again, and what follows by little else.
    if frames.len() == clip.frames() { Ok(clip.clone()) } else { pick(clip, &frames, clip.frame_rate()) }
}

fn pick(clip: &Clip, frames: &[usize], frame_rate: f64) -> Result<Clip, MotionError> {
    let rotations = frames.iter().flat_map(|&frame| clip.rotations(frame).iter().copied()).collect();
    let translations = (clip.translations().iter())
        .map(|track| TranslationTrack {
            joint: track.joint,
            values: frames.iter().map(|&frame| track.values[frame]).collect(),
        })
        .collect();
    Clip::new(clip.skeleton().clone(), frame_rate, rotations, translations)
}

fn slerp(from: Quat, to: Quat, part: f32) -> Quat {
    if part == 0.0 { from } else { from.slerp(if from.dot(to) < 0.0 { -to } else { to }, part) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Joint, Skeleton};
    use glam::Vec3;
    use std::sync::Arc;

    fn turning(frames: usize, rate: f64) -> Clip {
        let skeleton = Arc::new(Skeleton::new(vec![Joint::new("root", None, Vec3::ZERO)]).unwrap());
        let rotations = (0..frames).map(|f| Quat::from_rotation_y(0.1 * f as f32)).collect();
        let values = (0..frames).map(|f| Vec3::X * f as f32).collect();
        Clip::new(skeleton, rate, rotations, vec![TranslationTrack { joint: 0, values }]).unwrap()
    }

    #[test]
    fn whole_ratios_pick_frames() {
        let clip = turning(9, 120.00048);
        let slow = decimate(&clip, 30.0).unwrap();
        assert_eq!(slow.frames(), 3);
        assert_eq!(slow.rotations(1), clip.rotations(4));
        assert!((slow.frame_rate() - 30.00012).abs() < 1e-9);
        let exact = resample(&clip, 30.0).unwrap();
        assert_eq!((exact.frame_rate(), exact.frames(), resampled_frames(&clip, 30.0)), (30.0, 2, 2));
    }

    #[test]
    fn trimmed_to_all_of_it_a_clip_is_the_same_to_the_bit() {
        let mut clip = turning(200, 30.0);
        let turned = |f: usize| Quat::from_euler(glam::EulerRot::ZXY, 0.3 * f as f32, 0.07 * f as f32, 1.1);
        let rotations = (0..200).map(turned).collect();
        clip = Clip::new(clip.skeleton().clone(), 30.0, rotations, clip.translations().to_vec()).unwrap();
        let all: Vec<usize> = (0..200).collect();
        assert_ne!(pick(&clip, &all, 30.0).unwrap(), clip, "or this shows nothing");
        assert_eq!(trim(&clip, 0..200).unwrap(), clip);
        assert_eq!(trim(&clip, 0..usize::MAX).unwrap(), clip);
        assert_eq!(trim(&clip, 3..200).unwrap().frames(), 197);
    }

    #[test]
    fn other_ratios_interpolate() {
        let clip = turning(25, 24.0);
        let fast = resample(&clip, 30.0).unwrap();
        assert_eq!(fast.frames(), 31);
        assert!((fast.track(0).unwrap()[30].x - 24.0).abs() < 1e-4);
        let expected = Quat::from_rotation_y(0.08);
        assert!(fast.rotations(1)[0].dot(expected) > 1.0 - 1e-6);
        assert!((fast.duration() - clip.duration()).abs() < 1e-9);
    }

    #[test]
    fn one_frame_stays_one_frame() {
        let clip = turning(1, 60.0);
        assert_eq!(resample(&clip, 7.0).unwrap().frames(), 1);
        assert!(matches!(trim(&clip, 1..5), Err(MotionError::EmptyRange { .. })));
        assert_eq!(trim(&clip, 0..usize::MAX).unwrap().frames(), 1);
        assert!(sample_at(&clip, &[f64::NAN], 30.0).is_err());
    }
}
