//! How far every moment of a result is from a moment of a clip.

use inkrig::align::{Control, Options};
use inkrig::motion::{Clip, FeatureLayout, Features, Takes};

const PATCH: usize = 11;

pub(crate) struct Yardstick {
    layout: FeatureLayout,
    frames: Features,
    mean: f64,
}

impl Yardstick {
    /// For a clip of 30 frames a second.
    pub(crate) fn of(clip: &Clip) -> Self {
        let takes = Takes::from(clip.clone());
        let layout = FeatureLayout::of(&takes, &Options::default().features);
        let frames = layout.features(&takes);
        let pieces: Vec<usize> = (0..frames.frames() - PATCH).step_by(4).collect();
        let all = pieces.iter().flat_map(|&a| pieces.iter().map(move |&b| (a, b)));
        let total: f64 = all.map(|(a, b)| apart((&frames, a), (&frames, b))).sum();
        Self { layout, frames, mean: total / (pieces.len() * pieces.len()) as f64 }
    }

    /// Of every frame of a result to the moment around a frame of the clip, in mean distances.
    pub(crate) fn distances(&self, result: &Clip, frame: usize) -> Vec<f64> {
        let own = self.layout.features(&Takes::from(result.clone()));
        let begin = |frame: usize, count: usize| frame.saturating_sub(PATCH / 2).min(count - PATCH);
        let pose = begin(frame, self.frames.frames());
        let at = |frame| apart((&own, begin(frame, own.frames())), (&self.frames, pose)) / self.mean;
        (0..own.frames()).map(at).collect()
    }
}

fn apart((a, at): (&Features, usize), (b, bt): (&Features, usize)) -> f64 {
    let rows = (0..PATCH).flat_map(|step| a.row(at + step).iter().zip(b.row(bt + step)));
    rows.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>().sqrt()
}

/// Points of a control of one or two numbers, one a frame; of others the time and the largest number's place.
pub(crate) fn points(control: &Control) -> Vec<[f64; 2]> {
    let table = &control.features;
    let point = |frame: usize| match table.row(frame) {
        [value] => [frame as f64 / control.rate, f64::from(*value)],
        [x, y] if control.kind == inkrig::align::ControlKind::Curve => [f64::from(*x), f64::from(*y)],
        row => {
            let largest =
                row.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(index, _)| index);
            [frame as f64 / control.rate, -(largest as f64)]
        }
    };
    (0..table.frames()).map(point).collect()
}
