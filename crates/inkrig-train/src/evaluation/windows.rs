//! Pieces of held-out clips, with all that is said of them.

use crate::TrainError;
use crate::corpus::{Manifest, Split, key_pose_frames};
use inkrig_motion::Features;
use inkrig_motion::humanml::{Joints, WIDTH, recover_positions};

/// A piece of a clip that begins at the origin and faces along z.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluationWindow {
    /// Of which source it is.
    pub source: String,
    /// Who moves.
    pub subject: String,
    /// Verbs of the lexicon that its clip has.
    pub actions: Vec<String>,
    /// Features as they are, frames x [`WIDTH`].
    pub features: Vec<f32>,
    /// Places of the joints, metres.
    pub joints: Vec<Joints>,
    /// The frame whose pose stands out most.
    pub key_pose: usize,
}

/// Pieces of `frames` frames of a split, side by side, at most `most` of them, spread evenly over all.
///
/// # Errors
/// When a part of the corpus cannot be read, or no clip is long enough.
pub fn windows(
    manifest: &Manifest,
    split: Split,
    frames: usize,
    most: usize,
) -> Result<Vec<EvaluationWindow>, TrainError> {
    let count = |entry: &crate::corpus::Entry| entry.frames / frames.max(1);
    let all: usize = manifest.entries().iter().filter(|entry| entry.split == split).map(count).sum();
    if all == 0 {
        let what =
            format!("the corpus has no clip of the split `{}` as long as {frames} frames", split.name());
        return Err(TrainError::Device(what));
    }
    let (mut windows, mut seen) = (Vec::new(), 0_usize);
    for (path, entries) in manifest.parts(split) {
        let part = Manifest::read_part(&path, entries)?;
        for entry in entries {
            let Some(clip) = part.clips.get(entry.index) else { continue };
            for rows in clip.prepared.features.as_slice().chunks_exact(frames * WIDTH) {
                // Every one whose share of `most` begins a new whole.
                let taken = seen * most / all != (seen + 1) * most / all || all <= most;
                seen += 1;
                if !taken {
                    continue;
                }
                let features = Features::new(rows.to_vec(), WIDTH)?;
                windows.push(EvaluationWindow {
                    source: entry.source.clone(),
                    subject: entry.subject.clone(),
                    actions: entry.actions.clone(),
                    joints: recover_positions(&features)?,
                    key_pose: key_pose_frames(&features).first().copied().unwrap_or(0),
                    features: rows.to_vec(),
                });
            }
        }
    }
    Ok(windows)
}
