//! What the autoencoder is trained for (MLD, `train_vae_forward`).

use super::mask::FrameMask;
use burn::tensor::{Device, Tensor, TensorData};
use inkrig_motion::humanml::{JOINTS, Statistics, WIDTH};

/// Weights of the parts of the loss.
#[derive(Debug, Clone, PartialEq)]
pub struct VaeLossWeights {
    /// Of the features' smooth L1 distance.
    pub features: f64,
    /// Of that of the joints' places, metres.
    pub places: f64,
    /// Of the Kullback-Leibler divergence from a normal distribution.
    pub divergence: f64,
    /// Whether padded frames count as perfect in the means, as they do in the published code.
    pub padding_counts: bool,
}

impl Default for VaeLossWeights {
    /// As published, but padded frames do not count.
    fn default() -> Self {
        Self { features: 1.0, places: 1.0, divergence: 1e-4, padding_counts: false }
    }
}

/// The loss and its parts, each a tensor of one number.
#[derive(Debug, Clone)]
pub struct VaeLoss {
    /// What is made small: the weighted sum.
    pub total: Tensor<1>,
    /// Smooth L1 distance of normalised features.
    pub features: Tensor<1>,
    /// Smooth L1 distance of places, metres.
    pub places: Tensor<1>,
    /// Divergence, a mean over all numbers of the latents.
    pub divergence: Tensor<1>,
}

impl VaeLoss {
    /// Of clips x frames x [`WIDTH`] normalised features that were decoded and that should have been, and of the means and
    /// logarithms of variances that they were decoded from.
    pub fn new(
        decoded: Tensor<3>,
        features: Tensor<3>,
        (mean, log_variance): (Tensor<3>, Tensor<3>),
        mask: &FrameMask,
        statistics: &Statistics,
        weights: &VaeLossWeights,
    ) -> Self {
        let device = decoded.device();
        let features = match mask.keep(&device) {
            Some(keep) => features * keep,
            None => features,
        };
        let counted = if weights.padding_counts { mask.clips() * mask.frames() } else { mask.count() };
        let counted = counted.max(1) as f64;
        let per_frame = |distance: Tensor<3>| {
            let width = distance.dims()[2] as f64;
            distance.sum() / (counted * width)
        };
        let places = |features: Tensor<3>| {
            let places = recovered_places(&restored(features, statistics, &device));
            match mask.keep(&device) {
                Some(keep) => places * keep,
                None => places,
            }
        };
        let features_part = per_frame(smooth_l1(decoded.clone(), features.clone()));
        let places_part = per_frame(smooth_l1(places(decoded), places(features)));
        let divergence = (mean.square() + log_variance.clone().exp() - log_variance - 1.0).mean() * 0.5;
        let total = features_part.clone() * weights.features
            + places_part.clone() * weights.places
            + divergence.clone() * weights.divergence;
        Self { total, features: features_part, places: places_part, divergence }
    }
}

/// Half the square of small differences, the size of large ones less one half.
pub fn smooth_l1(a: Tensor<3>, b: Tensor<3>) -> Tensor<3> {
    let size = (a - b).abs();
    let small = size.clone().clamp_max(1.0);
    // With s the smaller of |d| and 1: s (|d| - s / 2).
    small.clone() * (size - small * 0.5)
}

/// Places of the 22 joints, clips x frames x 66 metres, from features that are not normalised: as
/// [`inkrig_motion::humanml::recover_positions`], for training.
pub fn recovered_places(features: &Tensor<3>) -> Tensor<3> {
    let [clips, frames, _] = features.dims();
    let device = features.device();
    let zero = Tensor::<3>::zeros([clips, 1, 1], &device);
    let column = |at: usize| features.clone().narrow(2, at, 1);
    // What is said at a frame happens before the next.
    let shifted = |x: Tensor<3>| Tensor::cat(vec![zero.clone(), x.narrow(1, 0, frames - 1)], 1);
    let angle = shifted(column(0)).cumsum(1) * 2.0;
    let (sin, cos) = (angle.clone().sin(), angle.cos());
    let turn = |x: Tensor<3>, z: Tensor<3>| {
        let (sin, cos) = (sin.clone(), cos.clone());
        (x.clone() * cos.clone() - z.clone() * sin.clone(), x * sin + z * cos)
    };
    let (x, z) = turn(shifted(column(1)), shifted(column(2)));
    let (root_x, root_z) = (x.cumsum(1), z.cumsum(1));
    let local = features.clone().narrow(2, 4, 3 * (JOINTS - 1)).reshape([clips, frames, JOINTS - 1, 3]);
    let axis = |at: usize| local.clone().narrow(3, at, 1).reshape([clips, frames, JOINTS - 1]);
    let (x, z) = turn(axis(0), axis(2));
    let joints = [x + root_x.clone(), axis(1), z + root_z.clone()];
    let root = [root_x, column(3), root_z];
    let with_root = root.into_iter().zip(joints).map(|(root, joints)| Tensor::cat(vec![root, joints], 2));
    Tensor::stack::<4>(with_root.collect(), 3).reshape([clips, frames, 3 * JOINTS])
}

fn restored(features: Tensor<3>, statistics: &Statistics, device: &Device) -> Tensor<3> {
    let row = |numbers: &[f32]| {
        Tensor::<1>::from_data(TensorData::new(numbers.to_vec(), [WIDTH]), device).reshape([1, 1, WIDTH])
    };
    features * row(statistics.deviation()) + row(statistics.mean())
}
