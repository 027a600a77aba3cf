//! One step of control by an estimate: an estimator of conditions and, in space, the correction, on a denoiser and an autoencoder that
//! stay as they are.

use super::placed::{Asked, Distances, Placed};
use crate::GenerateError;
use crate::networks::{
    CORRECTIONS, Correction, CorrectionTape, Denoiser, Domain, Dropout, Estimate, Estimator, EstimatorTape,
    Noisy, Sizes, Vae, WeightGradients, Work, told,
};
use crate::numeric::elementwise::add;
use crate::numeric::product::OuterWork;
use crate::sampling::{Conditions, Misses};
use crate::schedule::NoiseSchedule;
use crate::weights::Tensors;
use inkrig_motion::humanml::Statistics;

/// Samples of a batch, one after the other.
#[derive(Debug, Clone, Copy)]
pub struct EstimateBatch<'a> {
    /// Clean latents, samples x latent tokens x width.
    pub clean: &'a [f32],
    /// The same with noise.
    pub noisy: &'a [f32],
    /// One for each sample, from 0 to 999.
    pub timesteps: &'a [usize],
    /// The first samples have the noise of these later timesteps, and are brought to their own by the model itself, as a sampler would: what
    /// it sees then is not quite what was noised, but what is asked for is to be met all the same. Their velocities have no loss.
    pub rolled: &'a [usize],
    /// Samples x text width.
    pub texts: &'a [f32],
    /// What each is asked for.
    pub conditions: &'a [Conditions],
    /// The same by frames and joints, also where conditions are on the picture.
    pub asked: &'a [Asked<'a>],
}

/// Weights of what is made small.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimateObjective {
    /// Of the mean squared error of the corrected velocity.
    pub velocity: f64,
    /// Of the mean squared error of the estimated latent.
    pub estimate: f64,
    /// Of trajectories' mean distance in metres, in what is predicted.
    pub trajectory: f64,
    /// Of key poses'.
    pub keypose: f64,
    /// How much both count in what is estimated, to how much in what is predicted.
    pub estimated: f64,
}

/// The weighted loss, and its parts without their weights.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct EstimateLosses {
    /// What is made small.
    pub total: f64,
    /// See [`EstimateObjective::velocity`]; samples that were rolled count as without error.
    pub velocity: f64,
    /// See [`EstimateObjective::estimate`].
    pub estimate: f64,
    /// Distances in what is predicted.
    pub predicted: Distances,
    /// Distances in what is estimated.
    pub estimated: Distances,
}

/// The networks that stay, and buffers of a step.
#[derive(Debug)]
pub struct EstimateLearner<'a> {
    sizes: Sizes,
    domain: Domain,
    weights: Tensors,
    denoiser: Denoiser,
    /// Where it stays, and how many numbers it has.
    correction: Option<(Correction, usize)>,
    placed: Placed<'a>,
    schedule: NoiseSchedule,
    estimator: EstimatorTape,
    weighed: CorrectionTape,
    /// Of each correction, with what it was told of.
    corrected: [(CorrectionTape, Misses); CORRECTIONS],
    run: Work,
    vae: &'a Vae,
    features: &'a Statistics,
    work: OuterWork,
}

impl<'a> EstimateLearner<'a> {
    /// `weights` holds the tensors that have gradients and no others: the estimator of a domain, and in space the correction, which on the
    /// plane is in `base` as the denoiser is. `features` are their statistics.
    ///
    /// # Errors
    /// When a weight is missing or of another shape.
    pub fn new(
        sizes: &Sizes,
        weights: &Tensors,
        (vae, base): (&'a Vae, &Tensors),
        domain: Domain,
        features: &'a Statistics,
    ) -> Result<Self, GenerateError> {
        Estimator::new(sizes, weights, domain)?;
        let correction = match domain {
            Domain::Space => Correction::new(sizes, weights).map(|_| None)?,
            Domain::Plane => {
                let own = base.iter().filter(|(name, _)| name.starts_with("estimate.correction."));
                let mut own: Tensors = own.map(|(name, tensor)| (name.to_string(), tensor.clone())).collect();
                if base.in_half_precision() {
                    own.prefer_half_precision();
                }
                Some((Correction::new(sizes, &own)?, own.numbers()))
            }
        };
        Ok(Self {
            sizes: sizes.clone(),
            domain,
            weights: weights.clone(),
            denoiser: Denoiser::new(sizes, base)?,
            correction,
            placed: Placed::new(vae, features),
            schedule: NoiseSchedule::default(),
            estimator: EstimatorTape::default(),
            weighed: CorrectionTape::default(),
            corrected: Default::default(),
            run: Work::default(),
            vae,
            features,
            work: OuterWork::default(),
        })
    }

    /// The loss at the weights `row`, and its gradient, which replaces what is in `gradient`. `dropout` is the share of numbers that
    /// blocks drop, and which they are.
    ///
    /// # Errors
    /// When numbers do not fit each other.
    pub fn step(
        &mut self,
        row: &[f32],
        batch: &EstimateBatch<'_>,
        objective: &EstimateObjective,
        dropout: Option<(f32, u64)>,
        gradient: &mut Vec<f32>,
    ) -> Result<EstimateLosses, GenerateError> {
        batch.check(&self.sizes)?;
        let each = self.sizes.latent_tokens * self.sizes.width;
        let weights = self.weights.with_row(row)?;
        let estimator = Estimator::new(&self.sizes, &weights, self.domain)?;
        let learned = match self.domain {
            Domain::Space => Some(Correction::new(&self.sizes, &weights)?),
            Domain::Plane => None,
        };
        let dropout = dropout.map(|(share, seed)| Dropout { share, seed });
        self.estimator.set_dropout(dropout);
        for (at, (tape, _)) in self.corrected.iter_mut().enumerate() {
            let own = dropout.filter(|_| learned.is_some());
            tape.set_dropout(own.map(|own| own.of_block(64 * (at + 1))));
        }

        // The estimate, and what it corrects.
        let all = batch.conditions.iter();
        let all = all.flat_map(|own| told(own.frames, own.trajectory(), own.keypose())).collect();
        let estimate = estimator.forward_batch(all, &mut self.estimator);
        let stays = self.correction.as_ref().map(|(correction, _)| correction);
        let correction = learned.as_ref().or(stays);
        let Some(correction) = correction else {
            return Err(GenerateError::MissingTensor { name: "estimate.correction.*".into() });
        };
        let mut noisy = batch.noisy.to_vec();
        let rolled = batch.rolled.len();
        if rolled > 0 {
            let latents = &noisy[..rolled * each];
            let texts = &batch.texts[..rolled * self.sizes.text_width];
            let mut clean = denoised(&self.denoiser, latents, batch.rolled, texts, &mut self.run)?;
            let first = estimate.first(rolled, batch.timesteps.len());
            let tape = &mut CorrectionTape::default();
            correction.weigh(&mut clean, batch.rolled, &first, tape);
            let asked = &batch.conditions[..rolled];
            for _ in 0..CORRECTIONS {
                let missed = Misses::default().of(self.vae, self.features, &clean, asked)?;
                correction.correct(latents, &mut clean, batch.rolled, (&first, &missed), tape);
            }
            let steps = batch.rolled.iter().zip(batch.timesteps);
            let rows = noisy.chunks_exact_mut(each).zip(clean.chunks_exact(each));
            for ((noisy, clean), (&from, &to)) in rows.zip(steps) {
                let [from, to] = [from, to].map(|step| self.schedule.alpha(step));
                for (noisy, clean) in noisy.iter_mut().zip(clean) {
                    let noise = (*noisy - from.sqrt() * clean) / (1.0 - from).sqrt();
                    *noisy = to.sqrt() * clean + (1.0 - to).sqrt() * noise;
                }
            }
        }
        let mut clean = denoised(&self.denoiser, &noisy, batch.timesteps, batch.texts, &mut self.run)?;
        correction.weigh(&mut clean, batch.timesteps, &estimate, &mut self.weighed);
        for (tape, misses) in &mut self.corrected {
            let missed = misses.of(self.vae, self.features, &clean, batch.conditions)?;
            correction.correct(&noisy, &mut clean, batch.timesteps, (&estimate, &missed), tape);
        }
        // The error of the velocity is that of the clean latent over sqrt(1 - alpha).
        let mut losses = EstimateLosses::default();
        let mut of_clean = Vec::with_capacity(clean.len());
        let count = clean.len() as f64;
        let rows = clean.chunks_exact(each).zip(batch.clean.chunks_exact(each)).zip(batch.timesteps);
        for (sample, ((clean, wanted), &step)) in rows.enumerate() {
            let share = (1.0 - self.schedule.alpha(step)).sqrt();
            let counts = if sample < rolled { 0.0 } else { 1.0 };
            for (clean, wanted) in clean.iter().zip(wanted) {
                let apart = counts * f64::from((clean - wanted) / share);
                losses.velocity += apart * apart / count;
                of_clean.push((2.0 * objective.velocity * apart / count) as f32 / share);
            }
        }
        let mut of_estimate = Estimate::default();
        for (own, wanted) in estimate.latents.iter().zip(batch.clean) {
            let apart = f64::from(own - wanted);
            losses.estimate += apart * apart / count;
            of_estimate.latents.push((2.0 * objective.estimate * apart / count) as f32);
        }
        // Where the joints are.
        let wanted = self.placed.places(batch.clean, batch.asked)?;
        let by = (objective.trajectory, objective.keypose);
        let (predicted, of_places) = self.placed.distances(&clean, batch.asked, &wanted, by)?;
        add(&mut of_clean, &of_places);
        let both = (by.0 * objective.estimated, by.1 * objective.estimated);
        let (estimated, of_latents) = self.placed.distances(&estimate.latents, batch.asked, &wanted, both)?;
        add(&mut of_estimate.latents, &of_latents);
        (losses.predicted, losses.estimated) = (predicted, estimated);
        losses.total = objective.velocity * losses.velocity
            + objective.estimate * losses.estimate
            + by.0 * predicted.trajectory
            + by.1 * predicted.keypose
            + both.0 * estimated.trajectory
            + both.1 * estimated.keypose;

        gradient.clear();
        gradient.resize(row.len(), 0.0);
        // Weights that stay have gradients that nobody asks for.
        let mut nobody = vec![0.0; self.correction.as_ref().map_or(0, |(_, numbers)| *numbers)];
        let row = if learned.is_some() { &mut gradient[..] } else { &mut nobody };
        let mut to = WeightGradients { row, work: &mut self.work };
        let (vae, features) = (self.vae, self.features);
        for (tape, misses) in self.corrected.iter_mut().rev() {
            let back = |grad: &[f32]| misses.backward(vae, features, batch.conditions, grad);
            let through = (&*tape, &mut of_estimate);
            of_clean = correction.correct_back(&of_clean, batch.timesteps, through, &mut to, back)?;
        }
        let through = (&self.weighed, &mut of_estimate);
        correction.weigh_back(&of_clean, batch.timesteps, through, &mut to);
        let mut to = WeightGradients { row: gradient, work: &mut self.work };
        estimator.backward_batch(&estimate, &of_estimate, &self.estimator, &mut to);
        Ok(losses)
    }
}

/// The clean latents that the denoiser sees in noisy ones.
fn denoised(
    denoiser: &Denoiser,
    latents: &[f32],
    timesteps: &[usize],
    texts: &[f32],
    run: &mut Work,
) -> Result<Vec<f32>, GenerateError> {
    let noise = denoiser.noise(&Noisy { latents, timesteps, texts, guidance: None }, None, run)?;
    let (mut clean, schedule) = (vec![0.0; noise.len()], NoiseSchedule::default());
    let each = noise.len() / timesteps.len().max(1);
    let rows = clean.chunks_exact_mut(each).zip(latents.chunks_exact(each)).zip(noise.chunks_exact(each));
    for (((clean, noisy), noise), &step) in rows.zip(timesteps) {
        schedule.clean(noisy, noise, step, clean);
    }
    Ok(clean)
}

impl EstimateBatch<'_> {
    fn check(&self, sizes: &Sizes) -> Result<(), GenerateError> {
        let count = self.timesteps.len();
        let latent = sizes.latent_tokens * sizes.width;
        for (what, expected, got) in [
            ("clean latents", count * latent, self.clean.len()),
            ("latents", count * latent, self.noisy.len()),
            ("texts", count * sizes.text_width, self.texts.len()),
            ("conditions of samples", count, self.conditions.len()),
            ("what is asked of samples", count, self.asked.len()),
            ("samples beyond the batch", 0, self.rolled.len().saturating_sub(count)),
        ] {
            if expected != got || count == 0 {
                return Err(GenerateError::Length { what, expected, got });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::check_gradient_within;
    use super::*;
    use crate::guidance::{Ask, View};
    use crate::networks::{Parts, tensors};
    use crate::sampling::{Request, Semantics};
    use crate::schedule::Noise;
    use crate::weights::hashed;
    use inkrig_motion::glam::Vec3;
    use inkrig_motion::humanml::{Camera, WIDTH};

    fn conditions(view: View, frames: usize, asks: &[(usize, usize)], pose: Option<usize>) -> Conditions {
        let numbers = Noise::new(frames as u64).normals(3 * (asks.len() + 22));
        let mut places = numbers.chunks_exact(3).map(|at| Vec3::new(at[0], at[1], at[2]));
        let mut place = || places.next().unwrap();
        let asks = asks.iter().map(|&(frame, joint)| Ask { frame, joint, place: place() }).collect();
        let keypose = pose.map(|frame| (frame, std::array::from_fn(|_| place())));
        let request = Request { frames, text: Vec::new(), view, trajectory: asks, keypose };
        let places = Statistics::new(vec![0.1; 66], vec![0.5; 66]).unwrap();
        Conditions::new(&request, &places, Semantics::Paper).unwrap()
    }

    #[test]
    fn the_gradient_is_a_difference_in_every_tensor() {
        for (cosines, domain) in [(4, Domain::Space), (0, Domain::Space), (4, Domain::Plane)] {
            let sizes = Sizes { estimate: 12, cosines, latent_tokens: 2, velocity: true, ..Sizes::tiny() };
            let all = hashed(&sizes, Parts::ALL);
            let parts = Parts {
                vae: false,
                denoiser: false,
                control: domain == Domain::Space,
                control_2d: domain == Domain::Plane,
            };
            let own = tensors(&sizes, parts).into_iter();
            let own: Tensors =
                own.map(|spec| (spec.name.clone(), all.get(&spec.name).unwrap().clone())).collect();
            let vae = Vae::new(&sizes, &all).unwrap();
            let features = Statistics::new(vec![0.0; WIDTH], vec![0.1; WIDTH]).unwrap();
            let mut learner = EstimateLearner::new(&sizes, &own, (&vae, &all), domain, &features).unwrap();
            let camera = View::Plane(Camera::default());
            let view = if domain == Domain::Plane { camera } else { View::Space };
            let numbers = 3 * 2 * sizes.width;
            let (clean, noisy) = (Noise::new(1).normals(numbers), Noise::new(2).normals(numbers));
            let texts = Noise::new(3).normals(3 * sizes.text_width);
            let batch = EstimateBatch {
                clean: &clean,
                noisy: &noisy,
                timesteps: &[120, 300, 900],
                rolled: &[],
                texts: &texts,
                conditions: &[
                    conditions(view, 6, &[(0, 10), (5, 0)], Some(2)),
                    conditions(view, 9, &[(3, 4)], None),
                    conditions(view, 4, &[], Some(0)),
                ],
                asked: &[
                    Asked { frames: 6, trajectory: &[(0, 10), (5, 0)], keypose: Some(2) },
                    Asked { frames: 9, trajectory: &[(3, 4)], keypose: None },
                    Asked { frames: 4, trajectory: &[], keypose: Some(0) },
                ],
            };
            let objective = EstimateObjective {
                velocity: 0.01,
                estimate: 0.3,
                trajectory: 2.0,
                keypose: 4.0,
                estimated: 0.5,
            };
            for dropout in [None, Some((0.1, 5))] {
                check_gradient_within(3e-4, &own, &[], |row| {
                    let mut gradient = Vec::new();
                    let losses = learner.step(row, &batch, &objective, dropout, &mut gradient).unwrap();
                    assert!(losses.predicted.keypose > 0.0 && losses.estimated.trajectory > 0.0);
                    (losses.total, gradient)
                });
            }
            let short = EstimateBatch { asked: &[], ..batch };
            assert!(learner.step(&own.row(), &short, &objective, None, &mut Vec::new()).is_err());
        }
    }
}
