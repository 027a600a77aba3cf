//! Several solutions of one problem.

use super::first_plans::{FirstPlans, mean_distance};
use crate::alignment::{align_with, without_lead_ins};
use crate::coarse_to_fine::Buffers;
use crate::quality::result_frames;
use crate::{AlignError, Alignment, Control, Layout, Moments, Observer, Options};
use inkrig_motion::{Clip, FeatureLayout, Takes, time};
use inkrig_transport::Mat;

/// Two results are two solutions when they are this far from each other, in mean distances of the clip's moments: half as
/// far as two moments of the clip that have nothing to do with each other.
const DISTINCT: f64 = 0.5;

/// One of several solutions.
#[derive(Debug, Clone)]
pub struct Alternative {
    /// The motion, and how it came about.
    pub alignment: Alignment,
    /// Objective of the first plan, structure alone; lower is better. Comparable between the solutions of one problem.
    pub objective: f64,
    /// How far it is from the first solution: mean distance of what both do at the same time, in mean distances of the
    /// clip's moments. 0 for the first.
    pub distance: f64,
}

/// At most `most` solutions that differ: the one that [`align`](crate::align) gives, then others that fit the control's
/// structure about as well.
///
/// At the coarsest level, where runs part, plans are found from the mirror images of the first (MAMM Sec. 6: distances do
/// not know left from right) and from more starts. Kept are those whose objective is worse by at most 15 % of what the best
/// gains over the independent plan, and whose motions differ; each is then worked out at all levels, and left out when it ends
/// less than half a mean distance from one that is there.
///
/// # Errors
/// As for [`align`](crate::align).
pub fn alternatives(
    source: &Takes,
    control: &Control,
    options: &Options,
    most: usize,
    observer: Observer<'_>,
) -> Result<Vec<Alternative>, AlignError> {
    let mut buffers = Buffers::new(options.threads);
    // More than are asked for, since some come back to others.
    let wanted = if most > 1 { 2 * most } else { 0 };
    buffers.first = FirstPlans { wanted, ..FirstPlans::default() };
    let alignment = align_with(source, control, options, &mut buffers, observer)?;
    let first = std::mem::take(&mut buffers.first);
    let mut all = vec![Alternative { alignment, objective: first.objective, distance: 0.0 }];
    if first.others.is_empty() {
        return Ok(all);
    }
    let ruler = Ruler::of(source, control, options)?;
    let mut motions = vec![ruler.motion(&all[0].alignment.clip)?];
    for other in first.others {
        if all.len() >= most {
            break;
        }
        buffers.first = FirstPlans { given: Some(other.plan), ..FirstPlans::default() };
        let alignment = align_with(source, control, options, &mut buffers, observer)?;
        let motion = ruler.motion(&alignment.clip)?;
        let distances = motions.iter().map(|before| ruler.distance(before, &motion));
        let distances: Vec<f64> = distances.collect();
        if distances.iter().all(|&distance| distance >= DISTINCT) {
            let distance = distances.first().copied().unwrap_or(0.0);
            all.push(Alternative { alignment, objective: other.objective, distance });
            motions.push(motion);
        }
    }
    Ok(all)
}

/// Measures how far results are from each other.
struct Ruler {
    features: FeatureLayout,
    rows: Layout,
    rate: f64,
    /// What features are counted from: zeros, since only differences are looked at.
    origin: Vec<f32>,
    /// 1 over the mean distance of the clip's moments.
    scale: f64,
}

impl Ruler {
    fn of(source: &Takes, control: &Control, options: &Options) -> Result<Self, AlignError> {
        let (own, _) = without_lead_ins(source)?;
        let matched = own.decimate(options.matching_rate)?;
        let frames = control.frames(options.matching_rate);
        let patch = options.patch();
        let features = FeatureLayout::of(&matched, &options.features);
        let width = features.features(&time::trim(matched.clip(), 0..1)?.into()).width();
        Ok(Self {
            features,
            rows: if control.cyclic { Layout::cyclic(frames, patch) } else { Layout::open(frames, patch) },
            rate: options.matching_rate,
            origin: vec![0.0; width],
            scale: Moments::of(source, options)?.scale(),
        })
    }

    /// The features of a result, one frame a control sample.
    fn motion(&self, clip: &Clip) -> Result<Mat<f32>, AlignError> {
        result_frames(clip, &self.features, &self.rows, &self.origin, self.rate)
    }

    fn distance(&self, a: &Mat<f32>, b: &Mat<f32>) -> f64 {
        self.scale * mean_distance(a, b, &self.rows)
    }
}
