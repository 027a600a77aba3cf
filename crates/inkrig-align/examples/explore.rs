//! Exploration (not kept).
use inkrig_align::{Control, CurveOptions, Options, align};
use inkrig_motion::*;
use inkrig_sketch::Curve;

fn circles(n: usize, turns: f64) -> Curve {
    Curve::new(
        (0..n)
            .map(|i| {
                let u = i as f64 / (n - 1) as f64;
                let a = u * turns * std::f64::consts::TAU;
                let r = 0.2 + u;
                [r * a.cos(), r * a.sin()]
            })
            .collect(),
    )
    .unwrap()
}
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let refs = "/work/shared/data";
    let cases = [
        ("salsa01", format!("{refs}/cmu-dance/salsa/01.bvh"), 600usize, circles(300, 5.0)),
        ("35_29", format!("{refs}/cmu/35/35_29.bvh"), 0, circles(200, 5.0)),
        ("indian", format!("{refs}/cmu-dance/indian/04.bvh"), 600, circles(300, 5.0)),
        ("martial08", format!("{refs}/cmu-dance/martial/08.bvh"), 600, circles(300, 5.0)),
    ];
    let mut variants: Vec<(String, Options)> = vec![("default".into(), Options::default())];
    let mode = args.get(1).map(String::as_str).unwrap_or("");
    let base = Options::default;
    match mode {
        "feat" => {
            for (rn, r) in [("local", RotationSpace::Local), ("root", RotationSpace::Root)] {
                for (vn, v) in [("world", VelocityFrame::World), ("heading", VelocityFrame::Heading)] {
                    for (tn, t) in [("tw", VelocityFrame::World), ("th", VelocityFrame::Heading)] {
                        variants.push((
                            format!("{rn} {vn} {tn}"),
                            Options {
                                features: FeatureOptions { rotation_space: r, velocity_frame: v },
                                travel: t,
                                ..base()
                            },
                        ));
                    }
                }
            }
        }
        "sched" => {
            for (l, r, it, f) in [
                (6, 3, 6, 24),
                (6, 6, 3, 24),
                (6, 2, 9, 24),
                (6, 4, 4, 36),
                (6, 3, 6, 60),
                (4, 4, 6, 36),
                (3, 6, 6, 24),
                (6, 10, 6, 60),
                (1, 18, 6, 24),
            ] {
                variants.push((
                    format!("L{l} R{r} it{it} f{f}"),
                    Options { levels: l, rounds: r, iterations: it, first_iterations: f, ..base() },
                ));
            }
            for p in [0, 1, 2, 3] {
                variants.push((format!("polish {p}"), Options { polish: p, ..base() }));
            }
        }
        "par" => {
            for a in [0.5, 0.7, 0.8, 0.95] {
                variants.push((format!("alpha {a}"), Options { alpha: a, ..base() }));
            }
            for l in [0.01, 0.15, 0.3, 1.0] {
                variants.push((format!("lambda {l}"), Options { lambda: l, ..base() }));
            }
            for e in [0.001, 0.002, 0.01] {
                variants.push((format!("eps {e}"), Options { epsilon: e, ..base() }));
            }
            for s in [1, 2, 3] {
                variants.push((format!("seed {s}"), Options { seed: s, ..base() }));
            }
        }
        _ => {}
    }
    for (name, path, cut, curve) in &cases {
        let bytes = std::fs::read(path).unwrap();
        let import = inkrig_formats::read_bvh(&bytes, &Default::default()).unwrap();
        let mut clip = import.clip;
        if *cut > 0 {
            clip = time::trim(&clip, 0..*cut).unwrap();
        }
        let control = Control::from_curve(curve, &CurveOptions::default()).unwrap();
        println!("{name}: {} frames, {} Hz", clip.frames(), clip.frame_rate());
        for (label, options) in &variants {
            let a = align(&clip, &control, options, &mut |_| std::ops::ControlFlow::Continue(())).unwrap();
            let r = &a.report;
            println!(
                "  {label:24} P {:.3} S {:.3} warp {:.3} nn {:.3} cov {:.2} speed {:.2} jump {:.2} jerk {:.2} freeze {:.2}/{:.2} grad {} {:.0} ms en {:.4} lead {}",
                r.structure_pearson,
                r.structure_spearman,
                r.structure_pearson_warp,
                r.nearest_patch,
                r.coverage,
                r.speed_mean_ratio,
                r.jump_q999_ratio,
                r.jerk_ratio,
                r.freeze,
                r.freeze_source,
                r.gradients,
                r.solve_seconds * 1e3,
                r.feature_energy,
                r.rest_pose_frames
            );
        }
    }
}
