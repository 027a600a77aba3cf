//! The clips of a split, as stages of training see them.

use crate::TrainError;
use crate::corpus::{Manifest, Split};
use inkrig_generate::text::VERBS;
use inkrig_motion::humanml::{Statistics, WIDTH};
use std::collections::HashMap;

/// A clip, or its mirror image.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    /// Frames x 263 normalised numbers.
    pub rows: Vec<f32>,
    /// What is done in it, as places in the list of verbs.
    pub verbs: Vec<usize>,
    /// Frames worth a key pose.
    pub key_poses: Vec<usize>,
    /// How often a second of it is taken; 1 where all are alike.
    pub weight: f64,
}

impl Motion {
    pub(super) fn frames(&self) -> usize {
        self.rows.len() / WIDTH
    }
}

/// Reads a split. `balance` from 0 to 1: 0 takes every second of motion as often, 1 every action.
pub(super) fn read(
    manifest: &Manifest,
    split: Split,
    statistics: &Statistics,
    mirrored: bool,
    balance: f64,
) -> Result<Vec<Motion>, TrainError> {
    let mut by_action: HashMap<&str, f64> = HashMap::new();
    let own = || manifest.entries().iter().filter(|entry| entry.split == split);
    for entry in own() {
        for action in &entry.actions {
            *by_action.entry(action).or_default() += entry.frames as f64;
        }
    }
    let all: f64 = own().map(|entry| entry.frames as f64).sum();
    let mut motions = Vec::new();
    for (path, entries) in manifest.parts(split) {
        let part = Manifest::read_part(&path, entries)?;
        for entry in entries {
            let rarest = entry.actions.iter().filter_map(|action| by_action.get(action.as_str())).copied();
            let common = rarest.fold(all, f64::min).max(1.0) / all;
            let place = |action: &String| VERBS.iter().position(|verb| verb.name == action);
            let verbs: Vec<usize> = entry.actions.iter().filter_map(place).collect();
            let Some(clip) = part.clips.get(entry.index) else { continue };
            let tables = [Some(&clip.prepared.features), mirrored.then_some(&clip.prepared.mirrored)];
            for table in tables.into_iter().flatten() {
                let mut rows = table.as_slice().to_vec();
                statistics.normalise(&mut rows);
                motions.push(Motion {
                    rows,
                    verbs: verbs.clone(),
                    key_poses: clip.prepared.key_poses.clone(),
                    weight: common.powf(-balance),
                });
            }
        }
    }
    if motions.is_empty() {
        let what = format!("the corpus has no clips of the split `{}`", split.name());
        return Err(TrainError::Device(what));
    }
    Ok(motions)
}
