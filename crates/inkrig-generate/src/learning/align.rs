//! One step of the encoders of conditions on the picture (stage B): they learn to say what the encoders of space say of the same
//! motion.

use super::control::{ControlBatch, ControlLearner, ControlLosses, ControlObjective};
use crate::GenerateError;
use crate::networks::{ConditionEncoder, ConditionRows, Domain, EncoderTape, Sizes, Vae, WeightGradients};
use crate::numeric::elementwise::dot;
use crate::numeric::product::OuterWork;
use crate::weights::Tensors;
use inkrig_motion::humanml::Statistics;

/// Pairs of conditions, one for each sample that has them: the same motion in space and on the picture.
#[derive(Debug, Clone, Copy)]
pub struct AlignBatch<'a> {
    /// Trajectories in space, and as the camera sees them.
    pub trajectories: (&'a [ConditionRows], &'a [ConditionRows]),
    /// Key poses in space, and as the camera sees them.
    pub keyposes: (&'a [ConditionRows], &'a [ConditionRows]),
    /// Samples that are denoised by what the picture says (their conditions are those of the picture).
    pub denoised: Option<ControlBatch<'a>>,
}

/// What the encoders are trained for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AlignObjective {
    /// Weight of the contrast: which vector of space belongs to which of the picture (InfoNCE).
    pub contrast: f64,
    /// What similarities are divided by (tau_1).
    pub temperature: f64,
    /// Of the mean squared distance of both vectors.
    pub matching: f64,
    /// Of the denoising by the vectors of the picture.
    pub control: ControlObjective,
}

/// The weighted loss, and its parts without their weights.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AlignLosses {
    /// What is made small.
    pub total: f64,
    /// See [`AlignObjective::contrast`], of trajectories and key poses together.
    pub contrast: f64,
    /// See [`AlignObjective::matching`], of both together.
    pub matching: f64,
    /// See [`AlignObjective::control`].
    pub control: ControlLosses,
}

/// The networks that stay, and buffers of a step.
#[derive(Debug)]
pub struct AlignLearner<'a> {
    sizes: Sizes,
    weights: Tensors,
    /// ControlNet and adapter with the encoders that are trained.
    all: Tensors,
    space: (ConditionEncoder, ConditionEncoder),
    control: ControlLearner<'a>,
    tapes: (EncoderTape, EncoderTape),
    still: EncoderTape,
    of_all: Vec<f32>,
    work: OuterWork,
}

impl<'a> AlignLearner<'a> {
    /// `weights` holds the encoders that are trained and no others; `model` all that stays: denoiser, control, encoders of space.
    ///
    /// # Errors
    /// When a weight is missing or of another shape.
    pub fn new(
        sizes: &Sizes,
        weights: &Tensors,
        (vae, model): (&'a Vae, &Tensors),
        features: &'a Statistics,
        places: &'a Statistics,
    ) -> Result<Self, GenerateError> {
        let control = |name: &str| {
            name.starts_with("controlnet.")
                || (name.starts_with("denoiser.")
                    && !name.starts_with("denoiser.denoiser.")
                    && !name.starts_with("denoiser.pose_encoder"))
        };
        let stays = model.iter().filter(|(name, _)| control(name));
        let stays = stays.map(|(name, tensor)| (name.to_string(), tensor.clone()));
        let mut all: Tensors = stays.chain(weights.clone()).collect();
        if weights.in_half_precision() {
            all.prefer_half_precision();
        }
        let encoders = (
            ConditionEncoder::trajectory(sizes, model, Domain::Space)?,
            ConditionEncoder::keypose(sizes, model, Domain::Space)?,
        );
        Ok(Self {
            sizes: sizes.clone(),
            weights: weights.clone(),
            space: encoders,
            control: ControlLearner::new(sizes, &all, (vae, model), Domain::Plane, features, places)?,
            all,
            tapes: Default::default(),
            still: EncoderTape::default(),
            of_all: Vec::new(),
            work: OuterWork::default(),
        })
    }

    /// The loss at the weights `row`, and its gradient, which replaces what is in `gradient`.
    ///
    /// # Errors
    /// When numbers do not fit each other.
    pub fn step(
        &mut self,
        row: &[f32],
        batch: &AlignBatch<'_>,
        objective: &AlignObjective,
        gradient: &mut Vec<f32>,
    ) -> Result<AlignLosses, GenerateError> {
        let weights = self.weights.with_row(row)?;
        gradient.clear();
        gradient.resize(row.len(), 0.0);
        let mut losses = AlignLosses::default();
        let plane = (
            ConditionEncoder::trajectory(&self.sizes, &weights, Domain::Plane)?,
            ConditionEncoder::keypose(&self.sizes, &weights, Domain::Plane)?,
        );
        for (encoders, pairs, tape) in [
            ((&self.space.0, &plane.0), batch.trajectories, &mut self.tapes.0),
            ((&self.space.1, &plane.1), batch.keyposes, &mut self.tapes.1),
        ] {
            let ((in_space, on_plane), (space, picture)) = (encoders, pairs);
            if space.len() != picture.len() {
                let (what, expected, got) = ("conditions on the picture", space.len(), picture.len());
                return Err(GenerateError::Length { what, expected, got });
            }
            if space.is_empty() {
                continue;
            }
            let wanted = in_space.encode_batch(&space.iter().collect::<Vec<_>>(), &mut self.still)?;
            let picture: Vec<&ConditionRows> = picture.iter().collect();
            let said = on_plane.encode_batch(&picture, tape)?;
            let mut grad = vec![0.0; said.len()];
            losses.matching += matching(&said, &wanted, objective.matching, &mut grad);
            let width = self.sizes.width;
            let (tau, weight) = (objective.temperature, objective.contrast);
            losses.contrast += contrast(&wanted, &said, width, tau, weight, &mut grad);
            let mut to = WeightGradients { row: gradient, work: &mut self.work };
            on_plane.backward_batch(&grad, &picture, tape, &mut to);
        }
        if let Some(denoised) = &batch.denoised {
            let all: Tensors = self.all.clone().into_iter().chain(weights.clone()).collect();
            let own = &objective.control;
            losses.control = self.control.step(&all.row(), denoised, own, None, &mut self.of_all)?;
            let mut first = 0;
            for (name, tensor) in all.iter() {
                let range = first..first + tensor.data().len();
                first = range.end;
                if weights.get(name).is_some() {
                    let place = weights.place(name);
                    let own = gradient.iter_mut().skip(place);
                    own.zip(&self.of_all[range]).for_each(|(sum, part)| *sum += part);
                }
            }
        }
        losses.total = objective.contrast * losses.contrast
            + objective.matching * losses.matching
            + losses.control.total;
        Ok(losses)
    }
}

/// Mean squared distance; its gradient, weighted, is added to `grad`.
fn matching(said: &[f32], wanted: &[f32], weight: f64, grad: &mut [f32]) -> f64 {
    let count = said.len() as f64;
    let scale = (2.0 * weight / count) as f32;
    let mut sum = 0.0;
    for ((grad, said), wanted) in grad.iter_mut().zip(said).zip(wanted) {
        let apart = said - wanted;
        sum += f64::from(apart * apart);
        *grad += scale * apart;
    }
    sum / count
}

/// InfoNCE from space to picture, by the cosine of vectors: how unlikely the own partner is among all. The gradient with respect to
/// those of the picture, weighted, is added to `grad`.
fn contrast(space: &[f32], picture: &[f32], width: usize, tau: f64, weight: f64, grad: &mut [f32]) -> f64 {
    let count = space.len() / width;
    let unit = |rows: &[f32]| -> (Vec<f32>, Vec<f32>) {
        let lengths: Vec<f32> = rows.chunks_exact(width).map(|row| dot(row, row).sqrt().max(1e-8)).collect();
        let of = rows.chunks_exact(width).zip(&lengths);
        (of.flat_map(|(row, length)| row.iter().map(move |x| x / length)).collect(), lengths)
    };
    let ((space, _), (picture, lengths)) = (unit(space), unit(picture));
    let mut sum = 0.0;
    let mut of_unit = vec![0.0_f32; picture.len()];
    let scale = weight / (tau * count as f64);
    for (own, space) in space.chunks_exact(width).enumerate() {
        let scores: Vec<f64> =
            picture.chunks_exact(width).map(|row| f64::from(dot(space, row)) / tau).collect();
        let most = scores.iter().fold(f64::NEG_INFINITY, |most, score| most.max(*score));
        let total: f64 = scores.iter().map(|score| (score - most).exp()).sum();
        sum += most + total.ln() - scores[own];
        for (other, (score, of)) in scores.iter().zip(of_unit.chunks_exact_mut(width)).enumerate() {
            let share = (score - most).exp() / total - f64::from(u8::from(other == own));
            let by = (scale * share) as f32;
            of.iter_mut().zip(space).for_each(|(of, space)| *of += by * space);
        }
    }
    // Only what changes the direction counts.
    let rows = grad.chunks_exact_mut(width).zip(of_unit.chunks_exact(width)).zip(picture.chunks_exact(width));
    for (((grad, of), unit), length) in rows.zip(lengths) {
        let along = dot(of, unit);
        for ((grad, of), unit) in grad.iter_mut().zip(of).zip(unit) {
            *grad += (of - along * unit) / length;
        }
    }
    sum / count as f64
}

#[cfg(test)]
mod tests {
    use super::super::control::tests::made;
    use super::super::testing::check_gradient;
    use super::*;
    use crate::learning::Wanted;
    use crate::networks::{Parts, tensors};
    use crate::schedule::Noise;

    fn rows(seed: u64, frames: &[usize]) -> ConditionRows {
        let mut noise = Noise::new(seed);
        frames.iter().map(|&frame| (frame, noise.normals(66))).collect()
    }

    #[test]
    fn the_gradient_is_a_difference_in_every_tensor() {
        let made = made();
        let plane = Parts { vae: false, denoiser: false, control: false, control_2d: true };
        let used = tensors(&made.sizes, plane).into_iter().filter(|spec| spec.used);
        let own: Tensors =
            used.map(|spec| (spec.name.clone(), made.all.get(&spec.name).unwrap().clone())).collect();
        let parts = (&made.vae, &made.all);
        let mut learner = AlignLearner::new(&made.sizes, &own, parts, &made.features, &made.places).unwrap();
        let space = [rows(1, &[0, 1, 5]), rows(2, &[3]), rows(3, &[2, 4])];
        let picture = [rows(4, &[0, 1, 5]), rows(5, &[3]), rows(6, &[2, 4])];
        let (poses, drawn) = ([rows(7, &[1]), rows(8, &[0])], [rows(9, &[1]), rows(10, &[0])]);
        let numbers = 2 * 2 * made.sizes.width;
        let (noisy, noise) = (Noise::new(1).normals(numbers), Noise::new(2).normals(numbers));
        let (texts, places) =
            (Noise::new(3).normals(2 * made.sizes.text_width), Noise::new(8).normals(6 * 66));
        let wanted = [Wanted { sample: 0, places: &places, trajectory: &[], keypose: Some(1) }];
        let denoised = ControlBatch {
            noisy: &noisy,
            noise: &noise,
            timesteps: &[5, 300],
            texts: &texts,
            trajectories: &picture[..2],
            keyposes: &drawn,
            wanted: &wanted,
        };
        let control = ControlObjective { noise: 1.0, trajectory: 0.0, keypose: 0.03, signal_power: 0.5 };
        let objective = AlignObjective { contrast: 0.5, temperature: 0.3, matching: 0.7, control };
        let batch = AlignBatch {
            trajectories: (&space, &picture),
            keyposes: (&poses, &drawn),
            denoised: Some(denoised),
        };
        check_gradient(&own, &[".pe"], |row| {
            let mut gradient = Vec::new();
            let losses = learner.step(row, &batch, &objective, &mut gradient).unwrap();
            assert!(losses.contrast > 0.0 && losses.matching > 0.0 && losses.control.keypose > 0.0);
            (losses.total, gradient)
        });
        let short = AlignBatch { keyposes: (&poses, &drawn[..1]), ..batch };
        assert!(learner.step(&own.row(), &short, &objective, &mut Vec::new()).is_err());
    }

    #[test]
    fn vectors_that_belong_together_have_no_contrast() {
        let (apart, together) = ([1.0, 0.0, 0.0, 2.0], [0.0, 1.0, 3.0, 0.0]);
        let grad = &mut [0.0; 4];
        assert!(contrast(&apart, &apart, 2, 0.07, 1.0, grad) < 1e-5);
        assert!(contrast(&apart, &together, 2, 0.07, 1.0, grad) > 10.0);
        assert!(matching(&apart, &apart, 1.0, grad) == 0.0);
    }
}
