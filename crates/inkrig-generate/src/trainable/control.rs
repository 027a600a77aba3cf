//! Trajectory ControlNet, keypose adapter and the encoders of conditions, for training.

use super::branch::{Branch, NoisyBatch};
use super::layers::{Positions, Side, Source, Stack};
use super::mask::FrameMask;
use super::named::{parameter, to_tensors};
use crate::GenerateError;
use crate::networks::{Domain, POSE, Sizes};
use crate::weights::Tensors;
use burn::module::{Module, Param};
use burn::nn::Linear;
use burn::tensor::activation::relu;
use burn::tensor::{Device, Int, Tensor, TensorData};

/// The trajectory ControlNet, equal to [`crate::networks::ControlNet`] when nothing is dropped out.
#[derive(Module, Debug)]
pub struct TrainableControlNet {
    branch: Branch,
    controlnet_cond_embedding: Vec<Linear>,
    controlnet_down_mid_blocks: Vec<Linear>,
}

impl TrainableControlNet {
    /// Takes the weights that are named `controlnet.*`.
    ///
    /// # Errors
    /// When the sizes or the share cannot be, or a weight is missing or of another shape.
    pub fn new(
        sizes: &Sizes,
        weights: &Tensors,
        dropout: f64,
        device: &Device,
    ) -> Result<Self, GenerateError> {
        let source = Source::new(sizes, weights, dropout, device)?;
        let name = "controlnet.controlnet_cond_embedding";
        let layer = |at: usize| source.linear(&format!("{name}.{at}"), sizes.width, sizes.width);
        Ok(Self {
            branch: Branch::new(source, "controlnet", sizes.control_blocks, false)?,
            controlnet_cond_embedding: (0..3).map(layer).collect::<Result<_, _>>()?,
            controlnet_down_mid_blocks: outputs(source, "controlnet")?,
        })
    }

    /// Corrections for the adapter or the denoiser, one a block; `trajectories` are embeddings, samples x width.
    pub fn corrections(&self, batch: &NoisyBatch, trajectories: Tensor<2>) -> Vec<Tensor<3>> {
        let layers = self.controlnet_cond_embedding.iter();
        let condition = layers.fold(trajectories, |x, layer| layer.forward(x)).unsqueeze_dim::<3>(1);
        let batch = NoisyBatch { latents: batch.latents.clone() + condition, ..batch.clone() };
        let mut blocks = Vec::new();
        self.branch.forward(&batch, Side { residuals: None, outputs: Some(&mut blocks) });
        through(&self.controlnet_down_mid_blocks, blocks)
    }

    /// All weights by their published names.
    ///
    /// # Errors
    /// When a device gives its numbers in another form.
    pub fn to_tensors(&self) -> Result<Tensors, GenerateError> {
        to_tensors(self, "controlnet")
    }
}

/// The trajectory-aware keypose adapter, equal to [`crate::networks::Adapter`] when nothing is dropped out.
#[derive(Module, Debug)]
pub struct TrainableAdapter {
    branch: Branch,
    controlnet_cond_embedding_pose: Linear,
    controlnet_down_mid_blocks: Vec<Linear>,
}

impl TrainableAdapter {
    /// Takes the weights of the outer module `denoiser.*`, without the encoders of key poses.
    ///
    /// # Errors
    /// When the sizes or the share cannot be, or a weight is missing or of another shape.
    pub fn new(
        sizes: &Sizes,
        weights: &Tensors,
        dropout: f64,
        device: &Device,
    ) -> Result<Self, GenerateError> {
        let source = Source::new(sizes, weights, dropout, device)?;
        let pose = "denoiser.controlnet_cond_embedding_pose.1";
        Ok(Self {
            branch: Branch::new(source, "denoiser", sizes.control_blocks, false)?,
            controlnet_cond_embedding_pose: source.linear(pose, sizes.text_width, sizes.width)?,
            controlnet_down_mid_blocks: outputs(source, "denoiser")?,
        })
    }

    /// Texts that key poses say more about: samples x text width, of texts and of embeddings, samples x width.
    pub fn grounded(&self, texts: Tensor<2>, keyposes: Tensor<2>) -> Tensor<2> {
        texts + self.controlnet_cond_embedding_pose.forward(relu(keyposes))
    }

    /// Corrections for the denoiser, one a block, from the ControlNet's; the texts of `batch` are [`Self::grounded`] ones.
    pub fn corrections(&self, batch: &NoisyBatch, trajectory: Option<&[Tensor<3>]>) -> Vec<Tensor<3>> {
        let mut blocks = Vec::new();
        self.branch.forward(batch, Side { residuals: trajectory, outputs: Some(&mut blocks) });
        through(&self.controlnet_down_mid_blocks, blocks)
    }

    /// All weights by their published names.
    ///
    /// # Errors
    /// When a device gives its numbers in another form.
    pub fn to_tensors(&self) -> Result<Tensors, GenerateError> {
        to_tensors(self, "denoiser")
    }
}

/// Rows of conditions of a batch of samples, packed: frames that ask for nothing are not there.
#[derive(Debug, Clone, PartialEq)]
pub struct ConditionRows {
    rows: Vec<f32>,
    frames: Vec<usize>,
    counts: Vec<usize>,
    most: usize,
}

impl ConditionRows {
    /// Pairs of frame and 66 normalised numbers for each sample.
    ///
    /// # Errors
    /// [`GenerateError::Length`] when a row is not of 66 numbers.
    pub fn new<R: AsRef<[f32]>>(samples: &[Vec<(usize, R)>]) -> Result<Self, GenerateError> {
        let most = samples.iter().map(Vec::len).max().unwrap_or(0);
        let mut packed =
            Self { rows: Vec::new(), frames: Vec::new(), counts: samples.iter().map(Vec::len).collect(), most };
        for sample in samples {
            for (frame, row) in sample {
                let row = row.as_ref();
                if row.len() != POSE {
                    let (what, got) = ("row of a condition", row.len());
                    return Err(GenerateError::Length { what, expected: POSE, got });
                }
                packed.rows.extend_from_slice(row);
                packed.frames.push(*frame);
            }
            packed.rows.resize(packed.rows.len() + (most - sample.len()) * POSE, 0.0);
            packed.frames.resize(packed.frames.len() + most - sample.len(), 0);
        }
        Ok(packed)
    }

    /// Samples.
    pub fn samples(&self) -> usize {
        self.counts.len()
    }
}

/// A network that makes one vector of a trajectory or a key pose, equal to [`crate::networks::ConditionEncoder`] when nothing is
/// dropped out.
#[derive(Module, Debug)]
pub struct TrainableEncoder {
    global_motion_token: Param<Tensor<2>>,
    skel_embedding: Linear,
    /// The table of key poses' encoders, or that of trajectories'.
    query_pos: Option<Positions>,
    query_pos_encoder: Option<Positions>,
    encoder: Stack,
}

impl TrainableEncoder {
    /// The trajectory encoder `traj_encoder.*` or `traj_encoder_2d.*`.
    ///
    /// # Errors
    /// When the sizes or the share cannot be, or a weight is missing or of another shape.
    pub fn trajectory(
        sizes: &Sizes,
        weights: &Tensors,
        domain: Domain,
        dropout: f64,
        device: &Device,
    ) -> Result<Self, GenerateError> {
        let source = Source::new(sizes, weights, dropout, device)?;
        let name = Self::trajectory_name(domain);
        let encoder = source.stack(&format!("{name}.encoder"), sizes.trajectory_blocks, false, true)?;
        let positions = source.positions(&format!("{name}.query_pos_encoder"))?;
        Self::new(source, name, (None, Some(positions)), encoder)
    }

    /// The keypose encoder `denoiser.pose_encoder.*` or `denoiser.pose_encoder_2d.*`.
    ///
    /// # Errors
    /// When the sizes or the share cannot be, or a weight is missing or of another shape.
    pub fn keypose(
        sizes: &Sizes,
        weights: &Tensors,
        domain: Domain,
        dropout: f64,
        device: &Device,
    ) -> Result<Self, GenerateError> {
        let source = Source::new(sizes, weights, dropout, device)?;
        let name = Self::keypose_name(domain);
        let encoder = source.plain_stack(&format!("{name}.encoder"), sizes.keypose_blocks)?;
        let positions = source.positions(&format!("{name}.query_pos"))?;
        Self::new(source, name, (Some(positions), None), encoder)
    }

    /// What the weights of a trajectory encoder begin with.
    pub fn trajectory_name(domain: Domain) -> &'static str {
        if domain == Domain::Space { "traj_encoder" } else { "traj_encoder_2d" }
    }

    /// What the weights of a keypose encoder begin with.
    pub fn keypose_name(domain: Domain) -> &'static str {
        if domain == Domain::Space { "denoiser.pose_encoder" } else { "denoiser.pose_encoder_2d" }
    }

    fn new(
        source: Source<'_>,
        name: &str,
        (query_pos, query_pos_encoder): (Option<Positions>, Option<Positions>),
        encoder: Stack,
    ) -> Result<Self, GenerateError> {
        let width = source.sizes.width;
        let token = format!("{name}.global_motion_token");
        Ok(Self {
            global_motion_token: parameter(source.weights, &token, [1, width], source.device)?,
            skel_embedding: source.linear(&format!("{name}.skel_embedding"), width, POSE)?,
            query_pos,
            query_pos_encoder,
            encoder,
        })
    }

    /// One vector a sample, samples x width. Frames behind the end of the positional table count as its last.
    pub fn encode(&self, conditions: &ConditionRows) -> Tensor<2> {
        let ConditionRows { rows, frames, counts, most } = conditions;
        let (device, samples) = (self.global_motion_token.device(), counts.len());
        let width = self.skel_embedding.weight.dims()[1];
        let token = self.global_motion_token.val().unsqueeze::<3>().repeat_dim(0, samples);
        let rows = TensorData::new(rows.clone(), [samples, *most, POSE]);
        let rows = self.skel_embedding.forward(Tensor::<3>::from_data(rows, &device));
        let mut x = Tensor::cat(vec![token, rows], 1);
        if let Some(positions) = self.query_pos.as_ref().or(self.query_pos_encoder.as_ref()) {
            let table = positions.table();
            let last = table.dims()[0] - 1;
            let own = frames.chunks((*most).max(1)).flat_map(|frames| {
                std::iter::once(0).chain(frames.iter().map(|frame| (frame + 1).min(last) as i64))
            });
            let own = TensorData::new(own.collect::<Vec<i64>>(), [samples * (most + 1)]);
            let own = table.select(0, Tensor::<1, Int>::from_data(own, &device));
            x = x + own.reshape([samples, most + 1, width]);
        }
        let bias = FrameMask::new(counts, *most).bias(1, &device);
        let x = self.encoder.forward(x, bias.as_ref(), None);
        x.narrow(1, 0, 1).reshape([samples, width])
    }

    /// All weights, their names beginning with `name`.
    ///
    /// # Errors
    /// When a device gives its numbers in another form.
    pub fn to_tensors(&self, name: &str) -> Result<Tensors, GenerateError> {
        to_tensors(self, name)
    }
}

fn outputs(source: Source<'_>, name: &str) -> Result<Vec<Linear>, GenerateError> {
    let width = source.sizes.width;
    let output = |at: usize| source.linear(&format!("{name}.controlnet_down_mid_blocks.{at}"), width, width);
    (0..source.sizes.control_blocks).map(output).collect()
}

fn through(outputs: &[Linear], blocks: Vec<Tensor<3>>) -> Vec<Tensor<3>> {
    outputs.iter().zip(blocks).map(|(output, block)| output.forward(block)).collect()
}
