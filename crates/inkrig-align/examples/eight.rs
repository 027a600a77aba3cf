//! x
use inkrig_align::*;
fn main() {
    let clip = inkrig_formats::read_bvh(inkrig_samples::find("quadruped").unwrap().bytes, &Default::default()).unwrap().clip;
    for laps in [4, 6] {
        let control = Control::from_curve(&inkrig_sketch::shapes::figure_of_eight(laps, 300).unwrap(), &CurveOptions::default()).unwrap();
        let b = Options::default;
        let mut v = vec![];
        for polish in 0..4 { v.push((format!("polish {polish}"), Options { polish, ..b() })); }
        for seed in 1..5 { v.push((format!("seed {seed}"), Options { seed, ..b() })); }
        for e in [0.001, 0.002, 0.01, 0.02] { v.push((format!("eps {e}"), Options { epsilon: e, ..b() })); }
        for l in [0.01, 0.1, 0.2] { v.push((format!("lambda {l}"), Options { lambda: l, ..b() })); }
        for f in [60, 100, 200] { v.push((format!("first {f}"), Options { first_iterations: f, ..b() })); }
        v.push(("it 20".into(), Options { iterations: 20, ..b() }));
        v.push(("rounds 6".into(), Options { rounds: 6, ..b() }));
        v.push(("levels 1".into(), Options { levels: 1, first_iterations: 60, ..b() }));
        for (name, options) in v {
        let r = align(&clip, &control, &options, &mut |_| std::ops::ControlFlow::Continue(())).unwrap().report;
        println!("laps {laps} {name} P {:.3} S {:.3} warp {:.3} nn {:.3} cov {:.2} speed {:.2} jump {:.2} jerk {:.2} freeze {:.2}/{:.2}", r.structure_pearson, r.structure_spearman, r.structure_pearson_warp, r.nearest_patch, r.coverage, r.speed_mean_ratio, r.jump_q999_ratio, r.jerk_ratio, r.freeze, r.freeze_source);
    }}
}
