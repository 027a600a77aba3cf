//! The clips of a document: what there is, and which is read.

use super::{
    accessor,
    buffers::Buffers,
    container::Container,
    damaged,
    document::{Animation, Channel, Document, Path},
    track::Track,
};
use crate::{ClipInfo, FileSource, Finding, FormatError, ImportOptions, Limits, figure::Figure};
use std::collections::{BTreeSet, HashSet};

/// Names and lengths of all clips, without looking into buffers.
pub(super) fn list(document: &Document) -> Vec<ClipInfo> {
    let animations = document.animations.0.iter().enumerate();
    animations
        .map(|(index, animation)| ClipInfo {
            name: name(animation, index),
            channels: animation.channels.0.len(),
        })
        .collect()
}

fn name(animation: &Animation, index: usize) -> String {
    if animation.name.is_empty() { format!("clip_{}", index + 1) } else { animation.name.clone() }
}

/// The channels of one clip that move the skeleton or what stands above it.
pub(super) struct Channels<'d> {
    animation: &'d Animation,
    used: Vec<(usize, Path, &'d Channel)>,
}

impl<'d> Channels<'d> {
    pub(super) fn of(
        document: &'d Document,
        index: usize,
        figure: &Figure,
        findings: &mut Vec<Finding>,
    ) -> Option<Self> {
        let animation = document.animations.0.get(index)?;
        let chain: HashSet<usize> = figure.chain.iter().copied().collect();
        let (mut used, mut met, mut others) = (Vec::new(), HashSet::new(), 0_usize);
        for channel in &animation.channels.0 {
            let path = channel.target.path;
            // A face's weights are no joint's.
            let Some(node) = channel.target.node.filter(|_| path != Path::Other) else { continue };
            let node = node as usize;
            // The format wants one channel for one thing; the first counts.
            if chain.contains(&node) && met.insert((node, path as u8)) {
                used.push((node, path, channel));
            } else {
                others += 1;
            }
        }
        if others > 0 {
            let message = format!("channels that move no joint: {others}; they are left out");
            findings.push(Finding::info("gltf-other-channels", message));
        }
        Some(Self { animation, used })
    }

    /// Opens the tracks; returns them and the times of their keys, rising, seconds.
    ///
    /// `bytes` is the size of the file: keys that several channels share may not make a short file long work.
    pub(super) fn tracks<'a>(
        &self,
        document: &Document,
        buffers: &'a Buffers<'_>,
        bytes: usize,
    ) -> Result<(Vec<Track<'a>>, Vec<f64>), FormatError> {
        let most = Limits::FREE_CELLS.saturating_add(bytes);
        let (mut tracks, mut keys) = (Vec::with_capacity(self.used.len()), 0_usize);
        let (mut inputs, mut times) = (HashSet::new(), Vec::new());
        for &(node, path, channel) in &self.used {
            let Some(sampler) = self.animation.samplers.0.get(channel.sampler as usize) else {
                let part = format!("a channel of node {node}");
                let what = format!("its sampler {} does not exist", channel.sampler);
                return Err(damaged("gltf-index", part, what, "the file is damaged; export it again"));
            };
            let track = Track::open(node, path, sampler, document, buffers, most.saturating_sub(keys))?;
            keys = keys.saturating_add(track.keys());
            if keys > most {
                return Err(FormatError::Limit {
                    what: format!("the clip has {keys} keys and more"),
                    limit: most,
                    place: None,
                    hint: "cut the motion into shorter ones".into(),
                });
            }
            if inputs.insert(sampler.input) {
                times.extend((0..track.keys()).map(|key| track.time(key)));
            }
            tracks.push(track);
        }
        times.sort_unstable_by(f64::total_cmp);
        times.dedup();
        Ok((tracks, times))
    }
}

/// Loads the buffers behind the channels of some clips, each once.
pub(super) fn buffers<'a>(
    clips: &[Channels<'_>],
    document: &Document,
    container: &Container<'a>,
    options: &ImportOptions,
    files: FileSource<'_>,
) -> Result<Buffers<'a>, FormatError> {
    let mut wanted = BTreeSet::new();
    for clip in clips {
        for (_, _, channel) in &clip.used {
            if let Some(sampler) = clip.animation.samplers.0.get(channel.sampler as usize) {
                wanted.extend(accessor::buffers_of(sampler.input, document));
                wanted.extend(accessor::buffers_of(sampler.output, document));
            }
        }
    }
    Buffers::load(wanted, document, container, options, files)
}
