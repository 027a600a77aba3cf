//! Measures, losses and the evaluator against results of the published code.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod reference;

use inkrig_generate::losses::{contrast, divergence, smooth_l1, squared};
use inkrig_generate::measures::{
    Evaluator, WORDS, area_under_jerk, control_errors, frechet_distance, jerk, mean_jerk, peak_jerk,
    pose_error, retrieval, skating,
};
use inkrig_generate::networks::TensorSpec;
use inkrig_generate::weights::{Tensors, hashed_tensor};
use inkrig_motion::Features;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{JOINTS, Joints, Statistics, WIDTH, recover_positions};
use reference::{Vectors, assert_near};

fn clips(numbers: &[f32], frames: usize) -> Vec<Vec<Joints>> {
    let joints: Vec<Vec3> = numbers.as_chunks::<3>().0.iter().map(|place| Vec3::from(*place)).collect();
    let frames_of: Vec<Joints> =
        joints.chunks_exact(JOINTS).map(|joints| joints.try_into().unwrap()).collect();
    frames_of.chunks_exact(frames).map(<[Joints]>::to_vec).collect()
}

fn single(values: impl IntoIterator<Item = f64>) -> Vec<f32> {
    values.into_iter().map(|value| value as f32).collect()
}

#[test]
fn measures_are_those_of_the_published_code() {
    let Some(file) = Vectors::open("metrics") else { return };
    let clips = clips(&file.numbers("joints"), 40);
    let slides: Vec<_> = clips.iter().map(|clip| skating(clip)).collect();
    assert_near(
        "skating",
        &single(slides.iter().map(|slides| slides.ratio)),
        &file.numbers("skating_ratio"),
        1e-6,
    );
    let speeds = slides.iter().flat_map(|slides| slides.speeds.iter().flatten().copied());
    assert_near("speeds of feet", &single(speeds), &file.numbers("skate_vel"), 1e-5);
    let errors = clips[0].iter().zip(&clips[1]).map(|(a, b)| pose_error(a, b));
    assert_near("MPJPE", &single(errors), &file.numbers("mpjpe_per_frame_0_vs_1"), 1e-5);

    let mask = file.numbers("control_mask");
    let asked: Vec<[Option<Vec3>; JOINTS]> = (0..40)
        .map(|frame| {
            std::array::from_fn(|joint| (mask[frame * JOINTS + joint] > 0.0).then(|| clips[0][frame][joint]))
        })
        .collect();
    let errors = control_errors(&clips[1], &asked).unwrap();
    assert_near("Avg. Err.", &single([errors.mean]), &file.numbers("control_mean_err"), 1e-5);
    let truth = |failed: bool| f64::from(u8::from(failed));
    let [a, b] = errors.failed;
    let [c, d] = errors.places_failed;
    assert_near(
        "failures",
        &single([truth(a), truth(b), c, d, errors.mean]),
        &file.numbers("traj_err_5"),
        1e-5,
    );

    let fid = frechet_distance(&file.numbers("act_gt"), &file.numbers("act_gen"), 16).unwrap();
    assert_near("FID", &single([fid]), &file.numbers("fid_gt_gen"), 1e-4);
    let found = retrieval(&file.numbers("rp_text"), &file.numbers("rp_motion"), 16, 32).unwrap();
    let counts = found.precision.map(|share| share * 32.0);
    assert_near("R-precision", &single(counts), &file.numbers("rp_topk_counts"), 1e-6);
    // The published sum over the group, or its mean.
    let expected = file.numbers("mm_dist")[0];
    let scale = if expected > 2.0 * found.distance as f32 { 32.0 } else { 1.0 };
    assert_near("MM-Dist", &single([found.distance * scale]), &[expected], 1e-5);
}

#[test]
fn jerk_is_that_of_the_published_code() {
    let Some(file) = Vectors::open("jerk") else { return };
    let curves: Vec<Vec<f64>> = clips(&file.numbers("joints"), 60).iter().map(|clip| jerk(clip)).collect();
    assert_near(
        "jerk",
        &single(curves.iter().flatten().copied()),
        &file.numbers("jerk_max_over_joints"),
        1e-5,
    );
    let mean = mean_jerk(&curves);
    assert_near("mean jerk", &single(mean.iter().copied()), &file.numbers("mean_curve"), 1e-5);
    assert_near("AUJ", &single([area_under_jerk(&mean)]), &file.numbers("auj"), 1e-5);
    assert_near("PJ", &single([peak_jerk(&mean)]), &file.numbers("pj"), 1e-5);
}

#[test]
fn losses_are_those_of_the_published_code() {
    let Some(file) = Vectors::open("losses") else { return };
    let (made, wanted) = (file.numbers("feats_pred"), file.numbers("feats_ref"));
    let near =
        |what: &str, got: f64, name: &str| assert_near(what, &single([got]), &file.numbers(name), 1e-5);
    near("features", smooth_l1(&made, &wanted).unwrap(), "vae_feat_smooth_l1");
    let (flat, solid) = (file.numbers("emb_2d"), file.numbers("emb_3d"));
    near("match", squared(&flat, &solid).unwrap(), "align_mse");
    // The published one, 8e-5, is a difference of numbers near 1 in single precision; in double precision it is ours.
    let lost = contrast(&solid, &flat, 256, 0.07).unwrap();
    assert_near("contrast", &single([lost]), &file.numbers("info_nce_tau0.07_3d_to_2d"), 1e-4);
    near("divergence", divergence(&file.numbers("kl_mu"), &file.numbers("kl_logvar")).unwrap(), "kl_mean");
    let recover = Vectors::open("recover").unwrap();
    let statistics = Statistics::new(recover.numbers("mean"), recover.numbers("std")).unwrap();
    let places = |rows: &[f32]| -> Vec<f32> {
        let clip = |rows: &[f32]| {
            let mut rows = rows.to_vec();
            statistics.restore(&mut rows);
            let features = Features::new(rows, WIDTH).unwrap();
            recover_positions(&features)
                .unwrap()
                .into_iter()
                .flatten()
                .flat_map(|place| place.to_array())
                .collect::<Vec<_>>()
        };
        rows.chunks_exact(40 * WIDTH).flat_map(clip).collect()
    };
    near("joints", smooth_l1(&places(&made), &places(&wanted)).unwrap(), "vae_joint_smooth_l1");
}

/// Names and shapes of the evaluator.
fn evaluator() -> Tensors {
    let mut specs: Vec<(String, Vec<usize>)> = Vec::new();
    let mut linear = |name: &str, shape: &[usize]| {
        specs.push((format!("{name}.weight"), shape.to_vec()));
        specs.push((format!("{name}.bias"), vec![shape[0]]));
    };
    linear("t2m_moveencoder.main.0", &[512, 259, 4]);
    linear("t2m_moveencoder.main.3", &[512, 512, 4]);
    linear("t2m_moveencoder.out_net", &[512, 512]);
    linear("t2m_textencoder.pos_emb", &[300, 15]);
    for (name, width, state) in [("t2m_motionencoder", 512, 1024), ("t2m_textencoder", 300, 512)] {
        linear(&format!("{name}.input_emb"), &[state, width]);
        linear(&format!("{name}.output_net.0"), &[state, 2 * state]);
        linear(&format!("{name}.output_net.1"), &[state]);
        linear(&format!("{name}.output_net.3"), &[512, state]);
    }
    for (name, state) in [("t2m_motionencoder", 1024), ("t2m_textencoder", 512)] {
        specs.push((format!("{name}.hidden"), vec![2, 1, state]));
        for ending in ["", "_reverse"] {
            for kind in ["ih", "hh"] {
                specs.push((format!("{name}.gru.weight_{kind}_l0{ending}"), vec![3 * state, state]));
                specs.push((format!("{name}.gru.bias_{kind}_l0{ending}"), vec![3 * state]));
            }
        }
    }
    let fill = |(name, shape): (String, Vec<usize>)| {
        let tensor = hashed_tensor(&TensorSpec { name: name.clone(), shape, used: true });
        (name, tensor)
    };
    specs.into_iter().map(fill).collect()
}

#[test]
fn the_evaluator_is_the_published_one() {
    let weights = evaluator();
    assert_eq!((weights.len(), weights.numbers()), (42, 1_842_688 + 15_747_584 + 4_100_288));
    let evaluator = Evaluator::new(&weights).unwrap();
    assert!(evaluator.motion(&[0.0; 3 * WIDTH]).is_err() && evaluator.text(&[], &[]).is_err());
    let Some(file) = Vectors::open("t2m_evaluator") else { return };
    let motions = file.numbers("motion");
    let (mut movements, mut embeddings, mut texts) = (Vec::new(), Vec::new(), Vec::new());
    let steps = file.whole("motion_lens_div4");
    for (motion, steps) in motions.chunks_exact(40 * WIDTH).zip(&steps) {
        let movement = evaluator.movement(motion).unwrap();
        movements.extend_from_slice(&movement);
        // The published code reads all frames into steps and then leaves out those beyond the length; its last steps see the padding.
        embeddings.extend(evaluator.motion_of_steps(&movement[..steps * 512]));
    }
    assert_near("movements", &movements, &file.numbers("movement"), 1e-5);
    assert_near("motions", &embeddings, &file.numbers("motion_embedding"), 1e-5);
    let (words, kinds) = (file.numbers("word_embs"), file.numbers("pos_onehot"));
    let sizes = WORDS.map(|width| 22 * width);
    for ((words, kinds), &length) in
        words.chunks_exact(sizes[0]).zip(kinds.chunks_exact(sizes[1])).zip(&file.whole("text_lens"))
    {
        texts.extend(evaluator.text(&words[..length * WORDS[0]], &kinds[..length * WORDS[1]]).unwrap());
    }
    assert_near("texts", &texts, &file.numbers("text_embedding"), 1e-5);
}
