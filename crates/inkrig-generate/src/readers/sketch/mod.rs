//! The joints of a drawn figure, by a network that was shown many rendered ones.

mod decode;
mod limbs;
mod plan;

pub use decode::{Reading, decode};
pub use plan::{CELLS, MARGIN, Outputs, SIDE, plan};

use super::ink::Ink;
use super::network::{Network, Work};
use crate::GenerateError;
use crate::weights::Tensors;

/// Key points of a drawn figure.
pub const KEY_POINTS: usize = 18;

/// A joint that is less sure than this is to be pointed out: about half of such lie within a tenth of the torso of where they are.
pub const UNSURE: f32 = 0.6;

/// Which of the 22 joints they are, in order: those that a drawing has, see [`inkrig_motion::humanml::augment`].
pub const JOINT_OF_KEY_POINT: [usize; KEY_POINTS] =
    [0, 1, 2, 3, 4, 5, 7, 8, 10, 11, 12, 13, 14, 15, 18, 19, 20, 21];

/// The key point on the other side of the body.
pub const MIRRORED: [usize; KEY_POINTS] = [0, 2, 1, 3, 5, 4, 7, 6, 9, 8, 10, 12, 11, 13, 15, 14, 17, 16];

/// Reads figures.
#[derive(Debug, Clone)]
pub struct SketchReader {
    network: Network,
    outputs: Outputs,
}

impl SketchReader {
    /// Takes the weights that [`plan`] names.
    ///
    /// # Errors
    /// When one is missing or has another shape.
    pub fn new(tensors: &Tensors) -> Result<Self, GenerateError> {
        let (plan, outputs) = plan();
        Ok(Self { network: Network::from_tensors(plan, tensors)?, outputs })
    }

    /// Takes a network of [`plan`] as it is.
    pub fn of(network: Network, outputs: Outputs) -> Self {
        Self { network, outputs }
    }

    /// Reads a crop of [`SIDE`] x [`SIDE`] pixels with one figure; places come back in its pixels. The crop and its mirror image are
    /// looked at, and what speaks for a place is the mean of both.
    pub fn read(&self, crop: &Ink, work: &mut Work) -> Reading {
        self.network.forward(&crop.pixels, work);
        let mut heat = work.value(self.outputs.heat).to_vec();
        let mut presence = work.value(self.outputs.presence).to_vec();
        let turned: Vec<f32> = crop.pixels.chunks(SIDE).flat_map(|row| row.iter().rev().copied()).collect();
        self.network.forward(&turned, work);
        let other = work.value(self.outputs.heat);
        let rows = heat.chunks_exact_mut(CELLS * KEY_POINTS).zip(other.chunks_exact(CELLS * KEY_POINTS));
        for (row, other) in rows {
            let cells = row.chunks_exact_mut(KEY_POINTS).zip(other.chunks_exact(KEY_POINTS).rev());
            cells.for_each(|(own, other)| add_mirrored(own, other));
        }
        add_mirrored(&mut presence, work.value(self.outputs.presence));
        decode(&heat, &presence, crop)
    }
}

/// The mean with what a mirror image says of the other side.
fn add_mirrored(own: &mut [f32], other: &[f32]) {
    for (number, mirrored) in own.iter_mut().zip(MIRRORED) {
        *number = 0.5 * (*number + other.get(mirrored).copied().unwrap_or(*number));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::Noise;

    #[test]
    fn a_mirrored_drawing_is_read_as_the_mirrored_figure() {
        let (plan, outputs) = plan();
        let row = plan.random(2);
        let reader = SketchReader::of(Network::new(plan, &row).unwrap(), outputs);
        let mut noise = Noise::new(3);
        let mut ink = Ink::new(SIDE, SIDE);
        ink.pixels.iter_mut().for_each(|pixel| *pixel = (noise.uniform() as f32).powi(4));
        let mut mirror = ink.clone();
        mirror.pixels.chunks_exact_mut(SIDE).for_each(<[f32]>::reverse);
        let mut work = Work::default();
        let own = reader.read(&ink, &mut work);
        let other = reader.read(&mirror, &mut work).mirrored();
        for point in 0..KEY_POINTS {
            let ([x, y], [a, b]) = (own.places[point], other.places[point]);
            assert!(
                (x - (SIDE as f32 - a)).abs() < 1e-2 && (y - b).abs() < 1e-2,
                "{point}: {x} {y}, {a} {b}"
            );
            assert!((own.drawn[point] - other.drawn[point]).abs() < 1e-5);
        }
        // `mirrored` swaps sides, so what spoke for them speaks against the swap.
        assert!((own.arms + other.arms).abs() < 1e-3 && (own.legs + other.legs).abs() < 1e-3);
        assert!(own.arms != 0.0 && own.legs != 0.0);
    }
}
