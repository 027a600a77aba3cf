//! Stretches of time: runs of frames in which something holds, and easing around them.

/// The first and last frame of every run of `true` that is at least `shortest` frames long.
pub(crate) fn spans(holds: &[bool], shortest: usize) -> Vec<(usize, usize)> {
    let (mut spans, mut begin) = (Vec::new(), None);
    for frame in 0..=holds.len() {
        match (begin, holds.get(frame) == Some(&true)) {
            (None, true) => begin = Some(frame),
            (Some(first), false) => {
                if frame - first >= shortest {
                    spans.push((first, frame - 1));
                }
                begin = None;
            }
            _ => {}
        }
    }
    spans
}

/// A curve that is nowhere below any of the values, and slow: the most within `wide` frames around each, then the mean of that.
pub(crate) fn upper_envelope(values: &[f32], wide: usize) -> Vec<f32> {
    let around = |frame: usize| frame.saturating_sub(wide)..(frame + wide + 1).min(values.len());
    let most: Vec<f32> =
        (0..values.len()).map(|frame| values[around(frame)].iter().copied().fold(0.0, f32::max)).collect();
    let mean = |near: &[f32]| near.iter().sum::<f32>() / near.len() as f32;
    (0..values.len()).map(|frame| mean(&most[around(frame)])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_found_up_to_both_ends() {
        let holds = [true, true, false, true, false, true, true, true];
        assert_eq!(spans(&holds, 2), [(0, 1), (5, 7)]);
        assert_eq!(spans(&holds, 1).len(), 3);
        assert!(spans(&[], 1).is_empty());
    }

    #[test]
    fn an_envelope_is_never_below() {
        let values = [0.0, 0.0, 0.0, 1.0, 0.0, 0.5, 0.0, 0.0, 0.0];
        let above = upper_envelope(&values, 2);
        assert!(above.iter().zip(values).all(|(above, value)| *above >= value), "{above:?}");
        assert!(above.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.3), "{above:?}");
    }
}
