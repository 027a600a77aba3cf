//! Whole runs of sampling, guidance and inversion are those of the published code.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

mod reference;

use inkrig_generate::guidance::{Ask, GuidanceOptions, Guide, GuidedClip, Mean, Target, View};
use inkrig_generate::networks::{Decoding, Denoiser, Domain, Noisy, Parts, Sizes, Work};
use inkrig_generate::sampling::{Conditions, Networks, Sampler, SamplingOptions, Semantics, Steps};
use inkrig_generate::schedule::{Ddim, Lcm};
use inkrig_generate::weights::{Tensors, hashed};
use inkrig_motion::Features;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{Camera, Statistics, WIDTH, recover_positions};
use reference::{Vectors, assert_near, off};
use std::sync::LazyLock;

static WEIGHTS: LazyLock<Tensors> = LazyLock::new(|| hashed(&Sizes::full(), Parts::ALL));
static NETWORKS: LazyLock<Networks> = LazyLock::new(|| Networks::new(&Sizes::full(), &WEIGHTS).unwrap());

/// Both clips of the stored runs.
fn conditions(vectors: &Vectors) -> Vec<Conditions> {
    let (hint, pose) = (vectors.numbers("hint_2d"), vectors.numbers("pose_2d"));
    let (mask, pose_mask) = (vectors.numbers("guide_mask"), vectors.numbers("pose_mask"));
    let (asked, text) = (vectors.numbers("guide_hint_denorm"), vectors.numbers("text"));
    (0..2)
        .map(|clip| {
            let row = |table: &[f32], frame: usize| table[(clip * 40 + frame) * 66..][..66].to_vec();
            let frame = (0..40).find(|frame| pose_mask[clip * 40 + frame] != 0.0).unwrap();
            let rows = (0..40).map(|frame| (frame, row(&hint, frame)));
            let asks = (0..40 * 22).filter(|at| mask[clip * 40 * 22 + at] != 0.0).map(|at| {
                let place = Vec3::from_slice(&asked[3 * (clip * 40 * 22 + at)..]);
                Ask { frame: at / 22, joint: at % 22, place }
            });
            let target =
                Target { view: View::Plane(Camera::default()), asks: asks.collect(), depths: Vec::new() };
            Conditions::from_tables(
                40,
                text[clip * 768..][..768].to_vec(),
                Domain::Plane,
                rows.filter(|(_, row)| row.iter().sum::<f32>() != 0.0).collect(),
                Some((frame, row(&pose, frame))),
                target,
            )
            .unwrap()
        })
        .collect()
}

fn statistics() -> Option<Statistics> {
    let recover = Vectors::open("recover")?;
    Some(Statistics::new(recover.numbers("mean"), recover.numbers("std")).unwrap())
}

/// Runs two steps and compares each with the stored ones, down to joints.
fn run(vectors: &Vectors, name: &str, semantics: Semantics) -> Option<()> {
    let features = statistics()?;
    let sampler = Sampler { networks: &NETWORKS, features: &features, no_text: &[] };
    let options = SamplingOptions {
        steps: Steps::Lcm(2),
        text_weight: 7.5,
        semantics,
        guidance: None,
        guide_every: 1,
        settle: None,
        from: None,
    };
    let noise = vectors.numbers("noise");
    let sampled = sampler
        .run(
            &conditions(vectors),
            &options,
            vectors.numbers("latents_in"),
            |step| noise[step * 512..][..512].to_vec(),
            |seen| {
                let expected = vectors.numbers(&format!("{name}.eps_{}", seen.step));
                assert_near(&format!("{name} noise {}", seen.step), seen.noise, &expected, 5e-4);
                let expected = vectors.numbers(&format!("{name}.latents_{}", seen.step));
                assert_near(&format!("{name} latents {}", seen.step), seen.latents, &expected, 5e-4);
            },
        )
        .unwrap();
    let mut decoding = Decoding::default();
    NETWORKS.vae.decode(&sampled.latents, &[40, 40], &mut decoding).unwrap();
    let expected = vectors.numbers(&format!("{name}.features"));
    assert_near(&format!("{name} features"), decoding.features(), &expected, 5e-4);
    let mut rows = decoding.features().to_vec();
    features.restore(&mut rows);
    let mut joints = Vec::new();
    for clip in rows.chunks_exact(40 * WIDTH) {
        let places = recover_positions(&Features::new(clip.to_vec(), WIDTH).unwrap()).unwrap();
        joints.extend(places.iter().flatten().flat_map(Vec3::to_array));
    }
    assert_near(&format!("{name} joints"), &joints, &vectors.numbers(&format!("{name}.joints")), 5e-4);
    Some(())
}

#[test]
fn two_steps_as_the_paper_and_as_the_code_have_them() {
    let Some(vectors) = Vectors::open("sampler") else { return };
    run(&vectors, "paper_noguide", Semantics::Paper);
    run(&vectors, "code_noguide", Semantics::Official);
}

#[test]
fn guidance_has_the_stored_loss_and_gradient_and_comes_as_far() {
    let (Some(vectors), Some(features)) = (Vectors::open("sampler"), statistics()) else { return };
    let conditions = conditions(&vectors);
    let targets: Vec<Target> = {
        let (mask, asked) = (vectors.numbers("guide_mask"), vectors.numbers("guide_hint_denorm"));
        let view = View::Plane(Camera::default());
        (0..2)
            .map(|clip| {
                let asks = (0..40 * 22).filter(|at| mask[clip * 40 * 22 + at] != 0.0);
                let place = |at: usize| Vec3::from_slice(&asked[3 * (clip * 40 * 22 + at)..]);
                let asks = asks.map(|at| Ask { frame: at / 22, joint: at % 22, place: place(at) });
                Target { view, asks: asks.collect(), depths: Vec::new() }
            })
            .collect()
    };
    let clips: Vec<_> = targets.iter().map(|target| GuidedClip { target, frames: 40 }).collect();
    let mut guide = Guide::new(&NETWORKS.vae, &features, &clips);
    let lcm = Lcm::new(2).unwrap();
    let networks = &NETWORKS;
    let sampler = Sampler { networks, features: &features, no_text: &[] };
    // The noise before guidance: that of a run without it.
    let options =
        SamplingOptions { guidance: None, semantics: Semantics::Paper, ..SamplingOptions::default() };
    let alpha = lcm.schedule().alpha(998);
    let start = vectors.numbers("latents_in");
    let mut first = Vec::new();
    let fresh = |_| vec![0.0; 512];
    let seen = |step: inkrig_generate::sampling::StepReport<'_>| {
        if step.step == 0 {
            first = step.noise.to_vec();
        }
    };
    sampler.run(&conditions, &options, start.clone(), fresh, seen).unwrap();
    let clean: Vec<f32> = start
        .iter()
        .zip(&first)
        .map(|(z, noise)| (z - (1.0 - alpha).sqrt() * noise) / alpha.sqrt())
        .collect();
    let mut gradient = vec![0.0; 512];
    let loss = guide.loss(&clean, Mean::AllEntries, &mut gradient).unwrap() as f32;
    let factor = -(1.0 - alpha).sqrt() / alpha.sqrt();
    gradient.iter_mut().for_each(|gradient| *gradient *= factor);
    let before = vectors.numbers("paper_guide.guide_loss_before_0")[0];
    println!("loss {loss:e}, stored {before:e}");
    assert!((loss / before - 1.0).abs() < 1e-4);
    assert_near("gradient", &gradient, &vectors.numbers("paper_guide.guide_grad_0"), 1e-4);

    let options = SamplingOptions { guidance: Some(GuidanceOptions::default()), ..options };
    let noise = vectors.numbers("noise");
    let fresh = |step: usize| noise[step * 512..][..512].to_vec();
    let sampled = sampler.run(&conditions, &options, start, fresh, |_| {}).unwrap();
    for (step, guided) in sampled.guided.iter().enumerate() {
        let stored = |what: &str| vectors.numbers(&format!("paper_guide.guide_{what}_{step}"))[0];
        let (before, after, calls) = (stored("loss_before"), stored("loss_after"), stored("closure_calls"));
        println!("step {step}: {guided:?}; stored {before:e} to {after:e} in {calls}");
        assert!((guided.after as f32 / after - 1.0).abs() < 0.1);
    }
}

#[test]
fn fifty_steps_with_weighted_text_are_the_stored_ones() {
    let (Some(vectors), Some(inversion)) = (Vectors::open("schedulers"), Vectors::open("ddim_inversion"))
    else {
        return;
    };
    let (Some(features), text) = (statistics(), inversion.numbers("text")) else { return };
    let no_text = vectors.numbers("ddim_cfg_text_uncond");
    let sampler = Sampler { networks: &NETWORKS, features: &features, no_text: &no_text };
    let options = SamplingOptions { steps: Steps::Ddim(50), guidance: None, ..SamplingOptions::default() };
    let target = Target { view: View::Space, asks: Vec::new(), depths: Vec::new() };
    let conditions: Vec<_> = (text.chunks_exact(768))
        .map(|text| {
            let (rows, target) = (Vec::new(), target.clone());
            Conditions::from_tables(40, text.to_vec(), Domain::Space, rows, None, target).unwrap()
        })
        .collect();
    let stored = vectors.numbers("ddim_cfg_latents_after_each_step");
    let mut most = 0.0_f32;
    let start = vectors.numbers("ddim_latents_in");
    let seen = |step: inkrig_generate::sampling::StepReport<'_>| {
        most = most.max(off(step.latents, &stored[step.step * 512..][..512]));
    };
    sampler.run(&conditions, &options, start, |_| Vec::new(), seen).unwrap();
    println!("fifty steps: {most:.1e} off at most");
    assert!(most < 1e-4);
}

#[test]
fn inversion_is_the_stored_one() {
    let Some(vectors) = Vectors::open("ddim_inversion") else { return };
    let ddim = Ddim::new(50).unwrap();
    let mut timesteps = ddim.timesteps();
    timesteps.reverse();
    assert_eq!(timesteps, vectors.whole("timesteps_ascending"));
    let denoiser = Denoiser::new(&Sizes::full(), &WEIGHTS).unwrap();
    let (texts, stored) = (vectors.numbers("text"), vectors.numbers("latents_after_each_step"));
    let mut latents = vectors.numbers("z0");
    let (mut work, mut most) = (Work::default(), 0.0_f32);
    for (step, &timestep) in timesteps.iter().enumerate() {
        let noisy = Noisy { latents: &latents, timesteps: &[timestep; 2], texts: &texts, guidance: None };
        let noise = denoiser.noise(&noisy, None, &mut work).unwrap();
        ddim.invert(&mut latents, &noise, timestep);
        let off = off(&latents, &stored[step * 512..][..512]);
        if step < 3 {
            println!("step {step} at {timestep}: {off:.1e}");
        }
        most = most.max(off);
    }
    println!("inversion: {most:.1e} off at most");
    assert!(most < 1e-4);
}
