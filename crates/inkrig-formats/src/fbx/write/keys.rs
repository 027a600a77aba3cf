//! Few keys of a clip as keys of the format.

use super::curve::{Key, Shape};
use crate::FormatError;
use inkrig_motion::keyframes::{self, Interpolation, KeyedClip, Track};

/// Linear keys of x, y and z, one a frame.
pub(super) type Dense = [Vec<Key>; 3];

/// Few keys in the place of one a frame, where the joint has such. `numbers`: what a value or a slope is in the file.
pub(super) fn thinned<const N: usize>(
    dense: Dense,
    keyed: Option<&KeyedClip>,
    tracks: impl Fn(&KeyedClip) -> &[Track<N>],
    joint: usize,
    numbers: impl Fn([f32; N]) -> Result<[f64; 3], FormatError>,
) -> Result<Dense, FormatError> {
    let track = keyed.and_then(|keyed| {
        let track = tracks(keyed).iter().find(|track| track.joint == joint)?;
        (track.keys.len() > 1).then_some((keyed.interpolation, track))
    });
    match track {
        None => Ok(dense),
        Some((Interpolation::Step, track)) => Ok(held(&dense, &track.keys)),
        Some((Interpolation::Spline, track)) => curves(&dense, &track.keys, numbers),
    }
}

/// Values of the dense keys at the frames of the few.
fn held<const N: usize>(dense: &Dense, few: &[keyframes::Key<N>]) -> Dense {
    dense.each_ref().map(|dense| {
        let kept = few.iter().filter_map(|key| dense.get(key.frame));
        kept.map(|key| Key { shape: Shape::Stepped, ..*key }).collect()
    })
}

fn curves<const N: usize>(
    dense: &Dense,
    few: &[keyframes::Key<N>],
    numbers: impl Fn([f32; N]) -> Result<[f64; 3], FormatError>,
) -> Result<Dense, FormatError> {
    let mut all = [Vec::new(), Vec::new(), Vec::new()];
    for (index, key) in few.iter().enumerate() {
        let (values, slopes) = (numbers(key.value)?, numbers(key.slope_out)?);
        let next = numbers(few.get(index + 1).map_or([0.0; N], |next| next.slope_in))?;
        for (axis, out) in all.iter_mut().enumerate() {
            let tick = dense.get(axis).and_then(|dense| dense.get(key.frame)).map(|dense| dense.tick);
            let parts = (values.get(axis), slopes.get(axis), next.get(axis));
            if let (Some(tick), (Some(&value), Some(&slope), Some(&next_slope))) = (tick, parts) {
                out.push(Key { tick, value, shape: Shape::Cubic { slope, next_slope } });
            }
        }
    }
    Ok(all)
}
