//! Fuzz targets of the glTF reader and writer, on stable Rust. Under `cargo test` each runs for a second;
//! `BOLERO_RANDOM_TEST_TIME_MS=300000 cargo test --release -p inkrig-formats --test fuzz_gltf` runs them for longer.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod common;

use common::gltf::{Doc, glb, turn_x};
use inkrig_formats::{ClipChoice, ExportOptions, ImportOptions, no_files, read_gltf, write_glb};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicUsize, Ordering};

static TRIED: AtomicUsize = AtomicUsize::new(0);
static READABLE: AtomicUsize = AtomicUsize::new(0);

/// Values that a field may have instead of its own.
const VALUES: &[&str] = &[
    "0",
    "1",
    "2",
    "3",
    "7",
    "-1",
    "255",
    "65536",
    "4294967295",
    "18446744073709551615",
    "1e-300",
    "1e300",
    "0.5",
    "null",
    "true",
    "\"\"",
    "\"STEP\"",
    "\"LINEAR\"",
    "\"CUBICSPLINE\"",
    "\"VEC3\"",
    "\"VEC4\"",
    "\"SCALAR\"",
    "\"rotation\"",
    "\"scale\"",
    "\"translation\"",
    "[]",
    "{}",
    "[0]",
    "[1]",
    "[0,1,2]",
    "[0,0,0]",
    "[0,0,0,0]",
    "[1e30,1,1]",
    "[-1,1,1]",
    "[0,1,1]",
    "5120",
    "5121",
    "5122",
    "5123",
    "5125",
    "5126",
    "\"data:;base64,AAAAAAAAAAAAAAAAAAAAAA==\"",
    "\"../x\"",
    "{\"humanoid\":{\"humanBones\":{\"hips\":{\"node\":1}}}}",
];

/// Kind, place, what instead.
type Edit = (u8, u16, u16);

#[test]
fn documents_changed_at_random() {
    let seeds = seeds();
    bolero::check!().with_type::<(u8, Vec<Edit>, Vec<(u16, u8)>)>().for_each(|(seed, edits, bytes)| {
        let mut doc = seeds[usize::from(*seed) % seeds.len()].clone();
        for edit in edits.iter().take(1 + usize::from(*seed >> 4) % 2) {
            apply(&mut doc.json, *edit);
        }
        let count = doc.bin.len().max(1);
        for (place, byte) in bytes.iter().take(usize::from(*seed >> 6)) {
            if let Some(slot) = doc.bin.get_mut(usize::from(*place) % count) {
                *slot = *byte;
            }
        }
        TRIED.fetch_add(1, Ordering::Relaxed);
        READABLE.fetch_add(usize::from(check(&doc.glb())), Ordering::Relaxed);
    });
    let (tried, readable) = (TRIED.load(Ordering::Relaxed), READABLE.load(Ordering::Relaxed));
    println!("{tried} documents, {readable} of them readable");
    assert!(readable * 50 > tried);
}

#[test]
fn bytes_at_random() {
    let doc = Doc::walking_leg();
    let json = doc.json.to_string();
    bolero::check!().for_each(|bytes: &[u8]| {
        check(bytes);
        check(&glb(bytes, &doc.bin));
        check(&glb(json.as_bytes(), bytes));
    });
}

fn check(file: &[u8]) -> bool {
    let options = ImportOptions {
        limits: inkrig_formats::Limits { cells: 1 << 14, ..Default::default() },
        ..Default::default()
    };
    match read_gltf(file, &options, &no_files) {
        Ok(import) => {
            assert!(import.clip.frames() * import.clip.skeleton().len() <= 1 << 14);
            // What was read can be put back as a clip more, and written as a file of its own.
            let options = ExportOptions { metres_per_unit: 1.0, ..ExportOptions::like(&import.source) };
            let number = import.clips.len() + 1;
            for (options, number) in [(options, number), (ExportOptions::default(), 1)] {
                let written = match write_glb(&import.clip, &options) {
                    Ok(written) => written,
                    // Scales near 0 ask for places that no file can hold; anything else must be written.
                    Err(error) => {
                        assert!(error.to_string().contains("numbers go up to 1e12"), "{error}");
                        continue;
                    }
                };
                let clip = Some(ClipChoice::Number(number));
                let again = ImportOptions { clip, ..Default::default() };
                let again = read_gltf(&written.bytes, &again, &no_files).unwrap();
                assert_eq!(again.clip.frames(), import.clip.frames());
                assert_eq!(again.clip.skeleton().len(), import.clip.skeleton().len());
            }
            true
        }
        Err(error) => {
            let text = error.to_string();
            assert!(!text.is_empty() && !text.contains(char::is_control), "{text:?}");
            false
        }
    }
}

fn seeds() -> Vec<Doc> {
    let walking = Doc::walking_leg();
    let mut other = Doc::walking_leg();
    other.list("nodes").push(json!({ "name": "Armature", "children": [0], "scale": [2, 2, 2],
        "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }));
    other.channel(0, "scale", "STEP", &[0.0, 0.3], "VEC3", &[1.0, 1.0, 1.0, 2.0, 1.0, 1.0]);
    let spline = [[0.0; 4], turn_x(0.0), [0.5; 4], [0.1; 4], turn_x(1.0), [0.0; 4]].concat();
    other.channel(0, "rotation", "CUBICSPLINE", &[0.0, 0.7], "VEC4", &spline);
    let index = other.view(&[0, 0, 2, 0]);
    let sparse = json!({ "count": 2, "indices": { "bufferView": index, "componentType": 5123 },
        "values": { "bufferView": 1 } });
    other.json["accessors"][1]["sparse"] = sparse;
    other.json["extensions"] =
        json!({ "VRMC_vrm": { "humanoid": { "humanBones": { "hips": { "node": 0 } } } } });
    vec![walking, other]
}

/// Changes one place of the tree.
fn apply(json: &mut Value, (kind, place, what): Edit) {
    let mut pointers = Vec::new();
    collect(json, String::new(), &mut pointers);
    let pointer = &pointers[usize::from(place) % pointers.len()];
    let other = json.pointer(&pointers[usize::from(what) % pointers.len()]).cloned();
    let Some((parent, name)) = pointer.rsplit_once('/') else { return };
    let value: Value = serde_json::from_str(VALUES[usize::from(what) % VALUES.len()]).unwrap_or(Value::Null);
    match (json.pointer_mut(parent), kind % 4) {
        (Some(Value::Object(map)), 0) => drop(map.remove(name)),
        (Some(Value::Array(list)), 0) => drop(name.parse().map(|index: usize| list.remove(index))),
        (Some(Value::Array(list)), 1) => list.extend(other),
        (Some(Value::Object(map)), 1) => drop(map.insert(name.into(), other.unwrap_or(value))),
        _ => {
            if let Some(slot) = json.pointer_mut(pointer) {
                *slot = value;
            }
        }
    }
}

fn collect(json: &Value, at: String, pointers: &mut Vec<String>) {
    match json {
        Value::Object(map) => {
            for (name, value) in map {
                collect(value, format!("{at}/{name}"), pointers);
            }
        }
        Value::Array(list) => {
            for (index, value) in list.iter().enumerate() {
                collect(value, format!("{at}/{index}"), pointers);
            }
        }
        _ => {}
    }
    pointers.push(at);
}
