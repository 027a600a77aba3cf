//! Where the nodes of a document are, at rest and while a clip plays.

use super::{
    document::Path,
    forest::{Forest, Transform},
    track::Track,
};
use crate::{
    Finding, FormatError,
    figure::{Figure, Placed, Stage},
    timing::Timing,
};
use inkrig_motion::{Clip, glam::DAffine3};

/// The document's nodes in the clip's world, at rest.
pub(super) fn stage<'f>(figure: &'f Figure, forest: &Forest, clip_from_file: DAffine3) -> Stage<'f> {
    let mut rest = vec![Placed::STILL; forest.parents.len()];
    place(figure, forest, Placed::origin(clip_from_file), &forest.rest, &mut rest);
    Stage::new(figure, rest)
}

/// Places the nodes of the figure's chain.
fn place(figure: &Figure, forest: &Forest, origin: Placed, local: &[Transform], placed: &mut [Placed]) {
    for &node in &figure.chain {
        let parent = forest.parents.get(node).copied().flatten();
        let above = parent.and_then(|parent| placed.get(parent)).copied().unwrap_or(origin);
        let (Some(slot), Some(local)) = (placed.get_mut(node), local.get(node)) else { continue };
        let turned = (above.turned * local.rotation).normalize();
        *slot = Placed { world: above.world * local.affine(), turned };
    }
}

/// Plays tracks over a skeleton.
pub(super) struct Player<'s, 'f, 'a> {
    stage: &'s Stage<'f>,
    forest: &'s Forest,
    origin: Placed,
    tracks: Vec<Track<'a>>,
    timing: Timing,
    local: Vec<Transform>,
}

impl<'s, 'f, 'a> Player<'s, 'f, 'a> {
    pub(super) fn new(
        stage: &'s Stage<'f>,
        forest: &'s Forest,
        clip_from_file: DAffine3,
        tracks: Vec<Track<'a>>,
        timing: Timing,
    ) -> Self {
        let origin = Placed::origin(clip_from_file);
        Self { stage, forest, origin, tracks, timing, local: forest.rest.clone() }
    }

    /// The whole clip of `frames` frames.
    pub(super) fn clip(&mut self, frames: usize, findings: &mut Vec<Finding>) -> Result<Clip, FormatError> {
        let (stage, rate) = (self.stage, self.timing.rate);
        let mut scaled = 0.0_f64;
        let clip = stage.clip(frames, rate, &mut |frame, placed| {
            if frame == 0 {
                self.tracks.iter_mut().for_each(Track::rewind);
            }
            self.go_to(frame);
            scaled = scaled.max(self.largest_scaling());
            place(stage.figure, self.forest, self.origin, &self.local, placed);
            Ok(())
        })?;
        if scaled > 1e-3 {
            let message = "joints change their size in the clip; their places are kept, their sizes are not";
            findings.push(Finding::warning("gltf-scale", message.into()));
        }
        Ok(clip)
    }

    fn go_to(&mut self, frame: usize) {
        let (time, slack) = (self.timing.start + frame as f64 / self.timing.rate, self.timing.slack);
        for track in &mut self.tracks {
            let Some(local) = self.local.get_mut(track.node) else { continue };
            local.matrix = None;
            match track.path {
                Path::Translation => local.translation = track.vector(time, slack),
                Path::Rotation => local.rotation = track.rotation(time, slack),
                Path::Scale => local.scale = track.vector(time, slack),
                Path::Other => {}
            }
        }
    }

    /// How far any node's scale is from that of its rest, by ratio.
    fn largest_scaling(&self) -> f64 {
        let scales = self.tracks.iter().filter(|track| track.path == Path::Scale).filter_map(|track| {
            let (now, rest) = (self.local.get(track.node)?.scale, self.forest.rest.get(track.node)?.scale);
            Some((now - rest).abs().max_element() / rest.abs().max_element().max(1e-9))
        });
        scales.fold(0.0, f64::max)
    }
}
