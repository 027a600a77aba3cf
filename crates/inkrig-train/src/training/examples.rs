//! Which motions of a corpus a model is given to begin with.

use super::latents::{Cut, Latents, windows};
use super::motions::{self, Selection};
use super::stage::network;
use crate::TrainError;
use crate::corpus::{Manifest, Split};
use inkrig_generate::checkpoint::ModelHeader;
use inkrig_generate::networks::{Denoiser, Noisy, Vae, Work};
use inkrig_generate::sampling::Examples;
use inkrig_generate::schedule::{Noise, NoiseSchedule};
use inkrig_generate::text::{VERBS, VerbTable};
use inkrig_generate::weights::Tensors;
use inkrig_motion::humanml::{Statistics, WIDTH};
use std::path::Path;

/// Examples of a verb.
const EACH: usize = 8;
/// The most windows of a verb that are looked at.
const MOST: usize = 256;
/// Of those, the share that the verb says most about.
const BEST: f64 = 0.25;
/// Steps of training at which that is measured.
const TIMESTEPS: [usize; 4] = [300, 500, 700, 850];
/// Frames of a window, and from one to the next.
const FRAMES: usize = 40;
const STRIDE: usize = 10;
/// Verbs that take a body forward, and those that turn it. Whoever asks for a run wants no run backwards, nor the standing before one, though both are
/// called so in descriptions.
const GOING: [&str; 8] = ["walk", "run", "jog", "skip", "crawl", "sneak", "march", "limp"];
const TURNING: [&str; 2] = ["turn", "spin"];
/// Of the way or the turn that the farthest tenth of a verb's windows come to, how much an example has at least.
const FAR: f64 = 0.75;
/// A turn has at least this, radians.
const LEAST_TURN: f64 = 0.8;

/// Latents of a few windows of each verb, as tensors of the model: of the windows that show it (a run goes forward, a turn turns) and that the
/// denoiser tells best with the verb's help (a clip of jumps begins with standing), of the usual half those that differ most.
///
/// # Errors
/// When the corpus cannot be read, or the model has not the networks.
pub fn examples(corpus: &Path, header: &ModelHeader, weights: &Tensors) -> Result<Tensors, TrainError> {
    let of = |error: inkrig_generate::GenerateError| TrainError::Device(error.to_string());
    let vae = Vae::new(&header.sizes, weights).map_err(of)?;
    let denoiser = Denoiser::new(&header.sizes, weights).map_err(of)?;
    let verbs = VerbTable::new(weights, header.sizes.text_width).map_err(of)?;
    let (features, _) = header.statistics().map_err(|error| TrainError::Device(error.to_string()))?;
    let manifest = Manifest::read(corpus)?;
    let motions = motions::read(&manifest, Split::Train, &features, Selection::both_sides(0.0))?;
    let cut = Cut { frames: FRAMES, stride: STRIDE, other_lengths: 0.0, shortest: FRAMES, longest: FRAMES };
    let windows = windows(&motions, cut.checked(&header.sizes)?, 0);
    let latents = Latents::encode(&vae, &motions, &windows, rayon::current_num_threads())?;
    let ways: Vec<Way> = windows.iter().map(|window| Way::of(window.rows(&motions), &features)).collect();
    let (mut chosen, mut places) = (Vec::new(), Vec::new());
    for verb in 0..VERBS.len() {
        // Clips of nothing else, where there are enough: a run that ends in a roll is no example of a run.
        let of = |fits: &dyn Fn(&[usize]) -> bool| -> Vec<usize> {
            (0..latents.len()).filter(|&window| fits(latents.verbs(window))).collect()
        };
        let alone = of(&|verbs| *verbs == [verb]);
        let mut own = shown(verb, alone.clone(), &ways);
        if alone.len() < 4 * EACH || own.len() < EACH {
            own = shown(verb, of(&|verbs| verbs.contains(&verb)), &ways);
        }
        let every = own.len().div_ceil(MOST).max(1);
        let texts = [verbs.row(Some(verb)), verbs.row(None)];
        let mut told = Vec::new();
        for &window in own.iter().step_by(every) {
            told.push((told_by(&denoiser, latents.mean(window), texts).map_err(network)?, window));
        }
        told.sort_by(|a, b| b.0.total_cmp(&a.0));
        told.truncate(((BEST * told.len() as f64) as usize).max(EACH));
        let mut best: Vec<&[f32]> = told.iter().map(|(_, window)| latents.mean(*window)).collect();
        usual(&mut best);
        for at in apart(&best, EACH) {
            chosen.extend_from_slice(best[at]);
            places.push(verb);
        }
    }
    Examples::tensors(chosen, &places).map_err(network)
}

/// Where a window's body comes to.
#[derive(Debug, Clone, Copy)]
struct Way {
    /// As it faces, forward, metres.
    forward: f64,
    /// About the vertical, either way, radians.
    turn: f64,
}

impl Way {
    /// Of rows as the networks see them.
    fn of(rows: &[f32], features: &Statistics) -> Self {
        let mut rows = rows.to_vec();
        features.restore(&mut rows);
        // Each row has half the angle to the next, and the way there, x and z of where the body faces.
        let sum = |column: usize| {
            rows.chunks_exact(WIDTH).filter_map(|row| row.get(column)).map(|x| f64::from(*x)).sum::<f64>()
        };
        Self { forward: sum(2), turn: 2.0 * sum(0).abs() }
    }
}

/// Of a verb's windows those that do what it says, as far as that can be told from where they come to.
fn shown(verb: usize, windows: Vec<usize>, ways: &[Way]) -> Vec<usize> {
    let name = VERBS.get(verb).map_or("", |verb| verb.name);
    let far = |window: usize| match ways.get(window) {
        Some(way) if GOING.contains(&name) => Some((way.forward, 0.0)),
        Some(way) if TURNING.contains(&name) => Some((way.turn, LEAST_TURN)),
        _ => None,
    };
    let mut all: Vec<f64> = windows.iter().filter_map(|&window| far(window)).map(|(far, _)| far).collect();
    all.sort_by(f64::total_cmp);
    let most = all.get(all.len() * 9 / 10).copied().unwrap_or(0.0);
    let shows = |window: &usize| far(*window).is_none_or(|(far, least)| far >= (FAR * most).max(least));
    windows.into_iter().filter(shows).collect()
}

/// By how much a text lessens the error of what is predicted, in the mean over timesteps.
fn told_by(
    denoiser: &Denoiser,
    latent: &[f32],
    texts: [&[f32]; 2],
) -> Result<f64, inkrig_generate::GenerateError> {
    let (schedule, mut draw) = (NoiseSchedule::default(), Noise::new(1));
    let (mut noisy, mut noises) = (Vec::new(), Vec::new());
    for timestep in TIMESTEPS {
        let noise = draw.normals(latent.len());
        let mut own = latent.to_vec();
        schedule.add_noise(&mut own, &noise, timestep);
        noisy.extend(own);
        noises.extend(noise);
    }
    let mut errors = [0.0, 0.0];
    for (error, text) in errors.iter_mut().zip(texts) {
        let texts = text.repeat(TIMESTEPS.len());
        let noisy = Noisy { latents: &noisy, timesteps: &TIMESTEPS, texts: &texts, guidance: None };
        let predicted = denoiser.noise(&noisy, None, &mut Work::default())?;
        let rows = predicted.chunks_exact(latent.len()).zip(noises.chunks_exact(latent.len()));
        for ((predicted, noise), timestep) in rows.zip(TIMESTEPS) {
            let apart: f64 = predicted.iter().zip(noise).map(|(a, b)| f64::from((a - b) * (a - b))).sum();
            *error += apart * f64::from(denoiser.loss_weight(timestep));
        }
    }
    Ok(errors[1] - errors[0])
}

/// Leaves the half that is nearest to the mean of all, but no fewer than are chosen.
fn usual(rows: &mut Vec<&[f32]>) {
    let count = rows.len().max(1) as f32;
    let mut mean = vec![0.0; rows.first().map_or(0, |row| row.len())];
    for row in rows.iter() {
        mean.iter_mut().zip(*row).for_each(|(mean, x)| *mean += x / count);
    }
    let off = |row: &&[f32]| -> f32 { row.iter().zip(&mean).map(|(a, b)| (a - b) * (a - b)).sum() };
    rows.sort_by(|a, b| off(a).total_cmp(&off(b)));
    rows.truncate((rows.len() / 2).max(EACH));
}

/// Places of so many rows that are far from each other: the first, then always the one that is farthest from those that are chosen.
fn apart(rows: &[&[f32]], count: usize) -> Vec<usize> {
    let mut nearest = vec![f64::INFINITY; rows.len()];
    let mut chosen = Vec::new();
    let mut next = (!rows.is_empty()).then_some(0);
    while let Some(at) = next.filter(|_| chosen.len() < count) {
        chosen.push(at);
        for (nearest, row) in nearest.iter_mut().zip(rows) {
            let square: f64 = row.iter().zip(rows[at]).map(|(a, b)| f64::from((a - b) * (a - b))).sum();
            *nearest = nearest.min(square);
        }
        let far = nearest.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        next = far.filter(|(_, far)| **far > 0.0).map(|(at, _)| at);
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_goes_forward_and_a_turn_turns() {
        let verb = |name: &str| VERBS.iter().position(|verb| verb.name == name).unwrap();
        let way = |forward, turn| Way { forward, turn };
        let ways =
            [way(2.0, 0.0), way(-5.0, 0.1), way(3.0, 0.2), way(0.1, 1.5), way(1.6, 0.0), way(2.4, 0.7)];
        let of = |name| shown(verb(name), (0..ways.len()).collect(), &ways);
        assert_eq!(of("run"), [2, 5]);
        assert_eq!(of("turn"), [3]);
        assert_eq!(of("kick"), [0, 1, 2, 3, 4, 5], "how far one goes says nothing of a kick");
        assert!(shown(verb("turn"), vec![0, 1, 4], &ways).is_empty(), "none of them turns");
        let features = Statistics::new(vec![0.01; WIDTH], vec![2.0; WIDTH]).unwrap();
        let mut rows = vec![0.0; 3 * WIDTH];
        rows[2] = 0.5;
        rows[WIDTH] = -0.25;
        let way = Way::of(&rows, &features);
        assert!((way.forward - 1.03).abs() < 1e-6 && (way.turn - 0.94).abs() < 1e-6, "{way:?}");
    }

    #[test]
    fn what_is_chosen_is_far_apart() {
        let rows: [&[f32]; 5] = [&[0.0], &[0.1], &[5.0], &[5.0], &[2.0]];
        assert_eq!(apart(&rows, 3), [0, 3, 4]);
        assert_eq!(apart(&rows, 9).len(), 4, "the same is not taken twice");
        assert!(apart(&[], 3).is_empty());
        let numbers: Vec<[f32; 1]> = (0..40).map(|x| [if x == 7 { 90.0 } else { x as f32 }]).collect();
        let mut rows: Vec<&[f32]> = numbers.iter().map(|row| &row[..]).collect();
        usual(&mut rows);
        assert_eq!(rows.len(), 20);
        assert!(rows.iter().all(|row| row[0] > 8.0 && row[0] < 35.0), "{rows:?}");
    }
}
