//! Linear costs and masks: the same problem said in another way has the same solution.

use inkrig_transport::{
    Isa, Mask, Mat, MirrorDescent, MmSinkhorn, Params, Plan, Problem, Real, Start, Workspace, terms,
};

use crate::fixture::Fixture;

/// Enough iterations to stand still; at this epsilon both solvers find the same minimum.
const PARAMS: Params = Params { alpha: 0.9, lambda: 0.05, epsilon: 0.05 };

fn mm<T: Real>(problem: &Problem<'_, T>) -> Plan<T> {
    let mut workspace = Workspace::new(1);
    let solver = MmSinkhorn { iterations: 600, sweep_tolerance: 0.0, ..MmSinkhorn::default() };
    solver.solve(problem, &mut workspace).unwrap();
    workspace.take_plan()
}

fn md<T: Real>(problem: &Problem<'_, T>) -> Plan<T> {
    let mut workspace = Workspace::new(1);
    MirrorDescent { iterations: 2500, ..MirrorDescent::default() }.solve(problem, &mut workspace).unwrap();
    workspace.take_plan()
}

fn difference<T: Real>(a: &Plan<T>, b: &Plan<T>) -> f64 {
    let pairs = a.dense().as_slice().iter().zip(b.dense().as_slice());
    pairs.map(|(a, b)| (a.to_f64() - b.to_f64()).abs()).fold(0.0, f64::max)
}

#[test]
fn a_linear_cost_is_a_share_of_the_cost() {
    let fixture = Fixture::walks(30, 40, 2);
    let bias = Mat::from_fn(30, 40, |i, j| ((i * 7 + j * 5) % 13) as f64 * 0.02 - 0.05);
    let more = Mat::from_fn(30, 40, |i, j| fixture.cost.row(i)[j] + (bias.row(i)[j] + 0.05) / 0.1);
    let split = fixture.problem(PARAMS).with_linear(bias.view()).unwrap();
    let whole =
        Problem::new(fixture.control.view(), fixture.source.view(), Some(more.view()), PARAMS).unwrap();
    for solve in [mm::<f64>, md::<f64>] {
        let (a, b) = (solve(&split), solve(&whole));
        assert!(difference(&a, &b) < 1e-13, "{:e}", difference(&a, &b));
        assert!(difference(&a, &solve(&fixture.problem(PARAMS))) > 1e-3, "the bias does nothing");
        let (a, b) = (terms(&split, a.dense()).unwrap(), terms(&whole, b.dense()).unwrap());
        // The constant .05 that keeps the larger cost from being negative.
        assert!((a.objective + 0.05 - b.objective).abs() < 1e-12);
        assert!(a.linear < 0.0 && b.linear == 0.0);
    }
    let (small, bias) = (fixture.small(), Mat::from_fn(30, 40, |i, j| bias.row(i)[j] as f32));
    let small = small.problem(PARAMS).with_linear(bias.view()).unwrap();
    let got = terms(&small, mm(&small).dense()).unwrap().objective;
    let want = terms(&split, mm(&split).dense()).unwrap().objective;
    assert!((got - want).abs() < 1e-5, "{got} {want}");
}

#[test]
fn a_bad_linear_cost_is_refused() {
    let fixture = Fixture::walks(3, 4, 1);
    let problem = fixture.problem(PARAMS);
    let mut bias = Mat::zeros(3, 4);
    bias.row_mut(1)[2] = f64::NAN;
    let says = problem.with_linear(bias.view()).unwrap_err().to_string();
    assert!(says.contains("`bias` holds NaN at row 1, column 2"), "{says}");
    let says = problem.with_linear(Mat::zeros(4, 3).view()).unwrap_err().to_string();
    assert!(says.contains("`bias` is 4 x 3, expected 3 x 4"), "{says}");
}

#[test]
fn forbidden_columns_are_as_if_they_were_not_there() {
    let fixture = Fixture::walks(30, 40, 2);
    let mask = Mask { rows: Vec::new(), columns: vec![39, 0, 7, 8, 9, 20, 8] };
    let kept: Vec<usize> = (0..40).filter(|j| !mask.columns.contains(j)).collect();
    let source = Mat::from_fn(34, 34, |i, j| fixture.source.row(kept[i])[kept[j]]);
    let cost = Mat::from_fn(30, 34, |i, j| fixture.cost.row(i)[kept[j]]);
    let masked = fixture.problem(PARAMS).with_mask(&mask).unwrap();
    let reduced = Problem::new(fixture.control.view(), source.view(), Some(cost.view()), PARAMS).unwrap();
    for solve in [mm::<f64>, md::<f64>] {
        let (a, b) = (solve(&masked), solve(&reduced));
        for &j in &mask.columns {
            assert!((0..30).all(|i| a.row(i)[j] == 0.0) && a.column_mass()[j] == 0.0);
        }
        let inside = Plan::from_mat(Mat::from_fn(30, 34, |i, j| a.row(i)[kept[j]]));
        assert!(difference(&inside, &b) < 1e-13, "{:e}", difference(&inside, &b));
        let (a, b) = (terms(&masked, a.dense()).unwrap(), terms(&reduced, b.dense()).unwrap());
        assert!((a.objective - b.objective).abs() < 1e-12 && (a.kl - b.kl).abs() < 1e-12);
    }
}

#[test]
fn settled_rows_stay_and_the_others_make_the_best_of_it() {
    let fixture = Fixture::walks(30, 40, 2);
    let mask = Mask { rows: vec![(29, 3), (0, 17), (12, 17)], columns: vec![5, 6] };
    let problem = fixture.problem(PARAMS).with_mask(&mask).unwrap();
    let (a, b) = (mm(&problem), md(&problem));
    for plan in [&a, &b] {
        check(plan, &mask);
        assert!(plan.column_mass()[17] >= 2.0 / 30.0 && plan.column_mass()[3] >= 1.0 / 30.0);
    }
    // Two solvers that share nothing but the gradient agree, so the settled mass is counted as it should be.
    assert!(difference(&a, &b) < 1e-9, "{:e}", difference(&a, &b));
    let free = fixture.problem(PARAMS);
    let gap = terms(&free, a.dense()).unwrap().objective - terms(&free, mm(&free).dense()).unwrap().objective;
    assert!(gap > 1e-3, "the mask costs nothing: {gap}");
    let small = fixture.small();
    let small = small.problem(PARAMS).with_mask(&mask).unwrap();
    check(&mm(&small), &mask);
    check(&md(&small), &mask);
    let (got, want) =
        (terms(&small, mm(&small).dense()).unwrap().objective, terms(&problem, a.dense()).unwrap().objective);
    assert!((got - want).abs() < 1e-5, "{got} {want}");
}

#[test]
fn a_mask_holds_in_every_iteration_and_from_every_start() {
    let fixture = Fixture::walks(83, 50, 3).small();
    let mask = Mask { rows: vec![(0, 49), (79, 0), (82, 49)], columns: (10..30).collect() };
    let free = fixture.problem(Params::default());
    let problem = free.with_mask(&mask).unwrap();
    let mut workspace = Workspace::new(1);
    let mut elsewhere = Workspace::new(1);
    MmSinkhorn::default().solve(&free, &mut elsewhere).unwrap();
    let broken = elsewhere.take_plan();
    for iterations in 0..4 {
        for start in [Start::Independent, Start::Perturbed(4), Start::Continue] {
            workspace.resume(&broken);
            MmSinkhorn { iterations, start, ..MmSinkhorn::default() }
                .solve(&problem, &mut workspace)
                .unwrap();
            check(workspace.plan(), &mask);
            workspace.resume(&broken);
            MirrorDescent { iterations, start, ..MirrorDescent::default() }
                .solve(&problem, &mut workspace)
                .unwrap();
            check(workspace.plan(), &mask);
        }
    }
}

#[test]
fn a_masked_warm_start_goes_on_where_it_was() {
    let fixture = Fixture::walks(40, 50, 3);
    let mask = Mask { rows: vec![(4, 4)], columns: vec![0, 1] };
    let problem = fixture.problem(Params::default()).with_mask(&mask).unwrap();
    let solver = MmSinkhorn { iterations: 20, ..MmSinkhorn::default() };
    let (mut whole, mut halves, mut resumed) = (Workspace::new(1), Workspace::new(1), Workspace::new(1));
    solver.solve(&problem, &mut whole).unwrap();
    let half = MmSinkhorn { iterations: 10, ..solver };
    let go_on = MmSinkhorn { start: Start::Continue, ..half };
    half.solve(&problem, &mut halves).unwrap();
    // A resumed plan has no scaling with it: the way is another, the place the same.
    resumed.resume(halves.plan());
    go_on.solve(&problem, &mut halves).unwrap();
    assert_eq!(whole.plan(), halves.plan());
    go_on.solve(&problem, &mut resumed).unwrap();
    check(resumed.plan(), &mask);
    let objective = |workspace: &Workspace<f64>| terms(&problem, workspace.plan().dense()).unwrap().objective;
    assert!((objective(&resumed) - objective(&whole)).abs() < 1e-3);
}

#[test]
fn masks_are_the_same_on_all_threads_and_levels() {
    let fixture = Fixture::walks(203, 150, 6).small();
    let mask = Mask { rows: vec![(100, 3), (7, 149)], columns: (40..60).collect() };
    let problem = fixture.problem(PARAMS).with_mask(&mask).unwrap();
    let solve = |threads, isa| {
        let mut workspace = Workspace::new(threads);
        workspace.set_isa(isa);
        MmSinkhorn { iterations: 6, ..MmSinkhorn::default() }.solve(&problem, &mut workspace).unwrap();
        workspace.take_plan()
    };
    let best = Isa::current();
    assert_eq!(solve(1, best), solve(3, best));
    for isa in Isa::ALL.into_iter().filter(|&isa| isa <= Isa::detect()) {
        let plan = solve(1, isa);
        check(&plan, &mask);
        assert!(difference(&plan, &solve(1, best)) < 2e-3 / 203.0, "{}", isa.name());
    }
}

/// Rows settled and columns empty to the last bit, other rows summing to 1/N.
fn check<T: Real>(plan: &Plan<T>, mask: &Mask) {
    let p = 1.0 / plan.rows() as f64;
    for i in 0..plan.rows() {
        let row = plan.row(i);
        let sum: f64 = row.iter().map(|t| t.to_f64()).sum();
        assert!((sum - p).abs() < 1e-6, "row {i} sums to {sum}");
        assert!(mask.columns.iter().all(|&j| row[j] == T::ZERO), "row {i}");
    }
    for &(i, j) in &mask.rows {
        let want = |l| if l == j { T::from_f64(p) } else { T::ZERO };
        assert!(plan.row(i).iter().enumerate().all(|(l, &t)| t == want(l)), "row {i} is not settled");
    }
    assert!(mask.columns.iter().all(|&j| plan.column_mass()[j] == T::ZERO));
}
