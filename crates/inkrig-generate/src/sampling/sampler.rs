//! From noise to clips (Algorithm 1).

use super::model::{EstimateControl, Networks};
use super::{Conditions, Misses, Semantics};
use crate::GenerateError;
use crate::guidance::{GuidanceOptions, Guide, Guided, GuidedClip, SettleOptions};
use crate::networks::{
    CorrectionTape, Corrections, Estimate, Noisy, Work, corrections_at, guidance_waves, told,
};
use crate::schedule::{Ddim, Lcm, Noise, NoiseSchedule, STEPS, mix};
use inkrig_motion::humanml::Statistics;

/// How clips are sampled.
#[derive(Debug, Clone, PartialEq)]
pub struct SamplingOptions {
    /// Which steps.
    pub steps: Steps,
    /// How much more the text counts than nothing does (w_c). Distilled models take it as an input, others are run twice;
    /// with 1 neither happens.
    pub text_weight: f32,
    /// Paper or published code.
    pub semantics: Semantics,
    /// Whether clips are moved towards their targets, and how.
    pub guidance: Option<GuidanceOptions>,
    /// Guidance at every so many steps, the last among them; 1 and 0 are every step.
    pub guide_every: usize,
    /// Whether feet that stand are kept from sliding at the end, and how.
    pub settle: Option<SettleOptions>,
    /// The step of training that denoising begins at, of many steps; at the most noise where nothing is said. What it begins with is to be as noisy.
    pub from: Option<usize>,
}

/// The steps from noise to a latent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Steps {
    /// Many, without new noise.
    Ddim(usize),
    /// Few, with a model distilled for them.
    Lcm(usize),
}

impl Default for SamplingOptions {
    /// The published two steps with guidance.
    fn default() -> Self {
        let guidance = Some(GuidanceOptions::default());
        let (semantics, text_weight) = (Semantics::Paper, 7.5);
        Self {
            steps: Steps::Lcm(2),
            text_weight,
            semantics,
            guidance,
            guide_every: 1,
            settle: None,
            from: None,
        }
    }
}

/// Latents that were sampled.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    /// One clip's after the other.
    pub latents: Vec<f32>,
    /// What guidance did at each step.
    pub guided: Vec<Guided>,
}

/// What is seen of each step.
#[derive(Debug, Clone, Copy)]
pub struct StepReport<'a> {
    /// From 0.
    pub step: usize,
    /// Of the thousand of training.
    pub timestep: usize,
    /// Predicted, and perhaps guided.
    pub noise: &'a [f32],
    /// After the step.
    pub latents: &'a [f32],
}

/// Samples clips with the networks of a model.
#[derive(Debug, Clone, Copy)]
pub struct Sampler<'a> {
    /// The model.
    pub networks: &'a Networks,
    /// Of its features.
    pub features: &'a Statistics,
    /// The vector of a text that says nothing.
    pub no_text: &'a [f32],
}

/// The noise of a clip: it belongs to the seed and its number.
fn stream(seed: u64, clip: u64) -> Noise {
    Noise::new(mix(seed).wrapping_add(mix(clip)))
}

enum Schedule {
    Ddim(Ddim),
    Lcm(Lcm),
}

/// What stays the same over all steps.
struct Prepared {
    trajectories: Option<Vec<f32>>,
    /// What the key poses add to the texts.
    keyposes: Option<Vec<f32>>,
    waves: Option<Vec<f32>>,
    /// What the conditions alone say, where control is by an estimate.
    estimate: Option<Estimate>,
    /// Whether a second prediction, without text, is made.
    twice: bool,
}

impl Sampler<'_> {
    /// Samples from the noise of a seed. A clip's noise belongs to the seed and its number.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn sample(
        &self,
        conditions: &[Conditions],
        options: &SamplingOptions,
        seed: u64,
    ) -> Result<Sampled, GenerateError> {
        let each = self.networks.vae.latent_width();
        let mut streams: Vec<Noise> = (0..conditions.len() as u64).map(|clip| stream(seed, clip)).collect();
        let mut fresh = || streams.iter_mut().flat_map(|stream| stream.normals(each)).collect::<Vec<f32>>();
        let start = fresh();
        self.run(conditions, options, start, |_| fresh(), |_| {})
    }

    /// Samples as [`Self::sample`] does, but begins with clean latents, one clip's after the other, that are made as noisy as the step is which
    /// `options` begin at.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn sample_near(
        &self,
        examples: &[f32],
        conditions: &[Conditions],
        options: &SamplingOptions,
        seed: u64,
    ) -> Result<Sampled, GenerateError> {
        let schedule = NoiseSchedule::default();
        let mut start = examples.to_vec();
        let each = self.networks.vae.latent_width();
        let expected = each * conditions.len();
        if start.len() != expected {
            let what = "latents to begin with";
            return Err(GenerateError::Length { what, expected, got: start.len() });
        }
        for (clip, latent) in start.chunks_exact_mut(each).enumerate() {
            let noise = stream(seed, clip as u64).normals(each);
            schedule.add_noise(latent, &noise, options.from.unwrap_or(STEPS - 1).min(STEPS - 1));
        }
        self.run(conditions, options, start, |_| Vec::new(), |_| {})
    }

    /// Samples from latents of noise; `fresh` gives new noise for the step after the one that it is asked with, where the
    /// steps take any; `seen` is told of every step.
    ///
    /// # Errors
    /// When conditions are of different kinds, ask for a network that the model has not, or have numbers that do not fit.
    pub fn run(
        &self,
        conditions: &[Conditions],
        options: &SamplingOptions,
        start: Vec<f32>,
        mut fresh: impl FnMut(usize) -> Vec<f32>,
        mut seen: impl FnMut(StepReport<'_>),
    ) -> Result<Sampled, GenerateError> {
        let schedule = match options.steps {
            Steps::Ddim(steps) => Schedule::Ddim(Ddim::new(steps)?),
            Steps::Lcm(steps) => Schedule::Lcm(Lcm::new(steps)?),
        };
        let prepared = self.prepare(conditions, options, &schedule)?;
        let mut texts: Vec<f32> =
            conditions.iter().flat_map(|conditions| &conditions.text).copied().collect();
        let clips: Vec<GuidedClip<'_>> = conditions
            .iter()
            .map(|own| GuidedClip { target: own.guide.as_ref().unwrap_or(&own.target), frames: own.frames })
            .collect();
        let guidance =
            options.guidance.as_ref().filter(|_| clips.iter().any(|clip| !clip.target.asks.is_empty()));
        let mut guide = Guide::new(&self.networks.vae, self.features, &clips);
        let (mut latents, mut guided, mut work) = (start, Vec::new(), Work::default());
        let mut timesteps = schedule.timesteps();
        if let (Some(from), Schedule::Ddim(_)) = (options.from, &schedule) {
            timesteps.retain(|timestep| *timestep <= from);
        }
        for (step, &timestep) in timesteps.iter().enumerate() {
            let mut noise =
                self.noise(conditions, &prepared, options, &latents, timestep, &mut texts, &mut work)?;
            let due = (timesteps.len() - 1 - step).is_multiple_of(options.guide_every.max(1));
            if let Some(guidance) = guidance.filter(|_| due) {
                let reckoned = guidance.reckoned_step(timestep);
                let alpha = schedule.noise().alpha(reckoned);
                guided.push(guide.run(&mut latents, &mut noise, alpha, reckoned > 500, guidance)?);
            }
            match &schedule {
                Schedule::Ddim(ddim) => ddim.step(&mut latents, &noise, timestep),
                Schedule::Lcm(lcm) => {
                    let new = timesteps.get(step + 1).map(|&next| (next, fresh(step)));
                    let new = new.as_ref().map(|(next, noise)| (*next, &noise[..]));
                    lcm.step(&mut latents, &noise, timestep, new);
                }
            }
            seen(StepReport { step, timestep, noise: &noise, latents: &latents });
        }
        if let Some(settle) = &options.settle {
            let poses: Vec<_> = conditions.iter().map(|clip| clip.pose.as_ref()).collect();
            guide.settle(&mut latents, &poses, settle)?;
        }
        Ok(Sampled { latents, guided })
    }

    fn prepare(
        &self,
        conditions: &[Conditions],
        options: &SamplingOptions,
        schedule: &Schedule,
    ) -> Result<Prepared, GenerateError> {
        let (Some(first), sizes) = (conditions.first(), self.networks.vae.sizes()) else {
            return Err(GenerateError::Rows { what: "conditions", numbers: 0, width: 1, most: usize::MAX });
        };
        for clip in conditions {
            if !clip.alike(first) {
                return Err(GenerateError::MixedConditions);
            }
            if clip.text.len() != sizes.text_width {
                let (what, expected) = ("text vector", sizes.text_width);
                return Err(GenerateError::Length { what, expected, got: clip.text.len() });
            }
        }
        let distilled = sizes.guidance_width > 0 && matches!(schedule, Schedule::Lcm(_));
        let twice = !distilled && options.text_weight != 1.0;
        if twice && self.no_text.len() != sizes.text_width {
            let (what, expected) = ("vector of no text", sizes.text_width);
            return Err(GenerateError::Length { what, expected, got: self.no_text.len() });
        }
        let mut prepared =
            Prepared { trajectories: None, keyposes: None, waves: None, estimate: None, twice };
        if distilled {
            prepared.waves = Some(guidance_waves(options.text_weight, sizes.guidance_width));
        }
        let asked = !first.trajectory.is_empty() || first.keypose.is_some();
        if let Some(estimator) = if asked { self.networks.estimator(first.domain)? } else { None } {
            let told = conditions.iter().flat_map(|c| told(c.frames, &c.trajectory, c.keypose.as_ref()));
            prepared.estimate = Some(estimator.estimate(told.collect()));
            return Ok(prepared);
        }
        if !first.trajectory.is_empty() {
            let (_, encoders) = self.networks.control(first.domain)?;
            let mut all = Vec::new();
            for clip in conditions {
                let rows: Vec<_> = clip.trajectory.iter().map(|(frame, row)| (*frame, &row[..])).collect();
                all.extend(encoders.trajectory.encode(&rows)?);
            }
            prepared.trajectories = Some(all);
        }
        if first.keypose.is_some() {
            let (control, encoders) = self.networks.control(first.domain)?;
            let mut all = Vec::new();
            for (frame, row) in conditions.iter().filter_map(|clip| clip.keypose.as_ref()) {
                all.extend(encoders.keypose.encode(&[(*frame, row)])?);
            }
            let zeros = vec![0.0; conditions.len() * sizes.text_width];
            prepared.keyposes = Some(control.keypose.grounded(&zeros, &all)?);
        }
        Ok(prepared)
    }

    /// The noise in latents at a timestep.
    #[allow(clippy::too_many_arguments)]
    fn noise(
        &self,
        conditions: &[Conditions],
        prepared: &Prepared,
        options: &SamplingOptions,
        latents: &[f32],
        timestep: usize,
        texts: &mut Vec<f32>,
        work: &mut Work,
    ) -> Result<Vec<f32>, GenerateError> {
        let clips = conditions.len();
        let semantics = options.semantics;
        let timesteps = vec![timestep; 2 * clips];
        let noisy =
            Noisy { latents, timesteps: &timesteps[..clips], texts, guidance: prepared.waves.as_deref() };
        let mut corrections = match &prepared.trajectories {
            Some(trajectories) => {
                let (control, _) = self.networks.control(conditions[0].domain)?;
                Some(control.trajectory.corrections(&noisy, trajectories, work)?)
            }
            None => None,
        };
        // Samples that are predicted without text, behind the others.
        let empty = if prepared.twice { clips } else { 0 };
        let mut all_latents = latents.to_vec();
        all_latents.extend_from_slice(&latents[..latents.len() / clips * empty]);
        let mut all_texts = texts.clone();
        (0..empty).for_each(|_| all_texts.extend_from_slice(self.no_text));
        let mut base_texts = all_texts.clone();
        let with =
            |corrections: Option<Corrections>, samples| corrections.map(|c| c.with_zeros(samples, clips));
        if let Some(keyposes) = &prepared.keyposes {
            let (control, _) = self.networks.control(conditions[0].domain)?;
            let posed_without_text = if semantics.keypose_without_text() { empty } else { 0 };
            let samples = clips + posed_without_text;
            let mut posed = all_texts[..texts.len() / clips * samples].to_vec();
            let poses = keyposes.iter().cycle();
            posed.iter_mut().zip(poses).for_each(|(text, pose)| *text += pose);
            let noisy = Noisy {
                latents: &all_latents[..latents.len() / clips * samples],
                timesteps: &timesteps[..samples],
                texts: &posed,
                guidance: prepared.waves.as_deref(),
            };
            let trajectory = with(corrections, posed_without_text);
            let adapted = control.keypose.corrections(&noisy, trajectory.as_ref(), work)?;
            if semantics.keypose_stays_in_text() {
                base_texts[..posed.len()].copy_from_slice(&posed);
                texts.clear();
                texts.extend_from_slice(&posed[..posed.len() / samples * clips]);
            }
            corrections =
                Some(if posed_without_text < empty { adapted.with_zeros(empty, clips) } else { adapted });
        } else {
            corrections = with(corrections, empty);
        }
        let noisy = Noisy {
            latents: &all_latents,
            timesteps: &timesteps[..clips + empty],
            texts: &base_texts,
            guidance: prepared.waves.as_deref(),
        };
        let mut noise = self.networks.denoiser.noise(&noisy, corrections.as_ref(), work)?;
        if prepared.twice {
            let without = noise.split_off(latents.len());
            for (with, without) in noise.iter_mut().zip(without) {
                *with = without + options.text_weight * (*with - without);
            }
        }
        if let (Some(estimate), Some(control)) = (&prepared.estimate, &self.networks.estimate) {
            let corrections = corrections_at(timestep, options.settle.is_some());
            self.correct(control, conditions, (latents, timestep, corrections), estimate, &mut noise)?;
        }
        Ok(noise)
    }

    /// Corrects the noise that the denoiser predicts in latents by what is estimated and by what is missed.
    fn correct(
        &self,
        control: &EstimateControl,
        conditions: &[Conditions],
        (latents, timestep, corrections): (&[f32], usize, usize),
        estimate: &Estimate,
        noise: &mut [f32],
    ) -> Result<(), GenerateError> {
        let schedule = NoiseSchedule::default();
        let (mut clean, tape) = (vec![0.0; noise.len()], &mut CorrectionTape::default());
        let timesteps = vec![timestep; conditions.len()];
        schedule.clean(latents, noise, timestep, &mut clean);
        control.correction.weigh(&mut clean, &timesteps, estimate, tape);
        for _ in 0..corrections {
            let missed = Misses::default().of(&self.networks.vae, self.features, &clean, conditions)?;
            control.correction.correct(latents, &mut clean, &timesteps, (estimate, &missed), tape);
        }
        let alpha = schedule.alpha(timestep);
        let (keep, share) = (alpha.sqrt(), (1.0 - alpha).sqrt());
        for ((noise, noisy), clean) in noise.iter_mut().zip(latents).zip(&clean) {
            *noise = (noisy - keep * clean) / share;
        }
        Ok(())
    }
}

impl Schedule {
    fn timesteps(&self) -> Vec<usize> {
        match self {
            Self::Ddim(ddim) => ddim.timesteps(),
            Self::Lcm(lcm) => lcm.timesteps(),
        }
    }

    fn noise(&self) -> &NoiseSchedule {
        match self {
            Self::Ddim(ddim) => ddim.schedule(),
            Self::Lcm(lcm) => lcm.schedule(),
        }
    }
}
