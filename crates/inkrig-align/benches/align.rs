//! Time from features ready to final features (distances, all levels, polish), beside the bare matrix products that
//! the same gradients cost: `cargo bench -p inkrig-align`.
#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark")]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use inkrig_align::coarse_to_fine::{Buffers, Frames, solve};
use inkrig_align::pyramid::level_lengths;
use inkrig_align::{Control, CurveOptions, Keys, Layout, Options, pca};
use inkrig_formats::{ImportOptions, read_bvh};
use inkrig_motion::{FeatureOptions, frame_features, time};
use inkrig_sketch::shapes::growing_circles;
use inkrig_transport::{Mat, MatRef, matmul};
use std::ops::ControlFlow;

/// A case of `frames` source frames and as many control samples.
struct Case {
    source: inkrig_motion::Features,
    control: Mat<f32>,
}

impl Case {
    fn new(frames: usize) -> Self {
        let sample = inkrig_samples::find("person").unwrap();
        let clip = read_bvh(sample.bytes, &ImportOptions::default()).unwrap().clip;
        let places: Vec<f64> =
            (0..frames).map(|i| i as f64 * (clip.frames() - 1) as f64 / (frames - 1) as f64).collect();
        let clip = time::sample_at(&clip, &places, 30.0).unwrap();
        let curve = growing_circles(5, frames).unwrap();
        let control = Control::from_curve(&curve, &CurveOptions::default()).unwrap().features;
        let control = Mat::from_vec(control.frames(), control.width(), control.into_vec()).unwrap();
        Self { source: frame_features(&clip.into(), &FeatureOptions::default()), control }
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
fn products(frames: usize, options: &Options) {
    for (level, &length) in level_lengths(frames, options.levels, options.ratio, 55).iter().enumerate() {
        let patches = length + 1 - options.patch();
        let square = Mat::from_fn(patches, patches, |i, j| (i + j) as f32 * 1e-3);
        let (mut once, mut twice) = (Mat::default(), Mat::default());
        let first = if level == 0 { options.starts * options.scouting + options.first_iterations } else { 0 };
        for _ in 0..first + options.rounds * options.iterations {
            matmul(square.view(), square.view(), &mut once, options.threads).unwrap();
            matmul(square.view(), once.view(), &mut twice, options.threads).unwrap();
        }
    }
}

fn benches(criterion: &mut Criterion) {
    for frames in [300, 600] {
        let case = Case::new(frames);
        let mut group = criterion.benchmark_group(format!("{frames}x{frames}"));
        group.sample_size(20);
        for threads in [1, 2] {
            let options = Options { threads, ..Options::default() };
            let mut buffers = Buffers::new(threads);
            group.bench_function(BenchmarkId::new("align", threads), |bencher| {
                bencher.iter(|| case.run(&options, &mut buffers));
            });
            group.bench_function(BenchmarkId::new("products", threads), |bencher| {
                bencher.iter(|| products(frames, &options));
            });
        }
        group.finish();
    }
}

criterion_group!(all, benches);
criterion_main!(all);
