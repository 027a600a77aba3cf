//! Networks that see a noisy latent, a timestep and a text: the denoiser, the trajectory ControlNet, the keypose adapter.
//!
//! Their sequence is short: the latent's tokens, one for time, one for text. The published latent is one token.

use super::Sizes;
use super::branch::Branch;
use super::feeding::Feeding;
use super::linear::Linear;
use super::stack::{Ending, Residuals, StackTape};
use super::velocity::{Attending, Velocity};
use crate::GenerateError;
use crate::numeric::elementwise::{add, relu};
use crate::schedule::NoiseSchedule;
use crate::weights::Tensors;

/// What the three networks are given. Several samples may be run at once; their numbers follow one another.
#[derive(Debug, Clone, Copy)]
pub struct Noisy<'a> {
    /// Samples x latent tokens x width.
    pub latents: &'a [f32],
    /// One for each sample, from 0 to 999.
    pub timesteps: &'a [usize],
    /// Samples x text width.
    pub texts: &'a [f32],
    /// The waves of the guidance weight (see [`guidance_waves`](super::guidance_waves)), for distilled models.
    pub guidance: Option<&'a [f32]>,
}

/// Corrections from one network to the next, one table for each block.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Corrections {
    pub(crate) blocks: Residuals,
}

impl Corrections {
    /// Samples x tokens x width for each block, in the order of the blocks.
    pub fn blocks(&self) -> &[Vec<f32>] {
        &self.blocks
    }

    /// Those of `more` samples behind the `samples` that they are of: nothing, for samples that are not controlled.
    pub(crate) fn with_zeros(mut self, more: usize, samples: usize) -> Self {
        for block in &mut self.blocks {
            let each = block.len() / samples.max(1);
            block.resize(block.len() + each * more, 0.0);
        }
        self
    }
}

/// The network that predicts the noise in a latent.
#[derive(Debug, Clone)]
pub struct Denoiser {
    pub(super) form: Form,
    schedule: NoiseSchedule,
}

/// What it is made of.
#[derive(Debug, Clone)]
pub(super) enum Form {
    /// Blocks with attention between tokens, as published.
    Attending(Box<Attending>),
    /// Feed-forward blocks on whole latents.
    Feeding(Box<Feeding>),
}

impl Denoiser {
    /// Takes the weights that are named `denoiser.denoiser.*`.
    ///
    /// # Errors
    /// When the sizes cannot be, or a weight is missing or of another shape.
    pub fn new(sizes: &Sizes, weights: &Tensors) -> Result<Self, GenerateError> {
        let form = if sizes.trunk > 0 {
            Form::Feeding(Box::new(Feeding::new(sizes, weights)?))
        } else {
            let blocks = sizes.denoiser_blocks;
            let branch = Branch::new(weights, "denoiser.denoiser", sizes, blocks, Ending::Norm)?;
            Form::Attending(Box::new(Attending { branch, velocity: Velocity::new(sizes, weights)? }))
        };
        Ok(Self { form, schedule: NoiseSchedule::default() })
    }

    /// The noise in each latent: as many numbers as there are in the latents.
    ///
    /// # Errors
    /// When the numbers of latents, timesteps, texts or corrections do not fit each other.
    pub fn noise(
        &self,
        noisy: &Noisy<'_>,
        corrections: Option<&Corrections>,
        work: &mut Work,
    ) -> Result<Vec<f32>, GenerateError> {
        match &self.form {
            Form::Attending(own) => {
                let x = own.branch.run(noisy, corrections, None, &mut work.tape)?;
                Ok(own.noise_of(&x, noisy.latents, noisy.timesteps))
            }
            Form::Feeding(own) => {
                if let Some(block) = corrections.and_then(|corrections| corrections.blocks.first()) {
                    let what = "corrections of a block, which this denoiser has none of,";
                    return Err(GenerateError::Length { what, expected: 0, got: block.len() });
                }
                own.run(noisy)
            }
        }
    }

    /// What a squared error of the noise counts at a timestep, so that what is predicted counts alike at all.
    pub fn loss_weight(&self, timestep: usize) -> f32 {
        match &self.form {
            Form::Attending(own) if own.velocity.is_none() => 1.0,
            _ => 1.0 / self.schedule.alpha(timestep),
        }
    }
}

/// Buffers of the three networks, kept from one call to the next.
#[derive(Debug, Clone, Default)]
pub struct Work {
    tape: StackTape,
}

/// The trajectory ControlNet.
#[derive(Debug, Clone)]
pub struct ControlNet {
    pub(super) branch: Branch,
    pub(super) condition: [Linear; 3],
    pub(super) outputs: Vec<Linear>,
}

impl ControlNet {
    /// Takes the weights that are named `controlnet.*`.
    ///
    /// # Errors
    /// When the sizes cannot be, or a weight is missing or of another shape.
    pub fn new(sizes: &Sizes, weights: &Tensors) -> Result<Self, GenerateError> {
        let layer = |at: usize| {
            let name = format!("controlnet.controlnet_cond_embedding.{at}");
            Linear::new(weights, &name, sizes.width, sizes.width)
        };
        Ok(Self {
            branch: Branch::new(weights, "controlnet", sizes, sizes.control_blocks, Ending::Nothing)?,
            condition: [layer(0)?, layer(1)?, layer(2)?],
            outputs: outputs(weights, "controlnet", sizes)?,
        })
    }

    /// Corrections for the adapter, or, without a key pose, for the denoiser. `trajectories` are embeddings, samples x
    /// width.
    ///
    /// # Errors
    /// When the numbers of latents, timesteps, texts or trajectories do not fit each other.
    pub fn corrections(
        &self,
        noisy: &Noisy<'_>,
        trajectories: &[f32],
        work: &mut Work,
    ) -> Result<Corrections, GenerateError> {
        let (width, samples) = (self.branch.sizes.width, noisy.timesteps.len());
        let (what, expected) = ("trajectory embeddings", samples * width);
        if trajectories.len() != expected || samples == 0 {
            return Err(GenerateError::Length { what, expected, got: trajectories.len() });
        }
        let condition = self.condition.iter().fold(trajectories.to_vec(), |x, layer| layer.apply(&x));
        let mut latents = noisy.latents.to_vec();
        let each = latents.len() / samples;
        for (latent, condition) in latents.chunks_exact_mut(each.max(1)).zip(condition.chunks_exact(width)) {
            latent.chunks_exact_mut(width).for_each(|token| add(token, condition));
        }
        let mut blocks = Vec::new();
        let noisy = Noisy { latents: &latents, ..*noisy };
        self.branch.run(&noisy, None, Some(&mut blocks), &mut work.tape)?;
        Ok(through(&self.outputs, &blocks))
    }
}

/// The trajectory-aware keypose adapter.
#[derive(Debug, Clone)]
pub struct Adapter {
    pub(super) branch: Branch,
    pub(super) pose: Linear,
    pub(super) outputs: Vec<Linear>,
}

impl Adapter {
    /// Takes the weights of the outer module `denoiser.*`.
    ///
    /// # Errors
    /// When the sizes cannot be, or a weight is missing or of another shape.
    pub fn new(sizes: &Sizes, weights: &Tensors) -> Result<Self, GenerateError> {
        let pose = "denoiser.controlnet_cond_embedding_pose.1";
        Ok(Self {
            branch: Branch::new(weights, "denoiser", sizes, sizes.control_blocks, Ending::Nothing)?,
            pose: Linear::new(weights, pose, sizes.text_width, sizes.width)?,
            outputs: outputs(weights, "denoiser", sizes)?,
        })
    }

    /// A text that a key pose says more about: the text vector plus the projected embedding (samples x width) of the
    /// pose.
    ///
    /// # Errors
    /// When the numbers of texts and poses do not fit each other.
    pub fn grounded(&self, texts: &[f32], keyposes: &[f32]) -> Result<Vec<f32>, GenerateError> {
        let Sizes { width, text_width, .. } = self.branch.sizes;
        let (what, expected) = ("keypose embeddings", texts.len() / text_width * width);
        if keyposes.len() != expected {
            return Err(GenerateError::Length { what, expected, got: keyposes.len() });
        }
        let mut poses = keyposes.to_vec();
        relu(&mut poses);
        let mut grounded = self.pose.apply(&poses);
        add(&mut grounded, texts);
        Ok(grounded)
    }

    /// Corrections for the denoiser, from the ControlNet's. The texts of `noisy` are [`Self::grounded`] ones.
    ///
    /// # Errors
    /// When the numbers of latents, timesteps, texts or corrections do not fit each other.
    pub fn corrections(
        &self,
        noisy: &Noisy<'_>,
        trajectory: Option<&Corrections>,
        work: &mut Work,
    ) -> Result<Corrections, GenerateError> {
        let mut blocks = Vec::new();
        self.branch.run(noisy, trajectory, Some(&mut blocks), &mut work.tape)?;
        Ok(through(&self.outputs, &blocks))
    }
}

fn outputs(weights: &Tensors, name: &str, sizes: &Sizes) -> Result<Vec<Linear>, GenerateError> {
    let output = |at: usize| {
        let name = format!("{name}.controlnet_down_mid_blocks.{at}");
        Linear::new(weights, &name, sizes.width, sizes.width)
    };
    (0..sizes.control_blocks).map(output).collect()
}

fn through(outputs: &[Linear], blocks: &[Vec<f32>]) -> Corrections {
    Corrections { blocks: outputs.iter().zip(blocks).map(|(output, block)| output.apply(block)).collect() }
}
