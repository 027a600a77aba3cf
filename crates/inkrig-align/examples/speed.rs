//! The times that matter, as one table: `cargo run --release -p inkrig-align --example speed`.
//!
//! One thread: process CPU time; two: wall time; each the least of 20 runs (fewer for the largest). Beside them the bare
//! matrix products of the same gradients, timed in turn with the runs. A solve is from features ready to final
//! features: principal subspace, distances, all levels, polish.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that measures")]

use inkrig_align::coarse_to_fine::{Buffers, Frames, solve};
use inkrig_align::pyramid::level_lengths;
use inkrig_align::{
    Control, CurveOptions, Keys, Layout, LiveAlignment, LiveEvent, Options, StreamAlignment, StreamOptions,
    pca,
};
use inkrig_formats::{ImportOptions, read_bvh};
use inkrig_motion::{Clip, FeatureOptions, Features, frame_features, time};
use inkrig_sketch::{Curve, Timing, shapes::growing_circles};
use inkrig_transport::{Mat, MatRef, matmul};
use std::ops::ControlFlow;
use std::time::Instant;

fn main() {
    println!("| case | threads | ms | its products alone, ms | ratio |\n|---|---|---|---|---|");
    for (name, frames, preview, runs) in [
        ("full", 300, false, 20),
        ("preview", 300, true, 20),
        ("full", 600, false, 20),
        ("full", 1500, false, 3),
    ] {
        let case = Case::new(frames);
        for threads in [1, 2] {
            let options = Options { threads, ..Options::default() };
            let options = if preview { options.preview_schedule() } else { options };
            let (mut buffers, mut products) = (Buffers::new(threads), Products::new(frames, &options));
            let (mut run, mut bare) = (f64::INFINITY, f64::INFINITY);
            for _ in 0..runs {
                run = run.min(timed(threads, || case.run(&options, &mut buffers)));
                bare = bare.min(timed(threads, || products.run()));
            }
            let (run, bare, ratio) = (1e3 * run, 1e3 * bare, run / bare);
            println!("| {name} {frames} x {frames} | {threads} | {run:.1} | {bare:.1} | {ratio:.2} |");
        }
    }
    println!(
        "\n| live, 300 samples on 300 frames | threads | first answer, ms | final, ms |\n|---|---|---|---|"
    );
    for threads in [1, 2] {
        let [first, last] = redrawn(threads);
        println!("| a tenth redrawn, with its clips | {threads} | {first:.1} | {last:.1} |");
    }
    println!(
        "\n| stream, window 150 on 300 frames | threads | a hop of 3, ms | worst, ms | latency, samples |\n|---|---|---|---|---|"
    );
    for threads in [1, 2] {
        let (median, worst, latency) = streamed(threads);
        println!("| after the warm-up | {threads} | {median:.1} | {worst:.1} | {latency} |");
    }
}

/// Seconds: of the processor on one thread, by the clock on more.
fn timed(threads: usize, work: impl FnOnce()) -> f64 {
    let (cpu, wall) = (processor(), Instant::now());
    work();
    match (processor(), cpu) {
        (Some(now), Some(cpu)) if threads == 1 => now - cpu,
        _ => wall.elapsed().as_secs_f64(),
    }
}

/// Processor time of this process, seconds, where the system tells it.
fn processor() -> Option<f64> {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
    }
    #[cfg(not(unix))]
    None
}

/// The person's clip stretched to a number of frames.
fn person(frames: usize) -> Clip {
    let sample = inkrig_samples::find("person").unwrap();
    let clip = read_bvh(sample.bytes, &ImportOptions::default()).unwrap().clip;
    let step = (clip.frames() - 1) as f64 / (frames - 1) as f64;
    let places: Vec<f64> = (0..frames).map(|i| i as f64 * step).collect();
    time::sample_at(&clip, &places, 30.0).unwrap()
}

struct Case {
    source: Features,
    control: Mat<f32>,
}

impl Case {
    fn new(frames: usize) -> Self {
        let curve = growing_circles(5, frames).unwrap();
        let control = Control::from_curve(&curve, &CurveOptions::default()).unwrap().features;
        let control = Mat::from_vec(control.frames(), control.width(), control.into_vec()).unwrap();
        Self { source: frame_features(&person(frames).into(), &FeatureOptions::default()), control }
    }

    fn run(&self, options: &Options, buffers: &mut Buffers) {
        let table = MatRef::new(self.source.as_slice(), self.source.frames(), self.source.width()).unwrap();
        let reduced = pca::reduce(table, pca::FEATURE_ENERGY, options.threads).unwrap();
        let layouts = [table.rows(), self.control.rows()].map(|frames| Layout::open(frames, options.patch()));
        let source = Frames { table: reduced.frames.view(), layout: &layouts[0] };
        let control = Frames { table: self.control.view(), layout: &layouts[1] };
        let go_on = &mut |_| ControlFlow::Continue(());
        let matching = solve(source, control, &Keys::default(), options, buffers, go_on).unwrap();
        assert_eq!(matching.gradients, options.gradients());
    }
}

/// The two products of every gradient of a run, and nothing else.
struct Products {
    levels: Vec<(Mat<f32>, usize)>,
    out: [Mat<f32>; 2],
    threads: usize,
}

impl Products {
    fn new(frames: usize, options: &Options) -> Self {
        let lengths = level_lengths(frames, options.levels, options.ratio, 5 * options.patch());
        let levels = lengths.iter().enumerate().map(|(level, length)| {
            let patches = length + 1 - options.patch();
            let first = options.starts * options.scouting + options.first_iterations;
            let gradients = options.rounds * options.iterations + if level == 0 { first } else { 0 };
            (Mat::from_fn(patches, patches, |i, j| (i + j) as f32 * 1e-3), gradients)
        });
        Self { levels: levels.collect(), out: Default::default(), threads: options.threads }
    }

    fn run(&mut self) {
        let [half, whole] = &mut self.out;
        for (square, gradients) in &self.levels {
            for _ in 0..*gradients {
                matmul(square.view(), square.view(), half, self.threads).unwrap();
                matmul(square.view(), half.view(), whole, self.threads).unwrap();
            }
        }
    }
}

/// The least seconds to the first and to the final answer after a tenth of a curve was redrawn, clips included.
fn redrawn(threads: usize) -> [f64; 2] {
    let control = |from: f64| {
        let at = |i: usize| {
            let t = i as f64 / 300.0;
            let place = (t - from) / 0.1;
            let hump = if (0.0..1.0).contains(&place) { (std::f64::consts::PI * place).sin() } else { 0.0 };
            let (sin, cos) = (std::f64::consts::TAU * 5.0 * t).sin_cos();
            [(0.2 + 0.8 * t + 0.6 * hump) * cos, (0.2 + 0.8 * t + 0.6 * hump) * sin]
        };
        let options = CurveOptions { timing: Some(Timing::AsSampled), ..CurveOptions::default() };
        Control::from_curve(&Curve::new((0..300).map(at).collect()).unwrap(), &options).unwrap()
    };
    let options = Options { threads, ..Options::default() };
    let mut live = LiveAlignment::new(&person(300).into(), &options).unwrap();
    let mut least = [f64::INFINITY; 2];
    for run in 0..21 {
        let control = control(0.04 * f64::from(run));
        let mut seconds = [None, None];
        let mut spent = 0.0;
        let total = timed(threads, || {
            let begin = Instant::now();
            live.update(&control, &mut |event| {
                if let LiveEvent::Answer(answer) = event {
                    seconds[0].get_or_insert(begin.elapsed().as_secs_f64());
                    seconds[1] = answer.is_final.then(|| begin.elapsed().as_secs_f64());
                }
                ControlFlow::Continue(())
            })
            .unwrap();
            spent = begin.elapsed().as_secs_f64();
        });
        if run > 0 {
            // On one thread the final answer is told in CPU time, as the table's other figures.
            least[0] = least[0].min(1e3 * seconds[0].unwrap());
            least[1] = least[1].min(1e3 * if threads == 1 { total } else { spent });
        }
    }
    least
}

/// Median and worst milliseconds of a hop, and the latency in samples.
fn streamed(threads: usize) -> (f64, f64, usize) {
    let align = Options { threads, ..StreamOptions::default().align };
    let options = StreamOptions { align, ..StreamOptions::default() };
    let mut stream = StreamAlignment::new(&person(300).into(), &options).unwrap();
    let mut times = Vec::new();
    for i in (0..400).step_by(3) {
        let at = |i: usize| (i as f32 * 0.1).sin_cos();
        let samples: Vec<f32> =
            (i..i + 3).flat_map(|i| [at(i).0 * (1.0 + 0.002 * i as f32), at(i).1]).collect();
        let took = timed(threads, || {
            stream.append(&samples, 2).unwrap();
        });
        if i > options.window {
            times.push(1e3 * took);
        }
    }
    times.sort_by(f64::total_cmp);
    (times[times.len() / 2], times[times.len() - 1], stream.latency())
}
