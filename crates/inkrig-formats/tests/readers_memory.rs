//! Whatever a file says, reading it takes no more than 16 times its bytes and 64 MiB, and ends.
//!
//! The corpus: for every reader sound files and what is made of them: cut at many places, numbers made huge, negative or
//! none, pieces repeated, brackets nested; and files made to unpack, to hang on themselves, or to lead out of their folder.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too, and the test prints its table"
)]

mod common;
mod counting;

use base64::Engine as _;
use common::fbx::{SECOND, Text, vector};
use common::{fixture, gltf::Doc, odd_clip};
use fbxcel::low::{FbxVersion, v7400::ArrayAttributeEncoding};
use fbxcel::writer::v7400::binary::{FbxFooter, Writer};
use inkrig_formats::{ExportOptions, Format, ImportOptions, no_files, read_motion, write_fbx};
use serde_json::json;
use std::io::Cursor;
use std::time::{Duration, Instant};

const ASF: &str = ":units\n length 0.45\n angle deg\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n position 0 0 0\n:bonedata\n begin\n name a\n direction 0 -1 0\n length 2\n axis 0 0 20 XYZ\n dof rx ry rz\n limits (-1 1)\n end\n:hierarchy\n begin\n root a\n end\n";
const AMC: &str = ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 0 0 1 2 3\na 1 2 3\n2\nroot 0 0 1 1 2 3\na 3 2 1\n";
const CHARACTER: &str = r#"{"Skeleton":{"Joints":[{"ID":0,"Name":"root","Type":"none","Parent":-1},{"ID":1,"Name":"a","Type":"revolute","Parent":0,"AttachY":-0.4}]},"BodyDefs":[{"ID":1,"Shape":"box","AttachX":0.1,"Param0":0.2}]}"#;
const MOTION: &str =
    r#"{"Loop":"wrap","Frames":[[0.05,0,1,0,1,0,0,0,0.5],[0.1,0,1,0,1,0,0,0,1],[0,0,1,0,1,0,0,0,0]]}"#;

/// A file of the corpus.
struct Case {
    name: String,
    format: Format,
    bytes: Vec<u8>,
    skeleton: Option<Vec<u8>>,
}

impl Case {
    fn new(name: &str, format: Format, bytes: impl Into<Vec<u8>>) -> Self {
        Self { name: name.into(), format, bytes: bytes.into(), skeleton: None }
    }

    fn with(name: &str, format: Format, bytes: impl Into<Vec<u8>>, skeleton: impl Into<Vec<u8>>) -> Self {
        Self { skeleton: Some(skeleton.into()), ..Self::new(name, format, bytes) }
    }
}

/// The worst of a reader.
#[derive(Default)]
struct Worst {
    files: usize,
    read: usize,
    peak: usize,
    /// Part of what is allowed.
    share: f64,
    name: String,
    slowest: Duration,
}

// The only test of its file: others at the same time would be counted too.
#[test]
fn no_file_takes_more_than_its_share() {
    let mut worst = std::collections::BTreeMap::<&str, Worst>::new();
    let mut check = |case: &Case| {
        let options = ImportOptions { skeleton: case.skeleton.clone(), ..ImportOptions::default() };
        let size = case.bytes.len() + case.skeleton.as_ref().map_or(0, Vec::len);
        let allowed = 16 * size + (64 << 20);
        let start = Instant::now();
        let (peak, read) =
            counting::peak(|| read_motion(&case.bytes, case.format, &options, &no_files).is_ok());
        let worst = worst.entry(case.format.name()).or_default();
        worst.files += 1;
        worst.read += usize::from(read);
        worst.slowest = worst.slowest.max(start.elapsed());
        let share = peak as f64 / allowed as f64;
        if share > worst.share {
            (worst.share, worst.peak, worst.name) = (share, peak, format!("{} ({size} bytes)", case.name));
        }
        assert!(peak <= allowed, "{} {}: {peak} bytes for {size}", case.format.name(), case.name);
        assert!(start.elapsed() < Duration::from_secs(30), "{} {}", case.format.name(), case.name);
    };
    for seed in seeds() {
        check(&seed);
        for changed in changed(&seed) {
            check(&changed);
        }
    }
    for case in made() {
        check(&case);
    }
    println!(
        "{:<12}{:>7}{:>7}{:>12}{:>8}{:>9}  worst",
        "reader", "files", "read", "peak", "share", "slowest"
    );
    for (format, worst) in &worst {
        println!(
            "{format:<12}{:>7}{:>7}{:>12}{:>7.0}%{:>8.2}s  {}",
            worst.files,
            worst.read,
            worst.peak,
            100.0 * worst.share,
            worst.slowest.as_secs_f64(),
            worst.name
        );
        assert!(worst.read > 0 && worst.read < worst.files, "{format}: nothing is read, or nothing refused");
    }
}

fn seeds() -> Vec<Case> {
    let written = write_fbx(&odd_clip(20, 30.0), &ExportOptions::default()).unwrap().bytes;
    vec![
        Case::new("plain", Format::Bvh, fixture("plain")),
        Case::new("positions", Format::Bvh, fixture("positions-on-every-joint")),
        Case::with("person", Format::Amc, AMC, ASF),
        Case::with("person", Format::DeepMimic, MOTION, CHARACTER),
        Case::new("leg", Format::Glb, Doc::walking_leg().glb()),
        Case::new("leg as text", Format::Gltf, leg_as_text()),
        Case::new("leg", Format::Fbx, Text::leg().bytes()),
        Case::new("written", Format::Fbx, written),
    ]
}

fn leg_as_text() -> String {
    let mut doc = Doc::walking_leg();
    let data = base64::engine::general_purpose::STANDARD.encode(&doc.bin);
    doc.json["buffers"][0]["uri"] = json!(format!("data:;base64,{data}"));
    doc.json.to_string()
}

/// What stands in place of numbers.
const NUMBERS: [&[u8]; 9] =
    [b"99999999999", b"4294967295", b"-1", b"1e300", b"nan", b"inf", b"0", b"18446744073709551615", b"-1e12"];

/// What is done to a sound file, the same each time.
fn changed(seed: &Case) -> Vec<Case> {
    let mut out = Vec::new();
    let mut put = |name: String, bytes: Vec<u8>, skeleton: Option<Vec<u8>>| {
        out.push(Case { name: format!("{} {name}", seed.name), format: seed.format, bytes, skeleton });
    };
    let (bytes, skeleton) = (&seed.bytes, &seed.skeleton);
    for part in 0..48 {
        let end = bytes.len() * part / 48;
        put(format!("cut at {end}"), bytes[..end].to_vec(), skeleton.clone());
        if let Some(skeleton) = skeleton {
            let end = skeleton.len() * part / 48;
            put(format!("skeleton cut at {end}"), bytes.clone(), Some(skeleton[..end].to_vec()));
        }
    }
    for (kind, number) in NUMBERS.into_iter().enumerate() {
        for place in numbers_of(bytes, 40) {
            let name = format!("number {kind} at {}", place.start);
            put(name, replaced(bytes, place, number), skeleton.clone());
        }
        for place in skeleton.iter().flat_map(|skeleton| numbers_of(skeleton, 20)) {
            let changed = replaced(skeleton.as_ref().unwrap(), place.clone(), number);
            put(format!("skeleton number {kind} at {}", place.start), bytes.clone(), Some(changed));
        }
    }
    // Sizes of binary parts.
    for place in (0..bytes.len().saturating_sub(4)).step_by((bytes.len() / 150).max(1)) {
        let name = format!("bytes at {place}");
        put(name, replaced(bytes, place..place + 4, &[0xff, 0xff, 0xff, 0x7f]), skeleton.clone());
    }
    // Pieces again and again, up to a megabyte.
    for piece in [1_usize, 7, 60] {
        for part in 0..8 {
            let start = bytes.len() * part / 8;
            let end = (start + piece).min(bytes.len());
            let again = bytes[start..end].repeat((1 << 20) / piece);
            let name = format!("{piece} bytes from {start} repeated");
            put(name, replaced(bytes, start..start, &again), skeleton.clone());
        }
    }
    for nested in [&b"{"[..], b"[", b"{\"a\":", b"begin\n", b"a: {\n", b"JOINT b{OFFSET 0 1 0 "] {
        for part in 0..3 {
            let place = bytes.len() * part / 3;
            let name = format!("{:?} nested at {place}", String::from_utf8_lossy(nested));
            put(name, replaced(bytes, place..place, &nested.repeat(100_000)), skeleton.clone());
        }
    }
    out
}

fn replaced(bytes: &[u8], place: std::ops::Range<usize>, with: &[u8]) -> Vec<u8> {
    [&bytes[..place.start], with, &bytes[place.end..]].concat()
}

/// Where numbers stand in a text, at most so many of them, spread evenly.
fn numbers_of(bytes: &[u8], most: usize) -> Vec<std::ops::Range<usize>> {
    let digit = |byte: u8| byte.is_ascii_digit() || byte == b'-' || byte == b'.';
    let mut all: Vec<std::ops::Range<usize>> = Vec::new();
    for (place, &byte) in bytes.iter().enumerate() {
        match all.last_mut() {
            Some(last) if digit(byte) && last.end == place => last.end += 1,
            _ if digit(byte) => all.push(place..place + 1),
            _ => {}
        }
    }
    let step = (all.len() / most).max(1);
    all.into_iter().step_by(step).collect()
}

/// Files made for the purpose.
fn made() -> Vec<Case> {
    let mut cases = fbx_bombs();
    cases.extend(wide_and_short());
    cases.extend(leading_out());
    cases
}

/// Lists in an FBX that unpack to a thousand times their size.
fn fbx_bombs() -> Vec<Case> {
    let packed = |elements: usize| {
        let mut writer = Writer::new(Cursor::new(Vec::new()), FbxVersion::V7_4).unwrap();
        writer.new_node("Objects").unwrap();
        let mut node = writer.new_node("AnimationCurve").unwrap();
        node.append_i64(1).unwrap();
        node.append_string_direct("\0\u{1}AnimCurve").unwrap();
        node.append_string_direct("").unwrap();
        for (name, ticks) in [("KeyTime", true), ("KeyValueFloat", false)] {
            let mut node = writer.new_node(name).unwrap();
            let zlib = Some(ArrayAttributeEncoding::Zlib);
            if ticks {
                node.append_arr_i64_from_iter(zlib, std::iter::repeat_n(0, elements)).unwrap();
            } else {
                node.append_arr_f32_from_iter(zlib, std::iter::repeat_n(0.0, elements)).unwrap();
            }
            writer.close_node().unwrap();
        }
        for (name, value) in [("KeyAttrFlags", 4), ("KeyAttrRefCount", elements as i32)] {
            let mut node = writer.new_node(name).unwrap();
            node.append_arr_i32_from_iter(None, [value]).unwrap();
            writer.close_node().unwrap();
        }
        let mut node = writer.new_node("KeyAttrDataFloat").unwrap();
        node.append_arr_f32_from_iter(None, [0.0; 4]).unwrap();
        for _ in 0..3 {
            writer.close_node().unwrap();
        }
        writer.finalize(&FbxFooter::default()).unwrap().into_inner()
    };
    let many = |count: usize| {
        let mut text = Text::new();
        for id in 1..=count as u32 {
            text.node(id, "b", "Null", 0, "");
        }
        text.bytes()
    };
    let mut keys = Text::leg();
    let times: Vec<String> = (0..60_000).map(|frame| format!("{frame}:{}", frame % 7)).collect();
    keys.curves(100, 2, "Lcl Rotation", &[Some(&times.join(" ")), None, None]);
    let mut frames = Text::leg();
    for id in 10..60_u32 {
        frames.node(id, "b", "LimbNode", 1, &vector("Lcl Translation", [0.0, f64::from(id), 0.0]));
    }
    frames.stack(200, "long", [0, 1100 * SECOND]);
    frames.curves(200, 1, "Lcl Scaling", &[Some("0:1 33000:2"), Some("0:1 33000:2"), Some("0:1 33000:2")]);
    let longest = String::from_utf8(frames.bytes()).unwrap();
    let longest = longest
        .replace("\"AnimStack::walk\"", "\"AnimStack::none\"")
        .replace("\"OO\",101,100", "\"OO\",101,0");
    vec![
        Case::new("keys that unpack", Format::Fbx, packed(1 << 20)),
        Case::new("more keys that unpack", Format::Fbx, packed(12 << 20)),
        Case::new("many nodes", Format::Fbx, many(60_000)),
        Case::new("many keys", Format::Fbx, keys.bytes()),
        Case::new("long from few keys", Format::Fbx, longest),
        Case::new("a long name", Format::Fbx, {
            let mut text = Text::leg();
            text.node(9, &"n".repeat(1 << 20), "Null", 0, "");
            text.bytes()
        }),
        Case::new("many connections", Format::Fbx, {
            let mut text = Text::leg();
            text.connections += &"C: \"OO\",2,1\n".repeat(100_000);
            text.bytes()
        }),
        Case::new("many layers", Format::Fbx, {
            let mut text = Text::leg();
            for layer in 1000..20_000 {
                text.objects += &format!("AnimationLayer: {layer}, \"AnimLayer::\", \"\" {{\n}}\n");
                text.connections += &format!("C: \"OO\",{layer},100\n");
            }
            text.bytes()
        }),
    ]
}

/// Skeletons with many joints in motions with short rows.
fn wide_and_short() -> Vec<Case> {
    let bones: String = (0..2000)
        .map(|bone| format!(" begin\n name b{bone}\n direction 0 1 0\n length 1\n axis 0 0 0 XYZ\n end\n"))
        .collect();
    let names: Vec<String> = (0..2000).map(|bone| format!("b{bone}")).collect();
    let asf = ASF.replace(":hierarchy", &format!("{bones}:hierarchy"));
    let asf = asf.replace("root a\n", &format!("root a {}\n", names.join(" ")));
    let rows: String = (1..20_000).map(|frame| format!("{frame}\nroot 0 0 0 0 0 0\n")).collect();
    let joints: Vec<_> = (0..2000)
        .map(|id| json!({ "ID": id, "Name": "b", "Type": if id == 0 { "none" } else { "fixed" }, "Parent": id - 1 }))
        .collect();
    let character = json!({ "Skeleton": { "Joints": joints } }).to_string();
    let frames = vec!["[0.1,0,0,0,1,0,0,0]"; 20_000].join(",");
    vec![
        Case::with("wide", Format::Amc, rows, asf.clone()),
        Case::with("wide, few rows", Format::Amc, "1\nroot 0 0 0 0 0 0\n", asf),
        Case::with("wide", Format::DeepMimic, format!("{{\"Frames\":[{frames}]}}"), character.clone()),
        Case::with("wide, few rows", Format::DeepMimic, "{\"Frames\":[[0.1,0,0,0,1,0,0,0]]}", character),
    ]
}

/// Files that name others.
fn leading_out() -> Vec<Case> {
    let mut cases = Vec::new();
    for address in
        ["../../x", "file:///etc/passwd", "/dev/zero", "..%2f..%2fx", "C:\\x", "http://localhost/x"]
    {
        let mut doc = Doc::walking_leg();
        doc.json["buffers"][0]["uri"] = json!(address);
        cases.push(Case::new(&format!("buffer {address}"), Format::Gltf, doc.json.to_string()));
        let mut text = Text::leg();
        text.objects += &format!(
            "Video: 7, \"Video::\", \"Clip\" {{\nFileName: \"{address}\"\nRelativeFilename: \"{address}\"\n}}\n"
        );
        cases.push(Case::new(&format!("video {address}"), Format::Fbx, text.bytes()));
    }
    cases
}
