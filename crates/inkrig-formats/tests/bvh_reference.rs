//! Every real BVH file survives reading, writing and reading.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too, and the test prints its table"
)]

mod common;

use common::Difference;
use inkrig_formats::{ExportOptions, Import, ImportOptions, read_bvh, write_bvh};
use std::{collections::BTreeMap, path::Path, time::Instant};

#[derive(Default)]
struct Line {
    /// Seconds spent reading the files, and writing them.
    seconds: [f64; 2],
    files: usize,
    frames: usize,
    bytes: usize,
    written: usize,
    worst: Difference,
    units: BTreeMap<String, usize>,
    findings: BTreeMap<&'static str, usize>,
}

#[test]
fn all_reference_files_survive_writing() {
    let Some(files) = common::reference_files("bvh") else { return };
    let mut table: BTreeMap<String, Line> = BTreeMap::new();
    for path in &files {
        let bytes = std::fs::read(path).unwrap();
        let start = Instant::now();
        let first = read_bvh(&bytes, &ImportOptions::default())
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let read = Instant::now();
        let written = write_bvh(&first.clip, &ExportOptions::like(&first.source)).unwrap();
        let end = Instant::now();
        assert!(written.findings.is_empty(), "{}: {:?}", path.display(), written.findings);
        let second = read_bvh(&written.bytes, &ImportOptions::default()).unwrap();
        let difference = Difference::between(&first.clip, &second.clip);
        assert!(difference.is_kept(), "{}: {difference:?}", path.display());
        assert_eq!(first.source, second.source, "{}", path.display());
        assert_eq!(first.clip.frame_rate(), second.clip.frame_rate(), "{}", path.display());
        let line = table.entry(collection(path)).or_default();
        line.seconds[0] += (read - start).as_secs_f64();
        line.seconds[1] += (end - read).as_secs_f64();
        line.add(&first, bytes.len(), written.bytes.len(), difference);
    }
    println!(
        "{:<32}{:>6}{:>8}{:>8}{:>8}{:>11}{:>11}",
        "collection", "files", "frames", "MB in", "MB out", "position", "degrees"
    );
    for (name, line) in &table {
        let (read, written) = (line.bytes as f64 / 1e6, line.written as f64 / 1e6);
        let Difference { position, degrees } = line.worst;
        println!(
            "{name:<32}{:>6}{:>8}{read:>8.1}{written:>8.1}{position:>11.1e}{degrees:>11.1e}",
            line.files, line.frames
        );
        let [reading, writing] = line.seconds;
        println!("    read at {:.0} MB/s, written at {:.0} MB/s", read / reading, written / writing);
        println!("    units {:?}, findings {:?}", line.units, line.findings);
    }
    println!("{} files", files.len());
}

/// The first folder below `data`.
fn collection(path: &Path) -> String {
    let parts: Vec<_> = path.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    let data = parts.iter().rposition(|part| part == "data").unwrap();
    parts[data + 1].clone()
}

impl Line {
    fn add(&mut self, import: &Import, bytes: usize, written: usize, difference: Difference) {
        self.files += 1;
        self.frames += import.clip.frames();
        self.bytes += bytes;
        self.written += written;
        self.worst = self.worst.largest(difference);
        *self.units.entry(import.source.metres_per_unit.to_string()).or_default() += 1;
        for finding in &import.findings {
            *self.findings.entry(finding.code).or_default() += 1;
        }
    }
}
