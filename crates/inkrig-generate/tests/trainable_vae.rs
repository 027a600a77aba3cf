//! The autoencoder that is trained is the one that is run.
#![cfg(feature = "train")]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod reference;

use burn::module::Module;
use burn::optim::{AdamWConfig, GradientsParams};
use burn::tensor::{Device, Distribution, Tensor, TensorData};
use inkrig_generate::networks::{Decoding, Parts, Sizes, Vae};
use inkrig_generate::schedule::Noise;
use inkrig_generate::trainable::{FrameMask, TrainableVae, VaeLoss, VaeLossWeights, recovered_places};
use inkrig_generate::weights::{hashed, random};
use inkrig_motion::Features;
use inkrig_motion::humanml::{Statistics, WIDTH, recover_positions};
use reference::{Vectors, off};

fn tensor(numbers: &[f32], shape: [usize; 3], device: &Device) -> Tensor<3> {
    Tensor::from_data(TensorData::new(numbers.to_vec(), shape), device)
}

fn numbers(tensor: Tensor<3>) -> Vec<f32> {
    tensor.into_data().try_into_vec().unwrap()
}

#[test]
fn both_forms_give_the_same_with_padding_and_without() {
    for latent_tokens in [1, 3] {
        let sizes = Sizes { latent_tokens, ..Sizes::tiny() };
        let weights = hashed(&sizes, Parts::VAE);
        let vae = Vae::new(&sizes, &weights).unwrap();
        let device = Device::flex();
        let trainable = TrainableVae::new(&sizes, &weights, 0.1, &device).unwrap();
        assert_eq!(trainable.to_tensors().unwrap(), weights);

        let (frames, lengths) = (12, [12, 7]);
        let mask = FrameMask::new(&lengths, frames);
        let features = Noise::new(1).normals(2 * frames * WIDTH);
        let (mean, log_variance) = trainable.encode(tensor(&features, [2, frames, WIDTH], &device), &mask);
        let decoded = numbers(trainable.decode(&mean, &mask));
        let (mean, log_variance) = (numbers(mean), numbers(log_variance));
        let each = latent_tokens * sizes.width;
        for (clip, &length) in lengths.iter().enumerate() {
            let rows = &features[clip * frames * WIDTH..][..length * WIDTH];
            let encoded = vae.encode(rows).unwrap();
            assert!(off(&mean[clip * each..][..each], &encoded.mean) < 1e-5);
            assert!(off(&log_variance[clip * each..][..each], &encoded.log_variance) < 1e-5);
            let mut work = Decoding::default();
            vae.decode(&encoded.mean, &[length], &mut work).unwrap();
            let row = &decoded[clip * frames * WIDTH..][..frames * WIDTH];
            assert!(off(&row[..length * WIDTH], work.features()) < 1e-5);
            assert!(row[length * WIDTH..].iter().all(|x| *x == 0.0));
        }
    }
}

#[test]
fn both_forms_have_the_same_gradient() {
    let sizes = Sizes { latent_tokens: 2, ..Sizes::tiny() };
    let weights = hashed(&sizes, Parts::VAE);
    let device = Device::flex().autodiff();
    let trainable = TrainableVae::new(&sizes, &weights, 0.0, &device).unwrap();
    let (latent, way) = (Noise::new(1).normals(2 * sizes.width), Noise::new(2).normals(9 * WIDTH));
    let z = tensor(&latent, [1, 2, sizes.width], &device).require_grad();
    let decoded = trainable.decode(&z, &FrameMask::new(&[9], 9));
    let grads = (decoded * tensor(&way, [1, 9, WIDTH], &device)).sum().backward();
    let expected = numbers(z.grad(&grads).unwrap());
    let vae = Vae::new(&sizes, &weights).unwrap();
    let mut work = Decoding::default();
    vae.decode(&latent, &[9], &mut work).unwrap();
    assert!(off(vae.gradient(&way, &mut work).unwrap(), &expected) < 1e-4);
}

#[test]
fn places_are_recovered_as_from_a_file() {
    let features: Vec<f32> = Noise::new(3).normals(2 * 30 * WIDTH).iter().map(|x| 0.1 * x).collect();
    let places = numbers(recovered_places(&tensor(&features, [2, 30, WIDTH], &Device::flex())));
    for clip in 0..2 {
        let rows = features[clip * 30 * WIDTH..][..30 * WIDTH].to_vec();
        let expected = recover_positions(&Features::new(rows, WIDTH).unwrap()).unwrap();
        let expected: Vec<f32> =
            expected.iter().flatten().flat_map(inkrig_motion::glam::Vec3::to_array).collect();
        assert!(off(&places[clip * 30 * 66..][..30 * 66], &expected) < 1e-5);
    }
}

#[test]
fn the_loss_is_the_published_one() {
    let (Some(vectors), Some(recover)) = (Vectors::open("losses"), Vectors::open("recover")) else { return };
    let device = Device::flex();
    let table = |name: &str| tensor(&vectors.numbers(name), [2, 40, WIDTH], &device);
    let latent = |name: &str| tensor(&vectors.numbers(name), [1, 2, 256], &device);
    let statistics = Statistics::new(recover.numbers("mean"), recover.numbers("std")).unwrap();
    let loss = VaeLoss::new(
        table("feats_pred"),
        table("feats_ref"),
        (latent("kl_mu"), latent("kl_logvar")),
        &FrameMask::new(&[40, 40], 40),
        &statistics,
        &VaeLossWeights::default(),
    );
    for (got, name) in [
        (loss.features, "vae_feat_smooth_l1"),
        (loss.places, "vae_joint_smooth_l1"),
        (loss.divergence, "kl_mean"),
    ] {
        let got: f32 = got.into_scalar();
        let expected = vectors.numbers(name)[0];
        assert!((got / expected - 1.0).abs() < 1e-4, "{name}: {got} {expected}");
    }
}

#[test]
fn some_steps_of_training_make_the_loss_small() {
    let sizes = Sizes { latent_tokens: 2, ..Sizes::tiny() };
    let device = Device::flex().autodiff();
    device.seed(1);
    let mut vae = TrainableVae::new(&sizes, &random(&sizes, Parts::VAE, 1), 0.05, &device).unwrap();
    let mut optimiser = AdamWConfig::new().init();
    let mask = FrameMask::new(&[20, 16], 20);
    let statistics = Statistics::new(vec![0.0; WIDTH], vec![0.1; WIDTH]).unwrap();
    let features = tensor(&Noise::new(4).normals(2 * 20 * WIDTH), [2, 20, WIDTH], &device);
    let mut losses = Vec::new();
    for _ in 0..30 {
        let (mean, log_variance) = vae.encode(features.clone(), &mask);
        let noise = mean.random_like(Distribution::Normal(0.0, 1.0));
        let latent = TrainableVae::sample(mean.clone(), log_variance.clone(), noise, 0.1);
        let decoded = vae.decode(&latent, &mask);
        let spread = (mean, log_variance);
        let weights = VaeLossWeights::default();
        let loss = VaeLoss::new(decoded, features.clone(), spread, &mask, &statistics, &weights);
        losses.push(loss.total.clone().into_scalar::<f32>());
        let grads = GradientsParams::from_grads(loss.total.backward(), &vae);
        vae = optimiser.step(1e-2, vae, grads);
    }
    assert!(losses.iter().all(|loss| loss.is_finite()));
    assert!(losses[29] < 0.9 * losses[0], "{losses:?}");
    assert_eq!(vae.valid().to_tensors().unwrap().len(), hashed(&sizes, Parts::VAE).len());
}
