//! The one table of tensor names: what a model of given sizes consists of, in the names of the published state
//! dictionary.

use super::Sizes;
use super::estimate::{Correction, TOLD, WAVES};
use super::feeding::Feeding;
use super::trunk::{BLOCKS, WIDENING};
use crate::weights::Tensors;
use inkrig_motion::humanml::{JOINTS, WIDTH};

/// Numbers of a key pose, or of a frame of a trajectory: 22 joints in space.
pub(crate) const POSE: usize = 3 * JOINTS;

/// A tensor that a model has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TensorSpec {
    /// As in the published state dictionary.
    pub name: String,
    /// How long its axes are.
    pub shape: Vec<usize>,
    /// Whether a network reads it. Published models carry a few that none does.
    pub used: bool,
}

/// Which networks a model has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parts {
    /// The motion's encoder and decoder.
    pub vae: bool,
    /// The denoiser.
    pub denoiser: bool,
    /// ControlNet, adapter, and the 3D encoders; or the estimator of 3D conditions and the correction.
    pub control: bool,
    /// The encoders of 2D conditions; or their estimator.
    pub control_2d: bool,
}

impl Parts {
    /// All networks.
    pub const ALL: Self = Self { vae: true, denoiser: true, control: true, control_2d: true };
    /// The VAE alone.
    pub const VAE: Self = Self { vae: true, denoiser: false, control: false, control_2d: false };

    /// Those that some weights are of, by one name of each.
    pub fn of(weights: &Tensors) -> Self {
        let has = |name: &str| weights.get(name).is_some();
        Self {
            vae: has("vae.final_layer.weight"),
            denoiser: has("denoiser.denoiser.emb_proj.1.weight")
                || has("denoiser.denoiser.trunk.input.weight"),
            control: has("controlnet.controlnet_cond_embedding.0.weight")
                || has("estimate.space.input.weight"),
            control_2d: has("traj_encoder_2d.skel_embedding.weight") || has("estimate.plane.input.weight"),
        }
    }
}

/// All tensors of the parts of a model, in the order of the networks.
pub fn tensors(sizes: &Sizes, parts: Parts) -> Vec<TensorSpec> {
    let mut list = List { sizes, specs: Vec::new() };
    let width = sizes.width;
    if parts.vae {
        list.add("vae.global_motion_token", &[2 * sizes.latent_tokens, width]);
        list.positions("vae.query_pos_encoder.pe");
        list.stack("vae.encoder", sizes.vae_blocks, false);
        list.positions("vae.query_pos_decoder.pe");
        list.stack("vae.decoder", sizes.vae_blocks, true);
        list.linear("vae.skel_embedding", width, WIDTH);
        list.linear("vae.final_layer", WIDTH, width);
        if sizes.cosines > 0 {
            let (latent, spectrum) = (sizes.latent_tokens * width, sizes.cosines * WIDTH);
            list.linear("vae.linear_path.encoder", latent, spectrum);
            list.linear("vae.linear_path.decoder", spectrum, latent);
            list.add("vae.linear_path.log_variance", &[latent]);
        }
    }
    if parts.denoiser && sizes.trunk > 0 {
        list.trunk("denoiser.denoiser.trunk", Feeding::inputs(sizes), sizes.trunk);
        list.linear("denoiser.denoiser.velocity", sizes.latent_tokens * width, sizes.trunk);
    } else if parts.denoiser {
        list.branch("denoiser.denoiser", sizes.denoiser_blocks);
        list.norm("denoiser.denoiser.encoder.norm");
        if sizes.velocity {
            list.linear("denoiser.denoiser.velocity", width, width);
        }
    }
    if sizes.estimate > 0 {
        let latent = sizes.latent_tokens * width;
        for (name, _) in [("estimate.space", parts.control), ("estimate.plane", parts.control_2d)]
            .iter()
            .filter(|(_, has)| *has)
        {
            list.trunk(name, TOLD, sizes.estimate);
            list.linear(&format!("{name}.latent"), latent, sizes.estimate);
        }
        if parts.control {
            list.trunk("estimate.correction", Correction::inputs(sizes), sizes.estimate);
            list.linear("estimate.correction.latent", latent, sizes.estimate);
            list.linear("estimate.correction.gate", latent, sizes.estimate + WAVES);
        }
        return list.specs;
    }
    if parts.control {
        list.branch("denoiser", sizes.control_blocks);
        list.unused(|list| list.norm("denoiser.encoder.norm"));
        list.outputs("denoiser");
        list.keypose("denoiser.pose_encoder");
        list.linear("denoiser.controlnet_cond_embedding_pose.1", sizes.text_width, width);
        list.branch("controlnet", sizes.control_blocks);
        list.outputs("controlnet");
        for layer in 0..3 {
            list.linear(&format!("controlnet.controlnet_cond_embedding.{layer}"), width, width);
        }
        list.trajectory("traj_encoder");
    }
    if parts.control_2d {
        list.keypose("denoiser.pose_encoder_2d");
        list.trajectory("traj_encoder_2d");
    }
    list.specs
}

struct List<'a> {
    sizes: &'a Sizes,
    specs: Vec<TensorSpec>,
}

impl List<'_> {
    fn add(&mut self, name: &str, shape: &[usize]) {
        self.specs.push(TensorSpec { name: name.into(), shape: shape.to_vec(), used: true });
    }

    fn unused(&mut self, more: impl FnOnce(&mut Self)) {
        let before = self.specs.len();
        more(self);
        for spec in self.specs.iter_mut().skip(before) {
            spec.used = false;
        }
    }

    fn linear(&mut self, name: &str, outputs: usize, inputs: usize) {
        self.add(&format!("{name}.weight"), &[outputs, inputs]);
        self.add(&format!("{name}.bias"), &[outputs]);
    }

    fn norm(&mut self, name: &str) {
        self.add(&format!("{name}.weight"), &[self.sizes.width]);
        self.add(&format!("{name}.bias"), &[self.sizes.width]);
    }

    fn positions(&mut self, name: &str) {
        self.add(name, &[self.sizes.positions, 1, self.sizes.width]);
    }

    fn attention(&mut self, name: &str) {
        let width = self.sizes.width;
        self.add(&format!("{name}.in_proj_weight"), &[3 * width, width]);
        self.add(&format!("{name}.in_proj_bias"), &[3 * width]);
        self.linear(&format!("{name}.out_proj"), width, width);
    }

    fn block(&mut self, name: &str, cross: bool) {
        let (width, wide) = (self.sizes.width, self.sizes.feed_forward);
        self.attention(&format!("{name}.self_attn"));
        if cross {
            self.attention(&format!("{name}.multihead_attn"));
        }
        self.linear(&format!("{name}.linear1"), wide, width);
        self.linear(&format!("{name}.linear2"), width, wide);
        for norm in 1..=if cross { 3 } else { 2 } {
            self.norm(&format!("{name}.norm{norm}"));
        }
    }

    /// Blocks with skips, and the norm behind them.
    fn stack(&mut self, name: &str, blocks: usize, cross: bool) {
        self.blocks(name, blocks, cross);
        self.norm(&format!("{name}.norm"));
    }

    fn blocks(&mut self, name: &str, blocks: usize, cross: bool) {
        for block in block_names(blocks) {
            self.block(&format!("{name}.{block}"), cross);
        }
        for skip in 0..blocks / 2 {
            self.linear(&format!("{name}.linear_blocks.{skip}"), self.sizes.width, 2 * self.sizes.width);
        }
    }

    /// What denoiser, adapter and ControlNet have in common. A copy of the first few blocks has neither middle nor skips.
    fn branch(&mut self, name: &str, blocks: usize) {
        let (width, text) = (self.sizes.width, self.sizes.text_width);
        if self.sizes.guidance_width > 0 {
            let shape = [text, self.sizes.guidance_width];
            self.add(&format!("{name}.time_embedding.cond_proj.weight"), &shape);
        }
        self.linear(&format!("{name}.time_embedding.linear_1"), width, text);
        self.linear(&format!("{name}.time_embedding.linear_2"), width, width);
        self.linear(&format!("{name}.emb_proj.1"), width, text);
        self.positions(&format!("{name}.query_pos.pe"));
        if blocks == self.sizes.denoiser_blocks {
            self.blocks(&format!("{name}.encoder"), blocks, false);
        } else {
            for block in 0..blocks {
                self.block(&format!("{name}.encoder.input_blocks.{block}"), false);
            }
        }
    }

    /// Feed-forward blocks on whole vectors.
    fn trunk(&mut self, name: &str, inputs: usize, width: usize) {
        let norm = |list: &mut Self, name: &str| {
            list.add(&format!("{name}.weight"), &[width]);
            list.add(&format!("{name}.bias"), &[width]);
        };
        self.linear(&format!("{name}.input"), width, inputs);
        for block in 0..BLOCKS {
            let name = format!("{name}.blocks.{block}");
            norm(self, &format!("{name}.norm"));
            self.linear(&format!("{name}.widen"), WIDENING * width, width);
            self.linear(&format!("{name}.narrow"), width, WIDENING * width);
        }
        norm(self, &format!("{name}.norm"));
    }

    fn outputs(&mut self, name: &str) {
        for block in 0..self.sizes.control_blocks {
            let name = format!("{name}.controlnet_down_mid_blocks.{block}");
            self.linear(&name, self.sizes.width, self.sizes.width);
        }
    }

    fn trajectory(&mut self, name: &str) {
        self.add(&format!("{name}.global_motion_token"), &[1, self.sizes.width]);
        self.linear(&format!("{name}.skel_embedding"), self.sizes.width, POSE);
        self.positions(&format!("{name}.query_pos_encoder.pe"));
        self.stack(&format!("{name}.encoder"), self.sizes.trajectory_blocks, false);
    }

    fn keypose(&mut self, name: &str) {
        self.add(&format!("{name}.global_motion_token"), &[1, self.sizes.width]);
        self.linear(&format!("{name}.skel_embedding"), self.sizes.width, POSE);
        self.positions(&format!("{name}.query_pos.pe"));
        for block in 0..self.sizes.keypose_blocks {
            self.block(&format!("{name}.encoder.layers.{block}"), false);
        }
        self.norm(&format!("{name}.encoder.norm"));
        self.unused(|list| {
            list.positions(&format!("{name}.mem_pos.pe"));
            list.linear(&format!("{name}.rel_pos_layer.0"), 64, 1);
            list.add(&format!("{name}.rel_pos_layer.1.weight"), &[1]);
            list.linear(&format!("{name}.rel_pos_layer.3"), 64, 64);
        });
    }
}

/// Blocks of a stack in the order in which they run.
pub(crate) fn block_names(blocks: usize) -> impl Iterator<Item = String> {
    let half = blocks / 2;
    let inputs = (0..half).map(|at| format!("input_blocks.{at}"));
    let outputs = (0..half).map(|at| format!("output_blocks.{at}"));
    inputs.chain(["middle_block".to_owned()]).chain(outputs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_model_has_as_many_tensors_and_numbers_as_the_published_one() {
        let specs = tensors(&Sizes::full(), Parts::ALL);
        let numbers: usize = specs.iter().map(|spec| spec.shape.iter().product::<usize>()).sum();
        assert_eq!((specs.len(), numbers), (1129, 70_455_689));
        let vae = tensors(&Sizes::full(), Parts::VAE);
        assert_eq!(vae.iter().map(|spec| spec.shape.iter().product::<usize>()).sum::<usize>(), 18_032_135);
        let without_guidance = Sizes { guidance_width: 0, ..Sizes::full() };
        assert_eq!(tensors(&without_guidance, Parts::ALL).len(), 1126);
    }
}
