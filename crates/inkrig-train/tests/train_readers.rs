//! Readers learn, can be stopped at any moment, and go on as if they had not been.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

use inkrig_train::corpus::{Config, Shard, build};
use inkrig_train::reading::{Pace, SketchSettings, WordSettings, train_sketch, train_word};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// A corpus of one walk, to learn from and to measure on.
fn corpus(desk: &Path) -> PathBuf {
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

fn pace() -> Pace {
    Pace {
        steps: 24,
        batch: 10,
        warm_up: 3,
        measure_every: 12,
        measured: 10,
        save_every: 5,
        ..Pace::default()
    }
}

#[test]
fn a_reader_of_sketches_learns_and_a_stopped_run_ends_the_same() {
    let desk = tempfile::tempdir().unwrap();
    let corpus = corpus(desk.path());
    let settings = SketchSettings { pace: pace(), ..SketchSettings::default() };
    let whole = desk.path().join("whole");
    let (rows, complete) =
        train_sketch(&corpus, &whole, &settings, 1, &mut |_, _, _| ControlFlow::Continue(())).unwrap();
    println!("{rows:?}");
    assert!(complete && rows.len() == 2);
    assert!(rows[1].loss < 0.9 * rows[0].loss, "{rows:?}");

    // On two threads, stopped by hand, and once as if killed between two checkpoints.
    let parts = desk.path().join("parts");
    let stop_at = |at: u64| {
        train_sketch(&corpus, &parts, &settings, 2, &mut |step, _, _| {
            if step == at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .unwrap()
    };
    assert!(!stop_at(7).1);
    let checkpoint = std::fs::read(parts.join("checkpoint.safetensors")).unwrap();
    assert!(!stop_at(14).1);
    std::fs::write(parts.join("checkpoint.safetensors"), checkpoint).unwrap();
    let (again, complete) = stop_at(u64::MAX);
    assert!(complete && again.len() == 2, "{again:?}");
    let last = |folder: &Path| std::fs::read(folder.join("last.safetensors")).unwrap();
    assert!(last(&whole) == last(&parts), "the same weights to the bit");

    // Of weights that are there it begins where they are.
    let from = Some(whole.join("last.safetensors"));
    let one = Pace { steps: 1, measure_every: 1, ..pace() };
    let further = SketchSettings { pace: one, from, ..SketchSettings::default() };
    let go_on = &mut |_, _, _: Option<&_>| ControlFlow::Continue(());
    let (first, _) = train_sketch(&corpus, &desk.path().join("further"), &further, 2, go_on).unwrap();
    assert!(first[0].loss < 0.9 * rows[0].loss, "{first:?}");

    // More steps go on; other settings are another run; a broken checkpoint is said.
    let longer = SketchSettings { pace: Pace { steps: 26, ..pace() }, ..settings.clone() };
    assert!(train_sketch(&corpus, &parts, &longer, 2, go_on).unwrap().1);
    let other = SketchSettings { turned: 0.5, ..settings.clone() };
    let error = train_sketch(&corpus, &parts, &other, 2, go_on).unwrap_err().to_string();
    assert!(error.contains("other settings"), "{error}");
    std::fs::write(parts.join("checkpoint.safetensors"), b"damaged").unwrap();
    let error = train_sketch(&corpus, &parts, &settings, 2, go_on).unwrap_err().to_string();
    assert!(error.contains("damaged"), "{error}");
}

#[test]
fn a_reader_of_words_learns_from_fonts_and_says_what_is_wrong_with_them() {
    let desk = tempfile::tempdir().unwrap();
    let fonts = desk.path().join("fonts");
    std::fs::create_dir(&fonts).unwrap();
    for (name, wide) in [("one", 60), ("two", 90), ("three", 120)] {
        let glyph = |letter: char| {
            let code = u32::from(letter) % 32;
            let (right, high) = (wide * (1 + code % 3), 150 + 25 * (code / 2));
            format!(
                "<glyph unicode='{letter}' horiz-adv-x='{}' d='M 0 0 L {right} {high} L 0 {high}'/>",
                right + 40
            )
        };
        let glyphs: String = ('a'..='z').chain('A'..='Z').map(glyph).collect();
        let text = format!(
            "<svg xmlns='http://www.w3.org/2000/svg'><font><glyph unicode=' ' horiz-adv-x='150'/>{glyphs}</font></svg>"
        );
        std::fs::write(fonts.join(format!("{name}.svg")), text).unwrap();
    }
    let settings = WordSettings { pace: pace(), held_out: vec!["two".into()], ..WordSettings::default() };
    let go_on = &mut |_, _, _: Option<&_>| ControlFlow::Continue(());
    let (rows, complete) = train_word(&fonts, &desk.path().join("run"), &settings, 1, go_on).unwrap();
    println!("{rows:?}");
    assert!(complete && rows[1].loss < 0.7 * rows[0].loss, "{rows:?}");
    let wrong = WordSettings { held_out: vec!["four".into()], ..settings.clone() };
    let error = train_word(&fonts, &desk.path().join("other"), &wrong, 1, go_on).unwrap_err().to_string();
    assert!(error.contains("no font four"), "{error}");
    let none = WordSettings { held_out: vec!["one".into(), "two".into(), "three".into()], ..settings };
    assert!(train_word(&fonts, &desk.path().join("none"), &none, 1, go_on).is_err());
}
