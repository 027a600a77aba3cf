//! Draws the pictures of docs/constraints.md from the samples, each with and without its constraint, and prints their
//! figures: `cargo run --release -p inkrig --example constraints -- FOLDER`.

#![allow(clippy::print_stdout, reason = "an example prints its figures")]

mod keys;
mod paint;
mod solutions;
mod time_and_ground;
mod yardstick;

use inkrig::align::{Alignment, Control, CurveOptions, Key, Options, Preset, align};
use inkrig::motion::{Clip, Takes};
use paint::Fallible;
use std::ops::ControlFlow;
use std::path::PathBuf;

fn main() -> Fallible<()> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("give the folder for the pictures")?);
    std::fs::create_dir_all(&folder)?;
    let person = sample("person")?;
    keys::soft(&folder, &person)?;
    keys::soft_in_time(&folder, &person)?;
    keys::hard(&folder, &person)?;
    keys::keep_away(&folder, &person)?;
    time_and_ground::loops(&folder, &person)?;
    time_and_ground::fixed(&folder, &person)?;
    time_and_ground::roots(&folder)?;
    solutions::on_map(&folder, &person)?;
    solutions::mirrored(&folder, &person)
}

pub(crate) fn sample(name: &str) -> Fallible<Clip> {
    let bytes = inkrig::samples::find(name).ok_or("no such sample")?.bytes;
    Ok(inkrig::formats::read_bvh(bytes, &Default::default())?.clip)
}

pub(crate) fn drawing(name: &str) -> Fallible<Control> {
    let sample = inkrig::samples::find(name).ok_or("no such sample")?;
    let format = inkrig::sketch::Format::from_path(sample.file_name.as_ref()).ok_or("no curve")?;
    let curve = inkrig::sketch::read_curve(sample.bytes, format)?;
    Ok(Control::from_curve(&curve, &CurveOptions::default())?)
}

pub(crate) fn run(what: &str, clip: &Clip, control: &Control, keys: Vec<Key>) -> Fallible<Alignment> {
    run_with(what, clip, control, &Options { keys, ..Options::for_control(control.kind, Preset::Follow) })
}

pub(crate) fn run_with(what: &str, clip: &Clip, control: &Control, options: &Options) -> Fallible<Alignment> {
    let takes = Takes::from(clip.clone());
    let result = align(&takes, control, options, &mut |_| ControlFlow::Continue(()))?;
    let r = &result.report;
    println!(
        "{what}: structure {:.2} (stretched {:.2}), nearest {:.2}, jump {:.2}, speed {:.2}, {:?}",
        r.structure_pearson,
        r.structure_pearson_warp,
        r.nearest_patch,
        r.jump_q999_ratio,
        r.speed_mean_ratio,
        r.keys
    );
    Ok(result)
}
