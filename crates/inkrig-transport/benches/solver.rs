//! One outer iteration of the solver, on 1 and 2 threads, beside the bare pair of matrix products it contains; and of the
//! three kinds of problem at 1500 x 1500.
//!
//! `cargo bench -p inkrig-transport`. `bare` is two N x N products by the `gemm` crate, in one call each on one thread, in
//! blocks of rows on two; `iteration` is a warm start of 8 iterations divided by 8, set-up included.
#![allow(missing_docs)]
// A benchmark may stop at an error, and calls the `gemm` crate as it is, through pointers.
#![allow(unsafe_code, clippy::unwrap_used)]

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use inkrig_transport::{
    Mat, MmSinkhorn, Nystrom, Params, Problem, SparseProblem, SparseWorkspace, Start, Support, Workspace,
    matmul,
};

const ITERATIONS: usize = 8;

/// Self-distances of a closed curve, divided by their mean.
fn curve(n: usize, turns: f32) -> Mat<f32> {
    let at = |i: usize| {
        let t = i as f32 / n as f32 * std::f32::consts::TAU;
        [(turns * t).sin() * (1.0 + 0.3 * t.cos()), (turns * t).cos(), 0.2 * t]
    };
    let distance = |i, j| at(i).iter().zip(at(j)).map(|(a, b)| (a - b).powi(2)).sum::<f32>().sqrt();
    let mut mat = Mat::from_fn(n, n, distance);
    let mean = mat.as_slice().iter().sum::<f32>() / (n * n) as f32;
    mat.as_mut_slice().iter_mut().for_each(|x| *x /= mean);
    mat
}

/// `out = a b`, all N x N.
fn bare(a: &Mat<f32>, b: &Mat<f32>, out: &mut Mat<f32>) {
    let n = out.rows();
    assert!([a.rows(), a.cols(), b.rows(), b.cols(), out.cols()].iter().all(|&size| size == n));
    let (a, b, out) = (a.as_slice().as_ptr(), b.as_slice().as_ptr(), out.as_mut_slice().as_mut_ptr());
    let (step, none) = (n as isize, gemm::Parallelism::None);
    // SAFETY: all three are contiguous and N x N.
    unsafe {
        gemm::gemm(n, n, n, out, 1, step, false, a, 1, step, b, 1, step, 0.0, 1.0, false, false, false, none);
    }
}

fn solver(criterion: &mut Criterion) {
    for n in [100, 300, 600] {
        let mut group = criterion.benchmark_group(format!("{n}x{n}"));
        group
            .sample_size(30)
            .warm_up_time(Duration::from_millis(500))
            .measurement_time(Duration::from_secs(3));
        let (control, source) = (curve(n, 3.0), curve(n, 5.0));
        let cost = Mat::from_fn(n, n, |i, j| ((i * 7 + j * 13) % 17) as f32 / 17.0);
        let problem =
            Problem::new(control.view(), source.view(), Some(cost.view()), Params::default()).unwrap();
        for threads in [1, 2] {
            let (mut half, mut full) = (Mat::zeros(n, n), Mat::zeros(n, n));
            group.bench_function(BenchmarkId::new("bare", threads), |bencher| {
                bencher.iter(|| {
                    if threads == 1 {
                        bare(&control, &cost, &mut half);
                        bare(&half, &source, &mut full);
                    } else {
                        matmul(control.view(), cost.view(), &mut half, threads).unwrap();
                        matmul(half.view(), source.view(), &mut full, threads).unwrap();
                    }
                    black_box(&full);
                });
            });
            let mut workspace = Workspace::new(threads);
            MmSinkhorn { iterations: 20, ..MmSinkhorn::default() }.solve(&problem, &mut workspace).unwrap();
            let warm = MmSinkhorn { iterations: ITERATIONS, start: Start::Continue, ..MmSinkhorn::default() };
            group.bench_function(BenchmarkId::new("iteration", threads), |bencher| {
                bencher.iter_custom(|times| {
                    let start = std::time::Instant::now();
                    for _ in 0..times {
                        warm.solve(&problem, &mut workspace).unwrap();
                    }
                    start.elapsed() / ITERATIONS as u32
                });
            });
        }
        group.finish();
    }
}

/// One outer iteration at 1500 x 1500 on one thread: with matrices, with factors of rank 32, and with these on about 60
/// entries a row.
fn large(criterion: &mut Criterion) {
    let n = 1500;
    let mut group = criterion.benchmark_group(format!("{n}x{n}"));
    group.sample_size(10).measurement_time(Duration::from_secs(5));
    let (control, source) = (curve(n, 3.0), curve(n, 5.0));
    let low = |mat: &Mat<f32>| {
        Nystrom::default().fit(n, |i, out: &mut [f32]| out.copy_from_slice(mat.row(i))).unwrap()
    };
    let (low_control, low_source) = (low(&control), low(&source));
    let params = Params { alpha: 1.0, ..Params::default() };
    let warm = MmSinkhorn { iterations: ITERATIONS, start: Start::Continue, ..MmSinkhorn::default() };
    let dense = Problem::new(control.view(), source.view(), None, params).unwrap();
    let factors = Problem::with_distances((&low_control).into(), (&low_source).into(), None, params).unwrap();
    let mut workspace = Workspace::new(1);
    for (name, problem) in [("dense", &dense), ("rank 32", &factors)] {
        MmSinkhorn { iterations: 10, ..MmSinkhorn::default() }.solve(problem, &mut workspace).unwrap();
        group.bench_function(BenchmarkId::new("iteration", name), |bencher| {
            bencher.iter_custom(|times| {
                let start = std::time::Instant::now();
                for _ in 0..times {
                    warm.solve(problem, &mut workspace).unwrap();
                }
                start.elapsed() / ITERATIONS as u32
            });
        });
    }
    let support = Support::from_rows(n, n, |i, out| out.extend((0..60).map(|k| (i + 25 * k) % n))).unwrap();
    let sparse = SparseProblem::new(&low_control, &low_source, &support, None, params).unwrap();
    let mut workspace = SparseWorkspace::new(1);
    MmSinkhorn { iterations: 10, ..MmSinkhorn::default() }.solve_sparse(&sparse, &mut workspace).unwrap();
    group.bench_function(BenchmarkId::new("iteration", "60 entries a row"), |bencher| {
        bencher.iter_custom(|times| {
            let start = std::time::Instant::now();
            for _ in 0..times {
                warm.solve_sparse(&sparse, &mut workspace).unwrap();
            }
            start.elapsed() / ITERATIONS as u32
        });
    });
    group.finish();
}

criterion_group!(benches, solver, large);
criterion_main!(benches);
