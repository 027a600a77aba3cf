//! Motions that denoising may begin with: a few of each verb that a model has learned from.
//!
//! From pure noise the first steps decide what is done, and a small model decides badly. Retrieval start: a motion of the verb is made so
//! noisy that much of it is lost, and denoised from there.

use crate::GenerateError;
use crate::schedule::Noise;
use crate::weights::{Tensor, Tensors};

/// Latents with the verb of each.
#[derive(Debug, Clone, PartialEq)]
pub struct Examples {
    each: usize,
    latents: Vec<f32>,
    verbs: Vec<usize>,
}

impl Examples {
    /// Latents, examples x numbers of a latent.
    pub const LATENTS: &'static str = "examples.latents";
    /// Places in the list of verbs, one for each example.
    pub const VERBS: &'static str = "examples.verbs";
    /// The step of training whose noise an example is given: what is left of it is two fifths of the power.
    pub const TIMESTEP: usize = 400;

    /// Those of a model; none where it has none. `each` are the numbers of a latent.
    ///
    /// # Errors
    /// When the two tensors do not fit each other or the model, or a verb is no whole number.
    pub fn of(weights: &Tensors, each: usize) -> Result<Option<Self>, GenerateError> {
        let Some(verbs) = weights.get(Self::VERBS) else { return Ok(None) };
        let count = verbs.data().len();
        let latents = weights.expect(Self::LATENTS, &[count, each])?.to_vec();
        let place = |verb: &f32| {
            let is_place = *verb >= 0.0 && *verb < 1024.0 && verb.fract() == 0.0;
            let (setting, value, needed) =
                ("examples.verbs", verb.to_string(), "places in the list of verbs");
            is_place.then_some(*verb as usize).ok_or(GenerateError::Setting { setting, value, needed })
        };
        let verbs = verbs.data().iter().map(place).collect::<Result<_, _>>()?;
        Ok(Some(Self { each, latents, verbs }))
    }

    /// As tensors of a model.
    ///
    /// # Errors
    /// When there are not as many latents as verbs.
    pub fn tensors(latents: Vec<f32>, verbs: &[usize]) -> Result<Tensors, GenerateError> {
        let each = latents.len() / verbs.len().max(1);
        let mut tensors = Tensors::new();
        tensors.insert(Self::LATENTS, Tensor::new(vec![verbs.len(), each], latents)?);
        let places: Vec<f32> = verbs.iter().map(|verb| *verb as f32).collect();
        tensors.insert(Self::VERBS, Tensor::new(vec![verbs.len()], places)?);
        Ok(tensors)
    }

    /// One of a verb, by chance; none where no example is of it.
    pub fn pick(&self, verb: usize, noise: &mut Noise) -> Option<&[f32]> {
        let own: Vec<usize> =
            self.verbs.iter().enumerate().filter(|(_, of)| **of == verb).map(|(at, _)| at).collect();
        let at = *own.get((noise.uniform() * own.len() as f64) as usize)?;
        self.latents.get(at * self.each..(at + 1) * self.each)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn examples_are_of_their_verb() {
        let latents: Vec<f32> = (0..12).map(|x| x as f32).collect();
        let mut weights = Examples::tensors(latents, &[4, 2, 4]).unwrap();
        let examples = Examples::of(&weights, 4).unwrap().unwrap();
        let mut noise = Noise::new(3);
        let firsts: Vec<f32> = (0..20).map(|_| examples.pick(4, &mut noise).unwrap()[0]).collect();
        assert!(firsts.contains(&0.0) && firsts.contains(&8.0) && !firsts.contains(&4.0));
        assert_eq!(examples.pick(2, &mut noise), Some(&[4.0, 5.0, 6.0, 7.0][..]));
        assert_eq!(examples.pick(1, &mut noise), None);
        assert!(Examples::of(&weights, 3).is_err());
        weights.insert(Examples::VERBS, Tensor::new(vec![3], vec![0.0, 0.5, 1.0]).unwrap());
        assert!(Examples::of(&weights, 4).is_err());
        assert_eq!(Examples::of(&Tensors::new(), 4).unwrap(), None);
        assert!(Examples::tensors(vec![0.0; 5], &[1, 2]).is_err());
    }
}
