//! From frame weights to a clip at the clip's own frame rate.

use crate::AlignError;
use inkrig_motion::channels::PoseChannels;
use inkrig_motion::{Clip, Takes, VelocityFrame, time::whole_ratio};
use inkrig_transport::Mat;
use std::ops::Range;

/// Weights below this are rounding, not motion.
const LEAST_WEIGHT: f32 = 1e-5;

/// Blends the source's poses by weights that were found at a matching rate.
///
/// `weights` is m x n, rows sum to 1: output frame i takes `weights[i][j]` of frame j of `matched`, which are the
/// source's takes at the matching rate; `cyclic` says that the last row is followed by the first. The result has the source's own frame rate and the time of m matched frames. An
/// output frame between two matched ones blends both rows, each moved to its own moment in the source, so no detail
/// of a faster clip is lost by matching at a slower rate.
///
/// # Errors
/// When the result is not a motion (cannot happen for rows that sum to 1).
pub fn blend_clip(
    source: &Takes,
    matched: &Takes,
    weights: &Mat<f32>,
    cyclic: bool,
    travel: VelocityFrame,
) -> Result<Clip, AlignError> {
    let (layout, rows) = PoseChannels::of(source, travel);
    let rate = source.clip().frame_rate();
    let matching_rate = matched.clip().frame_rate();
    // Source frames per matched frame; exact where frames were picked, so that no interpolation creeps in.
    let step = whole_ratio(rate, matching_rate).map_or(rate / matching_rate, |whole| whole as f64);
    let frames = (weights.rows() as f64 * step).round().max(1.0) as usize;
    let takes: Vec<(Range<usize>, Range<usize>)> = matched.ranges().zip(source.ranges()).collect();
    let mut out = vec![0.0_f32; frames * layout.width()];
    let mut share = vec![0.0_f32; source.clip().frames()];
    for (frame, values) in out.chunks_exact_mut(layout.width()).enumerate() {
        // After its last row a loop goes on to its first; anything else stays where it is.
        let last = (weights.rows() - 1) as f64;
        let place = (frame as f64 / step).min(if cyclic { last + 1.0 - 1e-9 } else { last });
        let row = place.floor() as usize;
        let part = place - row as f64;
        share.fill(0.0);
        spread(weights.row(row), 1.0 - part, &takes, |column| (column as f64 + part) * step, &mut share);
        if part > 0.0 {
            let next = weights.row((row + 1) % weights.rows());
            spread(next, part, &takes, |column| (column as f64 + part - 1.0) * step, &mut share);
        }
        let total: f32 = share.iter().sum();
        for (index, &weight) in share.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
            let weight = weight / total;
            for (value, &channel) in values.iter_mut().zip(rows.row(index)) {
                *value += weight * channel;
            }
        }
    }
    Ok(layout.to_clip(&out, rate)?)
}

/// Adds a row of weights to the frames of the source that stand at the moments given, in frames since the beginning
/// of the take, shared between neighbours. What would lie outside of the take falls on its first or last frame.
fn spread(
    weights: &[f32],
    factor: f64,
    takes: &[(Range<usize>, Range<usize>)],
    moment: impl Fn(usize) -> f64,
    share: &mut [f32],
) {
    for (matched, own) in takes {
        let last = own.len().saturating_sub(1);
        let part_of_row = weights[matched.clone()].iter().enumerate();
        for (column, &weight) in part_of_row.filter(|(_, weight)| **weight > LEAST_WEIGHT) {
            let place = moment(column).clamp(0.0, last as f64);
            let low = place.floor() as usize;
            let part = (place - low as f64) as f32;
            let weight = factor as f32 * weight;
            share[own.start + low] += weight * (1.0 - part);
            share[own.start + (low + 1).min(last)] += weight * part;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::swinging;

    /// Every matched frame takes just itself.
    fn through(clip: &Clip) -> Clip {
        let source = Takes::from(clip.clone());
        let matched = source.resample(30.0).unwrap();
        let frames = matched.clip().frames();
        let identity = Mat::from_fn(frames, frames, |row, column| f32::from(u8::from(row == column)));
        blend_clip(&source, &matched, &identity, false, VelocityFrame::World).unwrap()
    }

    #[test]
    fn the_identity_gives_the_clip_back_at_its_own_rate() {
        for rate in [30.0, 60.0, 59.99988, 120.0] {
            let clip = swinging(4.0, rate);
            let back = through(&clip);
            assert_eq!(back.frame_rate(), rate);
            for frame in 0..back.frames().min(clip.frames()) {
                for (a, b) in clip.rotations(frame).iter().zip(back.rotations(frame)) {
                    assert!(a.dot(*b).abs() > 1.0 - 1e-6, "rate {rate}, frame {frame}");
                }
            }
        }
    }

    #[test]
    fn a_slower_clip_comes_back_at_its_own_rate_too() {
        let clip = swinging(4.0, 24.0);
        let back = through(&clip);
        assert_eq!(back.frames(), 97);
        for frame in 0..97 {
            let turned = clip.rotations(frame)[1].angle_between(back.rotations(frame)[1]);
            assert!(turned < 0.01, "frame {frame}: {turned} radians off");
        }
    }
}
