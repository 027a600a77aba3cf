//! A denoiser learns on a finished autoencoder, can be stopped at any moment, and what it writes can be sampled.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

mod desk;

use desk::{corpus, place};
use inkrig_generate::checkpoint::ModelFile;
use inkrig_generate::guidance::View;
use inkrig_generate::sampling::{Conditions, Networks, Request, Sampler, SamplingOptions, Semantics, Steps};
use inkrig_generate::text::{TextEncoder as _, VerbTable};
use inkrig_train::training::{
    Course, DenoiserSettings, Optimiser, Place, VaeSettings, train_denoiser, train_vae,
};
use std::ops::ControlFlow;
use std::path::Path;

fn settings() -> DenoiserSettings {
    let course = Course {
        steps: 240,
        batch: 16,
        rate: 5e-3,
        warm_up: 10,
        average: 0.9,
        optimiser: Optimiser::AdamW,
        measure_every: 80,
        save_every: 7,
        ..DenoiserSettings::default().course
    };
    DenoiserSettings {
        course,
        frames: 20,
        stride: 5,
        shortest: 10,
        longest: 40,
        mixed: 0.3,
        velocity: false,
        trunk: 0,
        ..DenoiserSettings::default()
    }
}

#[test]
fn a_run_learns_ends_the_same_when_killed_and_writes_models() {
    let desk = tempfile::tempdir().unwrap();
    let corpus = corpus(desk.path());
    let go_on = &mut |_, _, _: Option<&_>| ControlFlow::Continue(());
    let vae = VaeSettings {
        sizes: "tiny".into(),
        steps: 5,
        batch: 4,
        frames: 20,
        shortest: 10,
        longest: 40,
        ..VaeSettings::default()
    };
    let folder = desk.path().join("vae");
    train_vae(&place(&corpus, &folder, 1), &vae, go_on).unwrap();
    let vae = folder.join("last.safetensors");

    let whole = desk.path().join("whole");
    let report = train_denoiser(&place(&corpus, &whole, 2), &vae, &settings(), go_on).unwrap();
    assert!(report.complete);
    let held_out: Vec<f64> = report.rows.iter().map(|row| row.value("held_out_noise").unwrap()).collect();
    println!(
        "held out {held_out:?}, losses {:?}",
        report.rows.iter().map(|row| row.loss).collect::<Vec<_>>()
    );
    // Noise has variance 1: less than that was learned.
    assert!(held_out[2] < held_out[0] && held_out[2] < 0.8, "{held_out:?}");

    // The same of velocities.
    let settings_of_velocity = DenoiserSettings { velocity: true, ..settings() };
    let other = desk.path().join("velocity");
    let report = train_denoiser(&place(&corpus, &other, 2), &vae, &settings_of_velocity, go_on).unwrap();
    let losses: Vec<f64> = report.rows.iter().map(|row| row.loss).collect();
    println!("velocities: losses {losses:?}");
    assert!(losses[2] < 0.95 * losses[0], "{losses:?}");

    let settings_of_blocks = DenoiserSettings { velocity: true, trunk: 32, ..settings() };
    let other = desk.path().join("feeding");
    let report = train_denoiser(&place(&corpus, &other, 2), &vae, &settings_of_blocks, go_on).unwrap();
    let losses: Vec<f64> = report.rows.iter().map(|row| row.loss).collect();
    println!("feed-forward blocks: losses {losses:?}");
    assert!(losses[2] < 0.95 * losses[0], "{losses:?}");

    // Killed twice, once between two checkpoints.
    let parts = desk.path().join("parts");
    let stop_at = |at: u64| {
        train_denoiser(&place(&corpus, &parts, 2), &vae, &settings(), &mut |step, _, _| {
            if step == at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .unwrap()
    };
    assert!(!stop_at(23).complete);
    let checkpoint = std::fs::read(parts.join("checkpoint.safetensors")).unwrap();
    assert!(!stop_at(90).complete);
    std::fs::write(parts.join("checkpoint.safetensors"), checkpoint).unwrap();
    assert!(stop_at(u64::MAX).complete);
    let last = |folder: &Path| std::fs::read(folder.join("last.safetensors")).unwrap();
    assert!(last(&whole) == last(&parts), "the same weights to the bit");

    // From the weights alone.
    let from = Place { from: Some(&whole.join("last.safetensors")), ..place(&corpus, &parts, 1) };
    std::fs::remove_file(parts.join("checkpoint.safetensors")).unwrap();
    let short = Course { steps: 5, measure_every: 5, rate: 1e-4, ..settings().course };
    let again =
        train_denoiser(&from, &vae, &DenoiserSettings { course: short, ..settings() }, go_on).unwrap();
    let value = again.rows[0].value("held_out_noise").unwrap();
    assert!(value < held_out[0] && value < 1.2 * held_out[2], "{value} {held_out:?}");

    // Damage is said.
    std::fs::write(whole.join("checkpoint.safetensors"), b"damaged").unwrap();
    let error = train_denoiser(&place(&corpus, &whole, 2), &vae, &settings(), go_on).unwrap_err().to_string();
    assert!(error.contains("damaged"), "{error}");
    let error = train_denoiser(&place(&corpus, &whole, 2), &whole.join("log.jsonl"), &settings(), go_on);
    assert!(error.unwrap_err().to_string().contains("log.jsonl"));

    let mut file = ModelFile::open(std::fs::File::open(whole.join("best.safetensors")).unwrap()).unwrap();
    let (header, weights) = (file.header().clone(), file.tensors().unwrap());
    assert!(!header.is_distilled());
    let (features, places) = header.statistics().unwrap();
    let verbs = VerbTable::new(&weights, header.sizes.text_width).unwrap();
    let networks = Networks::new(&header.sizes, &weights).unwrap();
    let no_text = verbs.encode("").unwrap();
    let request = Request {
        frames: 20,
        text: verbs.encode("walk").unwrap(),
        view: View::Space,
        trajectory: Vec::new(),
        keypose: None,
    };
    let conditions = Conditions::new(&request, &places, Semantics::Paper).unwrap();
    let sampler = Sampler { networks: &networks, features: &features, no_text: &no_text };
    let options = SamplingOptions { steps: Steps::Ddim(10), guidance: None, ..SamplingOptions::default() };
    let sampled = sampler.sample(&[conditions], &options, 1).unwrap();
    assert!(sampled.latents.iter().all(|number| number.is_finite() && number.abs() < 50.0));
}
