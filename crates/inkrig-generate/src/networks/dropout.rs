//! Numbers that are dropped in training.

use crate::schedule::mix;

/// A share of the numbers that come out of a block's two parts is set to zero, and the others are made so much larger that the mean
/// stays. Which they are belongs to the seed, so that the way back finds the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Dropout {
    /// From 0 to below 1.
    pub(crate) share: f32,
    pub(crate) seed: u64,
}

impl Dropout {
    /// Another stream for each block of a stack.
    pub(crate) fn of_block(self, block: usize) -> Self {
        Self { seed: mix(self.seed.wrapping_add(block as u64)), ..self }
    }

    /// In place; `part` of the block.
    pub(crate) fn apply(self, x: &mut [f32], part: u64) {
        let below = (self.share * 65_536.0) as u64;
        let kept = 1.0 / (1.0 - self.share);
        let mut state = mix(self.seed ^ part);
        for numbers in x.chunks_mut(4) {
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut bits = mix(state);
            for x in numbers {
                // Sixteen bits decide on one number.
                *x *= if bits & 0xFFFF < below { 0.0 } else { kept };
                bits >>= 16;
            }
        }
    }

    /// The gradient of what went in from that of what came out, in a buffer.
    pub(crate) fn back<'a>(self, grad: &[f32], part: u64, buffer: &'a mut Vec<f32>) -> &'a [f32] {
        buffer.clear();
        buffer.extend_from_slice(grad);
        self.apply(buffer, part);
        buffer
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_is_dropped_by_the_seed() {
        let dropout = Dropout { share: 0.25, seed: 7 };
        let dropped = |dropout: Dropout, part| {
            let mut ones = vec![1.0; 10_001];
            dropout.apply(&mut ones, part);
            ones
        };
        let one = dropped(dropout, 0);
        assert_eq!(one, dropped(dropout, 0));
        assert!(one != dropped(dropout, 1) && one != dropped(dropout.of_block(3), 0));
        let zeros = one.iter().filter(|x| **x == 0.0).count() as f64 / 10_001.0;
        let mean = one.iter().sum::<f32>() / 10_001.0;
        assert!((zeros - 0.25).abs() < 0.02 && (mean - 1.0).abs() < 0.03, "{zeros} {mean}");
    }
}
