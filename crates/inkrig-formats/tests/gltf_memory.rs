//! No header makes the reader allocate more than a small multiple of the bytes that are really there.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod common;
mod counting;

use inkrig_formats::{ImportOptions, no_files, read_gltf};
use serde_json::json;

/// Bytes alive at the worst moment of reading, above what was alive before.
fn peak(file: &[u8]) -> (usize, bool) {
    counting::peak(|| read_gltf(file, &ImportOptions::default(), &no_files).is_ok())
}

// The only test of its file: others at the same time would be counted too.
#[test]
fn hostile_documents_allocate_little() {
    let skin = r#""skins":[{"joints":[0]}]"#;
    let list = |name: &str, element: &str, count: usize| {
        let elements = vec![element; count].join(",");
        format!(r#"{{"nodes":[{{}}],{skin},"{name}":[{elements}]}}"#)
    };
    let accessor = r#"{"componentType":5126,"count":1,"type":"SCALAR"}"#;
    let animation = |part: &str, element: &str, count: usize| {
        let elements = vec![element; count].join(",");
        format!(r#"{{"nodes":[{{}}],{skin},"animations":[{{"{part}":[{elements}]}}]}}"#)
    };
    let cases = [
        ("many empty nodes", format!(r#"{{{skin},"nodes":[{}{{}}]}}"#, "{},".repeat(60_000))),
        ("too many nodes", format!(r#"{{{skin},"nodes":[{}{{}}]}}"#, "{},".repeat(5_000_000))),
        (
            "many joints of a skin",
            format!(r#"{{"nodes":[{{}}],"skins":[{{"joints":[{}0]}}]}}"#, "0,".repeat(4_000_000)),
        ),
        (
            "many skins",
            list("x", "0", 1).replace(
                skin,
                &format!(r#""skins":[{}{{"joints":[0]}}]"#, r#"{"joints":[0]},"#.repeat(60_000)),
            ),
        ),
        ("many accessors", list("accessors", accessor, 400_000)),
        ("many buffer views", list("bufferViews", r#"{"buffer":0,"byteLength":1}"#, 400_000)),
        ("many buffers", list("buffers", r#"{"byteLength":1}"#, 60_000)),
        ("many animations", list("animations", "{}", 60_000)),
        ("many channels", animation("channels", r#"{"sampler":0,"target":{"path":"x"}}"#, 400_000)),
        ("many samplers", animation("samplers", r#"{"input":0,"output":0}"#, 400_000)),
        ("a long name", format!(r#"{{{skin},"nodes":[{{"name":"{}"}}]}}"#, "n".repeat(4_000_000))),
        ("many things unknown", list("materials", "{}", 4_000_000)),
        (
            "many bones",
            format!(
                r#"{{"extensions":{{"VRMC_vrm":{{"humanoid":{{"humanBones":{{{}"a":{{}}}}}}}}}}"#,
                r#""a":{},"#.repeat(100_000)
            ),
        ),
        ("nested lists", format!(r#"{{"nodes":{}"#, "[".repeat(1 << 20))),
    ];
    println!("{:<28}{:>12}{:>12}{:>8}", "case", "bytes", "peak", "times");
    let check = |name: &str, file: &[u8]| {
        let (peak, read) = peak(file);
        let (bytes, times) = (file.len(), peak as f64 / file.len() as f64);
        println!("{name:<28}{bytes:>12}{peak:>12}{times:>8.1}  {}", if read { "read" } else { "refused" });
        assert!(peak <= 16 * bytes + (64 << 20), "{name}: {peak} bytes for a file of {bytes}");
        read
    };
    for (name, json) in &cases {
        check(name, json.as_bytes());
    }
    // As many frames as a file of this size may have, every joint with a rotation and a translation.
    let joints = 1000_usize;
    let keys = ((1 << 20) + 200_000) / 1001 - 10;
    let channels: Vec<_> = [json!({ "sampler": 0, "target": { "node": 0, "path": "scale" } })].into();
    let root = json!({ "children": (1..=joints).collect::<Vec<_>>() });
    let child = json!({ "translation": [1, 2, 3], "name": "n".repeat(200) });
    let nodes: Vec<_> = std::iter::once(root).chain(vec![child; joints]).collect();
    let times: Vec<u8> =
        [0.0_f32, (keys - 1) as f32 / 30.0].iter().flat_map(|time| time.to_le_bytes()).collect();
    let sizes: Vec<u8> =
        [1.0_f32, 1.0, 1.0, 2.0, 2.0, 2.0].iter().flat_map(|size| size.to_le_bytes()).collect();
    let doc = common::gltf::Doc {
        json: json!({
            "nodes": nodes, "skins": [{ "joints": (0..=joints).collect::<Vec<_>>() }],
            "animations": [{ "channels": channels, "samplers": [{ "input": 0, "output": 1 }] }],
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": 2, "type": "SCALAR" },
                { "bufferView": 0, "byteOffset": 8, "componentType": 5126, "count": 2, "type": "VEC3" },
            ],
            "bufferViews": [{ "buffer": 0, "byteLength": 32 }], "buffers": [{ "byteLength": 32 }],
        }),
        bin: [times, sizes].concat(),
    };
    assert!(check("frames from two keys", &doc.glb()), "this one is to be read");
}
