//! 10 000 x 6 000 points without an N x M array: a dense plan on coarse grids, then sparse plans on finer ones.
//!
//! `cargo run --release -p inkrig-transport --example large [N M BASE_N BASE_M THREADS]`
//!
//! The control is a drawing of growing circles; the source wanders through twelve dimensions and comes back to old places.
//! Reported per level: time, entries per row, objective; at the end the agreement of distances (Pearson's correlation of
//! Dy with those between the means of matched places) and the most memory the process held.
#![allow(clippy::print_stdout)]

use std::time::Instant;

use inkrig_transport::{
    Mat, MmSinkhorn, Nystrom, Params, Plan, Problem, SparseProblem, SparseWorkspace, Support, TransportError,
    Workspace, terms,
};

/// Gradients per sparse level.
const GRADIENTS: usize = 12;
/// Growth from one level to the next.
const RATIO: f64 = 2.0;

fn main() -> Result<(), TransportError> {
    let given: Vec<usize> = std::env::args().skip(1).filter_map(|text| text.parse().ok()).collect();
    let number = |k: usize, default: usize| given.get(k).copied().unwrap_or(default);
    let (n, m) = (number(0, 10_000), number(1, 6_000));
    let (base_n, base_m, threads) = (number(2, 1250), number(3, 750), number(4, 1));
    let (drawing, motion) = (circles(n), wandering(m));
    let params = Params { alpha: 1.0, ..Params::default() };
    let start = Instant::now();

    let (control, source) = (every(&drawing, base_n), every(&motion, base_m));
    let (dy, dx) = (distances(&control)?, distances(&source)?);
    let problem = Problem::new_unchecked_values(dy.view(), dx.view(), None, params)?;
    let mut workspace = Workspace::new(threads);
    MmSinkhorn { iterations: 40, ..MmSinkhorn::default() }.solve(&problem, &mut workspace)?;
    let mut plan = workspace.take_plan();
    let solved = start.elapsed().as_secs_f64();
    let objective = terms(&problem, plan.dense())?.objective;
    let close = agreement(&plan, &control, &source);
    println!("{base_n} x {base_m} dense: {solved:.2} s, objective {objective:.4}, agreement {close:.3}");
    drop((workspace, dy, dx));

    let steps = ((n as f64 / base_n as f64).ln() / RATIO.ln()).ceil().max(1.0) as usize;
    let mut sparse = SparseWorkspace::new(threads);
    for step in 1..=steps {
        let begin = Instant::now();
        let at = |base: usize, full: usize| {
            let share = step as f64 / steps as f64;
            ((base as f64).powf(1.0 - share) * (full as f64).powf(share)).round() as usize
        };
        let (rows, cols) = (at(base_n, n), at(base_m, m));
        let (control, source) = (every(&drawing, rows), every(&motion, cols));
        let fit = |at: &Mat<f32>| -> Result<_, TransportError> {
            let mut low = Nystrom { threads, ..Nystrom::default() }.fit_features(at.view(), 1.0)?;
            low.scale(1.0 / low.mean())?;
            Ok(low)
        };
        let (low_control, low_source) = (fit(&control)?, fit(&source)?);
        let support = Support::from_coarse(&plan, rows, cols, 12, 2)?;
        let set_up = begin.elapsed().as_secs_f64();
        let problem = SparseProblem::new(&low_control, &low_source, &support, None, params)?;
        let solver = MmSinkhorn { iterations: GRADIENTS, trace: usize::MAX, ..MmSinkhorn::default() };
        let trace = solver.solve_sparse(&problem, &mut sparse)?;
        plan = sparse.take_plan();
        println!(
            "{rows} x {cols}: {set_up:.2} + {:.2} s, {} entries a row, objective {:.4}, agreement {:.3}",
            begin.elapsed().as_secs_f64() - set_up,
            support.len() / rows,
            trace.last().unwrap_or_default().objective,
            agreement(&plan, &control, &source),
        );
    }
    println!("{:.2} s in all on {threads} threads", start.elapsed().as_secs_f64());
    if let Some(peak) = peak_memory() {
        println!("{peak} at most");
    }
    Ok(())
}

/// Five circles, each larger than the one before.
fn circles(n: usize) -> Mat<f32> {
    Mat::from_fn(n, 2, |i, k| {
        let t = i as f32 / n as f32;
        let angle = 5.0 * std::f32::consts::TAU * t;
        (0.3 + t) * if k == 0 { angle.cos() } else { angle.sin() }
    })
}

/// Sums of waves of unrelated lengths.
fn wandering(m: usize) -> Mat<f32> {
    Mat::from_fn(m, 12, |j, k| {
        let t = j as f32 / m as f32 * std::f32::consts::TAU;
        let (k, phase) = (k as f32, (k * k) as f32);
        ((3.0 + 1.7 * k) * t + phase).sin() * (1.0 + 0.6 * (t + phase).cos()) / (1.0 + 0.3 * k)
    })
}

/// `count` rows spread evenly.
fn every(all: &Mat<f32>, count: usize) -> Mat<f32> {
    Mat::from_fn(count, all.cols(), |i, k| all.row((2 * i + 1) * all.rows() / (2 * count))[k])
}

fn distance(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f32>().sqrt()
}

/// All distances between rows, divided by their mean.
fn distances(at: &Mat<f32>) -> Result<Mat<f32>, TransportError> {
    let n = at.rows();
    let mut all = Mat::from_fn(n, n, |i, j| distance(at.row(i), at.row(j)));
    let mean = all.as_slice().iter().map(|&d| f64::from(d)).sum::<f64>() / (n * n) as f64;
    all.as_mut_slice().iter_mut().for_each(|d| *d /= mean as f32);
    Ok(all)
}

/// Correlation of distances in the control with those between what its points are mapped to, over 200 points.
fn agreement(plan: &Plan<f32>, control: &Mat<f32>, source: &Mat<f32>) -> f64 {
    let n = plan.rows();
    let chosen: Vec<usize> = (0..200.min(n)).map(|k| k * n / 200.min(n)).collect();
    let image: Vec<Vec<f32>> = chosen
        .iter()
        .map(|&i| {
            let mut mean = vec![0.0; source.cols()];
            for (j, t) in plan.entries(i) {
                mean.iter_mut().zip(source.row(j)).for_each(|(s, x)| *s += n as f32 * t * x);
            }
            mean
        })
        .collect();
    let mut pairs = Vec::new();
    for (a, &i) in chosen.iter().enumerate() {
        for (b, &k) in chosen.iter().enumerate().skip(a + 1) {
            let there = distance(&image[a], &image[b]);
            pairs.push((f64::from(distance(control.row(i), control.row(k))), f64::from(there)));
        }
    }
    let count = pairs.len() as f64;
    let (x, y) =
        (pairs.iter().map(|p| p.0).sum::<f64>() / count, pairs.iter().map(|p| p.1).sum::<f64>() / count);
    let sum = |f: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(f).sum::<f64>();
    sum(&|p| (p.0 - x) * (p.1 - y)) / (sum(&|p| (p.0 - x).powi(2)) * sum(&|p| (p.1 - y).powi(2))).sqrt()
}

/// The most memory the process held, where the system says.
fn peak_memory() -> Option<String> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(format!("{} MB", kilobytes / 1024))
}
