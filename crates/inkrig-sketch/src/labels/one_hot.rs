//! Labels as numbers: a 1 in the column of the frame's label, 0 elsewhere.

use super::Labels;
use crate::SketchError;
use crate::limits::MAX_FRAMES;
use crate::table::MAX_CONTROL_VALUES;
use crate::wave::MAX_RATE;

/// One-hot labels: frames x names.
#[derive(Debug, Clone, PartialEq)]
pub struct OneHot {
    /// What each column stands for, in order of first appearance; at least two.
    pub names: Vec<String>,
    /// 1 where the frame has the column's label, 0 elsewhere: frames x names. Each row sums to 1.
    pub values: Vec<f32>,
}

impl OneHot {
    /// Number of rows.
    pub fn frame_count(&self) -> usize {
        self.values.len().checked_div(self.names.len()).unwrap_or(0)
    }
}

impl Labels {
    /// The label of each frame as one-hot rows, at a rate in frames a second.
    ///
    /// Without `frames` the row has its own length. With it the row is stretched, each segment in proportion; borders go
    /// to the nearest frame, so a segment may vanish, but never a label.
    ///
    /// # Errors
    /// - [`SketchError::Rate`]: the rate is not above 0, or above [`MAX_RATE`].
    /// - [`SketchError::FrameCount`]: no frame, or more than [`MAX_FRAMES`].
    /// - [`SketchError::TooManyValues`]: frames times names is above [`MAX_CONTROL_VALUES`].
    /// - [`SketchError::LabelLost`]: a label has no frame left.
    pub fn to_one_hot(&self, rate: f64, frames: Option<usize>) -> Result<OneHot, SketchError> {
        if !(rate > 0.0 && rate <= MAX_RATE) {
            return Err(SketchError::Rate { rate });
        }
        let frames = frames.unwrap_or_else(|| self.frame_count(rate));
        if frames == 0 || frames > MAX_FRAMES {
            return Err(SketchError::FrameCount { frames });
        }
        let width = self.names.len();
        if frames * width > MAX_CONTROL_VALUES {
            return Err(SketchError::TooManyValues { what: "row of labels" });
        }
        let mut values = vec![0.0; frames * width];
        let mut rows = values.chunks_exact_mut(width.max(1));
        let mut lost = vec![true; width];
        let (total, mut passed, mut frame) = (self.length(rate), 0.0, 0);
        for (index, &(label, length)) in self.segments.iter().enumerate() {
            passed += length.in_frames(rate);
            let is_last = index + 1 == self.segments.len();
            let end = if is_last { frames } else { border(passed / total, frames) };
            for row in rows.by_ref().take(end.saturating_sub(frame)) {
                if let (Some(cell), Some(lost)) = (row.get_mut(label), lost.get_mut(label)) {
                    (*cell, *lost) = (1.0, false);
                }
            }
            frame = frame.max(end);
        }
        match self.names.iter().zip(lost).find(|(_, lost)| *lost) {
            Some((name, _)) => Err(SketchError::LabelLost { name: name.clone(), frames }),
            None => Ok(OneHot { names: self.names.clone(), values }),
        }
    }
}

/// The frame nearest to a part of all.
fn border(part: f64, frames: usize) -> usize {
    ((part * frames as f64).round() as usize).min(frames)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(text: &str, rate: f64, frames: Option<usize>) -> Result<String, SketchError> {
        let control = text.parse::<Labels>().unwrap().to_one_hot(rate, frames)?;
        let name = |cells: &[f32]| control.names[cells.iter().position(|&cell| cell == 1.0).unwrap()].clone();
        Ok(control.values.chunks(control.names.len()).map(name).collect())
    }

    #[test]
    fn frames_and_seconds_become_rows() {
        assert_eq!(row("A:3 B:2 A:1", 30.0, None).unwrap(), "AAABBA");
        assert_eq!(row("A:0.5s B:1s", 4.0, None).unwrap(), "AABBBB");
        assert_eq!(row("A:1 B:0.5s", 4.0, None).unwrap(), "ABB");
        assert_eq!(
            row("A:0.3s B:0.3s", 2.0, None),
            Err(SketchError::LabelLost { name: "B".into(), frames: 1 })
        );
    }

    #[test]
    fn stretching_keeps_proportions() {
        assert_eq!(row("A:3 B:2 A:1", 30.0, Some(12)).unwrap(), "AAAAAABBBBAA");
        assert_eq!(row("A:30 B:20 A:10", 30.0, Some(6)).unwrap(), "AAABBA");
        assert_eq!(row("A:10 B:1 A:10 B:10", 30.0, Some(4)).unwrap(), "AAAB", "a short segment may vanish");
        assert_eq!(
            row("A:10 B:1", 30.0, Some(4)),
            Err(SketchError::LabelLost { name: "B".into(), frames: 4 })
        );
    }

    #[test]
    fn sizes_have_limits() {
        let labels: Labels = "A:1000000 B:1".parse().unwrap();
        assert_eq!(labels.to_one_hot(30.0, None), Err(SketchError::FrameCount { frames: MAX_FRAMES + 1 }));
        assert_eq!(labels.to_one_hot(30.0, Some(0)), Err(SketchError::FrameCount { frames: 0 }));
        assert_eq!(
            labels.to_one_hot(30.0, Some(usize::MAX)),
            Err(SketchError::FrameCount { frames: usize::MAX })
        );
        for rate in [0.0, -1.0, f64::INFINITY] {
            assert_eq!(labels.to_one_hot(rate, None), Err(SketchError::Rate { rate }));
        }
        assert!(labels.to_one_hot(f64::NAN, None).is_err());
        let many: String = (0..100).map(|i| format!("{i}:10000 ")).collect();
        let many: Labels = many.parse().unwrap();
        assert_eq!(many.to_one_hot(30.0, None), Err(SketchError::TooManyValues { what: "row of labels" }));
        assert_eq!(many.to_one_hot(30.0, Some(160_000)).unwrap().values.len(), MAX_CONTROL_VALUES);
    }
}
