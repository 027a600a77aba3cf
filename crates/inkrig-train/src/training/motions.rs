//! The clips of a split, as stages of training see them.

use super::retime::{retimed, speed};
use crate::TrainError;
use crate::corpus::{Manifest, Split};
use inkrig_generate::schedule::Noise;
use inkrig_generate::text::VERBS;
use inkrig_motion::Features;
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

/// What is taken of a split, and how often.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Selection {
    /// From 0 to 1: 0 takes every second of motion as often, 1 every action.
    pub balance: f64,
    /// Whether mirror images are among it.
    pub mirrored: bool,
    /// Share of clips, mirror images among them, of which there is a copy that is faster or slower, up to 1.3 times.
    pub retimed: f64,
    /// Of which copies there are.
    pub seed: u64,
}

impl Selection {
    /// Clips as they were captured, each second as often as any other.
    pub const PLAIN: Self = Self { balance: 0.0, mirrored: false, retimed: 0.0, seed: 0 };
}

/// Reads a split.
pub(super) fn read(
    manifest: &Manifest,
    split: Split,
    statistics: &Statistics,
    selection: Selection,
) -> Result<Vec<Motion>, TrainError> {
    let Selection { balance, mirrored, .. } = selection;
    let mut noise = Noise::new(selection.seed ^ 0x7265_7469_6d65);
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
            let mut take = |table: &Features, speed: f64| {
                let mut rows = table.as_slice().to_vec();
                statistics.normalise(&mut rows);
                let last = table.frames().saturating_sub(1);
                let moved = |&frame: &usize| ((frame as f64 / speed).round() as usize).min(last);
                motions.push(Motion {
                    rows,
                    verbs: verbs.clone(),
                    key_poses: clip.prepared.key_poses.iter().map(moved).collect(),
                    weight: common.powf(-balance),
                });
            };
            for table in tables.into_iter().flatten() {
                take(table, 1.0);
                if noise.uniform() < selection.retimed {
                    let speed = speed(&mut noise);
                    let other = retimed(table, speed).map_err(|cause| TrainError::Content {
                        path: path.clone(),
                        what: format!("clip {} at another speed: {cause}", entry.index + 1),
                    })?;
                    other.iter().for_each(|other| take(other, speed));
                }
            }
        }
    }
    if motions.is_empty() {
        let what = format!("the corpus has no clips of the split `{}`", split.name());
        return Err(TrainError::Device(what));
    }
    Ok(motions)
}
