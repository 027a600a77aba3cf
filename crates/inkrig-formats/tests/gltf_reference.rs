//! Every real GLB file is read, clip by clip.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too, and the test prints its table"
)]

mod common;

use inkrig_formats::{ClipChoice, ImportOptions, no_files, read_gltf};
use std::time::Instant;

#[test]
fn all_clips_of_all_reference_files_are_read() {
    let Some(files) = common::reference_files("glb") else { return };
    println!(
        "{:<28}{:>8}{:>6}{:>7}{:>8}{:>9}{:>9}{:>7}  findings",
        "file", "joints", "ends", "clips", "frames", "seconds", "size m", "ms"
    );
    let mut facts = std::collections::BTreeMap::new();
    for path in &files {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let bytes = std::fs::read(path).unwrap();
        let start = Instant::now();
        if name == "fox-model.glb" {
            let error = read_gltf(&bytes, &ImportOptions::default(), &no_files).unwrap_err().to_string();
            assert!(
                error.starts_with("the file: a mesh without a skeleton; a motion needs joints"),
                "{error}"
            );
            println!("{name:<28}  refused: {error}");
            continue;
        }
        let first = read_gltf(&bytes, &ImportOptions::default(), &no_files)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let (mut frames, mut seconds) = (0, 0.0);
        let mut codes: Vec<_> = first.findings.iter().map(|finding| finding.code).collect();
        for number in 1..=first.clips.len() {
            let options = ImportOptions { clip: Some(ClipChoice::Number(number)), ..Default::default() };
            let import = read_gltf(&bytes, &options, &no_files)
                .unwrap_or_else(|error| panic!("{} clip {number}: {error}", path.display()));
            assert_eq!(import.clip.skeleton(), first.clip.skeleton());
            assert!([24.0, 30.0].contains(&import.clip.frame_rate()), "{name} {}", import.clip.frame_rate());
            frames += import.clip.frames();
            seconds += import.clip.duration();
            codes.extend(import.findings.iter().map(|finding| finding.code));
        }
        codes.sort_unstable();
        codes.dedup();
        let skeleton = first.clip.skeleton();
        let ends = skeleton.joints().iter().filter(|joint| joint.end_site).count();
        println!(
            "{name:<28}{:>8}{ends:>6}{:>7}{frames:>8}{seconds:>9.2}{:>9.2}{:>7.1}  {codes:?}",
            skeleton.len() - ends,
            first.clips.len(),
            skeleton.extent(),
            1e3 * start.elapsed().as_secs_f64()
        );
        facts.insert(name, (skeleton.len() - ends, first.clips.len(), frames));
    }
    println!("{} files", files.len());
    // As counted in the files by other means.
    assert_eq!(facts["wolf.glb"], (51, 12, 509));
    assert_eq!(facts["horse-animations.glb"], (56, 14, 847));
    assert_eq!(facts["Med_MovementAdvanced.glb"].0, 23);
}
