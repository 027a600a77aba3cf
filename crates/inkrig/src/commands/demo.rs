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

pub(super) fn run(args: &DemoArgs, console: &Console) -> Result<(), CliError> {
    let folder = &args.folder;
    std::fs::create_dir_all(folder).map_err(|source| OutputError::Io { path: folder.clone(), source })?;
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
    // These names are the demo's own, so they may be written again.
    let output = Output { force: true };
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
        align(&import.clip, &control, &Options::default(), &mut |progress| bar.update(progress))?
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
    output.write(&scene.source, motion.bytes)?;
    output.write(&scene.curve, curve.bytes)?;
    let written = write_bvh(&alignment.clip, &ExportOptions::like(&import.source))?;
    output.write(&scene.motion, &written.bytes)?;
    let title = format!("{} follows {}", motion.name, curve.name);
    output.write(&scene.preview, show::page(&title, &alignment, &control).as_bytes())?;
    output.write(&scene.sheet, &show::sheet(&alignment, &control)?)?;
    console.say(show::summary(&alignment, &scene.motion));
    console.say(format!("wrote {}\nwrote {}", scene.preview.display(), scene.sheet.display()));
    Ok(scene)
}
