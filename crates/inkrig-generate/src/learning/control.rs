//! One step of the control by conditions in space (stage A): ControlNet, adapter and their encoders, on a denoiser and an autoencoder
//! that stay as they are.

use super::decoded::{Decoded, DecodedLosses, Wanted};
use crate::GenerateError;
use crate::networks::{
    Adapter, ConditionEncoder, ConditionRows, ControlNet, ControlTape, Denoiser, DenoiserTape, Domain,
    Dropout, EncoderTape, Residuals, Samples, Sizes, Vae, WaveTable, WeightGradients,
};
use crate::numeric::product::OuterWork;
use crate::schedule::NoiseSchedule;
use crate::weights::Tensors;
use inkrig_motion::humanml::Statistics;

/// Samples of a batch, one after the other.
#[derive(Debug, Clone, Copy)]
pub struct ControlBatch<'a> {
    /// Latents with noise, samples x latent tokens x width.
    pub noisy: &'a [f32],
    /// The noise in them.
    pub noise: &'a [f32],
    /// One for each sample, from 0 to 999.
    pub timesteps: &'a [usize],
    /// Samples x text width.
    pub texts: &'a [f32],
    /// What each trajectory asks for; nothing for samples without.
    pub trajectories: &'a [ConditionRows],
    /// The key pose of each; nothing for samples without.
    pub keyposes: &'a [ConditionRows],
    /// What some samples shall be when they are decoded.
    pub wanted: &'a [Wanted<'a>],
}

/// What control is trained for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlObjective {
    /// Weight of the mean squared error of the noise.
    pub noise: f64,
    /// Of the trajectories' distance, in normalised units.
    pub trajectory: f64,
    /// Of the key poses'.
    pub keypose: f64,
    /// Distances of samples with much noise count less: times this power of the share of signal.
    pub signal_power: f64,
}

/// The weighted loss, and its parts without their weights.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ControlLosses {
    /// What is made small.
    pub total: f64,
    /// See [`ControlObjective::noise`].
    pub noise: f64,
    /// See [`ControlObjective::trajectory`].
    pub trajectory: f64,
    /// See [`ControlObjective::keypose`].
    pub keypose: f64,
}

/// The networks that stay, and buffers of a step.
#[derive(Debug)]
pub struct ControlLearner<'a> {
    sizes: Sizes,
    domain: Domain,
    weights: Tensors,
    vae: &'a Vae,
    denoiser: Denoiser,
    schedule: NoiseSchedule,
    waves: WaveTable,
    decoded: Decoded<'a>,
    base: DenoiserTape,
    trajectory: (EncoderTape, ControlTape),
    keypose: (EncoderTape, ControlTape),
    work: OuterWork,
}

impl<'a> ControlLearner<'a> {
    /// `weights` holds the tensors that have gradients and no others: ControlNet, adapter and the encoders of a domain; those of the
    /// denoiser are in `base`. `features` and `places` are the
    /// statistics of features and of joints' places.
    ///
    /// # Errors
    /// When a weight is missing or of another shape.
    pub fn new(
        sizes: &Sizes,
        weights: &Tensors,
        (vae, base): (&'a Vae, &Tensors),
        domain: Domain,
        features: &'a Statistics,
        places: &'a Statistics,
    ) -> Result<Self, GenerateError> {
        Parts::new(sizes, weights, domain)?;
        Ok(Self {
            domain,
            sizes: sizes.clone(),
            weights: weights.clone(),
            vae,
            denoiser: Denoiser::new(sizes, base)?,
            schedule: NoiseSchedule::default(),
            waves: WaveTable::new(sizes.text_width),
            decoded: Decoded::new(features, places)?,
            base: DenoiserTape::for_inputs(),
            trajectory: Default::default(),
            keypose: Default::default(),
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
        batch: &ControlBatch<'_>,
        objective: &ControlObjective,
        dropout: Option<(f32, u64)>,
        gradient: &mut Vec<f32>,
    ) -> Result<ControlLosses, GenerateError> {
        let count = batch.check(&self.sizes)?;
        let weights = self.weights.with_row(row)?;
        let parts = Parts::new(&self.sizes, &weights, self.domain)?;
        let width = self.sizes.width;
        let latent = self.sizes.latent_tokens * width;
        let each = latent + 2 * width;
        let dropout = dropout.map(|(share, seed)| Dropout { share, seed });
        self.trajectory.1.branch.set_dropout(dropout);
        self.keypose.1.branch.set_dropout(dropout.map(|dropout| dropout.of_block(64)));

        let with = |conditions: &[ConditionRows]| -> Vec<usize> {
            (0..count).filter(|&at| conditions.get(at).is_some_and(|rows| !rows.is_empty())).collect()
        };
        let (drawn, posed) = (with(batch.trajectories), with(batch.keyposes));
        let paths: Vec<&ConditionRows> = drawn.iter().map(|&at| &batch.trajectories[at]).collect();
        let poses: Vec<&ConditionRows> = posed.iter().map(|&at| &batch.keyposes[at]).collect();

        // Trajectories.
        let of_drawn = Own::of(batch, &drawn, (latent, self.sizes.text_width));
        let mut corrections: Residuals = vec![vec![0.0; count * each]; self.sizes.control_blocks];
        if !drawn.is_empty() {
            let embedded = parts.trajectory.encode_batch(&paths, &mut self.trajectory.0)?;
            let samples = of_drawn.samples();
            let own = parts.control.forward_batch(&samples, &self.waves, &embedded, &mut self.trajectory.1);
            scatter(&own, &drawn, each, &mut corrections);
        }
        // Key poses, which see the corrections of trajectories and take their place.
        let mut of_posed = Own::of(batch, &posed, (latent, self.sizes.text_width));
        if !posed.is_empty() {
            let embedded = parts.keypose.encode_batch(&poses, &mut self.keypose.0)?;
            of_posed.texts = parts.adapter.ground_batch(&of_posed.texts, &embedded, &mut self.keypose.1);
            let came = gather(&corrections, &posed, each);
            let samples = of_posed.samples();
            let own = parts.adapter.forward_batch(&samples, &self.waves, &came, &mut self.keypose.1);
            scatter(&own, &posed, each, &mut corrections);
        }
        let samples =
            Samples { latents: batch.noisy, timesteps: batch.timesteps, texts: batch.texts, guidance: None };
        let predicted =
            self.denoiser.forward_batch(&samples, &self.waves, Some(&corrections), &mut self.base);
        let (losses, grad) = self.losses(&predicted, batch, objective)?;
        gradient.clear();
        gradient.resize(row.len(), 0.0);
        let mut of_corrections: Residuals = vec![Vec::new(); self.sizes.control_blocks];
        self.denoiser.corrections_gradient(&grad, &samples, &mut self.base, &mut of_corrections);
        let mut to = WeightGradients { row: gradient, work: &mut self.work };
        if !posed.is_empty() {
            let own = gather(&of_corrections, &posed, each);
            let samples = of_posed.samples();
            let (came, embedded) = parts.adapter.backward_batch(&own, &samples, &mut self.keypose.1, &mut to);
            parts.keypose.backward_batch(&embedded, &poses, &mut self.keypose.0, &mut to);
            scatter(&came, &posed, each, &mut of_corrections);
        }
        if !drawn.is_empty() {
            let own = gather(&of_corrections, &drawn, each);
            let samples = of_drawn.samples();
            let embedded = parts.control.backward_batch(&own, &samples, &mut self.trajectory.1, &mut to);
            parts.trajectory.backward_batch(&embedded, &paths, &mut self.trajectory.0, &mut to);
        }
        Ok(losses)
    }

    /// All losses of what came out of the denoiser, and their gradient with respect to the predicted noise.
    fn losses(
        &mut self,
        predicted: &[f32],
        batch: &ControlBatch<'_>,
        objective: &ControlObjective,
    ) -> Result<(ControlLosses, Vec<f32>), GenerateError> {
        let latent = self.sizes.latent_tokens * self.sizes.width;
        let scale = 2.0 * objective.noise / predicted.len() as f64;
        let mut losses = ControlLosses::default();
        let mut grad: Vec<f32> = Vec::with_capacity(predicted.len());
        for (at, (predicted, noise)) in predicted.iter().zip(batch.noise).enumerate() {
            let apart = f64::from(predicted - noise);
            let weight = f64::from(self.denoiser.loss_weight(batch.timesteps[at / latent]));
            losses.noise += weight * apart * apart / batch.noise.len() as f64;
            grad.push((scale * weight * apart) as f32);
        }
        if !batch.wanted.is_empty() && (objective.trajectory > 0.0 || objective.keypose > 0.0) {
            let mut clean = Vec::with_capacity(batch.wanted.len() * latent);
            for wanted in batch.wanted {
                let own = wanted.sample * latent..(wanted.sample + 1) * latent;
                let first = clean.len();
                clean.resize(first + latent, 0.0);
                let step = batch.timesteps[wanted.sample];
                self.schedule.clean(&batch.noisy[own.clone()], &predicted[own], step, &mut clean[first..]);
            }
            let signal = |wanted: &Wanted<'_>| {
                f64::from(self.schedule.alpha(batch.timesteps[wanted.sample])).powf(objective.signal_power)
            };
            let signals: Vec<f64> = batch.wanted.iter().map(signal).collect();
            let weights = (objective.trajectory, objective.keypose);
            let (DecodedLosses { trajectory, keypose }, of_clean) =
                self.decoded.losses(self.vae, &clean, batch.wanted, &signals, weights)?;
            (losses.trajectory, losses.keypose) = (trajectory, keypose);
            for (wanted, of_clean) in batch.wanted.iter().zip(of_clean.chunks_exact(latent)) {
                let alpha = self.schedule.alpha(batch.timesteps[wanted.sample]);
                let factor = -((1.0 - alpha) / alpha).sqrt();
                let own = &mut grad[wanted.sample * latent..][..latent];
                own.iter_mut().zip(of_clean).for_each(|(grad, of)| *grad += factor * of);
            }
        }
        losses.total = objective.noise * losses.noise
            + objective.trajectory * losses.trajectory
            + objective.keypose * losses.keypose;
        Ok((losses, grad))
    }
}

impl ControlBatch<'_> {
    /// How many samples there are, if all fits.
    fn check(&self, sizes: &Sizes) -> Result<usize, GenerateError> {
        let count = self.timesteps.len();
        let latent = sizes.latent_tokens * sizes.width;
        let beyond = self.wanted.iter().filter(|wanted| wanted.sample >= count).count();
        for (what, expected, got) in [
            ("latents", count * latent, self.noisy.len()),
            ("noise of latents", count * latent, self.noise.len()),
            ("texts", count * sizes.text_width, self.texts.len()),
            ("trajectories of samples", count, self.trajectories.len()),
            ("key poses of samples", count, self.keyposes.len()),
            ("wanted samples beyond the batch", 0, beyond),
        ] {
            if expected != got || count == 0 {
                return Err(GenerateError::Length { what, expected, got });
            }
        }
        Ok(count)
    }
}

/// The networks that are trained.
struct Parts {
    control: ControlNet,
    adapter: Adapter,
    trajectory: ConditionEncoder,
    keypose: ConditionEncoder,
}

impl Parts {
    fn new(sizes: &Sizes, weights: &Tensors, domain: Domain) -> Result<Self, GenerateError> {
        Ok(Self {
            control: ControlNet::new(sizes, weights)?,
            adapter: Adapter::new(sizes, weights)?,
            trajectory: ConditionEncoder::trajectory(sizes, weights, domain)?,
            keypose: ConditionEncoder::keypose(sizes, weights, domain)?,
        })
    }
}

/// Some samples of a batch.
struct Own {
    latents: Vec<f32>,
    timesteps: Vec<usize>,
    texts: Vec<f32>,
}

impl Own {
    fn of(batch: &ControlBatch<'_>, which: &[usize], (latent, text): (usize, usize)) -> Self {
        let rows = |table: &[f32], width: usize| -> Vec<f32> {
            which.iter().flat_map(|&at| &table[at * width..(at + 1) * width]).copied().collect()
        };
        Self {
            latents: rows(batch.noisy, latent),
            timesteps: which.iter().map(|&at| batch.timesteps[at]).collect(),
            texts: rows(batch.texts, text),
        }
    }

    fn samples(&self) -> Samples<'_> {
        Samples { latents: &self.latents, timesteps: &self.timesteps, texts: &self.texts, guidance: None }
    }
}

/// The tables of some samples, `each` numbers a sample.
fn gather(tables: &Residuals, which: &[usize], each: usize) -> Residuals {
    let rows = |table: &Vec<f32>| which.iter().flat_map(|&at| &table[at * each..][..each]).copied().collect();
    tables.iter().map(rows).collect()
}

/// Puts the tables of some samples in the places of theirs among all.
fn scatter(from: &Residuals, which: &[usize], each: usize, into: &mut Residuals) {
    for (from, into) in from.iter().zip(into) {
        for (row, &at) in from.chunks_exact(each).zip(which) {
            into[at * each..][..each].copy_from_slice(row);
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::testing::check_gradient;
    use super::*;
    use crate::networks::{Parts as Networks, tensors};
    use crate::sampling::{Conditions, Networks as Whole, Request, Semantics};
    use crate::schedule::Noise;
    use crate::weights::hashed;
    use inkrig_motion::humanml::WIDTH;

    pub(in super::super) struct Made {
        pub(in super::super) sizes: Sizes,
        pub(in super::super) own: Tensors,
        pub(in super::super) all: Tensors,
        pub(in super::super) vae: Vae,
        pub(in super::super) features: Statistics,
        pub(in super::super) places: Statistics,
    }

    pub(in super::super) fn made() -> Made {
        let sizes = Sizes { latent_tokens: 2, guidance_width: 0, velocity: true, ..Sizes::tiny() };
        let all = hashed(&sizes, Networks::ALL);
        let control = Networks { vae: false, denoiser: false, control: true, control_2d: false };
        let used = tensors(&sizes, control).into_iter().filter(|spec| spec.used);
        let own = used.map(|spec| (spec.name.clone(), all.get(&spec.name).unwrap().clone())).collect();
        let deviation = |count| Noise::new(9).normals(count).iter().map(|x| 0.1 + 0.1 * x.abs()).collect();
        Made {
            vae: Vae::new(&sizes, &all).unwrap(),
            features: Statistics::new(vec![0.0; WIDTH], deviation(WIDTH)).unwrap(),
            places: Statistics::new(vec![0.1; 66], deviation(66)).unwrap(),
            own,
            all,
            sizes,
        }
    }

    impl Made {
        fn learner(&self) -> ControlLearner<'_> {
            let parts = (&self.vae, &self.all);
            ControlLearner::new(&self.sizes, &self.own, parts, Domain::Space, &self.features, &self.places)
                .unwrap()
        }
    }

    fn rows(seed: u64, frames: &[usize]) -> ConditionRows {
        let mut noise = Noise::new(seed);
        frames.iter().map(|&frame| (frame, noise.normals(66))).collect()
    }

    #[test]
    fn the_gradient_is_a_difference_in_every_tensor() {
        let made = made();
        let numbers = 4 * 2 * made.sizes.width;
        let (noisy, noise) = (Noise::new(1).normals(numbers), Noise::new(2).normals(numbers));
        let texts = Noise::new(3).normals(4 * made.sizes.text_width);
        // Both, one of each, none.
        let trajectories = [rows(4, &[0, 1, 5]), rows(5, &[3]), Vec::new(), Vec::new()];
        let keyposes = [rows(6, &[2]), Vec::new(), rows(7, &[0]), Vec::new()];
        let places = Noise::new(8).normals(6 * 66);
        let wanted = [
            Wanted { sample: 0, places: &places, trajectory: &[(0, 10), (5, 0)], keypose: Some(2) },
            Wanted { sample: 2, places: &places[66..], trajectory: &[], keypose: Some(0) },
        ];
        let batch = ControlBatch {
            noisy: &noisy,
            noise: &noise,
            timesteps: &[5, 300, 100, 700],
            texts: &texts,
            trajectories: &trajectories,
            keyposes: &keyposes,
            wanted: &wanted,
        };
        let objective = ControlObjective { noise: 1.0, trajectory: 0.02, keypose: 0.03, signal_power: 0.5 };
        let mut learner = made.learner();
        for dropout in [None, Some((0.1, 5))] {
            check_gradient(&made.own, &[".pe"], |row| {
                let mut gradient = Vec::new();
                let losses = learner.step(row, &batch, &objective, dropout, &mut gradient).unwrap();
                assert!(losses.trajectory > 0.0 && losses.keypose > 0.0);
                (losses.total, gradient)
            });
        }
        let short = ControlBatch { keyposes: &keyposes[..2], ..batch };
        assert!(learner.step(&made.own.row(), &short, &objective, None, &mut Vec::new()).is_err());
    }

    #[test]
    fn what_is_trained_is_what_is_sampled() {
        // The loss of the noise that a sampler's step would predict is the loss that training sees.
        use crate::guidance::{Ask, View};
        use crate::sampling::{Sampler, SamplingOptions, Steps};
        use inkrig_motion::glam::Vec3;
        let made = made();
        let networks = Whole::new(&made.sizes, &made.all).unwrap();
        let pose = std::array::from_fn(|joint| Vec3::new(0.1, 0.05 * joint as f32, 0.2));
        let asks = (0..4).map(|frame| Ask { frame, joint: 10, place: Vec3::new(0.1, 0.0, frame as f32) });
        let request = Request {
            frames: 8,
            text: Noise::new(3).normals(made.sizes.text_width),
            view: View::Space,
            trajectory: asks.collect(),
            keypose: Some((2, pose)),
        };
        let conditions = Conditions::new(&request, &made.places, Semantics::Paper).unwrap();
        let rows = |rows: &[(usize, Vec<f32>)]| rows.to_vec();
        let (trajectory, keypose) =
            (rows(&conditions.trajectory), conditions.keypose.iter().cloned().collect::<ConditionRows>());
        let start = Noise::new(1).normals(2 * made.sizes.width);
        let sampler = Sampler { networks: &networks, features: &made.features, no_text: &[] };
        let options = SamplingOptions {
            steps: Steps::Ddim(1),
            text_weight: 1.0,
            semantics: Semantics::Paper,
            guidance: None,
            guide_every: 1,
            settle: None,
            from: None,
        };
        let (mut noise, mut timestep) = (Vec::new(), 0);
        let seen = |report: crate::sampling::StepReport<'_>| {
            (noise, timestep) = (report.noise.to_vec(), report.timestep);
        };
        sampler.run(&[conditions], &options, start.clone(), |_| Vec::new(), seen).unwrap();
        let batch = ControlBatch {
            noisy: &start,
            noise: &noise,
            timesteps: &[timestep],
            texts: &request.text,
            trajectories: &[trajectory],
            keyposes: &[keypose],
            wanted: &[],
        };
        let objective = ControlObjective { noise: 1.0, trajectory: 0.0, keypose: 0.0, signal_power: 0.0 };
        let mut learner = made.learner();
        let losses = learner.step(&made.own.row(), &batch, &objective, None, &mut Vec::new()).unwrap();
        assert!(losses.noise < 1e-8, "{losses:?}");
    }
}
