//! What is known of a clip before there is any control.

use crate::alignment::without_lead_ins;
use crate::keys::{Context, Keys, Timing};
use crate::pca::Subspace;
use crate::{AlignError, Control, Layout, Options};
use inkrig_motion::{FeatureLayout, Features, Takes};

/// A clip without its lead-ins, at its own rate and at the matching rate, and the features of its frames.
#[derive(Debug, Clone)]
pub(crate) struct PreparedClip {
    pub(crate) given: Takes,
    /// Frames left out at the beginning of every take.
    pub(crate) lead_ins: Vec<usize>,
    pub(crate) source: Takes,
    pub(crate) matched: Takes,
    pub(crate) columns: Layout,
    pub(crate) layout: FeatureLayout,
    pub(crate) features: Features,
}

impl PreparedClip {
    /// Checks the clip's length first.
    pub(crate) fn new(given: &Takes, options: &Options) -> Result<Self, AlignError> {
        let (source, lead_ins) = without_lead_ins(given)?;
        check_clip(&source, options)?;
        let matched = source.decimate(options.matching_rate)?;
        let lengths: Vec<usize> = matched.ranges().map(|range| range.len()).collect();
        let columns = Layout::clips(&lengths, options.patch());
        let layout = FeatureLayout::of(&matched, &options.features);
        let features = layout.features(&matched);
        Ok(Self { given: given.clone(), lead_ins, source, matched, columns, layout, features })
    }

    /// The keys of the options, in frames of what is matched and in its subspace.
    pub(crate) fn keys(
        &self,
        subspace: &Subspace,
        control: &Control,
        rows: &Layout,
        options: &Options,
    ) -> Result<Keys, AlignError> {
        let Self { given, lead_ins, source, matched, layout, .. } = self;
        let timing = Timing { given, lead_ins, source, matched };
        Keys::new(&Context { timing, layout, subspace, control, rows, options })
    }
}

/// Says that a clip is too short or too long.
pub(crate) fn check_clip(source: &Takes, options: &Options) -> Result<(), AlignError> {
    let (patch, rate, clip_rate) = (options.patch(), options.matching_rate, source.clip().frame_rate());
    let needed = 2 * patch;
    let matched = |frames: usize| (frames.saturating_sub(1) as f64 * rate / clip_rate) as usize + 1;
    let longest = source.ranges().map(|range| matched(range.len())).max().unwrap_or(0);
    if longest < needed {
        return Err(AlignError::ClipTooShort { frames: longest, rate, patch, needed });
    }
    let frames = source.ranges().map(|range| matched(range.len())).sum();
    let most = options.solver.most_frames();
    if frames > most {
        return Err(AlignError::TooLong { what: "the clip", frames, most, cut: "--range" });
    }
    Ok(())
}
