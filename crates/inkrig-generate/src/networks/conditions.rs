//! Encoders of conditions: each makes one vector of a trajectory or a key pose.

use super::Sizes;
use super::block::Layout;
use super::linear::Linear;
use super::names::POSE;
use super::stack::{Ending, Stack, StackTape};
use super::tokens::{check_length, positions};
use crate::GenerateError;
use crate::numeric::elementwise::add;
use crate::weights::Tensors;

/// Whether conditions are in space or on the picture plane. Both have 66 numbers a frame; on the plane every third is a
/// constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Domain {
    /// Places in space.
    Space,
    /// Places on the picture, as the camera sees them.
    Plane,
}

/// A network that makes one vector of some frames of 66 numbers: 22 joints, normalised, zero where nothing is asked.
#[derive(Debug, Clone)]
pub struct ConditionEncoder {
    pub(super) width: usize,
    pub(super) token: Vec<f32>,
    pub(super) embed: Linear,
    pub(super) positions: Vec<f32>,
    pub(super) stack: Stack,
    /// Where the gradients of token and positional table begin in the row of all.
    pub(super) places: (usize, usize),
}

impl ConditionEncoder {
    /// The trajectory encoder `traj_encoder.*` or `traj_encoder_2d.*`.
    ///
    /// # Errors
    /// When the sizes cannot be, or a weight is missing or of another shape.
    pub fn trajectory(sizes: &Sizes, weights: &Tensors, domain: Domain) -> Result<Self, GenerateError> {
        sizes.check()?;
        let name = if domain == Domain::Space { "traj_encoder" } else { "traj_encoder_2d" };
        let encoder = format!("{name}.encoder");
        let stack = Stack::new(weights, &encoder, sizes, sizes.trajectory_blocks, false, Ending::Norm)?;
        Self::new(sizes, weights, name, "query_pos_encoder", stack)
    }

    /// The keypose encoder `denoiser.pose_encoder.*` or `denoiser.pose_encoder_2d.*`.
    ///
    /// # Errors
    /// When the sizes cannot be, or a weight is missing or of another shape.
    pub fn keypose(sizes: &Sizes, weights: &Tensors, domain: Domain) -> Result<Self, GenerateError> {
        sizes.check()?;
        let name = if domain == Domain::Space { "denoiser.pose_encoder" } else { "denoiser.pose_encoder_2d" };
        let blocks = (0..sizes.keypose_blocks).map(|block| format!("layers.{block}"));
        let stack = Stack::plain(weights, &format!("{name}.encoder"), sizes, blocks, Ending::Norm)?;
        Self::new(sizes, weights, name, "query_pos", stack)
    }

    fn new(
        sizes: &Sizes,
        weights: &Tensors,
        name: &str,
        table: &str,
        stack: Stack,
    ) -> Result<Self, GenerateError> {
        let token = weights.expect(&format!("{name}.global_motion_token"), &[1, sizes.width])?;
        Ok(Self {
            width: sizes.width,
            token: token.to_vec(),
            embed: Linear::new(weights, &format!("{name}.skel_embedding"), sizes.width, POSE)?,
            positions: positions(weights, &format!("{name}.{table}.pe"), sizes)?,
            stack,
            places: (
                weights.place(&format!("{name}.global_motion_token")),
                weights.place(&format!("{name}.{table}.pe")),
            ),
        })
    }

    /// One vector of the frames that ask for something: pairs of frame number and 66 numbers. A frame without anything
    /// is as if it were not there, so only those that ask have to be given.
    ///
    /// # Errors
    /// When a frame lies beyond the positional table, or a row is not of 66 numbers.
    pub fn encode(&self, frames: &[(usize, &[f32])]) -> Result<Vec<f32>, GenerateError> {
        let most = self.positions.len() / self.width - 1;
        let mut rows = Vec::with_capacity(frames.len() * POSE);
        for (frame, row) in frames {
            check_length("joints of a frame", row.len(), POSE, 1)?;
            check_length("frames before a condition", frame + 1, 1, most)?;
            rows.extend_from_slice(row);
        }
        let mut x = self.token.clone();
        add(&mut x, &self.positions[..self.width]);
        let mut embedded = self.embed.apply(&rows);
        for (token, (frame, _)) in embedded.chunks_exact_mut(self.width).zip(frames) {
            add(token, &self.positions[(frame + 1) * self.width..][..self.width]);
        }
        x.extend(embedded);
        let lengths = [1 + frames.len()];
        let layout = Layout { lengths: &lengths, memory: None };
        self.stack.forward(&mut x, layout, None, None, &mut StackTape::default());
        x.truncate(self.width);
        Ok(x)
    }

    /// Rows of a whole table that ask for something: frames x 66 numbers, zeros elsewhere.
    pub fn asking(table: &[f32]) -> Vec<(usize, &[f32])> {
        let asks = |row: &[f32]| row.iter().any(|x| *x != 0.0);
        table.chunks_exact(POSE).enumerate().filter(|(_, row)| asks(row)).collect()
    }
}
