//! No text and no bytes whatever make a reader of waves, labels or tables panic or run away. Runs a bounded number of random
//! inputs under `cargo test`, and as long as wanted under `cargo bolero test`.

use std::time::{Duration, Instant};

use bolero::check;
use inkrig_sketch::{Format, Labels, Wave, read_labels, read_table, read_wave};

const ITERATIONS: usize = 4000;
/// What one input of at most some kilobytes may take: far above what it does take, far below a search that runs away.
const PATIENCE: Duration = Duration::from_secs(5);

fn within_patience(work: impl FnOnce()) {
    let start = Instant::now();
    work();
    assert!(start.elapsed() < PATIENCE, "{:?}", start.elapsed());
}

/// Reads as text, and samples and shows what was read.
fn read_text(text: &str) {
    within_patience(|| {
        if let Ok(wave) = text.parse::<Wave>() {
            assert_eq!(wave.to_string().parse(), Ok(wave.clone()), "{wave}");
            if let Ok(values) = wave.sample(30.0, 90) {
                assert!(values.len() == 90 && values.iter().all(|value| value.is_finite()));
            }
        }
        if let Ok(labels) = text.parse::<Labels>() {
            check_labels(&labels);
        }
    });
}

/// Reads as a file of every kind, and brings what was read to frames.
fn read_files(bytes: &[u8]) {
    within_patience(|| {
        for format in [Format::Csv, Format::Json, Format::Svg] {
            if let Ok(wave) = read_wave(bytes, format) {
                assert_eq!(wave.width(), 1);
                assert!(wave.resample(24).is_ok_and(|values| values.len() == 24));
            }
            if let Ok(labels) = read_labels(bytes, format) {
                check_labels(&labels);
            }
        }
        if let Ok(table) = read_table(bytes) {
            assert!(table.resample(24).is_ok_and(|values| values.len() == 24 * table.width()));
        }
    });
}

fn check_labels(labels: &Labels) {
    assert_eq!(labels.to_string().parse(), Ok(labels.clone()), "{labels}");
    for frames in [Some(24), Some(2000)] {
        if let Ok(control) = labels.to_one_hot(30.0, frames) {
            let rows = control.values.chunks(control.names.len());
            assert!(rows.clone().all(|row| row.iter().sum::<f32>() == 1.0) && Some(rows.len()) == frames);
        }
    }
}

/// Joins pieces that the bytes choose, so that random input gets past the first characters.
fn assemble(pieces: &[&str], bytes: &[u8]) -> String {
    bytes.iter().filter_map(|&byte| pieces.get(usize::from(byte) % pieces.len())).copied().collect()
}

#[test]
fn any_bytes() {
    check!().with_iterations(ITERATIONS).with_max_len(512).for_each(|bytes: &[u8]| {
        read_files(bytes);
        read_text(&String::from_utf8_lossy(bytes));
    });
}

#[test]
fn wave_pieces() {
    const PIECES: &[&str] = &[
        "sine",
        "triangle",
        "square(",
        "saw",
        "noise(",
        "ramp(",
        "constant(",
        "alternate(",
        "sine(2Hz)",
        "(",
        "(",
        ")",
        ")",
        ",",
        ";",
        "=",
        "|",
        "+",
        "-",
        "*",
        "..",
        " ",
        "t",
        "1",
        "0.5",
        "2e-3",
        "1e15",
        "Hz",
        "s",
        "2Hz",
        "0.5s",
        " for ",
        " for 1s;",
        "amplitude=",
        "centre=",
        "phase=",
        "duty=",
        "seed=",
        ",centres=0|1",
        ",every=1s)",
        "0..1",
        "é",
        "\u{7}",
    ];
    check!().with_iterations(ITERATIONS).with_max_len(128).for_each(|bytes: &[u8]| {
        let text = assemble(PIECES, bytes);
        read_text(&text);
        read_text(&format!("sine(2Hz{text}"));
        // Closed, so that more texts are well formed.
        let open = text.matches('(').count().saturating_sub(text.matches(')').count());
        read_text(&format!("t+{text}{}", ")".repeat(open)));
    });
}

#[test]
fn label_pieces() {
    const PIECES: &[&str] = &[
        "A",
        "B",
        "\"",
        "\"\"",
        ":",
        ":",
        " ",
        " ",
        "30",
        "1.5s",
        "1e3s",
        "A:3 ",
        "B:0.1s ",
        "\"a b\":2 ",
        "-",
        "0",
        ",",
        "é",
        "\u{2003}",
        "99999999999",
        "s",
    ];
    check!().with_iterations(ITERATIONS).with_max_len(128).for_each(|bytes: &[u8]| {
        let text = assemble(PIECES, bytes);
        read_text(&text);
        read_text(&format!("A:3 B:4 {text}"));
    });
}

#[test]
fn csv_pieces() {
    const PIECES: &[&str] = &[
        ",", ",", ";", "\t", "\n", "\n", "\r\n", "\r", "#", "\"", "A", "label", "t", "time", "0", "1.5",
        "-2e3", "NaN", "inf", "1e999", "0,1\n", "2,3\n", " ", "\u{feff}", "é", "\0",
    ];
    check!().with_iterations(ITERATIONS).with_max_len(96).for_each(|bytes: &[u8]| {
        let text = assemble(PIECES, bytes);
        read_files(text.as_bytes());
        read_files(format!("t,a\n0,0\n{text}").as_bytes());
        read_files(format!("label\nA\nB\n{text}").as_bytes());
    });
}

#[test]
fn json_pieces() {
    const PIECES: &[&str] = &[
        "[",
        "]",
        "{",
        "}",
        ",",
        ",",
        ":",
        "0",
        "1.5",
        "-2e3",
        "1e999",
        "NaN",
        "null",
        "\"A\"",
        "\"B\"",
        "\"values\":",
        "\"rate\":",
        "\"labels\":",
        "\"name\":\"A\"",
        "\"frames\":3",
        "\"seconds\":0.5",
        "{\"name\":\"B\",\"frames\":2}",
        "[0,1",
        "[\"A\",\"B\"",
        "\"",
        "é",
    ];
    check!().with_iterations(ITERATIONS).with_max_len(96).for_each(|bytes: &[u8]| {
        let text = assemble(PIECES, bytes);
        read_files(text.as_bytes());
        read_files(format!("[0,1,{text}]").as_bytes());
        read_files(format!("[\"A\",\"B\",{text}]").as_bytes());
    });
}
