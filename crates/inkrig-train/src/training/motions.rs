//! The clips of a split, as stages of training see them.

use super::retime::{retimed, speed};
use crate::TrainError;
use crate::corpus::{Manifest, Prepared, Split};
use inkrig_generate::schedule::Noise;
use inkrig_generate::text::VERBS;
use inkrig_motion::humanml::{Statistics, WIDTH};
use inkrig_motion::{Features, MotionError};
use std::borrow::Cow;
use std::collections::HashMap;

/// A clip, its mirror image, or either of them at another speed.
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

    /// With mirror images, at their own speed.
    pub(super) fn both_sides(balance: f64) -> Self {
        Self { balance, mirrored: true, ..Self::PLAIN }
    }
}

/// Reads a split.
pub(super) fn read(
    manifest: &Manifest,
    split: Split,
    statistics: &Statistics,
    selection: Selection,
) -> Result<Vec<Motion>, TrainError> {
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
            let of_clip = copies(&clip.prepared, &selection, &mut noise).map_err(|cause| {
                let what = format!("clip {} at another speed: {cause}", entry.index + 1);
                TrainError::Content { path: path.clone(), what }
            })?;
            motions.extend(of_clip.into_iter().map(|(table, speed)| {
                let mut rows = table.as_slice().to_vec();
                statistics.normalise(&mut rows);
                Motion {
                    rows,
                    verbs: verbs.clone(),
                    key_poses: at_speed(&clip.prepared.key_poses, speed, table.frames()),
                    weight: common.powf(-selection.balance),
                }
            }));
        }
    }
    if motions.is_empty() {
        let what = format!("the corpus has no clips of the split `{}`", split.name());
        return Err(TrainError::Device(what));
    }
    Ok(motions)
}

/// The tables that are taken of a clip, with their speeds.
fn copies<'a>(
    clip: &'a Prepared,
    selection: &Selection,
    noise: &mut Noise,
) -> Result<Vec<(Cow<'a, Features>, f64)>, MotionError> {
    let mut copies = Vec::new();
    for table in [Some(&clip.features), selection.mirrored.then_some(&clip.mirrored)].into_iter().flatten() {
        copies.push((Cow::Borrowed(table), 1.0));
        if noise.uniform() < selection.retimed {
            let speed = speed(noise);
            copies.extend(retimed(table, speed)?.map(|other| (Cow::Owned(other), speed)));
        }
    }
    Ok(copies)
}

/// Where frames come to lie in a table at another speed.
fn at_speed(frames: &[usize], speed: f64, count: usize) -> Vec<usize> {
    let moved = |&frame: &usize| ((frame as f64 / speed).round() as usize).min(count.saturating_sub(1));
    frames.iter().map(moved).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_motion::glam::Vec3;
    use inkrig_motion::humanml::{Joints, features, ground, mirror};

    fn clip() -> Prepared {
        let pose = |frame: usize| -> Joints {
            std::array::from_fn(|joint| {
                let side = joint as f32 % 3.0 - 1.0;
                Vec3::new(0.1 * side + 0.01 * joint as f32, 1.6 - 0.07 * joint as f32, 0.05 * frame as f32)
            })
        };
        let poses: Vec<Joints> = (0..41).map(pose).collect();
        let table = |poses: &[Joints]| features(&ground(poses)).unwrap();
        Prepared { features: table(&poses), mirrored: table(&mirror(&poses)), key_poses: vec![0, 20, 39] }
    }

    #[test]
    fn copies_are_as_many_as_are_asked_for_and_the_same_for_a_seed() {
        let clip = clip();
        let taken = |mirrored, retimed, seed| {
            let selection = Selection { mirrored, retimed, seed, ..Selection::PLAIN };
            copies(&clip, &selection, &mut Noise::new(seed)).unwrap()
        };
        assert_eq!(taken(false, 0.0, 1).len(), 1);
        assert_eq!(taken(true, 0.0, 1).len(), 2);
        let all = taken(true, 1.0, 1);
        assert_eq!(all.len(), 4);
        assert!(all.iter().map(|(table, _)| table).zip(taken(true, 1.0, 1)).all(|(a, b)| *a == b.0));
        assert!(all[1].1 != taken(true, 1.0, 2)[1].1);
        for (table, speed) in &all {
            assert!((table.frames() as f64 - 39.0 / speed).abs() <= 1.0, "{speed}");
        }
        assert_eq!(at_speed(&[0, 20, 39], 1.25, 31), [0, 16, 30]);
        assert_eq!(at_speed(&[0, 20, 39], 1.0, 40), [0, 20, 39]);
    }
}
