//! Denoiser, control and encoders that are trained are the ones that are run.
#![cfg(feature = "train")]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod reference;

use burn::tensor::{Device, Tensor, TensorData};
use inkrig_generate::networks::{
    Adapter, ConditionEncoder, ControlNet, Denoiser, Domain, Noisy, Parts, Sizes, Work, guidance_waves,
};
use inkrig_generate::schedule::Noise;
use inkrig_generate::text::{TextEncoder as _, VERBS, VerbTable};
use inkrig_generate::trainable::{
    ConditionRows, NoisyBatch, TimeWaves, TrainableAdapter, TrainableControlNet, TrainableDenoiser,
    TrainableEncoder, TrainableVerbs,
};
use inkrig_generate::weights::{Tensor as Plain, Tensors, hashed};
use reference::off;

fn tensor<const D: usize>(numbers: &[f32], shape: [usize; D]) -> Tensor<D> {
    Tensor::from_data(TensorData::new(numbers.to_vec(), shape), &Device::flex())
}

fn numbers<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    tensor.into_data().try_into_vec().unwrap()
}

/// Those of a part, by what their names begin with; what no network reads is left out.
fn of(weights: &Tensors, begin: &str, but: &[&str]) -> Tensors {
    let own = |name: &str| name.starts_with(begin) && !but.iter().any(|part| name.starts_with(part));
    weights.iter().filter(|(name, _)| own(name)).map(|(name, row)| (name.to_string(), row.clone())).collect()
}

#[test]
fn both_forms_give_the_same_noise_and_corrections() {
    let whole = Sizes { latent_tokens: 2, ..Sizes::tiny() };
    let few = Sizes { guidance_width: 0, denoiser_blocks: 5, control_blocks: 2, ..whole.clone() };
    for sizes in [whole, few] {
        let weights = hashed(&sizes, Parts::ALL);
        let device = Device::flex();
        let (width, text, tokens) = (sizes.width, sizes.text_width, sizes.latent_tokens);
        let latents = Noise::new(1).normals(3 * tokens * width);
        let (texts, embeddings) = (Noise::new(2).normals(3 * text), Noise::new(3).normals(3 * width));
        let timesteps = [999, 40, 481];
        let waves = guidance_waves(6.5, sizes.guidance_width.max(2));
        let waves = Some(&waves[..]).filter(|_| sizes.guidance_width > 0);
        let noisy = Noisy { latents: &latents, timesteps: &timesteps, texts: &texts, guidance: waves };
        let batch = NoisyBatch {
            latents: tensor(&latents, [3, tokens, width]),
            times: TimeWaves::new(text).of(&timesteps, &device),
            texts: tensor(&texts, [3, text]),
            guidance: waves.map(|waves| tensor(&waves.repeat(3), [3, sizes.guidance_width])),
        };
        let work = &mut Work::default();

        let net = ControlNet::new(&sizes, &weights).unwrap();
        let expected = net.corrections(&noisy, &embeddings, work).unwrap();
        let trainable = TrainableControlNet::new(&sizes, &weights, 0.1, &device).unwrap();
        let trajectory = trainable.corrections(&batch, tensor(&embeddings, [3, width]));
        assert_eq!(trajectory.len(), sizes.control_blocks);
        for (own, expected) in trajectory.iter().zip(expected.blocks()) {
            assert!(off(&numbers(own.clone()), expected) < 1e-4);
        }
        assert_eq!(trainable.to_tensors().unwrap(), of(&weights, "controlnet.", &[]));

        let adapter = Adapter::new(&sizes, &weights).unwrap();
        let grounded = adapter.grounded(&texts, &embeddings).unwrap();
        let posed = Noisy { texts: &grounded, ..noisy };
        let expected = adapter.corrections(&posed, Some(&expected), work).unwrap();
        let alone = adapter.corrections(&posed, None, work).unwrap();
        let trainable = TrainableAdapter::new(&sizes, &weights, 0.1, &device).unwrap();
        let own = trainable.grounded(batch.texts.clone(), tensor(&embeddings, [3, width]));
        assert!(off(&numbers(own.clone()), &grounded) < 1e-4);
        let posed = NoisyBatch { texts: own, ..batch.clone() };
        let adapted = trainable.corrections(&posed, Some(&trajectory));
        for (own, expected) in adapted.iter().zip(expected.blocks()) {
            assert!(off(&numbers(own.clone()), expected) < 1e-4);
        }
        for (own, expected) in trainable.corrections(&posed, None).into_iter().zip(alone.blocks()) {
            assert!(off(&numbers(own), expected) < 1e-4);
        }
        let but = ["denoiser.denoiser.", "denoiser.pose_encoder", "denoiser.encoder.norm."];
        assert_eq!(trainable.to_tensors().unwrap(), of(&weights, "denoiser.", &but));

        let denoiser = Denoiser::new(&sizes, &weights).unwrap();
        let trainable = TrainableDenoiser::new(&sizes, &weights, 0.1, &device).unwrap();
        let with = denoiser.noise(&noisy, Some(&expected), work).unwrap();
        assert!(off(&numbers(trainable.noise(&batch, Some(&adapted))), &with) < 1e-4);
        let without = denoiser.noise(&noisy, None, work).unwrap();
        assert!(off(&numbers(trainable.noise(&batch, None)), &without) < 1e-4);
        assert!(off(&with, &without) > 1e-2, "corrections count");
        let last = trainable.noise(&batch.narrow(2, 1), None);
        assert!(off(&numbers(last), &without[2 * tokens * width..]) < 1e-4);
        assert_eq!(trainable.to_tensors().unwrap(), of(&weights, "denoiser.denoiser.", &[]));
    }
}

#[test]
fn both_forms_encode_the_same() {
    let sizes = Sizes::tiny();
    let weights = hashed(&sizes, Parts::ALL);
    let device = Device::flex();
    let rows = |seed, frames: &[usize]| -> Vec<(usize, Vec<f32>)> {
        let mut noise = Noise::new(seed);
        frames.iter().map(|&frame| (frame, noise.normals(66))).collect()
    };
    // Of different lengths, with gaps.
    let samples = [rows(1, &[0, 1, 2, 3, 9]), rows(2, &[39]), rows(3, &[4, 20])];
    let packed = ConditionRows::new(&samples).unwrap();
    assert_eq!(packed.samples(), 3);
    for domain in [Domain::Space, Domain::Plane] {
        let unused = ["mem_pos", "rel_pos_layer"];
        for (trainable, plain, name) in [
            (
                TrainableEncoder::trajectory(&sizes, &weights, domain, 0.1, &device).unwrap(),
                ConditionEncoder::trajectory(&sizes, &weights, domain).unwrap(),
                TrainableEncoder::trajectory_name(domain),
            ),
            (
                TrainableEncoder::keypose(&sizes, &weights, domain, 0.1, &device).unwrap(),
                ConditionEncoder::keypose(&sizes, &weights, domain).unwrap(),
                TrainableEncoder::keypose_name(domain),
            ),
        ] {
            let own = numbers(trainable.encode(&packed));
            for (own, sample) in own.chunks_exact(sizes.width).zip(&samples) {
                let rows: Vec<_> = sample.iter().map(|(frame, row)| (*frame, &row[..])).collect();
                assert!(off(own, &plain.encode(&rows).unwrap()) < 1e-4);
            }
            let unused: Vec<String> = unused.iter().map(|part| format!("{name}.{part}")).collect();
            let unused: Vec<&str> = unused.iter().map(String::as_str).collect();
            assert_eq!(trainable.to_tensors(name).unwrap(), of(&weights, &format!("{name}."), &unused));
        }
    }
    assert!(ConditionRows::new(&[vec![(0, vec![0.0; 65])]]).is_err());
}

#[test]
fn verbs_are_rows_of_the_table() {
    let mut weights = Tensors::new();
    let rows = Noise::new(1).normals(VERBS.len() * 6);
    weights.insert(VerbTable::VERBS, Plain::new(vec![VERBS.len(), 6], rows).unwrap());
    weights.insert(VerbTable::NOTHING, Plain::new(vec![6], Noise::new(2).normals(6)).unwrap());
    let table = VerbTable::new(&weights, 6).unwrap();
    let trainable = TrainableVerbs::new(&weights, 6, &Device::flex()).unwrap();
    let texts = numbers(trainable.texts(&[Some(1), None, Some(3)]));
    let expected = [table.encode("run"), table.encode(""), table.encode("jump")].map(Result::unwrap).concat();
    assert_eq!(texts, expected);
    assert_eq!(trainable.to_tensors().unwrap(), weights);
}
