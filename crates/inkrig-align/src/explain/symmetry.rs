//! Mirror images of a control.
//!
//! Only distances within the control count, so whatever maps it onto itself and keeps its distances gives another
//! solution that is as good (MAMM Sec. 6, "Ambiguity to Rigid Transformation and Symmetry"): the rising and the falling
//! slopes of a wave may change places, a figure may be walked the other way round.

use crate::suggest::principal_axes;
use inkrig_transport::Mat;

/// Axes of the control's patches of which any may be reversed.
const FLIPPED: usize = 3;
/// Axes in which the mirrored place of a patch is looked up.
const AXES: usize = 6;
/// Rounds of power iteration for them.
const ROUNDS: usize = 40;
/// Patches on which it is measured how nearly a control is its own mirror image.
const SAMPLE: usize = 512;
/// A reflection that moves patches less than this, in mean distances of the control, is none.
const LEAST_MOVED: f64 = 0.3;

/// A way to exchange the patches of a control so that their distances stay nearly as they are.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reflection {
    /// For every patch the one that takes its place.
    pub(crate) image: Vec<usize>,
    /// sqrt(sum (D(image, image) - D)^2 / sum D^2): 0 when no distance changes.
    pub(crate) distortion: f64,
}

impl Reflection {
    /// The reflections of a control with the distances `distances` (n x n) that move it, the truest first: every reversal
    /// of its three main axes, and of time.
    pub(crate) fn all(distances: &Mat<f32>) -> Vec<Self> {
        let count = distances.rows();
        let axes = principal_axes(distances, AXES, ROUNDS);
        let flips = (1..1_usize << FLIPPED).map(|flip| nearest_images(&axes, flip));
        let reversal = (0..count).rev().collect();
        let mean = mean(distances.as_slice().iter().map(|&distance| f64::from(distance)));
        let mut all: Vec<Self> = flips
            .chain(std::iter::once(reversal))
            .filter(|image| {
                let moved = image.iter().enumerate().map(|(i, &to)| f64::from(distances.row(i)[to]));
                self::mean(moved) >= LEAST_MOVED * mean
            })
            .map(|image| Self { distortion: distortion(distances, &image), image })
            .collect();
        all.sort_by(|a, b| a.distortion.total_cmp(&b.distortion));
        all
    }

    /// How nearly the control is a mirror image of itself: 1 when it is one exactly, 0 when none of its reflections keeps
    /// anything. Of a long one, some patches are looked at.
    pub(crate) fn symmetry(distances: &Mat<f32>) -> f64 {
        let (count, some) = (distances.rows(), distances.rows().min(SAMPLE));
        let sample;
        let distances = if some == count {
            distances
        } else {
            let at = |k: usize| (2 * k + 1) * count / (2 * some);
            sample = Mat::from_fn(some, some, |i, j| distances.row(at(i))[at(j)]);
            &sample
        };
        Self::all(distances).first().map_or(0.0, |truest| (1.0 - truest.distortion).max(0.0))
    }

    /// The rows of a plan in the reflected order.
    pub(crate) fn of_plan(&self, plan: &Mat<f32>) -> Mat<f32> {
        Mat::from_fn(plan.rows(), plan.cols(), |row, column| plan.row(self.image[row])[column])
    }
}

/// For every point the one nearest to its mirrored place; bit `k` of `flip` reverses axis `k`.
fn nearest_images(axes: &[Vec<f64>], flip: usize) -> Vec<usize> {
    let sign = |axis: usize| if flip >> axis & 1 == 1 { -1.0 } else { 1.0 };
    let count = axes.first().map_or(0, Vec::len);
    let apart = |i: usize, j: usize| -> f64 {
        axes.iter().enumerate().map(|(axis, along)| (sign(axis) * along[i] - along[j]).powi(2)).sum()
    };
    (0..count).map(|i| (0..count).min_by(|&a, &b| apart(i, a).total_cmp(&apart(i, b))).unwrap_or(i)).collect()
}

fn distortion(distances: &Mat<f32>, image: &[usize]) -> f64 {
    let (mut changed, mut all) = (0.0, 0.0);
    for (i, &to) in image.iter().enumerate() {
        let (row, mirrored) = (distances.row(i), distances.row(to));
        for (&distance, &other) in row.iter().zip(image) {
            changed += f64::from(mirrored[other] - distance).powi(2);
            all += f64::from(distance).powi(2);
        }
    }
    if all > 0.0 { (changed / all).sqrt() } else { 0.0 }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_usize), |(sum, count), value| (sum + value, count + 1));
    sum / count.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patches::{PatchScratch, normalised_self_distances};
    use crate::{Layout, Norm};

    fn distances(frames: usize, value: impl Fn(f32) -> f32) -> Mat<f32> {
        let table = Mat::from_fn(frames, 1, |row, _| value(row as f32));
        let mut out = Mat::default();
        let layout = Layout::open(frames, 11);
        normalised_self_distances(table.view(), &layout, Norm::Mean, &mut PatchScratch::new(), &mut out, 1)
            .unwrap()
            .unwrap();
        out
    }

    #[test]
    fn a_sine_is_its_own_mirror_image_and_a_sawtooth_with_steps_is_less_so() {
        let sine = Reflection::all(&distances(120, |t| (t * 0.2).sin()));
        assert!(sine[0].distortion < 0.1, "{}", sine[0].distortion);
        let odd = Reflection::all(&distances(120, |t| (t * 0.04).exp() * 0.01 + (t / 50.0).floor().powi(2)));
        assert!(odd[0].distortion > 2.0 * sine[0].distortion, "{}", odd[0].distortion);
        for reflection in sine.iter().chain(&odd) {
            assert!(reflection.image.len() == 110 && reflection.image.iter().all(|&to| to < 110));
        }
    }

    #[test]
    fn a_sample_says_how_symmetric_a_long_control_is() {
        for value in [|t: f32| (t * 0.05).sin(), |t: f32| (t * 0.002).exp() + 0.3 * (t * 0.05).sin()] {
            let long = distances(1400, value);
            let all = Reflection::all(&long).first().map_or(0.0, |truest| 1.0 - truest.distortion);
            assert!(
                (Reflection::symmetry(&long) - all).abs() < 0.05,
                "{} {all}",
                Reflection::symmetry(&long)
            );
        }
    }

    #[test]
    fn what_reads_the_same_backwards_is_found() {
        let there_and_back = distances(121, |t| (60.0 - t).abs().sqrt() + 3.0 * (60.0 - t).abs().sin());
        let all = Reflection::all(&there_and_back);
        // Reversing time leaves every pose where it is there, but runs through its patches backwards.
        assert!(all[0].distortion < 0.5, "{}", all[0].distortion);
    }
}
