//! How well clips survive the autoencoder, subject by subject.

use super::windows::EvaluationWindow;
use crate::TrainError;
use inkrig_generate::networks::{Decoding, Vae};
use inkrig_motion::Features;
use inkrig_motion::humanml::{Statistics, WIDTH, recover_positions};
use serde::Serialize;
use std::collections::BTreeMap;

/// Mean distance of joints between clips and what comes back of them by the mean of their latent.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReconstructionRow {
    /// Source and subject; `all` for the first row.
    pub name: String,
    /// How many windows.
    pub windows: usize,
    /// In the world, millimetres.
    pub global_mm: f64,
    /// With the pelvis at its place, millimetres.
    pub aligned_mm: f64,
}

/// A row for all windows, and one for every subject.
///
/// # Errors
/// When a window is longer than the network takes.
pub fn reconstruction(
    vae: &Vae,
    features: &Statistics,
    windows: &[EvaluationWindow],
) -> Result<Vec<ReconstructionRow>, TrainError> {
    let mut by_subject: BTreeMap<String, (usize, [f64; 2])> = BTreeMap::new();
    let mut all = (0, [0.0; 2]);
    let mut work = Decoding::default();
    for window in windows {
        let mut rows = window.features.clone();
        features.normalise(&mut rows);
        let encoded = vae.encode(&rows)?;
        vae.decode(&encoded.mean, &[window.joints.len()], &mut work)?;
        let mut back = work.features().to_vec();
        features.restore(&mut back);
        let back = recover_positions(&Features::new(back, WIDTH)?)?;
        let mut sums = [0.0; 2];
        for (own, back) in window.joints.iter().zip(&back) {
            for (a, b) in own.iter().zip(back) {
                sums[0] += f64::from(a.distance(*b));
                sums[1] += f64::from((*a - own[0]).distance(*b - back[0]));
            }
        }
        let counted = (window.joints.len() * window.joints.first().map_or(1, |joints| joints.len())) as f64;
        let name = format!("{} {}", window.source, window.subject);
        for (count, total) in [&mut all, by_subject.entry(name).or_default()] {
            *count += 1;
            total.iter_mut().zip(sums).for_each(|(total, sum)| *total += 1000.0 * sum / counted);
        }
    }
    let row = |(name, (windows, sums)): (String, (usize, [f64; 2]))| {
        let [global_mm, aligned_mm] = sums.map(|sum| sum / windows.max(1) as f64);
        ReconstructionRow { name, windows, global_mm, aligned_mm }
    };
    Ok(std::iter::once(("all".to_string(), all)).chain(by_subject).map(row).collect())
}
