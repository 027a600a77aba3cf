//! Writes motions in every format that other programs read, and beside them where we say each joint is:
//! `cargo run --release -p inkrig --example interop -- DIR REFERENCE`. `cargo xtask interop` compares.

use inkrig::align::{Control, CurveOptions, Options, align};
use inkrig::cli::ImportArgs;
use inkrig::formats::{ExportOptions, Format, Import, ImportOptions, read_bvh, write_motion};
use inkrig::motion::retarget::{RetargetOptions, retarget, standing_pose};
use inkrig::motion::{Clip, kinematics, time};
use inkrig::sketch::{self, read_curve};
use inkrig::{load, samples};
use serde_json::{Value, json};
use std::{error::Error, fs, ops::ControlFlow, path::Path};

/// The written formats that other programs read.
const EXTENSIONS: [&str; 4] = ["bvh", "glb", "fbx", "usda"];

/// More frames show nothing more, and importers take their time.
const MOST_FRAMES: usize = 240;

/// Real motion: name, file below `REFERENCE/data`, clip of it.
const REFERENCE: [(&str, &str, Option<&str>); 7] = [
    ("cmu-walk", "cmu/35/35_29.bvh", None),
    ("cmu-amc", "cmu/02/02_01.amc", None),
    ("salsa", "cmu-dance/salsa/01.bvh", None),
    ("wolf", "creatures/wolf.glb", Some("Gallop")),
    ("snake-glb", "creatures/snake-animations.glb", None),
    ("kaykit-punch", "kaykit/Med_CombatMelee.glb", None),
    ("deepmimic-spinkick", "deepmimic/motions/humanoid3d_spinkick.txt", None),
];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, reference] = arguments.as_slice() else { return Err("give DIR and REFERENCE".into()) };
    let folder = Path::new(folder);
    fs::create_dir_all(folder)?;
    let mut files = Vec::new();
    for sample in samples::motions() {
        files.extend(written(folder, sample.name, &read_bvh(sample.bytes, &ImportOptions::default())?)?);
    }
    let data = Path::new(reference).join("data");
    if data.is_dir() {
        for (name, file, clip) in REFERENCE {
            files.extend(written(folder, name, &read(&data.join(file), clip)?)?);
        }
        files.extend(written(folder, "walk-on-human", &on_human(&data)?)?);
        files.extend(written(folder, "aligned-horse", &aligned(&data)?)?);
    }
    fs::write(folder.join("files.json"), serde_json::to_vec_pretty(&files)?)?;
    Ok(())
}

fn read(path: &Path, clip: Option<&str>) -> Result<Import, Box<dyn Error>> {
    // AMC files have no frame rate; those of the folder have 60.
    let source_fps = path.extension().is_some_and(|extension| extension == "amc").then_some(60.0);
    Ok(load::motion(path, &ImportArgs { clip: clip.map(str::to_owned), source_fps, ..Default::default() })?)
}

/// A captured walk on a character with a body of its own.
fn on_human(data: &Path) -> Result<Import, Box<dyn Error>> {
    let walk = read(&data.join("cmu/35/35_29.bvh"), None)?;
    let human = read(&data.join("creatures/human-model.glb"), None)?;
    let options = RetargetOptions { stance: standing_pose(&human.clip), ..Default::default() };
    Ok(Import { clip: retarget(&walk.clip, human.clip.skeleton(), &options)?.clip, ..human })
}

/// A horse that follows a drawing.
fn aligned(data: &Path) -> Result<Import, Box<dyn Error>> {
    let horse = read(&data.join("creatures/horse-animations.glb"), Some("Eating"))?;
    let drawing = samples::find("heart").ok_or("no such sample")?;
    let curve = CurveOptions { samples: Some(120), ..Default::default() };
    let control = Control::from_curve(&read_curve(drawing.bytes, sketch::Format::Json)?, &curve)?;
    let options = Options { levels: 3, ..Default::default() };
    let result = align(&horse.clip.clone().into(), &control, &options, &mut |_| ControlFlow::Continue(()))?;
    Ok(Import { clip: result.clip, ..horse })
}

/// Writes a motion in every format, and into a copy of the file that it came from.
fn written(folder: &Path, name: &str, import: &Import) -> Result<Vec<Value>, Box<dyn Error>> {
    let clip = time::trim(&import.clip, 0..import.clip.frames().min(MOST_FRAMES))?;
    fs::write(folder.join(format!("{name}.tracks")), tracks(&clip)?)?;
    let mut files = Vec::new();
    let mut put = |file: String, format: Format, options: ExportOptions, original: Option<String>| {
        let written = write_motion(&clip, format, &ExportOptions { name: Some(name.into()), ..options })?;
        fs::write(folder.join(&file), written.bytes)?;
        files.push(json!({
            "file": file, "expected": format!("{name}.tracks"), "clip": name,
            "rate": clip.frame_rate(), "frames": clip.frames(), "original": original,
        }));
        Ok::<(), Box<dyn Error>>(())
    };
    for extension in EXTENSIONS {
        if let Some(format) = Format::from_extension(extension).filter(|format| format.is_written()) {
            put(format!("{name}.{extension}"), format, ExportOptions::default(), None)?;
        }
    }
    if let Some(original) = &import.source.original {
        let before = format!("{name}-before.glb");
        fs::write(folder.join(&before), original.bytes())?;
        put(format!("{name}-own.glb"), Format::Glb, ExportOptions::like(&import.source), Some(before))?;
    }
    Ok(files)
}

/// A line of JSON, then places as little-endian f32: frames x joints x 3, metres, y up. End sites are left out: many
/// programs do not keep them.
fn tracks(clip: &Clip) -> Result<Vec<u8>, serde_json::Error> {
    let joints = clip.skeleton().joints();
    let kept: Vec<usize> = (0..joints.len()).filter(|&joint| !joints[joint].end_site).collect();
    let names: Vec<&str> = kept.iter().map(|&joint| joints[joint].name.as_str()).collect();
    let mut out = serde_json::to_vec(&json!({ "joints": names, "frames": clip.frames() }))?;
    out.push(b'\n');
    let positions = kinematics::positions(clip);
    for frame in (0..positions.frames()).map(|frame| positions.frame(frame)) {
        let values = kept.iter().flat_map(|&joint| frame[joint].to_array());
        out.extend(values.flat_map(f32::to_le_bytes));
    }
    Ok(out)
}
