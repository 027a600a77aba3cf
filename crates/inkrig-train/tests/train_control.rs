//! Control, drawings and few steps are learned on a finished denoiser; each run can be stopped at any moment, and what it writes can be
//! sampled.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

mod desk;

use desk::{corpus, place};
use inkrig_generate::checkpoint::ModelFile;
use inkrig_generate::guidance::{Ask, View};
use inkrig_generate::networks::Parts;
use inkrig_generate::sampling::{Conditions, Networks, Request, Sampler, SamplingOptions, Semantics, Steps};
use inkrig_generate::text::{TextEncoder as _, VerbTable};
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::Camera;
use inkrig_train::TrainError;
use inkrig_train::training::{
    AlignSettings, ControlSettings, Course, DenoiserSettings, DistillSettings, EstimateSettings, OnStep,
    Report, VaeSettings, curves, train_align, train_control, train_denoiser, train_distill, train_vae,
};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

fn course(steps: u64) -> Course {
    Course {
        steps,
        batch: 12,
        rate: 4e-3,
        warm_up: 5,
        average: 0.9,
        measure_every: steps / 3,
        save_every: 7,
        ..Course::default()
    }
}

/// With a width, control by an estimate.
fn control(width: usize) -> ControlSettings {
    let frames = 20;
    ControlSettings {
        course: Course { rate: 2e-3, ..course(if width > 0 { 300 } else { 1800 }) },
        estimate: EstimateSettings { width, ..EstimateSettings::default() },
        frames,
        stride: 5,
        shortest: 10,
        longest: 40,
        decoded: 4,
        measured: 6,
        ..ControlSettings::default()
    }
}

/// The whole run in one folder, and in another the same stopped between two checkpoints, as if killed.
fn whole_and_killed(
    desk: &Path,
    name: &str,
    run: &dyn Fn(&Path, &mut OnStep<'_>) -> Result<Report, TrainError>,
) -> (Report, PathBuf) {
    let whole = desk.join(name);
    let report = run(&whole, &mut |_, _, _| ControlFlow::Continue(())).unwrap();
    assert!(report.complete);
    println!("{name}: {:?}", report.rows.iter().map(|row| (row.loss, &row.values)).collect::<Vec<_>>());
    let parts = desk.join(format!("{name}-parts"));
    let stop_at = |at: u64| {
        run(&parts, &mut |step, _, _| {
            if step == at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .unwrap()
    };
    stop_at(16);
    let checkpoint = std::fs::read(parts.join("checkpoint.safetensors")).unwrap();
    stop_at(19);
    std::fs::write(parts.join("checkpoint.safetensors"), checkpoint).unwrap();
    assert!(stop_at(u64::MAX).complete);
    let last = |folder: &Path| std::fs::read(folder.join("last.safetensors")).unwrap();
    assert!(last(&whole) == last(&parts), "{name}: the same weights to the bit");
    std::fs::write(parts.join("checkpoint.safetensors"), b"damaged").unwrap();
    let error = run(&parts, &mut |_, _, _| ControlFlow::Continue(())).unwrap_err().to_string();
    assert!(error.contains("damaged"), "{error}");
    assert!(curves(&whole).unwrap().contains("held out"));
    (report, whole.join("last.safetensors"))
}

/// Samples a clip with a trajectory and a key pose.
fn sample(model: &Path, view: View, steps: Steps) {
    let mut file = ModelFile::open(std::fs::File::open(model).unwrap()).unwrap();
    let (header, weights) = (file.header().clone(), file.tensors().unwrap());
    let (features, places) = header.statistics().unwrap();
    let verbs = VerbTable::new(&weights, header.sizes.text_width).unwrap();
    let networks = Networks::new(&header.sizes, &weights).unwrap();
    let asks = (0..5).map(|frame| Ask { frame, joint: 10, place: Vec3::new(0.1, 0.0, 0.1 * frame as f32) });
    let request = Request {
        frames: 20,
        text: verbs.encode("walk").unwrap(),
        view,
        trajectory: asks.collect(),
        keypose: Some((3, [Vec3::Y; 22])),
    };
    let conditions = Conditions::new(&request, &places, Semantics::Paper).unwrap();
    let no_text = verbs.encode("").unwrap();
    let sampler = Sampler { networks: &networks, features: &features, no_text: &no_text };
    let options = SamplingOptions { steps, guidance: None, ..SamplingOptions::default() };
    let sampled = sampler.sample(&[conditions], &options, 1).unwrap();
    assert!(sampled.latents.iter().all(|number| number.is_finite() && number.abs() < 100.0));
}

#[test]
fn stages_after_the_denoiser_learn_and_end_the_same_when_killed() {
    let desk = tempfile::tempdir().unwrap();
    let corpus = corpus(desk.path());
    let go_on = &mut |_, _, _: Option<&_>| ControlFlow::Continue(());
    let vae = VaeSettings {
        sizes: "tiny".into(),
        // So that what is decoded is a motion at once.
        cosines: Some(8),
        steps: 20,
        batch: 4,
        rate: 5e-3,
        frames: 20,
        shortest: 10,
        longest: 40,
        retimed: 0.0,
        ..VaeSettings::default()
    };
    let [of_vae, of_denoiser] = ["vae", "denoiser"].map(|name| desk.path().join(name));
    train_vae(&place(&corpus, &of_vae, 1), &vae, go_on).unwrap();
    let denoiser = DenoiserSettings {
        course: course(60),
        frames: 20,
        stride: 5,
        shortest: 10,
        longest: 40,
        velocity: false,
        trunk: 0,
        retimed: 0.0,
        mixed: 0.0,
        ..DenoiserSettings::default()
    };
    let vae = of_vae.join("last.safetensors");
    train_denoiser(&place(&corpus, &of_denoiser, 1), &vae, &denoiser, go_on).unwrap();
    let model = of_denoiser.join("last.safetensors");

    let error = train_align(&place(&corpus, &of_vae, 1), &model, &AlignSettings::default(), go_on);
    assert!(error.unwrap_err().to_string().contains("no control"));
    stages(desk.path(), &corpus, &model, 0);
    // Of feed-forward blocks, which nothing can copy.
    let of_feeding = desk.path().join("feeding");
    let denoiser = DenoiserSettings { velocity: true, trunk: 32, ..denoiser };
    train_denoiser(&place(&corpus, &of_feeding, 1), &vae, &denoiser, go_on).unwrap();
    let model = of_feeding.join("last.safetensors");
    let error = train_control(&place(&corpus, &of_vae, 1), &model, &control(0), go_on).unwrap_err();
    assert!(error.to_string().contains("estimate"), "{error}");
    stages(desk.path(), &corpus, &model, 24);
}

/// Control, drawings and few steps, one after the other.
fn stages(desk: &Path, corpus: &Path, model: &Path, width: usize) {
    let named = |stage: &str| format!("{stage}-{width}");
    let run = |folder: &Path, progress: &mut OnStep<'_>| {
        train_control(&place(corpus, folder, 2), model, &control(width), progress)
    };
    let (report, controlled) = whole_and_killed(desk, &named("control"), &run);
    let first_last = |report: &Report, name: &str| {
        let values: Vec<f64> = report.rows.iter().map(|row| row.value(name).unwrap()).collect();
        (values[0], values[values.len() - 1])
    };
    for name in [if width > 0 { "estimate" } else { "noise" }, "held_out_error"] {
        let (first, last) = first_last(&report, name);
        assert!(last < first, "{name} {first} {last}");
    }
    sample(&controlled, View::Space, Steps::Ddim(5));

    let run = |folder: &Path, progress: &mut OnStep<'_>| {
        let settings = AlignSettings {
            course: course(60),
            frames: 20,
            stride: 5,
            denoised: 3,
            measured: 6,
            ..AlignSettings::default()
        };
        train_align(&place(corpus, folder, 2), &controlled, &settings, progress)
    };
    let (report, aligned) = whole_and_killed(desk, &named("align"), &run);
    let learned: &[&str] = if width > 0 { &["estimate"] } else { &["matching", "contrast"] };
    for name in learned {
        let (first, last) = first_last(&report, name);
        assert!(last < first, "{name} {first} {last}");
    }
    sample(&aligned, View::Plane(Camera::default()), Steps::Ddim(5));

    let run = |folder: &Path, progress: &mut OnStep<'_>| {
        let settings = DistillSettings {
            course: Course { rate: 1e-3, ..course(60) },
            frames: 20,
            stride: 5,
            guidance_width: 16,
            ..DistillSettings::default()
        };
        train_distill(&place(corpus, folder, 2), &aligned, &settings, progress)
    };
    let (report, fast) = whole_and_killed(desk, &named("distill"), &run);
    let (first, last) = first_last(&report, "held_out_one_step");
    assert!(last < first, "{first} {last}");
    // Control and drawings are in it, and take its weight of the text without effect.
    let weights = ModelFile::open(std::fs::File::open(&fast).unwrap()).unwrap().tensors().unwrap();
    assert_eq!(Parts::of(&weights), Parts::ALL);
    sample(&fast, View::Plane(Camera::default()), Steps::Lcm(2));
    let go_on = &mut |_, _, _: Option<&_>| ControlFlow::Continue(());
    let folder = desk.join("again");
    let error = train_distill(&place(corpus, &folder, 1), &fast, &DistillSettings::default(), go_on);
    assert!(error.unwrap_err().to_string().contains("distilled already"));
}
