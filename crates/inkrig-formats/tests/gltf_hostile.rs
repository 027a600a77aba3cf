//! Damaged and hostile glTF files: an error that says what and where, never a panic, never long work.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod common;

use common::gltf::{Doc, glb};
use inkrig_formats::{Format, FormatError, ImportOptions, no_files, read_gltf, read_motions};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

fn error(bytes: &[u8]) -> FormatError {
    read_gltf(bytes, &ImportOptions::default(), &no_files).unwrap_err()
}

/// What is changed in the walking leg by a pointer into its JSON, and what is then said.
#[rustfmt::skip]
const CASES: &[(&str, &str, &str)] = &[
    ("/nodes/1/children", "[0]", "node 0 `hip`: it hangs below itself; "),
    ("/nodes/1/children", "[1]", "node 1 `knee`: its child 1 is also a child of node 0; "),
    ("/nodes/1/children", "[2,2]", "node 1 `knee`: its child 2 is also a child of node 1; "),
    ("/nodes/1/children", "[99]", "node 1 `knee`: its child 99 does not exist; "),
    ("/nodes/1/children", "[-1]", "line 1, column "),
    ("/nodes/1/rotation", "[0,0,0,0]", "node 1 `knee`: its rotation is zero; "),
    ("/nodes/1/translation", "[0,1e300,0]", "node 1 `knee`: its place has a number that is none or too large; "),
    ("/nodes/1/translation", "[0,1e999,0]", "line 1, column "),
    ("/nodes/1/translation", "[0,1]", "line 1, column "),
    ("/nodes/1/matrix", "[1e13,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]", "node 1 `knee`: its matrix has a number that is none or too large; "),
    ("/skins/0/joints", "[0,7]", "skin 0: its joint 7 does not exist; "),
    ("/skins/0/joints", "[4294967296]", "line 1, column "),
    ("/animations/0/channels/0/sampler", "9", "a channel of node 0: its sampler 9 does not exist; "),
    ("/animations/0/samplers/0/input", "9", "accessor 9: there is no such accessor; "),
    ("/animations/0/samplers/0/interpolation", "\"BEZIER\"", "line 1, column "),
    ("/accessors/0/type", "\"VEC3\"", "accessor 0: its elements are Vec3, and Scalar is wanted; "),
    ("/accessors/0/type", "\"MAT2\"", "accessor 0: its elements are Other, and Scalar is wanted; "),
    ("/accessors/0/componentType", "5124", "accessor 0: 5124 is no component type; "),
    ("/accessors/0/count", "0", "accessor 0: a channel without keys; "),
    ("/accessors/0/count", "32", "accessor 0: 32 elements of 4 bytes, and 124 bytes are there; "),
    ("/accessors/0/count", "18446744073709551615", "accessor 0: 18446744073709551615 elements of 4 bytes, and 124 bytes are there; "),
    ("/accessors/0/byteOffset", "18446744073709551615", "accessor 0: 31 elements of 4 bytes, and 0 bytes are there; "),
    ("/accessors/0/bufferView", "9", "accessor 0: buffer view 9 does not exist; "),
    ("/accessors/0/sparse", "{\"count\":9,\"indices\":{\"bufferView\":0,\"componentType\":5126},\"values\":{\"bufferView\":0}}", "accessor 0: 5126 is no component type of sparse indices; "),
    ("/accessors/0/sparse", "{\"count\":2,\"indices\":{\"bufferView\":0,\"componentType\":5121},\"values\":{\"bufferView\":0}}", "accessor 0: its sparse indices do not rise; "),
    ("/accessors/0/sparse", "{\"count\":1,\"indices\":{\"bufferView\":0,\"byteOffset\":120,\"componentType\":5125},\"values\":{\"bufferView\":0}}", "accessor 0: a sparse index is beyond its 31 elements; "),
    ("/accessors/0/sparse", "{\"count\":99999999999,\"indices\":{\"bufferView\":0,\"componentType\":5125},\"values\":{\"bufferView\":0}}", "accessor 0: 99999999999 sparse elements of 4 bytes, and 124 bytes are there; "),
    ("/bufferViews/0/byteLength", "18446744073709551615", "accessor 0: buffer view 0 ends at byte 18446744073709551615 of 1116; "),
    ("/bufferViews/0/byteStride", "0", "accessor 0: elements of 4 bytes stand 0 bytes apart; "),
    ("/bufferViews/0/byteStride", "3", "accessor 0: elements of 4 bytes stand 3 bytes apart; "),
    ("/bufferViews/0/buffer", "1", "buffer 1: there is no such buffer; "),
    ("/bufferViews/0/extensions", "{\"EXT_meshopt_compression\":{}}", "accessor 0: it is packed with meshopt, "),
    ("/buffers/0/uri", "\"x.bin\"", "buffer 0: its file `x.bin` cannot be read: no other files are at hand; "),
    ("/buffers/0/uri", "\"data:;base64,A*\"", "buffer 0: the data in the text is not base64; "),
    ("/buffers/0/uri", "\"../../etc/passwd\"", "buffer 0: it lies at `../../etc/passwd`: it leads out of the document's folder; "),
];

fn changed(pointer: &str, value: &str) -> Vec<u8> {
    let doc = Doc::walking_leg();
    let mut json = doc.json.clone();
    let (parent, name) = pointer.rsplit_once('/').unwrap();
    // What serde_json cannot hold is put in as text.
    json.pointer_mut(parent).unwrap()[name] = json!("@@");
    glb(json.to_string().replace("\"@@\"", value).as_bytes(), &doc.bin)
}

#[test]
fn damaged_parts_are_named() {
    for (pointer, value, expected) in CASES {
        let error = error(&changed(pointer, value));
        let text = error.to_string();
        assert!(text.starts_with(expected), "{text}");
        assert!(!error.hint().is_empty(), "{pointer}");
        assert!(!text.contains('\n'), "{text}");
    }
}

#[test]
fn numbers_that_are_none_are_named() {
    let said = |change: &dyn Fn(&mut Doc)| {
        let mut doc = Doc::walking_leg();
        change(&mut doc);
        error(&doc.glb()).to_string()
    };
    // Times from byte 0, places from 124, rotations from 620.
    let put = |at: usize, value: f32| {
        move |doc: &mut Doc| doc.bin[at..at + 4].copy_from_slice(&value.to_le_bytes())
    };
    assert!(
        said(&put(8, f32::NAN))
            .starts_with("accessor 0: key 2 is at NaN s, and times are numbers that rise; ")
    );
    assert!(said(&put(8, 0.0)).starts_with("accessor 0: key 2 is at 0 s, "));
    assert!(said(&put(120, f32::INFINITY)).starts_with("accessor 0: key 30 is at inf s, "));
    assert!(said(&put(124 + 16, f32::NAN)).starts_with("accessor 1: element 1 has a number that is none"));
    assert!(
        said(&put(124 + 16, 1e13))
            .starts_with("accessor 1: element 1 has a number that is none or too large; ")
    );
    let zero = said(&|doc: &mut Doc| doc.bin[620 + 16..620 + 32].fill(0));
    assert!(zero.starts_with("accessor 3: element 1 is a rotation of zero; "), "{zero}");
}

#[test]
fn a_file_may_be_cut_anywhere() {
    let file = Doc::walking_leg().glb();
    for end in 0..file.len() {
        assert!(read_gltf(&file[..end], &ImportOptions::default(), &no_files).is_err(), "{end}");
    }
    // The same with a header that announces what is there.
    for end in 20..file.len() {
        let mut cut = file[..end].to_vec();
        cut[8..12].copy_from_slice(&(end as u32).to_le_bytes());
        let _ = read_gltf(&cut, &ImportOptions::default(), &no_files);
    }
}

#[test]
fn hostile_sizes_are_refused_quickly() {
    let node =
        |count: usize| format!(r#"{{"nodes":[{}{{}}],"skins":[{{"joints":[0]}}]}}"#, "{},".repeat(count - 1));
    let deep = |depth: usize| {
        let nodes: Vec<Value> = (0..depth)
            .map(|node| json!({ "children": if node + 1 < depth { vec![node + 1] } else { vec![] } }))
            .collect();
        let joints: Vec<usize> = (0..depth).collect();
        json!({ "nodes": nodes, "skins": [{ "joints": joints }] }).to_string()
    };
    let cases: Vec<(&str, String, &str)> = vec![
        ("nested JSON", "{\"a\":".repeat(100_000), "line 1, column "),
        ("nested lists", format!("{{\"a\":{}", "[".repeat(1_000_000)), "line 1, column "),
        ("many nodes", node(1 << 20), "line 1, column "),
        ("many joints", deep(20_000), "the skeleton has 20000 joints, more than the limit of 16384; "),
        ("a key a second for ever", far(2), "24000000001 frames of 3 nodes make "),
        (
            "keys without bytes",
            empty_keys(),
            "accessor 0 has 4294967296 elements without bytes, more than the limit of ",
        ),
        (
            "shared keys without bytes",
            shared_keys(),
            "accessor 0 has 900000 elements without bytes, more than the limit of ",
        ),
    ];
    for (name, json, expected) in &cases {
        let start = Instant::now();
        let bin: Vec<u8> = [0.0_f32, 1e9].iter().flat_map(|time| time.to_le_bytes()).collect();
        let said = error(&glb(json.as_bytes(), &bin)).to_string();
        println!("{name:<24}{:>8.3} s  {said:.100}", start.elapsed().as_secs_f64());
        assert!(said.starts_with(expected), "{name}: {said}");
        assert!(start.elapsed() < Duration::from_secs(5), "{name}");
    }
    // A chain at the limit is read, without recursion.
    let text = glb(deep(16_384).as_bytes(), &[]);
    assert_eq!(read_gltf(&text, &ImportOptions::default(), &no_files).unwrap().clip.skeleton().len(), 16_384);
}

#[test]
fn keys_that_are_shared_are_counted_each_time() {
    let mut json: Value = serde_json::from_str(&shared_keys()).unwrap();
    let keys = 300_000_usize;
    json["accessors"][0] =
        json!({ "bufferView": 0, "componentType": 5126, "count": keys / 3, "type": "SCALAR" });
    json["accessors"][1] =
        json!({ "bufferView": 0, "componentType": 5126, "count": keys / 3, "type": "VEC3" });
    for part in ["bufferViews", "buffers"] {
        json[part][0]["byteLength"] = json!(4 * keys);
    }
    let bin: Vec<u8> = (0..keys).flat_map(|key| (key as f32).to_le_bytes()).collect();
    let (start, said) = (Instant::now(), error(&glb(json.to_string().as_bytes(), &bin)).to_string());
    assert!(said.starts_with("the clip has 2400000 keys and more, more than the limit of "), "{said}");
    assert!(start.elapsed() < Duration::from_secs(5));
}

#[test]
fn clips_that_share_their_keys_are_counted_together() {
    let clips = |count: usize| {
        let mut doc = Doc::leg();
        let times: Vec<f32> = (0..60_000).map(|frame| frame as f32 / 30.0).collect();
        let places: Vec<f32> = times.iter().flat_map(|time| [0.0, 1.0, *time]).collect();
        let [input, output] = [doc.floats("SCALAR", &times), doc.floats("VEC3", &places)];
        for number in 0..count {
            doc.animation(&format!("walk {number}"));
            doc.channel_of(0, "translation", "LINEAR", input, output);
        }
        doc.glb()
    };
    let all = |bytes: &[u8]| read_motions(bytes, Format::Glb, &ImportOptions::default(), &no_files);
    let (import, others) = all(&clips(9)).unwrap();
    assert_eq!((import.clip.frames(), others.len(), import.clips.len()), (60_000, 8, 9));
    assert!(others.iter().all(|clip| clip == &import.clip));
    let many = clips(2000);
    let start = Instant::now();
    let said = all(&many).unwrap_err().to_string();
    assert!(said.starts_with("the clips of the file have "), "{said}");
    assert!(start.elapsed() < Duration::from_secs(5));
    // One by one they are read.
    assert!(read_gltf(&many, &ImportOptions::default(), &no_files).is_ok());
}

/// Two keys a thousand million seconds apart.
fn far(count: u64) -> String {
    json!({
        "nodes": [{ "children": [1] }, { "children": [2] }, {}], "skins": [{ "joints": [0, 1, 2] }],
        "animations": [{
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }],
            "samplers": [{ "input": 0, "output": 1 }],
        }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": count, "type": "SCALAR" },
            { "componentType": 5126, "count": 2, "type": "VEC3" },
        ],
        "bufferViews": [{ "buffer": 0, "byteLength": 8 }], "buffers": [{ "byteLength": 8 }],
    })
    .to_string()
}

fn empty_keys() -> String {
    let mut json: Value = serde_json::from_str(&far(4_294_967_296)).unwrap();
    json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    json.to_string()
}

/// A thousand joints that all share a million keys which take no bytes.
fn shared_keys() -> String {
    let mut json: Value = serde_json::from_str(&far(1)).unwrap();
    json["nodes"] = json!(vec![json!({}); 1000]);
    json["skins"][0]["joints"] = json!((0..1000).collect::<Vec<_>>());
    json["accessors"][0] = json!({ "componentType": 5126, "count": 900_000, "type": "SCALAR" });
    json["accessors"][1] = json!({ "componentType": 5126, "count": 900_000, "type": "VEC3" });
    let channel = |node: usize| json!({ "sampler": 0, "target": { "node": node, "path": "translation" } });
    json["animations"][0]["channels"] = json!((0..1000).map(channel).collect::<Vec<_>>());
    json.to_string()
}
