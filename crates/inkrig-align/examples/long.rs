//! Long inputs from end to end, and how far the solvers for them are from the dense one.
//!
//! `cargo run --release -p inkrig-align --example long [FOLDER] [CONTROL CLIP [SOLVER..]]`
//!
//! FOLDER holds BVH files of one skeleton; without it the clip is the sample person at several speeds. First 10,000 control
//! frames on 6,000 frames of clip; then, for the drawings below, 600 x 600 and 1200 x 1200 by every solver. With CONTROL
//! and CLIP only that size, by the given solvers (auto, dense, lowrank, sparse).
#![allow(clippy::print_stdout)]

use inkrig_align::{Alignment, Control, CurveOptions, Options, Solver, align};
use inkrig_formats::{ImportOptions, read_bvh};
use inkrig_motion::{Clip, Takes, time};
use inkrig_sketch::{Curve, SketchError, shapes};
use std::error::Error;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

const SOLVERS: [(&str, Solver); 4] = [
    ("auto", Solver::Auto),
    ("dense", Solver::Dense),
    ("lowrank", Solver::LowRank),
    ("sparse", Solver::Sparse),
];

/// Frames of one circle, lap or wave, so that longer drawings have more of them.
const PERIOD: usize = 60;

fn main() -> Result<()> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let folder = given.first().filter(|text| text.parse::<usize>().is_err()).map(PathBuf::from);
    let rest = &given[usize::from(folder.is_some())..];
    let sizes: Vec<usize> = rest.iter().filter_map(|text| text.parse().ok()).collect();
    let [frames, clip] = if let [frames, clip, ..] = sizes[..] { [frames, clip] } else { [10_000, 6000] };
    let named: Vec<_> =
        SOLVERS.into_iter().filter(|(name, _)| rest.iter().any(|text| text == name)).collect();
    let solvers = if named.is_empty() { vec![SOLVERS[0]] } else { named };
    let curve = shapes::growing_circles(frames / PERIOD, frames);
    for solver in solvers {
        let result = run(&source(folder.as_deref(), clip)?, "circles", &curve.clone()?, solver)?;
        let stages =
            result.report.stages.iter().map(|stage| format!("{} {:.2} s", stage.name, stage.seconds));
        println!("  {}", stages.collect::<Vec<_>>().join(", "));
        let levels = result.report.levels.iter();
        let levels =
            levels.map(|row| format!("{} x {} {:.2} s", row.control_frames, row.source_frames, row.seconds));
        println!("  {}", levels.collect::<Vec<_>>().join(", "));
        println!("  {}", peak_memory().unwrap_or_default());
    }
    if !sizes.is_empty() {
        return Ok(());
    }
    for frames in [600, 1200] {
        let source = source(folder.as_deref(), frames)?;
        for (name, curve) in drawings(frames)? {
            for solver in &SOLVERS[1..] {
                run(&source, name, &curve, *solver)?;
            }
        }
    }
    Ok(())
}

fn drawings(frames: usize) -> std::result::Result<[(&'static str, Curve); 3], SketchError> {
    let count = frames / PERIOD;
    Ok([
        ("circles", shapes::growing_circles(count, frames)?),
        ("eights", shapes::figure_of_eight(count, frames)?),
        ("wave", shapes::wave(count, frames)?),
    ])
}

fn run(source: &Takes, drawing: &str, curve: &Curve, (name, solver): (&str, Solver)) -> Result<Alignment> {
    let control = Control::from_curve(curve, &CurveOptions::default())?;
    let options = Options { solver, ..Options::default() };
    let (begin, before) = (Instant::now(), cpu_seconds());
    let result = align(source, &control, &options, &mut |_| ControlFlow::Continue(()))?;
    let (wall, report) = (begin.elapsed().as_secs_f64(), &result.report);
    println!(
        "{} x {} {drawing:<7} {name:<7} structure {:.3} (stretched {:.3}), nearest {:.3}, coverage {:.2}, speed {:.2}, \
         jumps {:.2}; {} with {} entries a row; {wall:.2} s, {:.2} s of CPU",
        report.control_frames,
        report.source_frames,
        report.structure_pearson,
        report.structure_pearson_warp,
        report.nearest_patch,
        report.coverage,
        report.speed_mean_ratio,
        report.jump_q999_ratio,
        report.solver.name,
        report.solver.entries_per_row,
        cpu_seconds() - before,
    );
    Ok(result)
}

/// `frames` frames at 30 a second of the folder's clips, in the order of their names, or of the sample.
fn source(folder: Option<&Path>, frames: usize) -> Result<Takes> {
    let mut clips = Vec::new();
    match folder {
        Some(folder) => {
            let files = std::fs::read_dir(folder)?.map(|file| Ok(file?.path()));
            let mut files = files.collect::<std::io::Result<Vec<_>>>()?;
            files.retain(|path| path.extension().is_some_and(|extension| extension == "bvh"));
            files.sort();
            for file in files {
                clips.push(time::decimate(
                    &read_bvh(&std::fs::read(file)?, &ImportOptions::default())?.clip,
                    30.0,
                )?);
            }
        }
        None => {
            let person = inkrig_samples::find("person").ok_or("no sample person")?;
            let clip = read_bvh(person.bytes, &ImportOptions::default())?.clip;
            let mut made = 0;
            for speed in (0..20).cycle().map(|k| 0.7 + 0.06 * f64::from(k)) {
                let places = (0..(clip.frames() as f64 / speed) as usize).map(|at| at as f64 * speed);
                clips.push(time::sample_at(&clip, &places.collect::<Vec<_>>(), 30.0)?);
                made += clips.last().map_or(0, Clip::frames);
                if made >= frames {
                    break;
                }
            }
        }
    }
    let mut left = frames;
    let mut kept = Vec::new();
    for clip in clips {
        let some = clip.frames().min(left);
        if some >= 30 {
            kept.push(time::trim(&clip, 0..some)?);
        }
        left -= some;
    }
    if left > 0 {
        return Err(format!("the folder lacks {left} frames").into());
    }
    Ok(Takes::join(&kept)?)
}

/// Seconds of processor time that this process has taken, where the system says.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = stat.rsplit(") ").next().unwrap_or_default().split(' ');
    fields.skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// The most memory the process held, where the system says.
fn peak_memory() -> Option<String> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(format!("{} MB at most", kilobytes / 1024))
}
