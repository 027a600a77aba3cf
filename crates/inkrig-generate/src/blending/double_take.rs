//! A mask instead of inversion, for comparison, after DoubleTake (Shafir et al. 2023). That method works on frames; a
//! latent of few tokens has none, so at every step the clip is decoded, mixed with what shall stay, and encoded again.

use super::joining::placed_after;
use super::origin::{Origin, joints, normalised};
use crate::GenerateError;
use crate::networks::{Decoding, Noisy, Work};
use crate::sampling::Sampler;
use crate::schedule::{Ddim, Noise};
use inkrig_motion::humanml::{Joints, WIDTH};

/// What the second take is made with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DoubleTakeOptions {
    /// Frames that both clips share.
    pub handshake: usize,
    /// Frames on each side of them that are held less and less.
    pub fade: usize,
    /// Steps of denoising.
    pub steps: usize,
    /// Of the noise that it begins with.
    pub seed: u64,
}

impl Default for DoubleTakeOptions {
    /// As published.
    fn default() -> Self {
        Self { handshake: 20, fade: 10, steps: 50, seed: 0 }
    }
}

/// How much of a clip is held next to the frames that are made anew.
const HELD: f32 = 0.85;

/// Two clips that overlap by the handshake, made anew there.
///
/// # Errors
/// When a clip is not longer than the handshake, both are longer than the model's tables, or numbers do not fit.
pub fn double_take(
    sampler: &Sampler<'_>,
    first: &[Joints],
    second: &[Joints],
    options: &DoubleTakeOptions,
) -> Result<Vec<Joints>, GenerateError> {
    let overlap = options.handshake;
    if first.len() <= overlap || second.len() <= overlap {
        let (setting, value) = ("the handshake", format!("{overlap} frames"));
        return Err(GenerateError::Setting { setting, value, needed: "shorter than both clips" });
    }
    let start = first.len() - overlap;
    let joined = shaken(first, second, start);
    let origin = Origin::of(&joined[0]);
    let held = normalised(&origin.local(&joined), sampler.features)?;
    let frames = held.len() / WIDTH;
    let shares: Vec<f32> = (0..frames).map(|frame| share(frame, start, overlap, options.fade)).collect();
    let mix = |rows: &[f32]| -> Vec<f32> {
        let each = rows.chunks_exact(WIDTH).zip(held.chunks_exact(WIDTH)).zip(&shares);
        each.flat_map(|((row, held), share)| {
            row.iter().zip(held).map(move |(x, held)| x + share * (held - x))
        })
        .collect()
    };
    let networks = sampler.networks;
    let ddim = Ddim::new(options.steps)?;
    let mut latents = Noise::new(options.seed).normals(networks.vae.latent_width());
    let (mut clean, mut work, mut decoding) = (latents.clone(), Work::default(), Decoding::default());
    for timestep in ddim.timesteps() {
        let noisy =
            Noisy { latents: &latents, timesteps: &[timestep], texts: sampler.no_text, guidance: None };
        let mut noise = networks.denoiser.noise(&noisy, None, &mut work)?;
        ddim.schedule().clean(&latents, &noise, timestep, &mut clean);
        networks.vae.decode(&clean, &[frames], &mut decoding)?;
        let mixed = networks.vae.encode(&mix(decoding.features()))?.mean;
        let alpha = ddim.schedule().alpha(timestep);
        for ((noise, latent), mixed) in noise.iter_mut().zip(&latents).zip(&mixed) {
            *noise = (latent - alpha.sqrt() * mixed) / (1.0 - alpha).sqrt();
        }
        ddim.step(&mut latents, &noise, timestep);
    }
    networks.vae.decode(&latents, &[frames], &mut decoding)?;
    let mut motion = origin.world(&joints(mix(decoding.features()), sampler.features)?);
    motion.extend(joined.last());
    Ok(motion)
}

/// The second clip's beginning fades in over the first one's end.
fn shaken(first: &[Joints], second: &[Joints], start: usize) -> Vec<Joints> {
    let second = placed_after(&first[..=start], second);
    let overlap = first.len() - start;
    let fade = first[start..].iter().zip(&second).enumerate().map(|(at, (a, b))| {
        let share = at as f32 / overlap as f32;
        std::array::from_fn(|joint| a[joint].lerp(b[joint], share))
    });
    first[..start].iter().copied().chain(fade).chain(second[overlap..].iter().copied()).collect()
}

/// How much of a frame stays.
fn share(frame: usize, start: usize, overlap: usize, fade: usize) -> f32 {
    let away = start.saturating_sub(frame).max((frame + 1).saturating_sub(start + overlap));
    if away > fade { 1.0 } else { HELD * away as f32 / (fade + 1) as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_handshake_is_free_and_clips_are_held_more_the_farther_from_it() {
        let shares: Vec<f32> = (0..60).map(|frame| share(frame, 20, 20, 10)).collect();
        assert!(shares[20..40].iter().all(|share| *share == 0.0));
        assert!(shares[..10].iter().chain(&shares[50..]).all(|share| *share == 1.0));
        assert!(shares[9..20].windows(2).all(|pair| pair[0] > pair[1]));
        assert!(shares[40..51].windows(2).all(|pair| pair[0] < pair[1]));
    }
}
