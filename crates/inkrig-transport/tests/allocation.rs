//! Counts allocations: a solve in a used workspace makes none, however many iterations it does.
// A global allocator is an unsafe trait; this one hands everything on to the system's.
#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use inkrig_transport::{Mat, MirrorDescent, MmSinkhorn, Params, Problem, Start, Workspace};

struct Counting;

static COUNT: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        // SAFETY: the caller's.
        unsafe { System.dealloc(at, layout) }
    }
    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's.
        unsafe { System.realloc(at, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn count(run: impl FnOnce()) -> usize {
    let before = COUNT.load(Ordering::Relaxed);
    run();
    COUNT.load(Ordering::Relaxed) - before
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

    let mut workspace = Workspace::new(1);
    let mm = |iterations, start| MmSinkhorn { iterations, start, ..MmSinkhorn::default() };
    let md = |iterations| MirrorDescent { iterations, ..MirrorDescent::default() };
    mm(1, Start::Independent).solve(&problem, &mut workspace).unwrap();
    md(1).solve(&problem, &mut workspace).unwrap();
    let made = count(|| {
        mm(20, Start::Independent).solve(&problem, &mut workspace).unwrap();
        mm(20, Start::Continue).solve(&problem, &mut workspace).unwrap();
        md(20).solve(&problem, &mut workspace).unwrap();
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
}
