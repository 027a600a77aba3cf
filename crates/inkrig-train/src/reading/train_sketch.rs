//! Teaching the reader of sketches.

use super::run::{At, Lesson, OnStep, Task, teach};
use super::sketch_loss::Loss;
use super::{Poses, Shares, SketchSettings, Subset, measure, rendered};
use crate::TrainError;
use crate::corpus::{Manifest, Split};
use crate::figures::{Conditions, Family, Picture};
use inkrig_generate::checkpoint::CheckpointError;
use inkrig_generate::readers::file::{Header, read};
use inkrig_generate::readers::network::{Network, Work};
use inkrig_generate::readers::sketch::{Outputs, SketchReader, plan};
use inkrig_generate::schedule::Noise;
use inkrig_generate::weights::Tensors;
use serde::{Deserialize, Serialize};
use std::io::BufReader;
use std::path::Path;

/// A line of `log.jsonl`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SketchRow {
    /// Steps that were taken.
    pub step: u64,
    /// Mean loss since the last line.
    pub loss: f64,
    /// Rate of the last step.
    pub rate: f64,
    /// PCK@0.1 of held-out subjects, styles as learned.
    pub pck: f64,
    /// The same, left and right left open.
    pub pck_either_side: f64,
    /// PCK@0.1 of held-out subjects in the held-out style.
    pub pck_unseen: f64,
    /// PCK@0.1 of held-out subjects as characters.
    pub pck_characters: f64,
    /// Seconds of training, earlier runs included.
    pub seconds: f64,
}

/// Trains, or goes on with, the run in `folder`, on `threads` threads; what is learned does not depend on their number. `progress`
/// hears of every step, how many there are, and what was measured, and can stop the run, which keeps its place. Gives the log, and
/// whether all steps were taken.
///
/// # Errors
/// When the corpus or the checkpoint cannot be read, the checkpoint is of other settings, a loss is no number, or nothing can be written.
pub fn train_sketch(
    corpus: &Path,
    folder: &Path,
    settings: &SketchSettings,
    threads: usize,
    progress: &mut OnStep<'_, SketchRow>,
) -> Result<(Vec<SketchRow>, bool), TrainError> {
    settings.check().map_err(TrainError::Device)?;
    let manifest = Manifest::read(corpus)?;
    let held_out = Poses::read(&manifest, Split::Val)?;
    let (plan, outputs) = plan();
    let measured = |subset| rendered(&held_out, subset, settings.pace.measured, 7);
    let lesson = SketchLesson {
        poses: Poses::read(&manifest, Split::Train)?,
        settings,
        outputs,
        learned: measured(Subset::Learned),
        unseen: measured(Subset::Unseen),
        characters: measured(Subset::Characters),
    };
    let from = settings.from.as_deref().map(weights).transpose()?;
    let header = Header::new("sketch");
    let (pace, identity, from) = (&settings.pace, settings.identity(), from.as_ref());
    let task = Task { folder, pace, identity, header, from, threads };
    teach(&lesson, plan, &task, progress)
}

fn weights(path: &Path) -> Result<Tensors, TrainError> {
    let file = std::fs::File::open(path).map_err(|cause| TrainError::File { path: path.into(), cause })?;
    let wrong = |error: CheckpointError| TrainError::Content { path: path.into(), what: error.to_string() };
    Ok(read(BufReader::new(file), "sketch").map_err(wrong)?.1)
}

struct SketchLesson<'a> {
    poses: Poses,
    settings: &'a SketchSettings,
    outputs: Outputs,
    learned: Vec<Picture>,
    unseen: Vec<Picture>,
    characters: Vec<Picture>,
}

impl Lesson for SketchLesson<'_> {
    type Row = SketchRow;

    fn example(&self, network: &Network, noise: &mut Noise, work: &mut Work, gradient: &mut [f32]) -> f64 {
        let SketchSettings { bent, turned, varied, characters, .. } = *self.settings;
        let shares = Shares { bent, turned, varied, characters };
        let picture = self.poses.picture(&Family::LEARNED, &Conditions::LEARNED, &shares, noise);
        network.forward(&picture.ink.pixels, work);
        let mut loss = Loss::default();
        loss.of(&picture, work.value(self.outputs.heat), work.value(self.outputs.presence));
        let of = [(self.outputs.heat, &loss.heat[..]), (self.outputs.presence, &loss.presence[..])];
        network.backward(work, &of, gradient);
        loss.loss
    }

    fn measure(&self, network: &Network, at: At) -> (f64, SketchRow) {
        let reader = SketchReader::of(network.clone(), self.outputs);
        let own = measure(&reader, &self.learned);
        let At { step, loss, rate, seconds } = at;
        let [pck_unseen, pck_characters] =
            [&self.unseen, &self.characters].map(|pictures| measure(&reader, pictures).pck);
        let (pck, pck_either_side) = (own.pck, own.pck_either_side);
        (1.0 - pck, SketchRow { step, loss, rate, pck, pck_either_side, pck_unseen, pck_characters, seconds })
    }

    fn step_of(row: &SketchRow) -> u64 {
        row.step
    }
}
