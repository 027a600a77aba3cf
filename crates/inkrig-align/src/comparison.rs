//! Other ways to make a motion of a clip, measured as align's own results are.

use crate::alignment::{at_rate, check_lengths, without_lead_ins};
use crate::blend::{Window, frame_weights};
use crate::patches::{PatchScratch, normalised_self_distances, patch_distances};
use crate::quality::{centred, column_means, result_frames};
use crate::reconstruct::{Ends, Rules, blend_clip};
use crate::{AlignError, Control, FrameWeights, Layout, MOST_TABLE_FRAMES, Norm, Options, Quality};
use inkrig_motion::{Clip, FeatureLayout, Features, Takes};
use inkrig_transport::{Mat, MatRef, TransportError};

/// A clip and a control, brought to the matching rate as [`align`](crate::align) does it. Whatever arranges the clip's
/// frames (a baseline, another program's plan) can be made a clip and measured by it, and stands beside align's own.
#[derive(Debug, Clone)]
pub struct Comparison {
    source: Takes,
    matched: Takes,
    layout: FeatureLayout,
    features: Features,
    columns: Layout,
    control: Mat<f32>,
    rows: Layout,
    options: Options,
}

impl Comparison {
    /// Prepares a pair. Of the options the matching rate, the patch, the features, the travel and the threads count.
    ///
    /// # Errors
    /// As for [`align`](crate::align).
    pub fn new(source: &Takes, control: &Control, options: &Options) -> Result<Self, AlignError> {
        options.validate()?;
        control.validate()?;
        let (source, _) = without_lead_ins(source)?;
        check_lengths(&source, control, options)?;
        let matched = source.decimate(options.matching_rate)?;
        let lengths: Vec<usize> = matched.ranges().map(|range| range.len()).collect();
        let (control, rows) = at_rate(control, options);
        let layout = FeatureLayout::of(&matched, &options.features);
        let features = layout.features(&matched);
        let columns = Layout::clips(&lengths, options.patch());
        Ok(Self { source, matched, layout, features, columns, control, rows, options: options.clone() })
    }

    /// Frames of the clip at the matching rate, n x width: what patches are compared by.
    pub fn features(&self) -> &Features {
        &self.features
    }

    /// Where the clip's patches stand.
    pub fn columns(&self) -> &Layout {
        &self.columns
    }

    /// The control's rows at the matching rate; [`Layout::rows`] of them.
    pub fn control(&self) -> &Mat<f32> {
        &self.control
    }

    /// Where the control's patches stand.
    pub fn rows(&self) -> &Layout {
        &self.rows
    }

    /// Distances within the control's patches and within the clip's, each divided by its mean.
    ///
    /// # Errors
    /// When nothing moves in one of them, or they are longer than [`MOST_TABLE_FRAMES`].
    pub fn distances(&self) -> Result<[Mat<f32>; 2], AlignError> {
        let sides = [("the clip", &self.columns, "--range"), ("the control", &self.rows, "--length")];
        if let Some((what, layout, cut)) = sides.into_iter().find(|side| side.1.frames() > MOST_TABLE_FRAMES)
        {
            return Err(AlignError::TooLong { what, frames: layout.frames(), most: MOST_TABLE_FRAMES, cut });
        }
        let (mut scratch, threads) = (PatchScratch::new(), self.options.threads);
        let (mut control, mut source) = (Mat::default(), Mat::default());
        let table = MatRef::new(self.features.as_slice(), self.features.frames(), self.features.width())?;
        normalised_self_distances(
            self.control.view(),
            &self.rows,
            Norm::Mean,
            &mut scratch,
            &mut control,
            threads,
        )?
        .ok_or(AlignError::StillControl)?;
        normalised_self_distances(table, &self.columns, Norm::Mean, &mut scratch, &mut source, threads)?
            .ok_or(AlignError::StillClip)?;
        Ok([control, source])
    }

    /// Distances between the patches of a motion of that character, one row for each of the control's, and those of the
    /// clip, in mean distances of the clip's own.
    ///
    /// # Errors
    /// As for [`Self::measure`].
    pub fn cost(&self, result: &Clip) -> Result<Mat<f32>, AlignError> {
        let (own, frames, scale) = self.tables(result)?;
        let (mut scratch, threads, mut out) = (PatchScratch::new(), self.options.threads, Mat::default());
        let (own, frames) = ((own.view(), &self.rows), (frames.view(), &self.columns));
        patch_distances(own, frames, scale, &mut scratch, &mut out, threads)?;
        Ok(out)
    }

    /// Distances within the patches of a motion of that character, in mean distances of the clip's own: to be looked at
    /// beside those of the control.
    ///
    /// # Errors
    /// As for [`Self::measure`].
    pub fn distances_within(&self, result: &Clip) -> Result<Mat<f32>, AlignError> {
        let (own, _, scale) = self.tables(result)?;
        let (mut scratch, threads, mut out) = (PatchScratch::new(), self.options.threads, Mat::default());
        let own = (own.view(), &self.rows);
        patch_distances(own, own, scale, &mut scratch, &mut out, threads)?;
        Ok(out)
    }

    /// The clip that a plan between patches makes: rows of mass 1/N, blended as align blends its own.
    ///
    /// # Errors
    /// When the plan's rows are not such rows.
    pub fn clip_of_plan(&self, plan: MatRef<'_, f32>) -> Result<Clip, AlignError> {
        checked("plan", plan, [self.rows.patches(), self.columns.patches()])?;
        let mut weights = Mat::default();
        frame_weights(plan, (&self.rows, &self.columns), Window::Hann, &mut weights, self.options.threads);
        self.clip_of_weights(&weights)
    }

    /// The clip that weights of frames make: as many rows as the control has frames, each of sum 1 over the clip's
    /// frames at the matching rate.
    ///
    /// # Errors
    /// When the rows are not such rows.
    pub fn clip_of_weights(&self, weights: &Mat<f32>) -> Result<Clip, AlignError> {
        checked("weights", weights.view(), [self.rows.frames(), self.columns.frames()])?;
        let ends = if self.rows.is_cyclic() { Ends::Loop } else { Ends::Open };
        let weights = FrameWeights::from_mat(weights.view())?;
        blend_clip(&self.source, &self.matched, &weights, Rules::free(ends), &self.options)
    }

    /// How good a motion of that character is as one that follows the control.
    ///
    /// # Errors
    /// When it is of another skeleton, or nothing moves in the clip or the control.
    pub fn measure(&self, result: &Clip) -> Result<Quality, AlignError> {
        self.check_character(result)?;
        let (control, source) = ((&self.control, &self.rows), (&self.features, &self.columns));
        Quality::of(&self.source, result, &self.layout, source, control, &self.options)
    }

    /// The frames of a result and of the clip, both less the clip's means, and one over the clip's mean distance.
    fn tables(&self, result: &Clip) -> Result<(Mat<f32>, Mat<f32>, f32), AlignError> {
        self.check_character(result)?;
        let means = column_means(&self.features);
        let own = result_frames(result, &self.layout, &self.rows, &means, self.options.matching_rate)?;
        let frames = centred(&self.features, &means);
        let (mut scratch, mut out) = (PatchScratch::new(), Mat::default());
        let (table, threads) = (frames.view(), self.options.threads);
        let scale =
            normalised_self_distances(table, &self.columns, Norm::Mean, &mut scratch, &mut out, threads)?
                .ok_or(AlignError::StillClip)?;
        Ok((own, frames, scale))
    }

    fn check_character(&self, result: &Clip) -> Result<(), AlignError> {
        // Refuses another skeleton and says what differs.
        Takes::join(&[self.source.clip().clone(), result.clone()])?;
        Ok(())
    }
}

fn checked(name: &'static str, table: MatRef<'_, f32>, expected: [usize; 2]) -> Result<(), AlignError> {
    let (rows, cols) = (table.rows(), table.cols());
    if [rows, cols] == expected {
        return Ok(());
    }
    let [expected_rows, expected_cols] = expected;
    let hint = "one row for each of the control's and one column for each of the clip's";
    Err(TransportError::Shape { name, rows, cols, expected_rows, expected_cols, hint }.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::swinging;
    use inkrig_sketch::shapes::growing_circles;
    use std::ops::ControlFlow;

    #[test]
    fn a_result_of_align_measures_as_its_report_says() {
        let takes = Takes::from(swinging(6.0, 60.0));
        let control =
            Control::from_curve(&growing_circles(3, 120).unwrap(), &crate::CurveOptions::default()).unwrap();
        let options = Options { levels: 2, ..Options::default() };
        let aligned = crate::align(&takes, &control, &options, &mut |_| ControlFlow::Continue(())).unwrap();
        let comparison = Comparison::new(&takes, &control, &options).unwrap();
        let (quality, report) = (comparison.measure(&aligned.clip).unwrap(), &aligned.report);
        assert_eq!(quality, report.quality());
        let again = comparison.clip_of_plan(aligned.plan.dense()).unwrap();
        assert_eq!(
            comparison.measure(&again).unwrap(),
            quality,
            "the plan is all there is to a clip without keys"
        );
    }

    #[test]
    fn the_clip_itself_is_near_and_covers_all() {
        let takes = Takes::from(swinging(4.0, 30.0));
        let control =
            Control::from_curve(&growing_circles(3, 121).unwrap(), &crate::CurveOptions::default()).unwrap();
        let comparison = Comparison::new(&takes, &control, &Options::default()).unwrap();
        let quality = comparison.measure(takes.clip()).unwrap();
        assert!(quality.nearest_patch < 1e-2 && quality.coverage > 0.99, "{quality:?}");
        assert!((quality.structure_pearson - quality.structure_pearson_warp).abs() < 1e-3);
        let cost = comparison.cost(takes.clip()).unwrap();
        let [_, source] = comparison.distances().unwrap();
        assert!((0..100).all(|i| (cost.row(i)[50] - source.row(i)[50]).abs() < 2e-2));
        let within = comparison.distances_within(takes.clip()).unwrap();
        assert!((0..100).all(|i| (within.row(i)[50] - source.row(i)[50]).abs() < 2e-2));
        assert!((quality.jump_q999_ratio - 1.0).abs() < 1e-6);
        assert!(comparison.clip_of_weights(&Mat::zeros(3, 4)).unwrap_err().to_string().contains("3 x 4"));
    }
}
