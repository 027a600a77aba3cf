//! Counts allocations: a solve in a used workspace makes none, however many iterations it does; a sparse one none per
//! iteration, and never as much memory as a dense plan would take.
// A global allocator is an unsafe trait; this one hands everything on to the system's.
// Helpers stand outside of test functions.
#![allow(unsafe_code, clippy::unwrap_used, clippy::print_stdout)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use inkrig_transport::{
    Mask, Mat, MirrorDescent, MmSinkhorn, Nystrom, Params, Problem, SparseProblem, SparseWorkspace, Start,
    Support, Workspace,
};

struct Counting;

static COUNT: AtomicUsize = AtomicUsize::new(0);
static LIVE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

fn grown(by: usize) {
    let live = LIVE.fetch_add(by, Ordering::Relaxed) + by;
    PEAK.fetch_max(live, Ordering::Relaxed);
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        grown(layout.size());
        // SAFETY: the caller's.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's.
        unsafe { System.dealloc(at, layout) }
    }
    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        grown(size);
        LIVE.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's.
        unsafe { System.realloc(at, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The fewest of three times: the counter is the process's, and the threads of the test's own harness may take memory meanwhile.
fn count(mut run: impl FnMut()) -> usize {
    let once = |_| {
        let before = COUNT.load(Ordering::Relaxed);
        run();
        COUNT.load(Ordering::Relaxed) - before
    };
    (0..3).map(once).min().unwrap()
}

// One test in the file: the counter is the whole process's.
#[test]
fn iterations_allocate_nothing() {
    let line = |n: usize| Mat::from_fn(n, n, |i, j| (i as f32 - j as f32).abs() / n as f32);
    let (control, source, cost) =
        (line(200), line(130), Mat::from_fn(200, 130, |i, j| ((i * j) % 7) as f32 * 0.1));
    let problem = Problem::new(control.view(), source.view(), Some(cost.view()), Params::default()).unwrap();
    let little =
        Problem::new(source.view(), source.view(), None, Params { alpha: 1.0, ..Params::default() }).unwrap();

    let mask = Mask { rows: vec![(3, 5), (150, 129)], columns: vec![7, 8] };
    let limited = problem.with_linear(cost.view()).and_then(|problem| problem.with_mask(&mask)).unwrap();

    let mut workspace = Workspace::new(1);
    let mm = |iterations, start| MmSinkhorn { iterations, start, ..MmSinkhorn::default() };
    let md = |iterations| MirrorDescent { iterations, ..MirrorDescent::default() };
    mm(1, Start::Independent).solve(&problem, &mut workspace).unwrap();
    md(1).solve(&problem, &mut workspace).unwrap();
    let made = count(|| {
        mm(20, Start::Independent).solve(&problem, &mut workspace).unwrap();
        mm(20, Start::Continue).solve(&problem, &mut workspace).unwrap();
        md(20).solve(&problem, &mut workspace).unwrap();
        mm(20, Start::Continue).solve(&limited, &mut workspace).unwrap();
        md(20).solve(&limited, &mut workspace).unwrap();
        mm(20, Start::Perturbed(3)).solve(&little, &mut workspace).unwrap();
        mm(20, Start::Independent).solve(&problem, &mut workspace).unwrap();
    });
    assert_eq!(made, 0, "one thread");

    // The thread pool's queues may take a block now and then, but not with every iteration.
    let mut workspace = Workspace::new(2);
    mm(50, Start::Independent).solve(&problem, &mut workspace).unwrap();
    let made = count(|| {
        mm(300, Start::Continue).solve(&problem, &mut workspace).unwrap();
    });
    assert!(made < 30, "two threads: {made} in 300 iterations");
    drop(workspace);
    sparse_solves_stay_small();
}

fn sparse_solves_stay_small() {
    let (n, m) = (4000, 3000);
    let before = LIVE.load(Ordering::Relaxed);
    PEAK.store(before, Ordering::Relaxed);
    let fit = |count: usize| {
        let line = |i: usize, out: &mut [f32]| {
            out.iter_mut()
                .enumerate()
                .for_each(|(j, d)| *d = 3.0 * (i as f32 - j as f32).abs() / count as f32);
        };
        Nystrom { rank: 16, landmarks: 64, threads: 1 }.fit(count, line).unwrap()
    };
    let (control, source) = (fit(n), fit(m));
    let near = |i: usize, out: &mut Vec<usize>| {
        let at = i * m / n;
        out.extend(at.saturating_sub(15)..(at + 16).min(m));
    };
    let support = Support::from_rows(n, m, near).unwrap();
    let params = Params { alpha: 1.0, ..Params::default() };
    let problem = SparseProblem::new(&control, &source, &support, None, params).unwrap();
    let mut workspace = SparseWorkspace::new(1);
    let mm = |iterations| MmSinkhorn { iterations, ..MmSinkhorn::default() };
    // Twice: a solve keeps the support and the plan of the one before.
    for _ in 0..2 {
        mm(1).solve_sparse(&problem, &mut workspace).unwrap();
    }
    let one = count(|| {
        mm(1).solve_sparse(&problem, &mut workspace).unwrap();
    });
    let ten = count(|| {
        mm(10).solve_sparse(&problem, &mut workspace).unwrap();
    });
    assert_eq!(one, ten, "a sparse iteration allocates");
    let (peak, dense) = (PEAK.load(Ordering::Relaxed) - before, n * m * size_of::<f32>());
    println!("{n} x {m} on {} entries: {peak} bytes at most, a dense plan takes {dense}", support.len());
    assert!(peak < dense / 2, "{peak} bytes, a dense plan takes {dense}");
}
