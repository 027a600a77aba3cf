//! Damaged and hostile FBX files: an error that says what and where, never a panic, never long work.
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
use inkrig_formats::{ClipChoice, ExportOptions, FormatError, ImportOptions, Limits, read_fbx, write_fbx};
use std::time::{Duration, Instant};

fn error(bytes: &[u8]) -> FormatError {
    read_fbx(bytes, &ImportOptions::default()).unwrap_err()
}

fn binary() -> Vec<u8> {
    write_fbx(&odd_clip(10, 30.0), &ExportOptions::default()).unwrap().bytes
}

#[test]
fn what_is_no_fbx_is_told() {
    let header = "the file: it does not begin as an FBX file does, binary or text; check that it is one, and that it is not packed";
    let cases: [(&[u8], &str); 6] = [
        (b"", "the file: it is empty; export or copy it again"),
        (b"HIERARCHY\nROOT a\n", header),
        (b"PK\x03\x04 zipped", header),
        (&binary()[..8], header),
        (&binary()[..27], "the file: it ends in the middle of something; export or copy it again"),
        (
            b"FBXHeaderExtension:  {\n",
            "the file: it ends in the middle of something; export or copy it again",
        ),
    ];
    for (bytes, expected) in cases {
        assert_eq!(error(bytes).to_string(), expected, "{:?}", String::from_utf8_lossy(bytes));
    }
    let mut old = binary();
    // What is of another version is read as well as can be; this cannot.
    old[23..27].copy_from_slice(&1000_u32.to_le_bytes());
    old[27..31].copy_from_slice(&3_u32.to_le_bytes());
    assert_eq!(
        error(&old).to_string(),
        "the file: it is of a version that inkrig does not read; save it as FBX 7.4 (2014) or later, with Autodesk's FBX Converter for example"
    );
}

#[test]
fn an_encrypted_file_is_told() {
    let expected = "the file: it is encrypted; export it again without a password";
    let mut file = binary();
    let at = file.windows(14).position(|window| window == b"EncryptionType").unwrap();
    assert_eq!(file[at + 14..at + 19], *b"I\0\0\0\0");
    file[at + 15] = 1;
    assert_eq!(error(&file).to_string(), expected);
    let text = String::from_utf8(Text::leg().bytes()).unwrap();
    let text = text.replace("FBXVersion: 7400", "FBXVersion: 7400\nEncryptionType: 1");
    assert_eq!(error(text.as_bytes()).to_string(), expected);
    assert!(read_fbx(text.replace("Type: 1", "Type: 0").as_bytes(), &ImportOptions::default()).is_ok());
}

#[test]
fn a_file_without_a_skeleton_is_told() {
    let mut text = Text::new();
    assert_eq!(
        error(&text.bytes()).to_string(),
        "the file: neither a skeleton nor anything that moves; export the armature with its animation"
    );
    text.node(1, "statue", "Mesh", 0, "");
    text.objects += "Geometry: 7, \"Geometry::\", \"Mesh\" {\nVertices: *9 {\na: 0,0,0,1,0,0,0,1,0\n}\nPolygonVertexIndex: *3 {\na: 0,1,-3\n}\n}\n";
    text.connections += "C: \"OO\",7,1\n";
    assert_eq!(
        error(&text.bytes()).to_string(),
        "the file: a mesh without a skeleton; rig the mesh first, or export it together with its armature"
    );
}

#[test]
fn numbers_that_are_none_are_told() {
    let hint = "the file is damaged; export it again";
    for value in ["1e300", "nan", "-1.#IND", "inf"] {
        let text = String::from_utf8(Text::leg().bytes()).unwrap().replace("0,300", &format!("0,{value}"));
        let said = error(text.as_bytes()).to_string();
        let expected =
            format!("node `hip`: its place in frame 31 has a number that is none or too large; {hint}");
        // A number that is none spreads over the whole curve; some spellings are no numbers at all.
        let first = expected.replace("frame 31", "frame 2");
        assert!(
            said == expected || said == first || said.starts_with("the file: it is damaged ("),
            "{value}: {said}"
        );
    }
    let mut text = Text::leg();
    text.node(4, "toe", "LimbNode", 2, &vector("Lcl Translation", [0.0, 1e13, 0.0]));
    assert_eq!(
        error(&text.bytes()).to_string(),
        format!("node `toe`: its place at rest has a number that is none or too large; {hint}")
    );
    let mut text = Text::leg();
    text.node(4, "toe", "LimbNode", 2, &vector("Lcl Scaling", [0.0, 0.0, 0.0]));
    text.node(5, "nail", "LimbNode", 4, &vector("Lcl Translation", [0.0, 5.0, 0.0]));
    let flat = read_fbx(&text.bytes(), &ImportOptions::default()).unwrap();
    assert!(flat.clip.rotations(30).iter().all(|turn| turn.is_normalized()));
}

#[test]
fn a_file_may_be_cut_anywhere() {
    for file in [binary(), Text::leg().bytes()] {
        let text = file.starts_with(b";");
        let (mut read, step) = (0, (file.len() / 1500).max(1));
        for end in (0..file.len() - 200).step_by(step) {
            match read_fbx(&file[..end], &ImportOptions::default()) {
                Ok(_) => read += 1,
                Err(error) => assert!(!error.to_string().contains('\n')),
            }
        }
        assert!(text || read == 0, "a binary file that is cut was read {read} times");
    }
}

#[test]
fn hierarchies_that_are_none_are_told() {
    let mut text = Text::new();
    text.node(1, "a", "LimbNode", 2, "");
    text.node(2, "b", "LimbNode", 1, "");
    assert_eq!(
        error(&text.bytes()).to_string(),
        "the file: it is damaged (Cyclic node hierarchy); export or copy it again"
    );
    // Deep ones are read without recursion.
    let mut text = Text::new();
    for id in 1..=900_u32 {
        text.node(id, "bone", "LimbNode", id - 1, &vector("Lcl Translation", [0.0, 1.0, 0.0]));
    }
    let import = read_fbx(&text.bytes(), &ImportOptions::default()).unwrap();
    assert_eq!(import.clip.skeleton().depths().into_iter().max(), Some(899));
    let nested = format!("; FBX 7.4.0 project file\n{}", "a: {\n".repeat(100_000));
    let said = error(nested.as_bytes()).to_string();
    assert!(said.starts_with("the file: it is damaged ("), "{said}");
}

#[test]
fn hostile_sizes_are_refused_quickly() {
    let mut long = Text::leg();
    long.stack(200, "for ever", [0, 90_000_000 * SECOND]);
    long.curves(200, 1, "Lcl Rotation", &[Some("0:0 30:1"), None, None]);
    let start = Instant::now();
    let options = ImportOptions { clip: Some(ClipChoice::Number(2)), ..Default::default() };
    let said = read_fbx(&long.bytes(), &options).unwrap_err().to_string();
    assert!(
        said.starts_with(
            "2700000001 frames of 4 nodes and layers make 10800000004 places, more than the limit of "
        ),
        "{said}"
    );
    assert!(
        said.ends_with("cut the motion into shorter ones, or read it at a lower rate with `--source-fps`")
    );
    // Layers are work, too.
    let mut layers = Text::leg();
    for layer in 10_000..15_000 {
        layers.objects += &format!("AnimationLayer: {layer}, \"AnimLayer::x\", \"\" {{\n}}\n");
        layers.connections += &format!("C: \"OO\",{layer},100\n");
    }
    let limits = Limits { cells: 100_000, ..Default::default() };
    let said = read_fbx(&layers.bytes(), &ImportOptions { limits, ..Default::default() }).unwrap_err();
    assert!(said.to_string().starts_with("31 frames of 5004 nodes and layers make 155124 places"), "{said}");
    let mut many = Text::new();
    for id in 1..=17_000_u32 {
        many.node(100_000 + id, "bone", "LimbNode", 0, "");
    }
    let said = error(&many.bytes()).to_string();
    assert_eq!(
        said,
        "the skeleton has 17000 joints, more than the limit of 16384; leave joints out that do not matter"
    );
    let mut name = Text::leg();
    name.node(9, &"n".repeat(300), "LimbNode", 0, "");
    let said = error(&name.bytes()).to_string();
    assert!(
        said.contains("has 300 bytes, more than the limit of 256; give the joint a shorter name"),
        "{said}"
    );
    assert!(start.elapsed() < Duration::from_secs(20));
}

#[test]
fn nothing_beside_the_file_is_opened() {
    // A file that names others is read as if they were not there.
    let mut text = Text::leg();
    for (id, path) in ["../../../../etc/passwd", "file:///etc/passwd", "/dev/zero"].iter().enumerate() {
        let (texture, cache) = (500 + id, 600 + id);
        text.objects += &format!(
            "Texture: {texture}, \"Texture::x\", \"\" {{\nFileName: \"{path}\"\nRelativeFilename: \"{path}\"\n}}\n\
             CacheFile: {cache}, \"CacheFile::x\", \"\" {{\nCacheFileName: \"{path}\"\nCacheAbsoluteFileName: \"{path}\"\n\
             Properties70: {{\nP: \"CacheFileName\", \"KString\", \"XRefUrl\", \"\",\"{path}\"\n}}\n}}\n"
        );
    }
    let import = read_fbx(&text.bytes(), &ImportOptions::default()).unwrap();
    assert_eq!(import.clip.frames(), 31);
}
