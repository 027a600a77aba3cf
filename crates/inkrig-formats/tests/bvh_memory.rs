//! No header makes the reader allocate more than a small multiple of the bytes that are really there.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod counting;

use inkrig_formats::{ImportOptions, read_bvh};

/// Bytes alive at the worst moment of reading, above what was alive before.
fn peak(text: &[u8]) -> (usize, bool) {
    counting::peak(|| read_bvh(text, &ImportOptions::default()).is_ok())
}

// The only test of its file: others at the same time would be counted too.
#[test]
fn hostile_headers_allocate_little() {
    let root = "HIERARCHY\nROOT a{OFFSET 0 0 0 CHANNELS 1 Xrotation ";
    let motion = "}\nMOTION\nFrames: 99999999999\nFrame Time: 0.1\n";
    let long = "n".repeat(250);
    let cases = [
        ("a huge frame count", format!("{root}{motion}0\n")),
        ("a huge channel count", "HIERARCHY\nROOT a{OFFSET 0 0 0 CHANNELS 99999999999 Xrotation".into()),
        ("joints without channels", format!("{root}{}{motion}0\n", "JOINT b{OFFSET 0 1 0}".repeat(16_000))),
        ("end sites", format!("{root}{}{motion}0\n", "End{OFFSET 0 1 0}".repeat(16_000))),
        ("end sites of a long name", {
            let sites = "End{OFFSET 0 1 0}".repeat(16_000);
            format!("HIERARCHY\nROOT {long}{{OFFSET 0 0 0 CHANNELS 1 Xrotation {sites}{motion}0\n")
        }),
        ("nested joints", format!("{root}{}", "JOINT b{OFFSET 0 1 0 ".repeat(16_000))),
        ("joints beyond the limit", format!("{root}{}", "JOINT b{".repeat(200_000))),
        ("channels", format!("{root}{}", "JOINT b{OFFSET 0 1 0 CHANNELS 1 Xrotation}".repeat(16_000))),
        ("many channels of a joint", {
            let channels = "Xrotation ".repeat(300_000);
            format!("HIERARCHY\nROOT a{{OFFSET 0 0 0 CHANNELS 300000 {channels}{motion}0\n")
        }),
        ("a name of 1 MB", format!("HIERARCHY\nROOT {}", "n".repeat(1 << 20))),
        ("a number of 1 MB", format!("{root}{motion}{}", "1".repeat(1 << 20))),
        ("a row of 1 MB", format!("{root}{motion}{}", "1 ".repeat(1 << 19))),
        ("a million rows", format!("{root}{motion}{}", "1\n".repeat(1 << 20))),
        ("a million empty lines", format!("{root}{motion}{}1\n", " \n".repeat(1 << 20))),
        ("positions", {
            let channels = "CHANNELS 3 Xposition Yposition Zposition";
            format!("HIERARCHY\nROOT a{{OFFSET 0 0 0 {channels}{motion}{}", "1 1 1\n".repeat(200_000))
        }),
    ];
    println!("{:<28}{:>12}{:>12}{:>8}", "case", "bytes", "peak", "times");
    for (name, text) in &cases {
        let (peak, read) = peak(text.as_bytes());
        let times = peak as f64 / text.len() as f64;
        println!(
            "{name:<28}{:>12}{peak:>12}{times:>8.1}  {}",
            text.len(),
            if read { "read" } else { "refused" }
        );
        assert!(peak <= 16 * text.len() + (1 << 20), "{name}: {peak} bytes for a file of {}", text.len());
    }
    // Short rows of a wide skeleton are the one thing that may cost more: up to 16 MiB, and 16 bytes a byte.
    let wide = format!("{root}{}{motion}{}", "JOINT b{OFFSET 0 1 0}".repeat(1000), "0\n".repeat(1000));
    let (peak, read) = peak(wide.as_bytes());
    assert!(read && peak <= 17 * wide.len() + (17 << 20), "{peak} bytes for a file of {}", wide.len());
}
