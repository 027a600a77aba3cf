//! A run learns, can be stopped at any moment, and goes on as if it had not been.
#![cfg(feature = "train")]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

use inkrig_train::corpus::{Config, Shard, build};
use inkrig_train::training::{VaeSettings, train_vae};
use std::ops::ControlFlow;
use std::path::Path;

/// A corpus of one walk, to learn from and to measure on.
fn corpus(desk: &Path) -> std::path::PathBuf {
    let person = inkrig_samples::find("person").unwrap().bytes;
    for subject in ["ann", "bob"] {
        let folder = desk.join("data").join(subject);
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("walk.bvh"), person).unwrap();
    }
    let config = "[[source]]\nname='own'\nfolder='data'\nlicence='free'\nsubjects={bob='val'}\n";
    std::fs::write(desk.join("corpus.toml"), config).unwrap();
    let config = Config::read(&desk.join("corpus.toml")).unwrap();
    let out = desk.join("corpus");
    build(&config, &out, Shard::ALL, 1, &|_| ControlFlow::Continue(())).unwrap();
    out
}

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
    let report = train_vae(&corpus, &whole, &settings(), 2, go_on).unwrap();
    assert!(report.complete && report.rows.len() == 3);
    let losses: Vec<f64> = report.rows.iter().map(|row| row.loss).collect();
    println!("losses {losses:?}, held out {:?}", report.held_out);
    assert!(losses[2] < 0.85 * losses[0], "{losses:?}");
    let held_out: Vec<f64> = report.rows.iter().map(|row| row.held_out_aligned_mm).collect();
    assert!(held_out[2] < held_out[0], "{held_out:?}");
    assert_eq!(report.held_out.len(), 1, "the tiny network takes 40 frames and no 80");

    // Stopped twice, once by force between two checkpoints.
    let parts = desk.path().join("parts");
    let stop_at = |at: u64| {
        train_vae(&corpus, &parts, &settings(), 2, &mut |step, _, _| {
            if step == at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .unwrap()
    };
    assert!(!stop_at(23).complete);
    let checkpoint = std::fs::read(parts.join("checkpoint.safetensors")).unwrap();
    assert!(!stop_at(45).complete);
    // As if killed: the log is ahead of the checkpoint.
    std::fs::write(parts.join("checkpoint.safetensors"), checkpoint).unwrap();
    let again = stop_at(u64::MAX);
    assert!(again.complete);
    let numbers = |rows: &[inkrig_train::training::Row]| -> Vec<(u64, f64, f64)> {
        rows.iter().map(|row| (row.step, row.loss, row.held_out_mm)).collect()
    };
    let (one, other) = (numbers(&report.rows), numbers(&again.rows));
    assert_eq!(one.last().unwrap().2, other.last().unwrap().2, "{one:?} {other:?}");
    let last = |folder: &Path| std::fs::read(folder.join("last.safetensors")).unwrap();
    assert!(last(&whole) == last(&parts), "the same weights to the bit");

    // Other settings are another run; a broken checkpoint is said.
    let other = VaeSettings { rate: 1e-3, ..settings() };
    let error = train_vae(&corpus, &parts, &other, 2, go_on).unwrap_err().to_string();
    assert!(error.contains("other settings"), "{error}");
    std::fs::write(parts.join("checkpoint.safetensors"), b"damaged").unwrap();
    let error = train_vae(&corpus, &parts, &settings(), 2, go_on).unwrap_err().to_string();
    assert!(error.contains("damaged"), "{error}");
    let wild = VaeSettings { rate: 1.0, clip: 1e30, warm_up: 0, steps: 400, ..settings() };
    match train_vae(&corpus, &desk.path().join("wild"), &wild, 1, go_on) {
        Err(error) => assert!(error.to_string().contains("smaller rate"), "{error}"),
        // Adam's steps are bounded; if it held, its loss is a number all along.
        Ok(report) => assert!(report.rows.iter().all(|row| row.loss.is_finite())),
    }
}
