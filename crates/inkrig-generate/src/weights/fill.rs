//! Weights that follow from their names: for tests, and to begin training with.

use super::{Tensor, Tensors};
use crate::networks::{Parts, Sizes, TensorSpec, tensors};
use crate::schedule::{Noise, mix};

/// Every number from the tensor's name and its place by a hash, so that any program in any language can make the same
/// model. Networks filled so are as lively as trained ones: nothing is zero.
pub fn hashed(sizes: &Sizes, parts: Parts) -> Tensors {
    tensors(sizes, parts).into_iter().map(|spec| (spec.name.clone(), hashed_tensor(&spec))).collect()
}

/// One tensor of [`hashed`].
pub fn hashed_tensor(spec: &TensorSpec) -> Tensor {
    let (scale, shift) = range(spec);
    let seed = spec.name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    fill(&spec.shape, |at| {
        let counter = (at as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let unit = (mix(seed.wrapping_add(counter)) >> 40) as f64 / f64::from(1 << 24);
        (shift + scale * (2.0 * unit - 1.0)) as f32
    })
}

/// Scale and shift of a tensor's numbers, by its name.
fn range(spec: &TensorSpec) -> (f64, f64) {
    let name = spec.name.as_str();
    let leaf = name.rsplit('.').next().unwrap_or(name);
    let one_axis = spec.shape.len() < 2;
    if leaf == "pe" || leaf == "hidden" {
        (0.5, 0.0)
    } else if name.contains("global_motion_token") {
        (1.0, 0.0)
    } else if one_axis && leaf == "weight" {
        let norm = name.contains("norm") || name.starts_with("t2m_") && name.contains(".output_net.1.");
        (0.1, if norm { 1.0 } else { 0.25 })
    } else if one_axis {
        (0.1, 0.0)
    } else {
        let inputs: usize = spec.shape.iter().skip(1).product();
        let small = ["controlnet_down_mid_blocks", "controlnet_cond_embedding.2"];
        let gain = if small.iter().any(|part| name.contains(part)) { 0.5 } else { 1.0 };
        (gain * (3.0 / inputs.max(1) as f64).sqrt(), 0.0)
    }
}

/// Parts of names of what is zero at first.
const ZERO: [&str; 6] = [
    "controlnet_down_mid_blocks",
    "controlnet_cond_embedding.2",
    "estimate.correction.latent",
    "estimate.correction.gate",
    "in_proj_bias",
    "out_proj.bias",
];

/// Weights as training begins with them: matrices uniform by Glorot's rule, biases 0, norms 1, positions and tokens as in
/// the published code, and zero where a control shall begin without effect.
pub fn random(sizes: &Sizes, parts: Parts, seed: u64) -> Tensors {
    let start = |(number, spec): (usize, TensorSpec)| {
        // Every tensor has a stream of its own, so that one network does not depend on which others there are.
        let mut noise = Noise::new(mix(seed).wrapping_add(mix(number as u64 + 1)));
        let name = spec.name.as_str();
        let tensor = if ZERO.iter().any(|part| name.contains(part)) {
            fill(&spec.shape, |_| 0.0)
        } else if name.ends_with(".pe") {
            fill(&spec.shape, |_| noise.uniform() as f32)
        } else if name.contains("global_motion_token") {
            fill(&spec.shape, |_| noise.normal())
        } else if let [outputs, inputs] = spec.shape[..] {
            // A packed projection is three matrices.
            let outputs = if name.ends_with("in_proj_weight") { outputs / 3 } else { outputs };
            let most = (6.0 / (outputs + inputs) as f64).sqrt();
            fill(&spec.shape, |_| (most * (2.0 * noise.uniform() - 1.0)) as f32)
        } else if name.ends_with("weight") {
            let norm = if name.contains("norm") { 1.0 } else { 0.25 };
            fill(&spec.shape, |_| norm)
        } else {
            fill(&spec.shape, |_| 0.0)
        };
        (spec.name, tensor)
    };
    tensors(sizes, parts).into_iter().enumerate().map(start).collect()
}

fn fill(shape: &[usize], mut number: impl FnMut(usize) -> f32) -> Tensor {
    Tensor::filled(shape, (0..shape.iter().product()).map(&mut number).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_weights_belong_to_their_seed() {
        let sizes = Sizes::tiny();
        let weights = random(&sizes, Parts::ALL, 3);
        assert_eq!(weights, random(&sizes, Parts::ALL, 3));
        let name = "vae.encoder.middle_block.linear1.weight";
        assert_ne!(weights.get(name), random(&sizes, Parts::ALL, 4).get(name));
        let zero = weights.get("controlnet.controlnet_down_mid_blocks.0.weight").unwrap();
        assert!(zero.data().iter().all(|x| *x == 0.0));
    }
}
