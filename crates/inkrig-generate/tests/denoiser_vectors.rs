//! Denoiser, ControlNet, adapter and the encoders of conditions give what the published code gives.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod reference;

use inkrig_generate::networks::{
    Adapter, ConditionEncoder, ControlNet, Denoiser, Domain, Noisy, Parts, Sizes, Work, guidance_waves,
    timestep_waves,
};
use inkrig_generate::weights::{Tensors, hashed};
use reference::{Vectors, assert_near};
use std::sync::LazyLock;

static WEIGHTS: LazyLock<Tensors> =
    LazyLock::new(|| hashed(&Sizes::full(), Parts { vae: false, ..Parts::ALL }));

/// Embeddings of both clips of a stored table.
fn embed(encoder: &ConditionEncoder, table: &[f32], mask: &[f32]) -> Vec<f32> {
    let clips = table.chunks_exact(40 * 66).zip(mask.chunks_exact(40));
    clips
        .flat_map(|(clip, mask)| {
            let rows = clip.chunks_exact(66).enumerate().filter(|(frame, _)| mask[*frame] != 0.0);
            encoder.encode(&rows.collect::<Vec<_>>()).unwrap()
        })
        .collect()
}

#[test]
fn times_and_guidance_become_the_published_waves() {
    let Some(vectors) = Vectors::open("embeddings") else { return };
    let waves: Vec<f32> =
        vectors.whole("timesteps").iter().flat_map(|&timestep| timestep_waves(timestep, 768)).collect();
    assert_near("waves of time", &waves, &vectors.numbers("sinusoid"), 1e-4);
    let weights = vectors.numbers("w_minus_1");
    let waves: Vec<f32> = weights.iter().flat_map(|w| guidance_waves(w + 1.0, 256)).collect();
    assert_near("waves of guidance", &waves, &vectors.numbers("w_embedding"), 1e-4);
}

#[test]
fn conditions_are_encoded_as_by_the_published_networks() {
    let Some(vectors) = Vectors::open("encoders") else { return };
    for (domain, name) in [(Domain::Space, "3d"), (Domain::Plane, "2d")] {
        let encoder = ConditionEncoder::trajectory(&Sizes::full(), &WEIGHTS, domain).unwrap();
        let hint = vectors.numbers(&format!("hint_{name}"));
        let got = embed(&encoder, &hint, &vectors.numbers("hint_mask"));
        assert_near(&format!("trajectory {name}"), &got, &vectors.numbers(&format!("traj_{name}")), 1e-4);
        let encoder = ConditionEncoder::keypose(&Sizes::full(), &WEIGHTS, domain).unwrap();
        let pose = vectors.numbers(&format!("pose_{name}"));
        let got = embed(&encoder, &pose, &vectors.numbers("pose_mask"));
        assert_near(&format!("key pose {name}"), &got, &vectors.numbers(&format!("pose_enc_{name}")), 1e-4);
    }
}

#[test]
fn noise_is_predicted_as_by_the_published_networks() {
    let (Some(vectors), Some(encoded)) = (Vectors::open("denoiser"), Vectors::open("encoders")) else {
        return;
    };
    let sizes = Sizes::full();
    let base = Denoiser::new(&sizes, &WEIGHTS).unwrap();
    let control = ControlNet::new(&sizes, &WEIGHTS).unwrap();
    let adapter = Adapter::new(&sizes, &WEIGHTS).unwrap();
    let (latents, texts) = (vectors.numbers("latents"), vectors.numbers("text"));
    let (timesteps, guidance) = (vectors.whole("timesteps"), guidance_waves(7.5, 256));
    assert_near("guidance", &guidance, &vectors.numbers("w_cond")[..256], 1e-4);
    let guidance = vectors.numbers("w_cond")[..256].to_vec();
    let noisy = Noisy { latents: &latents, timesteps: &timesteps, texts: &texts, guidance: Some(&guidance) };
    let work = &mut Work::default();
    let near = |what: &str, got: &[f32], most: f32| assert_near(what, got, &vectors.numbers(what), most);

    near("eps_base", &base.noise(&noisy, None, work).unwrap(), 1e-4);
    let without = Noisy { guidance: None, ..noisy };
    near("eps_base_no_w", &base.noise(&without, None, work).unwrap(), 1e-4);

    for (name, suffix) in [("2d", ""), ("3d", "_3d")] {
        let trajectory = encoded.numbers(&format!("traj_{name}"));
        let corrections = control.corrections(&noisy, &trajectory, work).unwrap();
        near(&format!("controlnet_residuals{suffix}"), &flat(corrections.blocks()), 5e-4);
        if suffix.is_empty() {
            near("eps_traj_only", &base.noise(&noisy, Some(&corrections), work).unwrap(), 5e-4);
        }
        let grounded = adapter.grounded(&texts, &encoded.numbers(&format!("pose_enc_{name}"))).unwrap();
        let posed = Noisy { texts: &grounded, ..noisy };
        let corrections = adapter.corrections(&posed, Some(&corrections), work).unwrap();
        near(&format!("adapter_residuals{suffix}"), &flat(corrections.blocks()), 5e-4);
        let noise = base.noise(&noisy, Some(&corrections), work).unwrap();
        near(&format!("eps_full_paper{suffix}"), &noise, 5e-4);
        if suffix.is_empty() {
            near("text_after_inplace_add", &grounded, 1e-4);
            near("eps_full_code", &base.noise(&posed, Some(&corrections), work).unwrap(), 5e-4);
        }
    }
}

/// From samples x tokens to the stored order, tokens x samples.
fn flat(blocks: &[Vec<f32>]) -> Vec<f32> {
    let mut out = Vec::new();
    for block in blocks {
        for token in 0..3 {
            for sample in 0..2 {
                out.extend_from_slice(&block[(sample * 3 + token) * 256..][..256]);
            }
        }
    }
    out
}
