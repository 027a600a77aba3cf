use inkrig_transport::{Isa, MirrorDescent, MmSinkhorn, Params, Plan, Real, Start, Workspace};

use crate::fixture::Fixture;

/// Sizes around the block size and the lane width, and one on each side of going parallel within a sweep.
const SIZES: [(usize, usize); 6] = [(1, 1), (2, 17), (81, 33), (160, 64), (203, 150), (530, 520)];

fn solve<T: Real>(fixture: &Fixture<T>, mut workspace: Workspace<T>) -> (Plan<T>, Plan<T>) {
    let problem = fixture.problem(Params::default());
    let solver = MmSinkhorn { iterations: 4, tolerance: 1e-12, ..MmSinkhorn::default() };
    solver.solve(&problem, &mut workspace).unwrap();
    let mm = workspace.take_plan();
    MirrorDescent { iterations: 3, ..MirrorDescent::default() }.solve(&problem, &mut workspace).unwrap();
    (mm, workspace.take_plan())
}

#[test]
fn the_number_of_threads_never_shows() {
    for (n, m) in SIZES {
        let fixture = Fixture::walks(n, m, 5);
        let small = fixture.small();
        let (want, want_small) = (solve(&fixture, Workspace::new(1)), solve(&small, Workspace::new(1)));
        for threads in [2, 3, 8] {
            assert!(want == solve(&fixture, Workspace::new(threads)), "{n} x {m}, {threads} threads, f64");
            assert!(
                want_small == solve(&small, Workspace::new(threads)),
                "{n} x {m}, {threads} threads, f32"
            );
        }
    }
}

#[test]
fn every_instruction_level_agrees() {
    // The last size is about threads, and slow at the lowest level.
    for (n, m) in SIZES.into_iter().take(5) {
        let fixture = Fixture::walks(n, m, 6);
        let small = fixture.small();
        let at = |isa| {
            let (mut wide, mut narrow) = (Workspace::new(1), Workspace::new(1));
            wide.set_isa(isa);
            narrow.set_isa(isa);
            (solve(&fixture, wide), solve(&small, narrow))
        };
        let (want, want_small) = at(Isa::Portable);
        for isa in Isa::ALL.into_iter().filter(|&isa| isa <= Isa::detect()) {
            let (got, got_small) = at(isa);
            let p = 1.0 / n as f64;
            for (got, want, limit) in [(&got.0, &want.0, 1e-10), (&got.1, &want.1, 1e-12)] {
                assert!(difference(got, want) < limit * p, "{n} x {m}, {}, f64", isa.name());
            }
            for (got, want) in [(&got_small.0, &want_small.0), (&got_small.1, &want_small.1)] {
                let off = difference(got, want) / p;
                assert!(off < 2e-3, "{n} x {m}, {}, f32: {off:e}", isa.name());
            }
        }
    }
}

fn difference<T: Real>(a: &Plan<T>, b: &Plan<T>) -> f64 {
    let pairs = a.dense().as_slice().iter().zip(b.dense().as_slice());
    pairs.map(|(a, b)| (a.to_f64() - b.to_f64()).abs()).fold(0.0, f64::max)
}

#[test]
fn a_workspace_has_no_memory_but_the_continued() {
    let (large, little) = (Fixture::walks(90, 70, 7), Fixture::walks(33, 40, 8));
    let solver = MmSinkhorn { iterations: 5, ..MmSinkhorn::default() };
    let mut used = Workspace::new(1);
    solver.solve(&large.problem(Params::default()), &mut used).unwrap();
    solver.solve(&little.problem(Params::default()), &mut used).unwrap();
    let mut fresh = Workspace::new(1);
    solver.solve(&little.problem(Params::default()), &mut fresh).unwrap();
    assert_eq!(used.plan(), fresh.plan());

    let proceed = MmSinkhorn { start: Start::Continue, ..solver };
    let error = proceed.solve(&large.problem(Params::default()), &mut used).unwrap_err();
    assert!(error.to_string().contains("holds a 33 x 40 plan and the problem is 90 x 70"), "{error}");
    let error = proceed.solve(&large.problem(Params::default()), &mut Workspace::new(1)).unwrap_err();
    assert!(error.to_string().contains("holds a 0 x 0 plan"), "{error}");
}

#[test]
fn no_entry_is_denormal() {
    let fixture = Fixture::walks(60, 75, 9).small();
    for epsilon in [0.001, 0.005] {
        let mut workspace = Workspace::new(1);
        MmSinkhorn::default()
            .solve(&fixture.problem(Params { epsilon, ..Params::default() }), &mut workspace)
            .unwrap();
        let plan = workspace.plan();
        assert!(plan.dense().as_slice().iter().chain(plan.column_mass()).all(|t| !t.is_subnormal()));
        assert!(plan.dense().as_slice().contains(&0.0), "nothing was small enough to matter");
    }
}

#[test]
fn settings_out_of_range_are_refused() {
    let fixture = Fixture::walks(3, 4, 10);
    let problem = fixture.problem(Params::default());
    let mut workspace = Workspace::new(1);
    let good = MmSinkhorn::default();
    for bad in [
        MmSinkhorn { sweeps: 0, ..good },
        MmSinkhorn { mu: f64::NAN, ..good },
        MmSinkhorn { mu: -1.0, ..good },
        MmSinkhorn { tolerance: -1.0, ..good },
        MmSinkhorn { sweep_tolerance: f64::INFINITY, ..good },
    ] {
        assert!(bad.solve(&problem, &mut workspace).is_err(), "{bad:?}");
    }
    for step in [0.0, -1.0, f64::NAN] {
        let bad = MirrorDescent { step: inkrig_transport::Step::Fixed(step), ..MirrorDescent::default() };
        assert!(bad.solve(&problem, &mut workspace).is_err(), "{bad:?}");
    }
}
