//! Which frames of a batch are there.

use crate::networks::waves;
use burn::tensor::{Device, Tensor, TensorData};

/// What a padded place is given before a softmax: so little that it gets nothing.
const NEVER: f32 = -1e9;

/// Lengths of the clips of a batch, whose tables are as long as the longest.
#[derive(Debug, Clone)]
pub struct FrameMask {
    lengths: Vec<usize>,
    frames: usize,
}

impl FrameMask {
    /// Of clips with these lengths, in tables of `frames` rows. A longer length counts as `frames`.
    pub fn new(lengths: &[usize], frames: usize) -> Self {
        Self { lengths: lengths.iter().map(|&length| length.min(frames)).collect(), frames }
    }

    /// Clips of the batch.
    pub fn clips(&self) -> usize {
        self.lengths.len()
    }

    /// Rows of the tables.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Frames that are there, of all clips.
    pub fn count(&self) -> usize {
        self.lengths.iter().sum()
    }

    /// Clips x frames x 1: one where a frame is there, else zero. `None` when all are.
    pub fn keep(&self, device: &Device) -> Option<Tensor<3>> {
        self.table(0, [1.0, 0.0], device).map(|table| table.reshape([self.clips(), self.frames, 1]))
    }

    /// Clips x 1 x 1 x (`tokens` + frames): what is added to attention's scores, `tokens` being there always.
    pub(crate) fn bias(&self, tokens: usize, device: &Device) -> Option<Tensor<4>> {
        let width = tokens + self.frames;
        self.table(tokens, [0.0, NEVER], device).map(|table| table.reshape([self.clips(), 1, 1, width]))
    }

    /// Clips x frames x `cosines`: cosines over each clip's own time, 0 behind its end.
    pub(crate) fn waves(&self, cosines: usize, device: &Device) -> Tensor<3> {
        let mut numbers = Vec::with_capacity(self.clips() * self.frames * cosines);
        for (clip, &length) in self.lengths.iter().enumerate() {
            numbers.extend(waves(length, cosines));
            numbers.resize((clip + 1) * self.frames * cosines, 0.0);
        }
        Tensor::from_data(TensorData::new(numbers, [self.clips(), self.frames, cosines]), device)
    }

    /// Clips x 1 x `cosines`: what the sums of a clip times its waves are to be multiplied by to be amplitudes.
    pub(crate) fn amplitudes(&self, cosines: usize, device: &Device) -> Tensor<3> {
        let of_clip = |&length: &usize| {
            let each = 1.0 / length.max(1) as f32;
            (0..cosines).map(move |at| if at == 0 { each } else { 2.0 * each })
        };
        let numbers: Vec<f32> = self.lengths.iter().flat_map(of_clip).collect();
        Tensor::from_data(TensorData::new(numbers, [self.clips(), 1, cosines]), device)
    }

    fn table(&self, tokens: usize, [there, padded]: [f32; 2], device: &Device) -> Option<Tensor<1>> {
        if self.lengths.iter().all(|&length| length == self.frames) {
            return None;
        }
        let rows = self.lengths.iter().flat_map(|&length| {
            let real = std::iter::repeat_n(there, tokens + length);
            real.chain(std::iter::repeat_n(padded, self.frames - length))
        });
        let numbers: Vec<f32> = rows.collect();
        let count = numbers.len();
        Some(Tensor::from_data(TensorData::new(numbers, [count]), device))
    }
}
