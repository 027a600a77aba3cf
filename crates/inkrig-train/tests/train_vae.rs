//! A run learns, can be stopped at any moment, and goes on as if it had not been.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

mod desk;

use desk::{corpus, place};
use inkrig_train::training::{Place, VaeSettings, train_vae};
use std::ops::ControlFlow;
use std::path::Path;

fn settings() -> VaeSettings {
    VaeSettings {
        sizes: "tiny".into(),
        latent_tokens: Some(2),
        steps: 60,
        batch: 8,
        rate: 5e-3,
        warm_up: 5,
        frames: 20,
        shortest: 10,
        longest: 40,
        measure_every: 20,
        save_every: 7,
        ..VaeSettings::default()
    }
}

#[test]
fn a_run_learns_and_a_stopped_one_ends_the_same() {
    let desk = tempfile::tempdir().unwrap();
    let corpus = corpus(desk.path());
    let whole = desk.path().join("whole");
    let go_on = &mut |_, _, _: Option<&_>| ControlFlow::Continue(());
    let (report, held_out) = train_vae(&place(&corpus, &whole, 2), &settings(), go_on).unwrap();
    assert!(report.complete && report.rows.len() == 3);
    let losses: Vec<f64> = report.rows.iter().map(|row| row.loss).collect();
    println!("losses {losses:?}, held out {held_out:?}");
    assert!(losses[2] < 0.85 * losses[0], "{losses:?}");
    let measured = |name: &str| report.rows.iter().map(|row| row.value(name).unwrap()).collect::<Vec<_>>();
    let aligned = measured("held_out_aligned_mm");
    assert!(aligned[2] < aligned[0], "{aligned:?}");
    assert_eq!(report.best.unwrap().0, measured("held_out_mm").into_iter().fold(f64::MAX, f64::min));
    assert_eq!(held_out.len(), 1, "the tiny network takes 40 frames and no 80");

    // Stopped twice, once by force between two checkpoints.
    let parts = desk.path().join("parts");
    let stop_at = |at: u64| {
        train_vae(&place(&corpus, &parts, 2), &settings(), &mut |step, _, _| {
            if step == at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .unwrap()
        .0
    };
    assert!(!stop_at(23).complete);
    let checkpoint = std::fs::read(parts.join("checkpoint.safetensors")).unwrap();
    assert!(!stop_at(45).complete);
    // As if killed: the log is ahead of the checkpoint.
    std::fs::write(parts.join("checkpoint.safetensors"), checkpoint).unwrap();
    let again = stop_at(u64::MAX);
    assert!(again.complete);
    let numbers = |rows: &[inkrig_train::training::Row]| -> Vec<(u64, f64, f64)> {
        rows.iter().map(|row| (row.step, row.loss, row.value("held_out_mm").unwrap())).collect()
    };
    let (one, other) = (numbers(&report.rows), numbers(&again.rows));
    assert_eq!(one.last().unwrap().2, other.last().unwrap().2, "{one:?} {other:?}");
    let last = |folder: &Path| std::fs::read(folder.join("last.safetensors")).unwrap();
    assert!(last(&whole) == last(&parts), "the same weights to the bit");

    // Other settings are another run; a broken checkpoint is said.
    let other = VaeSettings { rate: 1e-3, ..settings() };
    let error = train_vae(&place(&corpus, &parts, 2), &other, go_on).unwrap_err().to_string();
    assert!(error.contains("other settings"), "{error}");
    std::fs::write(parts.join("checkpoint.safetensors"), b"damaged").unwrap();
    let error = train_vae(&place(&corpus, &parts, 2), &settings(), go_on).unwrap_err().to_string();
    assert!(error.contains("damaged"), "{error}");
    // The checkpoint is gone: on from the weights alone.
    let from = Place { from: Some(&whole.join("last.safetensors")), ..place(&corpus, &parts, 2) };
    std::fs::remove_file(parts.join("checkpoint.safetensors")).unwrap();
    let short = VaeSettings { steps: 20, ..settings() };
    let (again, _) = train_vae(&from, &short, go_on).unwrap();
    assert!(again.rows[0].loss < 0.9 * report.rows[0].loss, "{:?} {losses:?}", again.rows);

    let wild = VaeSettings { rate: 1.0, clip: 1e30, warm_up: 0, steps: 400, ..settings() };
    match train_vae(&place(&corpus, &desk.path().join("wild"), 1), &wild, go_on) {
        Err(error) => assert!(error.to_string().contains("smaller rate"), "{error}"),
        // Adam's steps are bounded; if it held, its loss is a number all along.
        Ok((report, _)) => assert!(report.rows.iter().all(|row| row.loss.is_finite())),
    }
}

#[test]
fn a_linear_path_brings_clips_back_before_anything_is_learned() {
    let desk = tempfile::tempdir().unwrap();
    let corpus = corpus(desk.path());
    let go_on = &mut |_, _, _: Option<&_>| ControlFlow::Continue(());
    let mut begun = |cosines: usize, folder: &str| {
        let settings = VaeSettings {
            cosines: Some(cosines),
            steps: 1,
            rate: 1e-9,
            measure_every: 1,
            other_lengths: 0.0,
            ..settings()
        };
        let (report, _) = train_vae(&place(&corpus, &desk.path().join(folder), 1), &settings, go_on).unwrap();
        let row = &report.rows[0];
        ["held_out_mm", "held_out_aligned_mm", "divergence"].map(|name| row.value(name).unwrap())
    };
    let (with, without) = (begun(8, "with"), begun(0, "without"));
    println!("with {with:?}, without {without:?}");
    // 32 numbers for 20 frames of the few motions of the fixture.
    assert!(with[1] < 0.2 * without[1] && with[0] < 0.2 * without[0], "{with:?} {without:?}");
    // Numbers of the latent have variance 1, so all that is left of the divergence is what they say.
    assert!(with[2] < 6.0, "{with:?}");
    let decaying = VaeSettings { cosines: Some(8), weight_decay: 0.1, ..settings() };
    let error = train_vae(&place(&corpus, &desk.path().join("decay"), 1), &decaying, go_on).unwrap_err();
    assert!(error.to_string().contains("weight_decay"), "{error}");
}
