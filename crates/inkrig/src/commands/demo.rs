//! `inkrig demo`: the main job on our own samples, with nothing else needed.

use crate::cli::DemoArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::output::{Output, OutputError};
use crate::show;
use inkrig_align::{Control, CurveOptions, Options, align};
use inkrig_formats::{ExportOptions, ImportOptions, read_bvh, write_bvh};
use inkrig_samples::Sample;
use inkrig_sketch::read_curve;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What is shown: a clip, a drawing.
const SCENES: [(&str, &str); 3] = [("person", "spiral"), ("quadruped", "eight"), ("snake", "wave")];

/// The names that the demo writes are its own, so they may be written again.
const OWN: Output = Output { force: true };

pub(super) fn run(args: &DemoArgs, console: &Console) -> Result<(), CliError> {
    let folder = &args.folder;
    std::fs::create_dir_all(folder).map_err(|source| OutputError::Io { path: folder.clone(), source })?;
    for sample in inkrig_samples::motions().iter().chain(inkrig_samples::curves()) {
        OWN.write(&folder.join(sample.file_name), sample.bytes)?;
    }
    let mut scenes = Vec::new();
    for (motion, curve) in SCENES {
        let (Some(motion), Some(curve)) = (inkrig_samples::find(motion), inkrig_samples::find(curve)) else {
            continue;
        };
        scenes.push(scene(folder, motion, curve, console)?);
    }
    if let Some(first) = scenes.first() {
        console.say(format!("\nOpen {} in a browser. Then try your own:", first.preview.display()));
        console.say(format!(
            "  inkrig align {} --curve YOUR-DRAWING.svg -o new.bvh --preview new.html",
            first.source.display()
        ));
    }
    console.result(&scenes)?;
    Ok(())
}

#[derive(Serialize)]
struct Scene {
    source: PathBuf,
    curve: PathBuf,
    motion: PathBuf,
    preview: PathBuf,
    sheet: PathBuf,
    structure_pearson: f64,
}

fn scene(folder: &Path, motion: &Sample, curve: &Sample, console: &Console) -> Result<Scene, CliError> {
    let place = |name: &str| folder.join(name);
    let (source, drawing) = (place(motion.file_name), place(curve.file_name));
    let import = read_bvh(motion.bytes, &ImportOptions::default())
        .map_err(|error| CliError::Format { path: source.clone(), source: Box::new(error) })?;
    let format = inkrig_sketch::Format::from_path(&drawing).ok_or_else(|| CliError::Kind {
        path: drawing.clone(),
        known: "known drawings: .json, .csv, .svg",
    })?;
    let read = read_curve(curve.bytes, format)
        .map_err(|error| CliError::Curve { path: drawing.clone(), source: error })?;
    let control = Control::from_curve(&read, &CurveOptions::default())?;
    let alignment = {
        let bar = console.bar("aligning");
        align(&import.clip.into(), &control, &Options::default(), &mut |progress| bar.update(progress))?
    };
    let name = format!("{}-follows-{}", motion.name, curve.name);
    let scene = Scene {
        motion: place(&format!("{name}.bvh")),
        preview: place(&format!("{name}.html")),
        sheet: place(&format!("{name}.png")),
        source,
        curve: drawing,
        structure_pearson: alignment.report.structure_pearson,
    };
    let written = write_bvh(&alignment.clip, &ExportOptions::like(&import.source))?;
    OWN.write(&scene.motion, &written.bytes)?;
    let title = format!("{} follows {}", motion.name, curve.name);
    OWN.write(&scene.preview, show::page(&title, &alignment, &control).as_bytes())?;
    OWN.write(&scene.sheet, &show::sheet(&alignment, &control)?)?;
    console.say(show::summary(&alignment, &scene.motion));
    console.say(format!("wrote {}\nwrote {}", scene.preview.display(), scene.sheet.display()));
    Ok(scene)
}
