//! All networks of a model.

use crate::GenerateError;
use crate::networks::{Adapter, ConditionEncoder, ControlNet, Denoiser, Domain, Parts, Sizes, Vae};
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
        let control = if parts.control {
            Some(Control {
                trajectory: ControlNet::new(sizes, weights)?,
                keypose: Adapter::new(sizes, weights)?,
                space: Encoders::new(sizes, weights, Domain::Space)?,
            })
        } else {
            None
        };
        Ok(Self {
            vae: Vae::new(sizes, weights)?,
            denoiser: Denoiser::new(sizes, weights)?,
            control,
            plane: if parts.control_2d { Some(Encoders::new(sizes, weights, Domain::Plane)?) } else { None },
        })
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
