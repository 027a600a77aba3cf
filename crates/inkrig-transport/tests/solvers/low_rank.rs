//! Distances by factors: the same solution as with the matrix they stand for, and nearly that of the exact distances.

use inkrig_transport::{
    Distances, Isa, LowRank, Mat, MirrorDescent, MmSinkhorn, Nystrom, Params, Plan, Problem, Real, Workspace,
    terms,
};

use crate::fixture::Curves;

fn whole<T: Real>(low: &LowRank<T>) -> Mat<T> {
    Mat::from_fn(low.len(), low.len(), |i, j| low.distance(i, j))
}

fn difference<T: Real>(a: &Plan<T>, b: &Plan<T>) -> f64 {
    let pairs = a.dense().as_slice().iter().zip(b.dense().as_slice());
    pairs.map(|(a, b)| (a.to_f64() - b.to_f64()).abs()).fold(0.0, f64::max) * a.rows() as f64
}

#[test]
fn factors_solve_as_the_matrix_they_stand_for() {
    let curves = Curves::new(130, 170);
    let job = Nystrom { rank: 10, landmarks: 40, threads: 1 };
    let (control, source) =
        (job.fit_features(curves.control.view(), 1.0), job.fit_features(curves.source.view(), 1.0));
    let (control, source) = (control.unwrap(), source.unwrap());
    let (all_control, all_source) = (whole(&control), whole(&source));
    let cost = Mat::from_fn(130, 170, |i, j| ((i * 7 + j * 13) % 17) as f64 / 17.0);
    let params = Params { epsilon: 0.02, ..Params::default() };
    let problem =
        |control, source| Problem::with_distances(control, source, Some(cost.view()), params).unwrap();
    let (y, x): ([Distances<'_, f64>; 2], [Distances<'_, f64>; 2]) =
        ([all_control.view().into(), (&control).into()], [all_source.view().into(), (&source).into()]);
    let want = solve(&problem(y[0], x[0]), 1);
    let want_terms = terms(&problem(y[0], x[0]), want.0.dense()).unwrap();
    for (y, x) in [(y[0], x[1]), (y[1], x[0]), (y[1], x[1])] {
        let problem = problem(y, x);
        let got = solve(&problem, 1);
        assert!(difference(&got.0, &want.0) < 1e-9 && difference(&got.1, &want.1) < 1e-9);
        let got_terms = terms(&problem, want.0.dense()).unwrap();
        assert!((got_terms.gw - want_terms.gw).abs() < 1e-12, "{got_terms:?} {want_terms:?}");
        assert_eq!(got, solve(&problem, 3));
    }
}

fn solve<T: Real>(problem: &Problem<'_, T>, threads: usize) -> (Plan<T>, Plan<T>) {
    let mut workspace = Workspace::new(threads);
    MmSinkhorn { iterations: 8, ..MmSinkhorn::default() }.solve(problem, &mut workspace).unwrap();
    let mm = workspace.take_plan();
    MirrorDescent { iterations: 5, ..MirrorDescent::default() }.solve(problem, &mut workspace).unwrap();
    (mm, workspace.take_plan())
}

#[test]
fn single_precision_and_every_level_agree() {
    let curves = Curves::new(130, 170);
    let job = Nystrom { rank: 20, landmarks: 80, threads: 1 };
    let double = [&curves.control, &curves.source].map(|at| job.fit_features(at.view(), 1.0).unwrap());
    let single = [&curves.control, &curves.source].map(|at| {
        let at = Mat::from_fn(at.rows(), at.cols(), |i, j| at.row(i)[j] as f32);
        job.fit_features(at.view(), 1.0).unwrap()
    });
    let params = Params { alpha: 1.0, epsilon: 0.02, ..Params::default() };
    let problem = Problem::with_distances((&double[0]).into(), (&double[1]).into(), None, params).unwrap();
    let want = terms(&problem, solve(&problem, 1).0.dense()).unwrap().objective;
    let problem = Problem::with_distances((&single[0]).into(), (&single[1]).into(), None, params).unwrap();
    for isa in Isa::ALL.into_iter().filter(|&isa| isa <= Isa::detect()) {
        let mut workspace = Workspace::new(1);
        workspace.set_isa(isa);
        MmSinkhorn { iterations: 8, ..MmSinkhorn::default() }.solve(&problem, &mut workspace).unwrap();
        let got = terms(&problem, workspace.plan().dense()).unwrap().objective;
        println!("{}: {got} in f64 {want}", isa.name());
        assert!((got - want).abs() < 1e-4, "{}: {got} {want}", isa.name());
    }
}

/// Both plans are judged by the exact objective.
#[test]
fn rank_32_costs_little() {
    let curves = Curves::new(220, 260);
    let (control, source) = (curves.control_distances(), curves.source_distances());
    for epsilon in [0.005, 0.02] {
        let params = Params { alpha: 1.0, lambda: 0.05, epsilon };
        let exact = Problem::new(control.view(), source.view(), None, params).unwrap();
        let objective = |plan: &Plan<f64>| terms(&exact, plan.dense()).unwrap().objective;
        let mut workspace = Workspace::new(2);
        MmSinkhorn::default().solve(&exact, &mut workspace).unwrap();
        let want = objective(workspace.plan());
        for rank in [8, 16, 32] {
            let job = Nystrom { rank, ..Nystrom::default() };
            let low = [&curves.control, &curves.source].map(|at| job.fit_features(at.view(), 1.0).unwrap());
            let problem = Problem::with_distances((&low[0]).into(), (&low[1]).into(), None, params).unwrap();
            MmSinkhorn::default().solve(&problem, &mut workspace).unwrap();
            let gap = objective(workspace.plan()) - want;
            println!("epsilon {epsilon} rank {rank}: {want:.5} {gap:+.5}");
            assert!(rank < 32 || gap < 0.02, "epsilon {epsilon}: {want} {gap:+}");
        }
    }
}
