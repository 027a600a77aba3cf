//! Plans on a support: with all entries the dense solution, with few nearly it; masks, threads, levels, warm starts.

use inkrig_transport::{
    Isa, LowRank, Mask, Mat, MmSinkhorn, Nystrom, Params, Plan, Problem, Real, SparseProblem,
    SparseWorkspace, Start, Support, Workspace, terms,
};

use crate::fixture::Curves;

const SIZE: (usize, usize) = (210, 190);

struct Sides<T> {
    control: LowRank<T>,
    source: LowRank<T>,
    cost: Mat<T>,
    bias: Mat<T>,
}

impl<T: Real> Sides<T> {
    fn new((n, m): (usize, usize), rank: usize) -> Self {
        let curves = Curves::new(n, m);
        let job = Nystrom { rank, landmarks: 4 * rank, threads: 1 };
        let fit = |at: &Mat<f64>| {
            let at = Mat::from_fn(at.rows(), at.cols(), |i, k| T::from_f64(at.row(i)[k]));
            job.fit_features(at.view(), 1.0).unwrap()
        };
        let number = |i: usize, j: usize, by: f64| T::from_f64(((i * 7 + j * 13) % 17) as f64 * by);
        Self {
            control: fit(&curves.control),
            source: fit(&curves.source),
            cost: Mat::from_fn(n, m, |i, j| number(i, j, 1.0 / 17.0)),
            bias: Mat::from_fn(n, m, |i, j| number(j, i, 0.01)),
        }
    }

    fn dense(&self, params: Params) -> Problem<'_, T> {
        let (control, source) = ((&self.control).into(), (&self.source).into());
        Problem::with_distances(control, source, Some(self.cost.view()), params)
            .and_then(|problem| problem.with_linear(self.bias.view()))
            .unwrap()
    }

    /// Cost and bias at the entries.
    fn at(&self, support: &Support) -> (Vec<T>, Vec<T>) {
        let read = |mat: &Mat<T>| {
            (0..support.rows())
                .flat_map(|i| support.row(i).iter().map(move |&j| mat.row(i)[j as usize]))
                .collect()
        };
        (read(&self.cost), read(&self.bias))
    }
}

fn difference<T: Real>(a: &Plan<T>, b: &Plan<T>) -> f64 {
    let (mut x, mut y) = (vec![T::ZERO; a.cols()], vec![T::ZERO; b.cols()]);
    let mut most = 0.0f64;
    for i in 0..a.rows() {
        a.row_into(i, &mut x);
        b.row_into(i, &mut y);
        most = x.iter().zip(&y).fold(most, |most, (x, y)| most.max((x.to_f64() - y.to_f64()).abs()));
    }
    most * a.rows() as f64
}

const SOLVER: MmSinkhorn = MmSinkhorn {
    iterations: 30,
    sweeps: 20,
    sweep_tolerance: 1e-2,
    mu: 0.05,
    start: Start::Independent,
    trace: 15,
    tolerance: 0.0,
    min_iterations: 20,
};

fn with_all_entries<T: Real>(limit: f64, plans: f64, mask: Option<&Mask>) {
    let sides = Sides::<T>::new(SIZE, 24);
    let support = Support::full(SIZE.0, SIZE.1).unwrap();
    let (cost, bias) = sides.at(&support);
    let params = Params { epsilon: 0.01, ..Params::default() };
    let mut dense = sides.dense(params);
    let mut sparse = SparseProblem::new(&sides.control, &sides.source, &support, Some(&cost), params)
        .and_then(|problem| problem.with_linear(&bias))
        .unwrap();
    if let Some(mask) = mask {
        (dense, sparse) = (dense.with_mask(mask).unwrap(), sparse.with_mask(mask).unwrap());
    }
    let (mut workspace, mut few) = (Workspace::new(1), SparseWorkspace::new(1));
    let want = SOLVER.solve(&dense, &mut workspace).unwrap();
    let got = SOLVER.solve_sparse(&sparse, &mut few).unwrap();
    assert_eq!((want.iterations, want.records.len()), (got.iterations, got.records.len()));
    for (want, got) in want.records.iter().zip(&got.records) {
        let (a, b) = (want.terms, got.terms);
        println!("{} {:.6} {:+.1e}", want.iteration, a.objective, b.objective - a.objective);
        for (a, b) in
            [(a.objective, b.objective), (a.gw, b.gw), (a.w, b.w), (a.linear, b.linear), (a.kl, b.kl)]
        {
            assert!((a - b).abs() < limit, "{want:?} {got:?}");
        }
        assert!((a.entropy - b.entropy).abs() < 1e2 * limit, "{want:?} {got:?}");
    }
    let off = difference(workspace.plan(), few.plan());
    assert!(off < plans, "plans differ by {off:e} of a row");
    assert_eq!(few.plan().support().map(Support::rows), Some(SIZE.0));
    let judged = terms(&dense, few.plan().clone().into_mat().view()).unwrap().objective;
    assert!((judged - got.last().unwrap().objective).abs() < limit);
    assert!(
        (sparse.terms(workspace.plan()).unwrap().objective - want.last().unwrap().objective).abs() < limit
    );
}

#[test]
fn all_entries_give_the_dense_solution() {
    with_all_entries::<f64>(1e-9, 1e-6, None);
    with_all_entries::<f32>(1e-5, 1e-2, None);
}

#[test]
fn masks_hold_and_give_the_dense_solution() {
    let mask = Mask { rows: vec![(0, 189), (100, 4)], columns: (20..60).collect() };
    with_all_entries::<f64>(1e-9, 1e-6, Some(&mask));
    with_all_entries::<f32>(1e-5, 1e-2, Some(&mask));
    let sides = Sides::<f32>::new(SIZE, 8);
    let near =
        |i: usize, out: &mut Vec<usize>| out.extend((i / 2).saturating_sub(10)..(i / 2 + 11).min(SIZE.1));
    let support = Support::from_rows(SIZE.0, SIZE.1, near).unwrap();
    let (cost, _) = sides.at(&support);
    let params = Params::default();
    let free = SparseProblem::new(&sides.control, &sides.source, &support, Some(&cost), params).unwrap();
    let error = free.with_mask(&mask).unwrap_err().to_string();
    assert!(error.contains("no column is left for row 60"), "{error}");
    let mask = Mask { columns: vec![7, 30], ..mask };
    let mut workspace = SparseWorkspace::new(1);
    for start in [Start::Independent, Start::Perturbed(3), Start::Continue] {
        for iterations in [0, 1, 5] {
            let solver = MmSinkhorn { iterations, start, ..SOLVER };
            SOLVER.solve_sparse(&free, &mut workspace).unwrap();
            solver.solve_sparse(&free.with_mask(&mask).unwrap(), &mut workspace).unwrap();
            let plan = workspace.plan();
            assert!(plan.column_mass()[7] == 0.0 && plan.column_mass()[30] == 0.0);
            let p = 1.0 / SIZE.0 as f32;
            assert_eq!(plan.entries(0).collect::<Vec<_>>(), [(189, p)]);
            assert_eq!(plan.entries(100).collect::<Vec<_>>(), [(4, p)]);
            for i in 0..SIZE.0 {
                let sum: f32 = plan.entries(i).map(|(_, t)| t).sum();
                assert!((sum - p).abs() < 1e-6, "row {i}: {sum}");
            }
        }
    }
}

/// Judged by the same objective: rank 32 and dense, against rank 32 on the support that a coarser plan suggests.
#[test]
fn a_support_from_a_coarser_plan_costs_little() {
    let params = Params { alpha: 1.0, ..Params::default() };
    let coarse = Sides::<f32>::new((150, 130), 32);
    let (control, source) = ((&coarse.control).into(), (&coarse.source).into());
    let problem = Problem::with_distances(control, source, None, params).unwrap();
    let mut workspace = Workspace::new(2);
    MmSinkhorn::default().solve(&problem, &mut workspace).unwrap();
    let (n, m) = (450, 400);
    let support = Support::from_coarse(workspace.plan(), n, m, 12, 2).unwrap();
    let share = support.len() as f64 / (n * m) as f64;
    let fine = Sides::<f32>::new((n, m), 32);
    let (control, source) = ((&fine.control).into(), (&fine.source).into());
    let dense = Problem::with_distances(control, source, None, params).unwrap();
    MmSinkhorn::default().solve(&dense, &mut workspace).unwrap();
    let want = terms(&dense, workspace.plan().dense()).unwrap().objective;
    let sparse = SparseProblem::new(&fine.control, &fine.source, &support, None, params).unwrap();
    let mut few = SparseWorkspace::new(2);
    MmSinkhorn { iterations: 20, ..MmSinkhorn::default() }.solve_sparse(&sparse, &mut few).unwrap();
    let got = sparse.terms(few.plan()).unwrap().objective;
    println!(
        "{} a row, {share:.3} of all: {got:.5}, dense {want:.5}, gap {:+.5}",
        support.len() / n,
        got - want
    );
    assert!(got - want < 0.02 && share < 0.35, "{got} {want} {share}");
}

#[test]
fn threads_never_show_and_levels_agree() {
    let sides = Sides::<f32>::new(SIZE, 20);
    let support = Support::from_rows(SIZE.0, SIZE.1, |i, out| {
        out.extend((0..SIZE.1).filter(|j| (i * 31 + j * 17) % 5 < 2));
    })
    .unwrap();
    let (cost, _) = sides.at(&support);
    let params = Params { epsilon: 0.02, ..Params::default() };
    let problem = SparseProblem::new(&sides.control, &sides.source, &support, Some(&cost), params).unwrap();
    let solve = |threads, isa| {
        let mut workspace = SparseWorkspace::new(threads);
        workspace.set_isa(isa);
        MmSinkhorn { iterations: 6, ..SOLVER }.solve_sparse(&problem, &mut workspace).unwrap();
        workspace.take_plan()
    };
    let want = solve(1, Isa::current());
    for threads in [2, 3, 8] {
        assert_eq!(want, solve(threads, Isa::current()), "{threads} threads");
    }
    for isa in Isa::ALL.into_iter().filter(|&isa| isa <= Isa::detect()) {
        let off = difference(&want, &solve(1, isa));
        assert!(off < 2e-3, "{}: {off:e}", isa.name());
    }
}

#[test]
fn warm_starts_go_on_and_move_to_another_support() {
    let sides = Sides::<f64>::new((60, 50), 12);
    let band = |width: usize| {
        Support::from_rows(60, 50, move |i, out| {
            let at = i * 50 / 60;
            out.extend(at.saturating_sub(width)..(at + width + 1).min(50));
        })
        .unwrap()
    };
    let params = Params { alpha: 1.0, ..Params::default() };
    let (wide, narrow) = (band(20), band(4));
    let on = |support| SparseProblem::new(&sides.control, &sides.source, support, None, params).unwrap();
    let half = MmSinkhorn { iterations: 10, trace: 0, ..SOLVER };
    let go_on = MmSinkhorn { start: Start::Continue, ..half };
    let (mut whole, mut halves) = (SparseWorkspace::new(1), SparseWorkspace::new(1));
    MmSinkhorn { iterations: 20, ..half }.solve_sparse(&on(&wide), &mut whole).unwrap();
    half.solve_sparse(&on(&wide), &mut halves).unwrap();
    go_on.solve_sparse(&on(&wide), &mut halves).unwrap();
    assert_eq!(whole.plan(), halves.plan());
    // On a smaller support rows are whole again, even without an iteration; a dense plan is taken too.
    for from in [whole.take_plan(), Plan::from_mat(halves.take_plan().into_mat())] {
        halves.resume(&from);
        MmSinkhorn { iterations: 0, ..go_on }.solve_sparse(&on(&narrow), &mut halves).unwrap();
        for i in 0..60 {
            let sum: f64 = halves.plan().entries(i).map(|(_, t)| t).sum();
            assert!((sum - 1.0 / 60.0).abs() < 1e-12 && halves.plan().entries(i).count() <= 9);
        }
    }
    let error = go_on.solve_sparse(&on(&wide), &mut SparseWorkspace::new(1)).unwrap_err();
    assert!(error.to_string().contains("0 x 0 plan"));
}

#[test]
fn what_does_not_fit_is_refused() {
    let sides = Sides::<f32>::new((6, 5), 2);
    let support = Support::from_rows(6, 5, |i, out| out.extend([i % 5, 4])).unwrap();
    let new = |support: &Support, cost: Option<&[f32]>, params| {
        SparseProblem::new(&sides.control, &sides.source, support, cost, params)
            .map(|_| ())
            .unwrap_err()
            .to_string()
    };
    let params = Params::default();
    assert!(new(&Support::full(5, 6).unwrap(), None, params).contains("`support` is 5 x 6, expected 6 x 5"));
    assert!(new(&support, None, params).contains("no cost matrix"));
    assert!(new(&support, Some(&[0.0; 3]), params).contains("`cost` is 3 x 1, expected 11 x 1"));
    let mut cost = [0.5f32; 11];
    cost[8] = -1.0;
    assert!(new(&support, Some(&cost), params).contains("-1 at row 4, column 4"));
    let good = SparseProblem::new(&sides.control, &sides.source, &support, Some(&[0.5; 11]), params).unwrap();
    assert!(good.with_linear(&[f32::NAN; 11]).unwrap_err().to_string().contains("NaN at row 0, column 0"));
    assert!(good.with_linear(&[0.0; 12]).is_err());
}

#[test]
fn the_gradient_is_that_of_the_definition_also_off_the_support() {
    let (n, m) = (90, 70);
    let sides = Sides::<f64>::new((n, m), 12);
    let support =
        Support::from_rows(n, m, |i, out| out.extend([i % m, (i * 5 + 3) % m, (i / 2) % m])).unwrap();
    let (cost, _) = sides.at(&support);
    let params = Params::default();
    let mask = Mask { rows: vec![(4, 60)], columns: vec![7] };
    let problem = SparseProblem::new(&sides.control, &sides.source, &support, Some(&cost), params)
        .and_then(|problem| problem.with_mask(&mask))
        .unwrap();
    let mut workspace = SparseWorkspace::new(1);
    SOLVER.solve_sparse(&problem, &mut workspace).unwrap();
    let plan = workspace.plan().clone().into_mat();
    let mass: Vec<f64> = (0..m).map(|j| (0..n).map(|i| plan.row(i)[j]).sum()).collect();
    let mut got = Mat::<f64>::zeros(n, m);
    let gradient = workspace.gradient(&problem).unwrap();
    gradient.write(0, &mut got.as_mut_slice()[..50 * m]);
    gradient.write(50, &mut got.as_mut_slice()[50 * m..]);
    let moved =
        Mat::from_fn(n, m, |i, l| (0..n).map(|k| sides.control.distance(i, k) * plan.row(k)[l]).sum::<f64>());
    let even = 1.0 / (m - 1) as f64;
    for i in 0..n {
        for j in 0..m {
            if j == 7 {
                assert!(got.row(i)[j] > 1e20);
                continue;
            }
            let squares: f64 = (0..m).map(|l| sides.source.distance(j, l).powi(2) * mass[l]).sum();
            let cross: f64 = (0..m).map(|l| moved.row(i)[l] * sides.source.distance(l, j)).sum();
            let pull = params.lambda * (mass[j] / even).max(0.1).ln();
            let want = 2.0 * params.alpha * (squares - 2.0 * cross) + pull;
            assert!((got.row(i)[j] - want).abs() < 1e-9, "{i} {j}: {} {want}", got.row(i)[j]);
        }
    }
    assert!(SparseWorkspace::<f64>::new(1).gradient(&problem).is_err());
}
