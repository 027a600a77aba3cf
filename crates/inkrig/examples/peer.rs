//! Our side of `benches/peers/compare.py`: writes the matrices of a case, then solves them once for every line that it is
//! given, so that our runs stand between those of the peers.
//!
//! `cargo run --release -p inkrig --example peer -- CASE PATCHES FOLDER`, where CASE is the beginning of the name of a
//! case of `inkrig bench align`. For every line on standard input (`f32` or `f64`) it prints one JSON object.
#![allow(clippy::print_stdout, reason = "it talks to a script")]

use inkrig::align::{Comparison, Control, Options, align};
use inkrig::bench::{Clock, own_cases};
use inkrig::motion::{Takes, time};
use inkrig::transport::{Mat, MmSinkhorn, Params, Problem, Real, Start, Workspace, terms};
use std::io::{BufRead, Write};
use std::ops::ControlFlow;
use std::path::Path;

type Anything = Box<dyn std::error::Error>;

const PARAMS: Params = Params { alpha: 0.9, lambda: 0.05, epsilon: 0.01 };
const ITERATIONS: usize = 50;

fn main() -> Result<(), Anything> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [case, patches, folder] = &arguments[..] else {
        return Err("give a case, a number of patches and a folder".into());
    };
    let folder = Path::new(folder);
    let [control, source, cost] = matrices(case, patches.parse()?)?;
    for (name, table) in [("control", &control), ("source", &source), ("cost", &cost)] {
        std::fs::write(folder.join(name).with_extension("npy"), npy(table))?;
    }
    println!("{}", serde_json::json!({ "rows": cost.rows(), "columns": cost.cols() }));
    std::io::stdout().flush()?;
    let single = Side::new(&control, &source, &cost, |value| value);
    let double = Side::new(&control, &source, &cost, f64::from);
    let (mut single_room, mut double_room) = (Workspace::new(1), Workspace::new(1));
    for line in std::io::stdin().lock().lines() {
        let answer = match line?.trim() {
            "f32" => single.run(&mut single_room, folder, "f32")?,
            "f64" => double.run(&mut double_room, folder, "f64")?,
            other => return Err(format!("f32 or f64, not {other}").into()),
        };
        println!("{answer}");
        std::io::stdout().flush()?;
    }
    Ok(())
}

/// What the solver meets at the finest level of a case of that many patches on both sides: distances within the
/// control, within the clip, and between the motion as it is before polish and the clip.
fn matrices(case: &str, patches: usize) -> Result<[Mat<f32>; 3], Anything> {
    let cases = own_cases()?;
    let case = cases.iter().find(|known| known.name.starts_with(case)).ok_or("no such case")?;
    let options = Options { polish: 0, threads: 1, ..case.options.clone() };
    let frames = patches + options.patch() - 1;
    let clip = case.source.clip();
    let places: Vec<f64> = evenly(frames, clip.frames());
    let source: Takes = time::sample_at(clip, &places, options.matching_rate)?.into();
    let length = case.control.features.frames();
    let rate = options.matching_rate * length as f64 / frames as f64;
    let control = Control { rate, ..case.control.clone() };
    let result = align(&source, &control, &options, &mut |_| ControlFlow::Continue(()))?;
    let comparison = Comparison::new(&source, &control, &options)?;
    let [of_control, of_source] = comparison.distances()?;
    Ok([of_control, of_source, comparison.cost(&result.clip)?])
}

fn evenly(frames: usize, of: usize) -> Vec<f64> {
    (0..frames).map(|frame| frame as f64 * (of - 1) as f64 / (frames - 1) as f64).collect()
}

/// The matrices in one precision.
struct Side<T> {
    control: Mat<T>,
    source: Mat<T>,
    cost: Mat<T>,
}

impl<T: Real> Side<T> {
    fn new(control: &Mat<f32>, source: &Mat<f32>, cost: &Mat<f32>, as_t: impl Fn(f32) -> T) -> Self {
        let convert = |table: &Mat<f32>| {
            Mat::from_fn(table.rows(), table.cols(), |row, column| as_t(table.row(row)[column]))
        };
        Self { control: convert(control), source: convert(source), cost: convert(cost) }
    }

    /// Solves from a cold start, writes the plan and says what it took.
    fn run(&self, room: &mut Workspace<T>, folder: &Path, name: &str) -> Result<serde_json::Value, Anything> {
        let solver =
            MmSinkhorn { iterations: ITERATIONS, start: Start::Independent, ..MmSinkhorn::default() };
        let problem = Problem::new(self.control.view(), self.source.view(), Some(self.cost.view()), PARAMS)?;
        let clock = Clock::start();
        solver.solve(&problem, room)?;
        let spent = clock.spent();
        let plan = room.plan().dense();
        let objective = terms(&problem, plan)?.objective;
        let single =
            Mat::from_fn(plan.rows(), plan.cols(), |row, column| plan.row(row)[column].to_f64() as f32);
        std::fs::write(folder.join(format!("plan_{name}.npy")), npy(&single))?;
        Ok(
            serde_json::json!({ "cpu": spent.cpu_seconds, "wall": spent.wall_seconds, "objective": objective }),
        )
    }
}

/// The file format of NumPy, version 1.0: a header padded to 64 bytes, then the numbers.
fn npy(table: &Mat<f32>) -> Vec<u8> {
    let shape = format!(
        "{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}), }}",
        table.rows(),
        table.cols()
    );
    let padding = (64 - (10 + shape.len() + 1) % 64) % 64;
    let header = format!("{shape}{}\n", " ".repeat(padding));
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(table.as_slice().iter().flat_map(|value| value.to_le_bytes()));
    bytes
}
