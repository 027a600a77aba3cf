//! How large the networks are.

use crate::GenerateError;
use serde::{Deserialize, Serialize};

/// The sizes of all networks of a model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sizes {
    /// Numbers of a token, and of a latent token.
    pub width: usize,
    /// Heads of attention; they share the width.
    pub heads: usize,
    /// Numbers between the two layers of a feed-forward part.
    pub feed_forward: usize,
    /// Latent tokens of a clip, 1 to 8.
    pub latent_tokens: usize,
    /// Blocks of the VAE's encoder, and of its decoder; odd.
    pub vae_blocks: usize,
    /// Blocks of the denoiser; odd.
    pub denoiser_blocks: usize,
    /// Blocks that the trajectory ControlNet and the keypose adapter copy: all, or the first few before the middle.
    pub control_blocks: usize,
    /// Blocks of the trajectory encoders; odd.
    pub trajectory_blocks: usize,
    /// Blocks of the keypose encoders.
    pub keypose_blocks: usize,
    /// Rows of the positional tables: frames of a clip, and one or two tokens.
    pub positions: usize,
    /// Numbers of a text vector, and of the embedding of the timestep before it is projected.
    pub text_width: usize,
    /// Numbers of the embedding of the guidance weight, which distilled models take; 0 for others.
    pub guidance_width: usize,
    /// Cosines of each feature that the VAE's linear path beside its blocks sees; 0 without such a path, as published.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub cosines: usize,
    /// Whether the denoiser's blocks say the velocity (Salimans and Ho 2022), which the noise follows from, by a linear layer of their own;
    /// else they say the noise, as published.
    #[serde(default, skip_serializing_if = "is_false")]
    pub velocity: bool,
    /// Numbers of a row in the networks that make control by an estimate; 0 for ControlNet and adapter, as published.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub estimate: usize,
    /// Numbers of a row in a denoiser of feed-forward blocks on whole latents; 0 for blocks with attention, as published.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub trunk: usize,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_false(said: &bool) -> bool {
    !*said
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(number: &usize) -> bool {
    *number == 0
}

impl Sizes {
    /// As published.
    pub fn full() -> Self {
        Self {
            width: 256,
            heads: 4,
            feed_forward: 1024,
            latent_tokens: 1,
            vae_blocks: 9,
            denoiser_blocks: 9,
            control_blocks: 9,
            trajectory_blocks: 9,
            keypose_blocks: 6,
            positions: 500,
            text_width: 768,
            guidance_width: 256,
            cosines: 0,
            velocity: false,
            estimate: 0,
            trunk: 0,
        }
    }

    /// What can be trained in some hours on two cores: an eighth of the arithmetic, two latent tokens, and a linear path.
    pub fn small() -> Self {
        Self {
            width: 128,
            feed_forward: 512,
            latent_tokens: 2,
            vae_blocks: 7,
            denoiser_blocks: 7,
            control_blocks: 7,
            trajectory_blocks: 5,
            keypose_blocks: 3,
            positions: 256,
            cosines: 16,
            velocity: true,
            estimate: 384,
            trunk: 512,
            ..Self::full()
        }
    }

    /// For tests.
    pub fn tiny() -> Self {
        Self {
            width: 16,
            heads: 2,
            feed_forward: 32,
            vae_blocks: 3,
            denoiser_blocks: 3,
            control_blocks: 3,
            trajectory_blocks: 3,
            keypose_blocks: 2,
            positions: 64,
            text_width: 24,
            guidance_width: 16,
            ..Self::full()
        }
    }

    /// Frames of the longest clip: the encoder's own tokens take the first rows of the positional table.
    pub fn most_frames(&self) -> usize {
        self.positions.saturating_sub(2 * self.latent_tokens)
    }

    /// Whether the networks can be built: widths that heads share, odd numbers of blocks, and limits that keep a header
    /// from asking for more memory than a model of this kind can need.
    ///
    /// # Errors
    /// [`GenerateError::Setting`] with the first size that cannot be.
    pub fn check(&self) -> Result<(), GenerateError> {
        let odd = |blocks: usize| blocks % 2 == 1 && blocks <= 31;
        let control = self.control_blocks == self.denoiser_blocks
            || (1..=self.denoiser_blocks / 2).contains(&self.control_blocks);
        let even = |width: usize| width.is_multiple_of(2) && width <= 4096;
        let rules: [(&'static str, usize, bool, &'static str); 15] = [
            ("heads", self.heads, (1..=64).contains(&self.heads), "1 to 64"),
            (
                "width",
                self.width,
                self.width > 0 && even(self.width) && self.width.is_multiple_of(self.heads.max(1)),
                "an even multiple of heads, at most 4096",
            ),
            ("feed_forward", self.feed_forward, (1..=16384).contains(&self.feed_forward), "1 to 16384"),
            ("latent_tokens", self.latent_tokens, (1..=8).contains(&self.latent_tokens), "1 to 8"),
            ("vae_blocks", self.vae_blocks, odd(self.vae_blocks), "odd, at most 31"),
            ("denoiser_blocks", self.denoiser_blocks, odd(self.denoiser_blocks), "odd, at most 31"),
            (
                "control_blocks",
                self.control_blocks,
                control,
                "all blocks, or at most those before the middle",
            ),
            ("trajectory_blocks", self.trajectory_blocks, odd(self.trajectory_blocks), "odd, at most 31"),
            ("keypose_blocks", self.keypose_blocks, (1..=31).contains(&self.keypose_blocks), "1 to 31"),
            ("positions", self.positions, (32..=8192).contains(&self.positions), "32 to 8192"),
            (
                "text_width",
                self.text_width,
                self.text_width > 0 && even(self.text_width),
                "even, at most 4096",
            ),
            ("guidance_width", self.guidance_width, even(self.guidance_width), "even, at most 4096"),
            ("cosines", self.cosines, self.cosines <= 64, "at most 64"),
            ("estimate", self.estimate, self.estimate <= 4096, "at most 4096"),
            (
                "trunk",
                self.trunk,
                self.trunk == 0 || self.trunk <= 4096 && self.velocity,
                "at most 4096, and 0 where `velocity` is false",
            ),
        ];
        for (setting, value, right, needed) in rules {
            if !right {
                return Err(GenerateError::Setting { setting, value: value.to_string(), needed });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_that_cannot_be_are_named() {
        for sizes in [Sizes::full(), Sizes::small(), Sizes::tiny()] {
            sizes.check().unwrap();
        }
        let error = Sizes { vae_blocks: 4, ..Sizes::tiny() }.check().unwrap_err().to_string();
        assert!(error.contains("vae_blocks is 4"), "{error}");
        assert!(Sizes { heads: 3, ..Sizes::tiny() }.check().is_err());
        assert!(Sizes { control_blocks: 2, ..Sizes::tiny() }.check().is_err());
        Sizes { control_blocks: 4, ..Sizes::full() }.check().unwrap();
    }
}
