//! How well a clip survives the autoencoder.

use super::windows::Windows;
use crate::TrainError;
use inkrig_generate::networks::{Decoding, Vae};
use inkrig_motion::Features;
use inkrig_motion::humanml::{Statistics, WIDTH, recover_positions};
use serde::{Deserialize, Serialize};

/// Mean distance of joints between clips and what comes back of them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reconstruction {
    /// Frames of a window.
    pub frames: usize,
    /// How many windows.
    pub windows: usize,
    /// In the world, millimetres.
    pub global_mm: f64,
    /// With the pelvis at its place, millimetres.
    pub aligned_mm: f64,
}

/// Encodes and decodes windows of `frames` frames, at most `most`, by the mean of the latent.
///
/// # Errors
/// When a window is longer than the network takes.
pub fn reconstruction(
    vae: &Vae,
    windows: &Windows,
    statistics: &Statistics,
    frames: usize,
    most: usize,
) -> Result<Reconstruction, TrainError> {
    let network = |error: inkrig_generate::GenerateError| TrainError::Device(error.to_string());
    let places = |numbers: &[f32]| {
        let mut numbers = numbers.to_vec();
        statistics.restore(&mut numbers);
        let table = Features::new(numbers, WIDTH).and_then(|table| recover_positions(&table));
        table.map_err(|error| TrainError::Device(error.to_string()))
    };
    let (mut global, mut aligned, mut count) = (0.0_f64, 0.0_f64, 0_usize);
    let mut work = Decoding::default();
    let chosen = windows.spread(frames, most);
    for window in &chosen {
        let encoded = vae.encode(window).map_err(network)?;
        vae.decode(&encoded.mean, &[frames], &mut work).map_err(network)?;
        for (own, back) in places(window)?.iter().zip(places(work.features())?) {
            for (a, b) in own.iter().zip(&back) {
                global += f64::from(a.distance(*b));
                aligned += f64::from((*a - own[0]).distance(*b - back[0]));
                count += 1;
            }
        }
    }
    let mean = |sum: f64| 1000.0 * sum / count.max(1) as f64;
    Ok(Reconstruction { frames, windows: chosen.len(), global_mm: mean(global), aligned_mm: mean(aligned) })
}
