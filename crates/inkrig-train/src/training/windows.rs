//! Pieces of the corpus, normalised, for training.

use super::motions::{self, Selection};
use crate::TrainError;
use crate::corpus::{Manifest, Split};
use inkrig_generate::schedule::Noise;
use inkrig_motion::humanml::{Statistics, WIDTH};

/// The clips of a split in memory, normalised.
#[derive(Debug, Clone)]
pub struct Windows {
    clips: Vec<Vec<f32>>,
    /// Sums of the clips' weights up to each: where a random number falls, that clip is taken.
    upto: Vec<f64>,
}

/// Clips x frames x 263 numbers, padded with zeros.
#[derive(Debug, Clone, PartialEq)]
pub struct Batch {
    /// The numbers.
    pub features: Vec<f32>,
    /// How many frames of each clip are there.
    pub lengths: Vec<usize>,
    /// Frames of the table.
    pub frames: usize,
}

impl Windows {
    /// Reads a split.
    ///
    /// # Errors
    /// When a part cannot be read, or the split is empty.
    pub fn read(
        manifest: &Manifest,
        split: Split,
        statistics: &Statistics,
        selection: Selection,
    ) -> Result<Self, TrainError> {
        let motions = motions::read(manifest, split, statistics, selection)?;
        let mut sum = 0.0;
        let weights = motions.iter().map(|motion| motion.frames() as f64 * motion.weight);
        let upto = weights.map(|weight| {
            sum += weight;
            sum
        });
        let upto = upto.collect();
        Ok(Self { clips: motions.into_iter().map(|motion| motion.rows).collect(), upto })
    }

    /// How many clips there are, copies included.
    pub fn clips(&self) -> usize {
        self.clips.len()
    }

    /// Frames of all clips.
    pub fn frames(&self) -> usize {
        self.clips.iter().map(|clip| clip.len() / WIDTH).sum()
    }

    /// `count` windows of at most `frames` frames, drawn by the clips' weights.
    pub fn draw(&self, count: usize, frames: usize, noise: &mut Noise) -> Batch {
        let mut batch =
            Batch { features: vec![0.0; count * frames * WIDTH], lengths: Vec::with_capacity(count), frames };
        let total = self.upto.last().copied().unwrap_or(0.0);
        for rows in batch.features.chunks_exact_mut(frames * WIDTH) {
            let place = noise.uniform() * total;
            let clip = self.upto.partition_point(|&upto| upto <= place).min(self.clips.len() - 1);
            let own = &self.clips[clip];
            let length = own.len() / WIDTH;
            let free = length.saturating_sub(frames);
            let first = (noise.uniform() * (free + 1) as f64) as usize;
            let taken = length.min(frames);
            rows[..taken * WIDTH].copy_from_slice(&own[first * WIDTH..][..taken * WIDTH]);
            batch.lengths.push(taken);
        }
        batch
    }

    /// Windows of exactly `frames` frames side by side, at most `most`, spread evenly over all clips.
    pub fn spread(&self, frames: usize, most: usize) -> Vec<&[f32]> {
        let all: Vec<&[f32]> = self.clips.iter().flat_map(|clip| clip.chunks_exact(frames * WIDTH)).collect();
        let step = all.len().div_ceil(most.max(1)).max(1);
        all.into_iter().step_by(step).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn windows(lengths: &[usize], weights: &[f64]) -> Windows {
        let clip = |(index, &length): (usize, &usize)| -> Vec<f32> {
            (0..length * WIDTH).map(|i| (index * 1000 + i / WIDTH) as f32).collect()
        };
        let upto = weights.iter().scan(0.0, |sum, weight| {
            *sum += weight;
            Some(*sum)
        });
        Windows { clips: lengths.iter().enumerate().map(clip).collect(), upto: upto.collect() }
    }

    #[test]
    fn windows_lie_within_clips_and_are_drawn_by_weight() {
        let windows = windows(&[100, 10, 50], &[1.0, 0.0, 3.0]);
        let batch = windows.draw(400, 40, &mut Noise::new(1));
        let clips: Vec<usize> =
            batch.features.chunks_exact(40 * WIDTH).map(|rows| rows[0] as usize / 1000).collect();
        let share = clips.iter().filter(|&&clip| clip == 2).count() as f64 / 400.0;
        assert!((share - 0.75).abs() < 0.08, "{share}");
        assert!(!clips.contains(&1), "a clip without weight");
        for (rows, &length) in batch.features.chunks_exact(40 * WIDTH).zip(&batch.lengths) {
            assert_eq!(length, 40);
            let frame = |at: usize| rows[at * WIDTH];
            assert!((1..40).all(|at| frame(at) == frame(at - 1) + 1.0), "consecutive frames of one clip");
        }
        assert_eq!(batch, windows.draw(400, 40, &mut Noise::new(1)));
        let long = windows.draw(50, 80, &mut Noise::new(2));
        for (rows, &length) in long.features.chunks_exact(80 * WIDTH).zip(&long.lengths) {
            assert!(length == 80 || length == 50);
            assert!(rows[length * WIDTH..].iter().all(|number| *number == 0.0));
        }
    }

    #[test]
    fn windows_to_measure_on_are_spread() {
        let windows = windows(&[100, 10, 50], &[1.0, 1.0, 1.0]);
        assert_eq!(windows.spread(40, 100).len(), 3);
        assert_eq!(windows.spread(10, 8).len(), 8);
        assert_eq!((windows.clips(), windows.frames()), (3, 160));
    }
}
