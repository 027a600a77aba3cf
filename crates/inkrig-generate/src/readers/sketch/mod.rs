//! The joints of a drawn figure, by a network that was shown many rendered ones.

mod decode;
mod plan;

pub use decode::{Reading, decode};
pub use plan::{CELLS, MARGIN, Outputs, SIDE, plan};

use super::ink::Ink;
use super::network::{Network, Work};
use crate::GenerateError;
use crate::weights::Tensors;

/// Key points of a drawn figure.
pub const KEY_POINTS: usize = 18;

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

    /// Reads a crop of [`SIDE`] x [`SIDE`] pixels with one figure; places come back in its pixels.
    pub fn read(&self, crop: &Ink, work: &mut Work) -> Reading {
        self.network.forward(&crop.pixels, work);
        decode(work.value(self.outputs.heat), work.value(self.outputs.presence))
    }
}
