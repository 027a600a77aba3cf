//! Fuzz targets of the FBX reader and writer, on stable Rust. Under `cargo test` each runs for a second;
//! `BOLERO_RANDOM_TEST_TIME_MS=300000 cargo test --release -p inkrig-formats --test fuzz_fbx` runs them for longer.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod common;

use common::fbx::{SECOND, Text, vector};
use common::odd_clip;
use inkrig_formats::{ExportOptions, FormatError, ImportOptions, Limits, read_fbx, write_fbx};
use std::sync::atomic::{AtomicUsize, Ordering};

static TRIED: AtomicUsize = AtomicUsize::new(0);
static READABLE: AtomicUsize = AtomicUsize::new(0);

/// Words that mean something to the reader, or nearly.
const WORDS: &[&str] = &[
    "{\n",
    "}\n",
    "\"OO\"",
    "\"OP\"",
    "C: \"OO\",2,1\n",
    "C: \"OO\",1,2\n",
    "C: \"OO\",1,1\n",
    "\"LimbNode\"",
    "\"Null\"",
    "\"Mesh\"",
    "\"Lcl Scaling\"",
    "\"Lcl Rotation\"",
    "\"d|X\"",
    "P: \"InheritType\", \"enum\", \"\", \"\",2\n",
    "P: \"RotationOrder\", \"enum\", \"\", \"\",4\n",
    "P: \"RotationActive\", \"bool\", \"\", \"\",1\n",
    "P: \"PreRotation\", \"Vector3D\", \"Vector\", \"\",0,0,90\n",
    "P: \"ScalingPivot\", \"Vector3D\", \"Vector\", \"\",0,1e9,90\n",
    "P: \"TimeMode\", \"enum\", \"\", \"\",14\n",
    "P: \"CustomFrameRate\", \"double\", \"Number\", \"\",1e9\n",
    "P: \"inkrig_end_site\", \"bool\", \"\", \"U\",1\n",
    "*99999999999",
    "99999999999",
    "-1",
    "nan",
    "1e300",
    "1e-300",
    "0,",
    "0",
    "a: ",
    "Post-Extrapolation: {\nType: R\nRepetition: -1\n}\n",
    "\u{feff}",
    "\0",
    ";",
    "\"",
];

/// Kind, place, argument, second place.
type Edit = (u8, u16, u8, u16);

#[test]
fn files_changed_at_random() {
    let seeds = seeds();
    bolero::check!().with_type::<(u8, Vec<Edit>)>().for_each(|(seed, edits)| {
        let mut file = seeds[usize::from(*seed) % seeds.len()].clone();
        for edit in edits.iter().take(1 + usize::from(*seed >> 5)) {
            apply(&mut file, *edit, &seeds);
        }
        TRIED.fetch_add(1, Ordering::Relaxed);
        READABLE.fetch_add(usize::from(check(&file)), Ordering::Relaxed);
    });
    let (tried, readable) = (TRIED.load(Ordering::Relaxed), READABLE.load(Ordering::Relaxed));
    println!("{tried} files, {readable} of them readable");
    assert!(readable * 20 > tried);
}

#[test]
fn bytes_at_random() {
    let head = seeds().pop().unwrap()[..27].to_vec();
    bolero::check!().for_each(|bytes: &[u8]| {
        check(bytes);
        check(&[&b"; FBX 7.4.0 project file\n"[..], bytes].concat());
        check(&[&head[..], bytes].concat());
    });
}

fn seeds() -> Vec<Vec<u8>> {
    let mut rig = Text::new();
    let lying = vector("Lcl Rotation", [-90.0, 0.0, 0.0]) + &vector("Lcl Scaling", [100.0, 100.0, 100.0]);
    rig.node(1, "Armature", "Null", 0, &lying);
    rig.node(2, "hip", "LimbNode", 1, &vector("Lcl Translation", [0.0, 0.0, 1.0]));
    rig.node(3, "helper", "Null", 2, "");
    rig.node(4, "knee", "LimbNode", 3, "P: \"InheritType\", \"enum\", \"\", \"\",2\n");
    rig.node(5, "knee_end", "LimbNode", 4, &vector("Lcl Translation", [0.5, 0.0, 0.0]));
    rig.stack(100, "swing", [0, SECOND]);
    rig.curves_of(100, 2, "Lcl Rotation", &[Some("0:0 30:90"), None, None], "3080", "0,0,0,0");
    rig.curves_of(100, 4, "Lcl Scaling", &[Some("0:1 7.3:2 30:1"), None, None], "2", "0,0,0,0");
    rig.stack(200, "walk", [SECOND, 2 * SECOND]);
    let written = write_fbx(&odd_clip(6, 30.0), &ExportOptions::default()).unwrap().bytes;
    vec![Text::leg().bytes(), rig.bytes(), written]
}

fn apply(file: &mut Vec<u8>, (kind, place, argument, other): Edit, seeds: &[Vec<u8>]) {
    let place = usize::from(place) % (file.len() + 1);
    let end = (place + usize::from(argument) % 64).min(file.len());
    let other = usize::from(other);
    match kind % 16 {
        0 | 1 => {
            let word = WORDS[other % WORDS.len()];
            file.splice(place..place, word.bytes());
        }
        2 | 3 => {
            let word = WORDS[other % WORDS.len()];
            let from = place + file[place..].iter().take_while(|byte| !byte.is_ascii_digit()).count();
            let to = from + file[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
            file.splice(from..to, word.bytes());
        }
        4 => drop(file.drain(place..end)),
        5 => {
            let copy: Vec<u8> = file[place..end].to_vec();
            let to = other % (file.len() + 1);
            file.splice(to..to, copy);
        }
        6 => file.truncate(place),
        7 => {
            let source = &seeds[usize::from(argument) % seeds.len()];
            let from = other % (source.len() + 1);
            file.truncate(place);
            file.extend_from_slice(&source[from..]);
        }
        8 => {
            // A whole line, or what lies between two of them.
            let start = place + file[place..].iter().position(|byte| *byte == b'\n').unwrap_or(0);
            let end = start + 1 + file[start..].iter().skip(1).position(|byte| *byte == b'\n').unwrap_or(0);
            drop(file.drain(start..end.min(file.len())));
        }
        // Most changes keep the file readable: another digit, or another byte.
        9..=13 => {
            if let Some(digit) = file.iter_mut().skip(place).find(|byte| byte.is_ascii_digit()) {
                *digit = b'0' + argument % 10;
            }
        }
        _ => {
            if let Some(byte) = file.get_mut(place) {
                *byte = argument;
            }
        }
    }
}

/// Reading does not panic; what was read can be written, and what was written is read as the same motion. Whether it could
/// be read.
fn check(file: &[u8]) -> bool {
    let limits = Limits { cells: 1 << 12, joints: 200, ..Limits::default() };
    let options = ImportOptions { limits, ..ImportOptions::default() };
    let first = match read_fbx(file, &options) {
        Ok(first) => first,
        Err(error) => {
            let text = error.to_string();
            assert!(!text.is_empty() && !text.contains(char::is_control), "{text:?}");
            return false;
        }
    };
    assert!(first.clip.frames() * first.clip.skeleton().len() <= 1 << 12);
    match write_fbx(&first.clip, &ExportOptions::like(&first.source)) {
        Ok(written) => {
            let options = ImportOptions { frame_rate: Some(first.clip.frame_rate()), ..Default::default() };
            let second = read_fbx(&written.bytes, &options).unwrap();
            assert_eq!(first.clip.frames(), second.clip.frames());
            assert_eq!(first.clip.skeleton().len(), second.clip.skeleton().len());
        }
        // Places far away may be further in another unit.
        Err(FormatError::Write { .. } | FormatError::Options { .. }) => {}
        Err(error) => panic!("{error}"),
    }
    true
}
