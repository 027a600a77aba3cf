use inkrig_transport::{MirrorDescent, MmSinkhorn, Params, Problem, Real, Start, Workspace, terms};

use crate::fixture::Fixture;

fn objective<T: Real>(problem: &Problem<'_, T>, workspace: &Workspace<T>) -> f64 {
    terms(problem, workspace.plan().dense()).unwrap().objective
}

/// Seed 2 of the fixture: on it both solvers find the same minimum. Where a problem has several, as with other seeds, they
/// may end up in different ones, either of them lower.
#[test]
fn fifty_of_mm_are_worth_four_hundred_of_mirror_descent() {
    let fixture = Fixture::walks(120, 150, 2);
    let small = fixture.small();
    let mut workspace = Workspace::new(1);
    let mut workspace_small = Workspace::new(1);
    for lambda in [0.01, 0.05, 0.1] {
        for epsilon in [0.005, 0.01, 0.02] {
            let params = Params { alpha: 0.9, lambda, epsilon };
            let problem = fixture.problem(params);
            MmSinkhorn::default().solve(&problem, &mut workspace).unwrap();
            let mm = objective(&problem, &workspace);
            MmSinkhorn::default().solve(&small.problem(params), &mut workspace_small).unwrap();
            let mm_small = objective(&small.problem(params), &workspace_small);
            MirrorDescent::default().solve(&problem, &mut workspace).unwrap();
            let md = objective(&problem, &workspace);
            println!(
                "lambda {lambda} epsilon {epsilon}: MM 50 {mm:.6}, in f32 {:+.1e}, MD 400 {md:.6}",
                mm_small - mm
            );
            assert!((mm - md).abs() < 1e-3, "{params:?}: MM {mm}, MD {md}");
            assert!((mm_small - md).abs() < 1e-3, "{params:?}: MM in f32 {mm_small}, MD {md}");
        }
    }
}

#[test]
fn never_nan_and_never_worse_than_the_start() {
    let wide = Fixture::walks(40, 50, 2);
    let narrow = wide.small();
    for lambda in [0.0, 0.01, 0.03, 0.1, 0.3, 1.0] {
        for epsilon in [0.001, 0.002, 0.005, 0.01, 0.02, 0.05] {
            for alpha in [0.0, 0.5, 0.9, 1.0] {
                let params = Params { alpha, lambda, epsilon };
                check(&narrow.problem(params));
                check(&wide.problem(params));
            }
        }
    }
}

fn check<T: Real>(problem: &Problem<'_, T>) {
    let mut workspace = Workspace::new(1);
    let trace = MmSinkhorn { iterations: 30, trace: 10, ..MmSinkhorn::default() }
        .solve(problem, &mut workspace)
        .unwrap();
    let what = format!("{:?}", problem.params());
    finite(&what, &workspace);
    let start = {
        let mut workspace = Workspace::new(1);
        MmSinkhorn { iterations: 0, ..MmSinkhorn::default() }.solve(problem, &mut workspace).unwrap();
        objective(problem, &workspace)
    };
    let steps: Vec<f64> = trace.records.iter().map(|record| record.terms.objective).collect();
    assert!(steps.iter().all(|&x| x <= start + 1e-6), "{what}: from {start} to {steps:?}");
    MirrorDescent { iterations: 60, ..MirrorDescent::default() }.solve(problem, &mut workspace).unwrap();
    finite(&what, &workspace);
}

fn finite<T: Real>(what: &str, workspace: &Workspace<T>) {
    let plan = workspace.plan();
    let p = 1.0 / plan.rows() as f64;
    for i in 0..plan.rows() {
        let sum: f64 = plan.row(i).iter().map(|t| t.to_f64()).sum();
        assert!((sum - p).abs() < 1e-6, "{what}: row {i} sums to {sum}");
        assert!(plan.row(i).iter().all(|t| *t >= T::ZERO), "{what}: row {i}");
    }
}

#[test]
fn a_warm_start_goes_on_where_it_was() {
    let fixture = Fixture::walks(40, 50, 3);
    let problem = fixture.problem(Params::default());
    let solver = MmSinkhorn { iterations: 20, ..MmSinkhorn::default() };
    let (mut whole, mut halves) = (Workspace::new(1), Workspace::new(1));
    solver.solve(&problem, &mut whole).unwrap();
    let half = MmSinkhorn { iterations: 10, ..solver };
    half.solve(&problem, &mut halves).unwrap();
    MmSinkhorn { start: Start::Continue, ..half }.solve(&problem, &mut halves).unwrap();
    assert_eq!(whole.plan(), halves.plan());
}

#[test]
fn another_seed_starts_elsewhere() {
    let fixture = Fixture::walks(40, 50, 4);
    let problem = fixture.problem(Params { alpha: 1.0, ..Params::default() });
    let solve = |start| {
        let mut workspace = Workspace::new(1);
        MmSinkhorn { start, ..MmSinkhorn::default() }.solve(&problem, &mut workspace).unwrap();
        workspace.take_plan()
    };
    assert_eq!(solve(Start::Perturbed(0)), solve(Start::Independent));
    assert_eq!(solve(Start::Perturbed(7)), solve(Start::Perturbed(7)));
    assert_ne!(solve(Start::Perturbed(7)), solve(Start::Perturbed(8)));
}

#[test]
fn stopping_on_the_plan_leaves_a_good_plan() {
    let fixture = Fixture::walks(40, 50, 5);
    let problem = fixture.problem(Params { epsilon: 0.02, ..Params::default() });
    let mut workspace = Workspace::new(1);
    let solver =
        MmSinkhorn { iterations: 2000, tolerance: 1e-7, sweep_tolerance: 0.0, ..MmSinkhorn::default() };
    let trace = solver.solve(&problem, &mut workspace).unwrap();
    assert!(trace.iterations < 2000 && trace.change.unwrap() < 1e-7, "{trace:?}");
    let early = objective(&problem, &workspace);
    MmSinkhorn { tolerance: 0.0, ..solver }.solve(&problem, &mut workspace).unwrap();
    assert!((early - objective(&problem, &workspace)).abs() < 1e-6);
}
