//! The linear path of the autoencoder, worked out of the corpus: principal components of clips' cosines.
//!
//! Components are those of where joints are, so that what is left out is left out of the picture and not of some number; the
//! matrix back is the regression of all features on them. Noise is spread as rate-distortion theory has it (Cover and
//! Thomas, "reverse water-filling"): every component gets the same amount, one that is smaller than that becomes noise alone,
//! and each number of the latent has variance 1.

use super::windows::Windows;
use crate::TrainError;
use inkrig_generate::networks::{Sizes, spectrum};
use inkrig_generate::schedule::Noise;
use inkrig_generate::weights::{Tensor, Tensors};
use inkrig_motion::humanml::{JOINTS, Statistics, WIDTH};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use std::f64::consts::PI;

/// Windows that components are worked out of, at most.
const WINDOWS: usize = 12_288;
/// Windows at a time.
const CHUNK: usize = 512;
/// The features that say where joints are: turn, velocity and height of the root, then joints relative to it.
const PLACED: usize = 4 + 3 * (JOINTS - 1);
/// Metres that a radian of the body's turn moves a joint, about: part by its distance, part as the path turns along.
const LEVER: f64 = 0.6;
/// What is asked of a path.
#[derive(Debug, Clone, Copy)]
pub(super) struct PathOptions {
    /// Frames of most windows.
    pub frames: usize,
    /// Share of the windows that are as long as `shortest` to `longest`.
    pub other_lengths: f64,
    pub shortest: usize,
    pub longest: usize,
    /// Deviation of the noise on a component: metres, the root of the sum over joints of the mean square.
    pub noise: f64,
    pub seed: u64,
}

/// The tensors of the path.
pub(super) fn linear_path(
    windows: &Windows,
    statistics: &Statistics,
    sizes: &Sizes,
    options: &PathOptions,
) -> Result<Tensors, TrainError> {
    let (cosines, latent) = (sizes.cosines, sizes.latent_tokens * sizes.width);
    let weights = weights(cosines, options.frames, statistics);
    let wide = weights.len();
    let mut mean = DVector::zeros(cosines * WIDTH);
    let mut squares = DMatrix::zeros(wide, wide);
    let chunks = (4 * windows.frames() / options.frames.max(1)).clamp(1, WINDOWS).div_ceil(CHUNK);
    for spectra in spectra(windows, cosines, options, chunks) {
        mean += spectra.row_sum().transpose();
        let placed = placed(&spectra, &weights);
        squares.gemm_tr(1.0, &placed, &placed, 1.0);
    }
    let count = (chunks * CHUNK) as f64;
    mean /= count;
    let of_placed = placed(&DMatrix::from_row_slice(1, mean.len(), mean.as_slice()), &weights).transpose();
    let covariance = squares / count - &of_placed * of_placed.transpose();
    let components = SymmetricEigen::new(covariance);
    let mut order: Vec<usize> = (0..wide).collect();
    order.sort_by(|&a, &b| components.eigenvalues[b].total_cmp(&components.eigenvalues[a]));

    // From weighted cosines to components of deviation 1, then to the latent.
    let mut encoder = DMatrix::zeros(latent, wide);
    let mut noise = vec![1.0_f64; latent];
    let least = components.eigenvalues.max() * 1e-12 + f64::MIN_POSITIVE;
    for (at, &component) in order.iter().take(latent).enumerate() {
        let variance = components.eigenvalues[component].max(least);
        noise[at] = (options.noise * options.noise / variance).min(1.0);
        let scale = ((1.0 - noise[at]) / variance).sqrt();
        let direction = components.eigenvectors.column(component);
        // Which of the two directions is the solver's choice; ours is the same on every machine.
        let sign = if direction[direction.iamax()] < 0.0 { -scale } else { scale };
        encoder.row_mut(at).copy_from(&(direction.transpose() * sign));
    }
    // The best linear guess of the features from noisy components: what they have in common with them, as the variance is 1.
    let mut decoder = DMatrix::zeros(cosines * WIDTH, latent);
    for mut spectra in spectra(windows, cosines, options, chunks) {
        for mut row in spectra.row_iter_mut() {
            row -= mean.transpose();
        }
        let latents = placed(&spectra, &weights) * encoder.transpose();
        decoder.gemm_tr(1.0 / count, &spectra, &latents, 1.0);
    }

    let bias = -(&encoder * &of_placed);
    let mut whole = vec![0.0; latent * cosines * WIDTH];
    for row in 0..latent {
        for (at, weight) in weights.iter().enumerate() {
            let (wave, feature) = (at / PLACED, at % PLACED);
            whole[(row * cosines + wave) * WIDTH + feature] = (encoder[(row, at)] * weight) as f32;
        }
    }
    let single = |numbers: &[f64]| numbers.iter().map(|x| *x as f32).collect::<Vec<f32>>();
    let back = decoder.transpose();
    let least = f64::from(f32::EPSILON);
    let log_variance: Vec<f64> = noise.iter().map(|noise| noise.max(least).ln()).collect();
    let tensors = [
        ("encoder.weight", vec![latent, cosines * WIDTH], whole),
        ("encoder.bias", vec![latent], single(bias.as_slice())),
        ("decoder.weight", vec![cosines * WIDTH, latent], single(back.as_slice())),
        ("decoder.bias", vec![cosines * WIDTH], single(mean.as_slice())),
        ("log_variance", vec![latent], single(&log_variance)),
    ];
    let tensor = |(name, shape, data)| {
        let tensor = Tensor::new(shape, data).map_err(|error| TrainError::Device(error.to_string()))?;
        Ok((format!("vae.linear_path.{name}"), tensor))
    };
    tensors.into_iter().map(tensor).collect()
}

/// How many metres (the root of the sum of squares over all joints) a unit of a wave of a feature moves the body, in the mean over
/// the clip; cosines x [`PLACED`]. Velocities add up over the clip.
fn weights(cosines: usize, frames: usize, statistics: &Statistics) -> Vec<f64> {
    let mut weights = Vec::with_capacity(cosines * PLACED);
    let all = (JOINTS as f64).sqrt();
    for wave in 0..cosines {
        let frames = frames as f64;
        let (mean_square, summed) = match wave {
            0 => (1.0, frames / 3.0_f64.sqrt()),
            _ => (0.5, frames / (PI * wave as f64)),
        };
        for (feature, deviation) in statistics.deviation().iter().take(PLACED).enumerate() {
            let moved = match feature {
                // Half the angle is what is stored.
                0 => 2.0 * LEVER * summed * all,
                1 | 2 => summed * all,
                3 => all,
                _ => 1.0,
            };
            weights.push(f64::from(*deviation) * moved * f64::sqrt(mean_square));
        }
    }
    weights
}

/// Spectra of drawn windows, some at a time; always the same ones.
fn spectra<'a>(
    windows: &'a Windows,
    cosines: usize,
    options: &PathOptions,
    chunks: usize,
) -> impl Iterator<Item = DMatrix<f64>> + 'a {
    let options = *options;
    let mut noise = Noise::new(options.seed);
    (0..chunks).map(move |_| {
        let other = noise.uniform() < options.other_lengths;
        let span = (options.longest - options.shortest + 1) as f64;
        let drawn = options.shortest + (noise.uniform() * span) as usize;
        let batch = windows.draw(CHUNK, if other { drawn } else { options.frames }, &mut noise);
        let mut rows = Vec::with_capacity(CHUNK * cosines * WIDTH);
        for (clip, frames) in batch.features.chunks_exact(batch.frames * WIDTH).zip(&batch.lengths) {
            let clip = clip.get(..frames * WIDTH).unwrap_or_default();
            rows.extend(spectrum(clip, cosines).into_iter().map(f64::from));
        }
        DMatrix::from_row_slice(CHUNK, cosines * WIDTH, &rows)
    })
}

/// The waves of features that say where joints are, weighted: a row a clip.
fn placed(spectra: &DMatrix<f64>, weights: &[f64]) -> DMatrix<f64> {
    let column = |at: usize| at / PLACED * WIDTH + at % PLACED;
    DMatrix::from_fn(spectra.nrows(), weights.len(), |row, at| spectra[(row, column(at))] * weights[at])
}
