//! Which model a list of tensors is, and how its names are ours.

use super::source::Listed;
use super::{CheckpointError, ModelHeader};
use crate::networks::{Parts, Sizes};
use crate::sampling::Examples;
use crate::text::VerbTable;
use inkrig_motion::humanml::WIDTH;
use std::collections::BTreeMap;

/// Published models that can be told by their tensors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModelKind {
    /// Sketch2Anim: base denoiser, ControlNet, adapter, condition encoders.
    Sketch2Anim,
    /// MotionLCM, first version: VAE and a distilled denoiser.
    MotionLcm,
    /// MLD: VAE and a denoiser.
    Mld,
    /// A motion VAE alone.
    Vae,
    /// A model file of ours, of whatever networks.
    Own,
}

impl ModelKind {
    /// As people call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sketch2Anim => "Sketch2Anim",
            Self::MotionLcm => "MotionLCM (version 1)",
            Self::Mld => "MLD",
            Self::Vae => "a motion VAE alone",
            Self::Own => "a model file of inkrig",
        }
    }
}

/// What was found out.
#[derive(Debug, Clone)]
pub(super) struct Detected {
    pub(super) kind: ModelKind,
    pub(super) sizes: Sizes,
    pub(super) parts: Parts,
}

/// The weight whose second axis is that of the guidance's embedding; only distilled models have it.
const DISTILLED: &str = "time_embedding.cond_proj.weight";

/// Finds model and sizes by names and shapes.
pub(super) fn detect(listed: &[Listed]) -> Result<Detected, CheckpointError> {
    let names = Names(listed.iter().map(|tensor| (tensor.name.as_str(), tensor.shape.as_slice())).collect());
    let unknown = |what: &str| Err(CheckpointError::Unknown { what: what.into() });
    if !names.any("vae.") {
        return unknown("no tensor of a motion VAE (vae.*) is there");
    }
    if names.any("vae.latent_pre.") || names.any("vae.latent_post.") {
        return unknown(
            "its VAE has another latent space, as that of MotionLCM's version 2, which is not supported",
        );
    }
    let base = if names.any("denoiser.denoiser.") { "denoiser.denoiser" } else { "denoiser" };
    let kind = if base == "denoiser.denoiser" {
        ModelKind::Sketch2Anim
    } else if !names.any("denoiser.") {
        ModelKind::Vae
    } else if names.axis(&format!("{base}.{DISTILLED}"), 1).is_some() {
        ModelKind::MotionLcm
    } else {
        ModelKind::Mld
    };
    let official = kind == ModelKind::Sketch2Anim;
    let parts = Parts {
        vae: true,
        denoiser: kind != ModelKind::Vae,
        control: official && (names.any("controlnet.") || names.any("denoiser.pose_encoder.")),
        control_2d: official && (names.any("traj_encoder_2d.") || names.any("denoiser.pose_encoder_2d.")),
    };
    let like = Sizes::full();
    let denoiser_blocks = names.stack(&format!("{base}.encoder")).unwrap_or(like.denoiser_blocks);
    let copies = names.count("controlnet.encoder.input_blocks.");
    let control_blocks = names.stack("controlnet.encoder").unwrap_or(copies.max(1));
    let trajectory = names.stack("traj_encoder.encoder").or_else(|| names.stack("traj_encoder_2d.encoder"));
    let keypose = names.count("denoiser.pose_encoder.encoder.layers.");
    let sizes = Sizes {
        width: names.axis("vae.skel_embedding.weight", 0).unwrap_or(like.width),
        feed_forward: names.axis("vae.encoder.input_blocks.0.linear1.weight", 0).unwrap_or(like.feed_forward),
        latent_tokens: names
            .axis("vae.global_motion_token", 0)
            .map_or(like.latent_tokens, |tokens| tokens / 2),
        vae_blocks: names.stack("vae.encoder").unwrap_or(like.vae_blocks),
        denoiser_blocks,
        control_blocks: if parts.control { control_blocks } else { denoiser_blocks },
        trajectory_blocks: trajectory.unwrap_or(like.trajectory_blocks),
        keypose_blocks: if keypose > 0 { keypose } else { like.keypose_blocks },
        positions: names.axis("vae.query_pos_encoder.pe", 0).unwrap_or(like.positions),
        text_width: names.axis(&format!("{base}.emb_proj.1.weight"), 1).unwrap_or(like.text_width),
        guidance_width: names.axis(&format!("{base}.{DISTILLED}"), 1).unwrap_or(0),
        cosines: names.axis("vae.linear_path.encoder.weight", 1).map_or(0, |numbers| numbers / WIDTH),
        velocity: names.any("denoiser.denoiser.velocity."),
        ..like
    };
    sizes.check()?;
    Ok(Detected { kind, sizes, parts })
}

/// What a model file of ours says of itself; which networks are there, its tensors say.
pub(super) fn of_header(header: &ModelHeader, listed: &[Listed]) -> Detected {
    let has = |prefixes: &[&str]| {
        listed.iter().any(|tensor| prefixes.iter().any(|prefix| tensor.name.starts_with(prefix)))
    };
    let parts = Parts {
        vae: has(&["vae."]),
        denoiser: has(&["denoiser.denoiser."]),
        control: has(&["controlnet.", "denoiser.pose_encoder.", "estimate.space."]),
        control_2d: has(&["traj_encoder_2d.", "denoiser.pose_encoder_2d.", "estimate.plane."]),
    };
    Detected { kind: ModelKind::Own, sizes: header.sizes.clone(), parts }
}

/// What a name of a file is called by us; `None` for tensors that we have no use for.
pub(super) fn own_name(kind: ModelKind, name: &str) -> Option<String> {
    match kind {
        ModelKind::Sketch2Anim | ModelKind::Own => Some(name.to_owned()),
        // The base denoiser stands alone there. What controls it is of another make.
        ModelKind::Mld | ModelKind::MotionLcm => match name.strip_prefix("denoiser.") {
            Some(rest) => Some(format!("denoiser.denoiser.{rest}")),
            None => name.starts_with("vae.").then(|| name.to_owned()),
        },
        ModelKind::Vae => name.starts_with("vae.").then(|| name.to_owned()),
    }
}

/// The network that a tensor belongs to, by its name.
pub(super) fn network(name: &str) -> &'static str {
    const NETWORKS: [&str; 15] = [
        "vae",
        "denoiser.denoiser",
        "denoiser.pose_encoder",
        "denoiser.pose_encoder_2d",
        "denoiser",
        "controlnet",
        "traj_encoder",
        "traj_encoder_2d",
        "t2m_moveencoder",
        "t2m_motionencoder",
        "t2m_textencoder",
        "text_encoder",
        "estimate",
        "text",
        "examples",
    ];
    let is = |network: &&&str| name.strip_prefix(**network).is_some_and(|rest| rest.starts_with('.'));
    NETWORKS.iter().find(is).copied().unwrap_or("others")
}

/// Whether a tensor is one of the networks that measure motions.
pub(super) fn is_evaluator(name: &str) -> bool {
    name.starts_with("t2m_")
}

/// Whether a tensor of ours is no network's: vectors of verbs, motions to begin with.
pub(super) fn is_table(name: &str) -> bool {
    [VerbTable::VERBS, VerbTable::NOTHING, Examples::LATENTS, Examples::VERBS].contains(&name)
}

struct Names<'a>(BTreeMap<&'a str, &'a [usize]>);

impl Names<'_> {
    fn any(&self, prefix: &str) -> bool {
        self.0.range(prefix..).next().is_some_and(|(name, _)| name.starts_with(prefix))
    }

    fn axis(&self, name: &str, axis: usize) -> Option<usize> {
        self.0.get(name)?.get(axis).copied()
    }

    /// How many numbers follow a prefix, counted from 0.
    fn count(&self, prefix: &str) -> usize {
        (0..64).take_while(|at| self.any(&format!("{prefix}{at}."))).count()
    }

    /// Blocks of a stack with skips; `None` where it has no middle.
    fn stack(&self, prefix: &str) -> Option<usize> {
        self.any(&format!("{prefix}.middle_block."))
            .then(|| 2 * self.count(&format!("{prefix}.input_blocks.")) + 1)
    }
}
