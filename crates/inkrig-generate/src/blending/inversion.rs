//! Blending by inversion: two clips with a straight transition become noise step by step, and again motion, guided so that
//! what was not transition stays (Sec. 6 and D).

use super::joining::linear;
use super::origin::{Origin, joints, normalised};
use crate::GenerateError;
use crate::guidance::{Ask, GuidanceOptions, Guided, Mean, Target, View};
use crate::networks::{Decoding, Domain, Noisy, Work};
use crate::sampling::{Conditions, Sampler, SamplingOptions, Semantics, Steps};
use crate::schedule::Ddim;
use inkrig_motion::humanml::Joints;

/// How two clips are blended.
#[derive(Debug, Clone, PartialEq)]
pub struct BlendOptions {
    /// Frames of the transition.
    pub transition: usize,
    /// Steps, each way.
    pub steps: usize,
    /// How much more the text counts than nothing does, on the way back.
    pub text_weight: f32,
    /// How the clips are held; `None` leaves them to the network.
    pub guidance: Option<GuidanceOptions>,
    /// Guidance at every so many steps, the last among them.
    pub guide_every: usize,
}

impl Default for BlendOptions {
    /// The paper's twenty frames and four iterations, at every fifth step.
    fn default() -> Self {
        let guidance = GuidanceOptions { mean: Mean::Asked, step_early: false, ..GuidanceOptions::default() };
        Self { transition: 20, steps: 50, text_weight: 7.5, guidance: Some(guidance), guide_every: 5 }
    }
}

/// Two clips as one.
#[derive(Debug, Clone, PartialEq)]
pub struct Blended {
    /// As many frames as both have; where the first was.
    pub motion: Vec<Joints>,
    /// Frames of the transition.
    pub transition: std::ops::Range<usize>,
    /// What guidance did, step by step.
    pub guided: Vec<Guided>,
}

/// Blends a clip into the next, which is turned and moved to where the first ends. `text` says what both do. The model
/// has to be one that can go back: not a distilled one.
///
/// # Errors
/// When a clip is not longer than the transition, both are longer than the model's tables, or numbers do not fit.
pub fn blend(
    sampler: &Sampler<'_>,
    text: &[f32],
    first: &[Joints],
    second: &[Joints],
    options: &BlendOptions,
) -> Result<Blended, GenerateError> {
    let joined = linear(first, second, options.transition)?;
    let start = first.len() - options.transition / 2;
    let transition = start..start + options.transition;
    let origin = Origin::of(&joined[0]);
    let local = origin.local(&joined);
    let rows = normalised(&local, sampler.features)?;
    let frames = local.len() - 1;
    let vae = &sampler.networks.vae;
    let mut latents = vae.encode(&rows)?.mean;
    invert(sampler, text, &mut latents, options.steps)?;

    let kept = (0..frames).filter(|frame| !transition.contains(frame));
    let asks = kept.flat_map(|frame| {
        local[frame].iter().enumerate().map(move |(joint, &place)| Ask { frame, joint, place })
    });
    let target = Target { view: View::Space, asks: asks.collect(), depths: Vec::new() };
    let conditions = Conditions::from_tables(frames, text.to_vec(), Domain::Space, Vec::new(), None, target)?;
    let sampling = SamplingOptions {
        steps: Steps::Ddim(options.steps),
        text_weight: options.text_weight,
        semantics: Semantics::Paper,
        guidance: options.guidance.clone(),
        guide_every: options.guide_every,
        settle: None,
        from: None,
    };
    let sampled = sampler.run(&[conditions], &sampling, latents, |_| Vec::new(), |_| {})?;
    let mut decoding = Decoding::default();
    vae.decode(&sampled.latents, &[frames], &mut decoding)?;
    let mut motion = origin.world(&joints(decoding.features().to_vec(), sampler.features)?);
    // Features say how a frame goes on, so the last pose is one more than there are rows.
    motion.extend(joined.last());
    Ok(Blended { motion, transition, guided: sampled.guided })
}

/// From a latent to the noise that would have become it.
fn invert(
    sampler: &Sampler<'_>,
    text: &[f32],
    latents: &mut [f32],
    steps: usize,
) -> Result<(), GenerateError> {
    let ddim = Ddim::new(steps)?;
    let mut work = Work::default();
    for timestep in ddim.timesteps().into_iter().rev() {
        let noisy = Noisy { latents, timesteps: &[timestep], texts: text, guidance: None };
        let noise = sampler.networks.denoiser.noise(&noisy, None, &mut work)?;
        ddim.invert(latents, &noise, timestep);
    }
    Ok(())
}
