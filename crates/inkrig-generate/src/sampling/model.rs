//! All networks of a model.

use super::Examples;
use crate::GenerateError;
use crate::networks::{
    Adapter, ConditionEncoder, ControlNet, Correction, Denoiser, Domain, Estimator, Parts, Sizes, Vae,
};
use crate::weights::Tensors;

/// The networks that its weights have.
#[derive(Debug, Clone)]
pub struct Networks {
    /// Motion to latent and back.
    pub vae: Vae,
    /// Latent and text to noise.
    pub denoiser: Denoiser,
    /// What makes it follow conditions.
    pub control: Option<Control>,
    /// Encoders of conditions on the picture.
    pub plane: Option<Encoders>,
    /// What makes it follow conditions where the sizes say that an estimate shall.
    pub estimate: Option<EstimateControl>,
    /// Motions to begin with.
    pub examples: Option<Examples>,
}

/// Control by an estimate.
#[derive(Debug, Clone)]
pub struct EstimateControl {
    /// Of conditions in space.
    pub space: Estimator,
    /// Of conditions on the picture.
    pub plane: Option<Estimator>,
    /// For every prediction of the denoiser.
    pub correction: Correction,
}

/// Networks that make the denoiser follow conditions.
#[derive(Debug, Clone)]
pub struct Control {
    /// For trajectories.
    pub trajectory: ControlNet,
    /// For key poses.
    pub keypose: Adapter,
    /// Encoders of conditions in space.
    pub space: Encoders,
}

/// Encoders of one domain.
#[derive(Debug, Clone)]
pub struct Encoders {
    /// Of trajectories.
    pub trajectory: ConditionEncoder,
    /// Of key poses.
    pub keypose: ConditionEncoder,
}

impl Encoders {
    fn new(sizes: &Sizes, weights: &Tensors, domain: Domain) -> Result<Self, GenerateError> {
        Ok(Self {
            trajectory: ConditionEncoder::trajectory(sizes, weights, domain)?,
            keypose: ConditionEncoder::keypose(sizes, weights, domain)?,
        })
    }
}

impl Networks {
    /// Builds what the weights have: a VAE and a denoiser at least.
    ///
    /// # Errors
    /// When the sizes cannot be, or a weight is missing or of another shape.
    pub fn new(sizes: &Sizes, weights: &Tensors) -> Result<Self, GenerateError> {
        let parts = Parts::of(weights);
        let by_estimate = sizes.estimate > 0;
        if parts.control && !by_estimate && sizes.trunk > 0 {
            let (setting, value, needed) =
                ("trunk", sizes.trunk.to_string(), "0 where control is by a ControlNet");
            return Err(GenerateError::Setting { setting, value, needed });
        }
        let control = if parts.control && !by_estimate {
            Some(Control {
                trajectory: ControlNet::new(sizes, weights)?,
                keypose: Adapter::new(sizes, weights)?,
                space: Encoders::new(sizes, weights, Domain::Space)?,
            })
        } else {
            None
        };
        Ok(Self {
            examples: Examples::of(weights, sizes.latent_tokens * sizes.width)?,
            vae: Vae::new(sizes, weights)?,
            denoiser: Denoiser::new(sizes, weights)?,
            control,
            plane: if parts.control_2d && !by_estimate {
                Some(Encoders::new(sizes, weights, Domain::Plane)?)
            } else {
                None
            },
            estimate: if parts.control && by_estimate {
                let estimator = |domain| Estimator::new(sizes, weights, domain);
                Some(EstimateControl {
                    space: estimator(Domain::Space)?,
                    plane: if parts.control_2d { Some(estimator(Domain::Plane)?) } else { None },
                    correction: Correction::new(sizes, weights)?,
                })
            } else {
                None
            },
        })
    }

    /// Whether clips can be asked to follow conditions of a domain.
    pub fn follows(&self, domain: Domain) -> bool {
        match (&self.estimate, domain) {
            (Some(_), Domain::Space) => true,
            (Some(estimate), Domain::Plane) => estimate.plane.is_some(),
            (None, Domain::Space) => self.control.is_some(),
            (None, Domain::Plane) => self.control.is_some() && self.plane.is_some(),
        }
    }

    /// The estimator of a domain, and what corrects by it, where control is of that kind.
    ///
    /// # Errors
    /// [`GenerateError::MissingTensor`] when the model has none of this domain.
    pub(crate) fn estimator(&self, domain: Domain) -> Result<Option<&Estimator>, GenerateError> {
        let Some(estimate) = &self.estimate else { return Ok(None) };
        let missing = || GenerateError::MissingTensor { name: "estimate.plane.*".into() };
        match domain {
            Domain::Space => Ok(Some(&estimate.space)),
            Domain::Plane => estimate.plane.as_ref().ok_or_else(missing).map(Some),
        }
    }

    /// Control and the encoders of a domain.
    ///
    /// # Errors
    /// [`GenerateError::MissingTensor`] when the model has none.
    pub(crate) fn control(&self, domain: Domain) -> Result<(&Control, &Encoders), GenerateError> {
        let missing = |name: &str| GenerateError::MissingTensor { name: name.into() };
        let control = self.control.as_ref().ok_or_else(|| missing("controlnet.*"))?;
        let encoders = match domain {
            Domain::Space => &control.space,
            Domain::Plane => self.plane.as_ref().ok_or_else(|| missing("traj_encoder_2d.*"))?,
        };
        Ok((control, encoders))
    }
}
