//! Tiny networks give what PyTorch gives, with weights that follow from their names. `fixtures/make.py` made the numbers.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

mod reference;

use inkrig_generate::networks::{
    Adapter, ConditionEncoder, ControlNet, Decoding, Denoiser, Domain, Noisy, Parts, Sizes, Vae, Work,
};
use inkrig_generate::weights::{Tensors, hashed};
use reference::{Vectors, assert_near};

/// Numbers are stored in single precision, computed in double.
const NEAR: f32 = 3e-6;

fn model() -> (Sizes, Tensors, Vectors) {
    let sizes = Sizes { latent_tokens: 2, ..Sizes::tiny() };
    let weights = hashed(&sizes, Parts::ALL);
    (sizes, weights, Vectors::of(include_bytes!("fixtures/tiny.safetensors")))
}

#[test]
fn a_clip_is_encoded_and_decoded_and_its_gradient_taken() {
    let (sizes, weights, stored) = model();
    let vae = Vae::new(&sizes, &weights).unwrap();
    let features = stored.numbers("features");
    let mut encoded = vae.encode(&features).unwrap();
    encoded.mean.extend(encoded.log_variance);
    assert_near("encoded", &encoded.mean, &stored.numbers("encoded"), NEAR);
    let mut work = Decoding::default();
    vae.decode(&stored.numbers("z"), &[6], &mut work).unwrap();
    assert_near("decoded", work.features(), &stored.numbers("decoded"), NEAR);
    assert_near("gradient", vae.gradient(&features, &mut work).unwrap(), &stored.numbers("gradient"), 1e-5);
}

#[test]
fn conditions_and_noise() {
    let (sizes, weights, stored) = model();
    let (hint, pose) = (stored.numbers("hint"), stored.numbers("pose"));
    let encoder = ConditionEncoder::trajectory(&sizes, &weights, Domain::Space).unwrap();
    let trajectory = encoder.encode(&[(0, &hint[..66]), (2, &hint[66..132]), (5, &hint[132..])]).unwrap();
    assert_near("trajectory", &trajectory, &stored.numbers("trajectory"), NEAR);
    let encoder = ConditionEncoder::keypose(&sizes, &weights, Domain::Plane).unwrap();
    let keypose = encoder.encode(&[(4, &pose)]).unwrap();
    assert_near("key pose", &keypose, &stored.numbers("keypose"), NEAR);

    let (latents, texts, waves) = (stored.numbers("z"), stored.numbers("text"), stored.numbers("waves"));
    let noisy = Noisy { latents: &latents, timesteps: &[499], texts: &texts, guidance: Some(&waves) };
    let mut work = Work::default();
    let control = ControlNet::new(&sizes, &weights).unwrap();
    let first = control.corrections(&noisy, &trajectory, &mut work).unwrap();
    // Waves of time are computed in single precision, as the published weights were trained with them.
    assert_near("ControlNet", &first.blocks().concat(), &stored.numbers("first"), 1e-4);
    let adapter = Adapter::new(&sizes, &weights).unwrap();
    let grounded = adapter.grounded(&texts, &keypose).unwrap();
    let posed = Noisy { texts: &grounded, ..noisy };
    let second = adapter.corrections(&posed, Some(&first), &mut work).unwrap();
    assert_near("adapter", &second.blocks().concat(), &stored.numbers("second"), 1e-4);
    let denoiser = Denoiser::new(&sizes, &weights).unwrap();
    let noise = denoiser.noise(&noisy, Some(&second), &mut work).unwrap();
    assert_near("noise", &noise, &stored.numbers("noise"), 1e-4);
}
