//! What is measured of a model on held-out clips. The networks are tiny and their weights are random: figures are bad, and that has to
//! show.
#![allow(clippy::unwrap_used)]

use inkrig_generate::networks::{Parts, Sizes};
use inkrig_generate::sampling::{Networks, Sampler, SamplingOptions, Steps};
use inkrig_generate::text::{VERBS, VerbTable};
use inkrig_generate::weights::{Tensor, hashed};
use inkrig_motion::Features;
use inkrig_motion::humanml::{JOINTS, Statistics, WIDTH, recover_positions};
use inkrig_train::TrainError;
use inkrig_train::evaluation::{
    ControlOptions, ControlTable, EvaluationWindow, Protocol, bounds, control, reconstruction,
};

fn window(subject: &str, forward: f32) -> EvaluationWindow {
    let row = |frame: usize| {
        let mut row = vec![0.0_f32; WIDTH];
        (row[2], row[3]) = (forward, 0.9);
        for joint in 1..JOINTS {
            let wave = (frame as f32 * 0.3 + joint as f32).sin();
            row[1 + 3 * joint..4 + 3 * joint].copy_from_slice(&[0.1 * joint as f32, 0.9, 0.1 * wave]);
        }
        row
    };
    let features: Vec<f32> = (0..20).flat_map(row).collect();
    let joints = recover_positions(&Features::new(features.clone(), WIDTH).unwrap()).unwrap();
    let (source, actions) = ("own".into(), vec!["walk".into()]);
    EvaluationWindow { source, subject: subject.into(), actions, features, joints, key_pose: 7 }
}

struct Setup {
    networks: Networks,
    features: Statistics,
    places: Statistics,
    texts: VerbTable,
}

fn setup() -> Setup {
    let sizes = Sizes { guidance_width: 0, ..Sizes::tiny() };
    let mut weights = hashed(&sizes, Parts::ALL);
    let width = sizes.text_width;
    let table = Tensor::new(vec![VERBS.len(), width], vec![0.1; VERBS.len() * width]).unwrap();
    weights.insert(VerbTable::VERBS, table);
    weights.insert(VerbTable::NOTHING, Tensor::new(vec![width], vec![0.0; width]).unwrap());
    Setup {
        networks: Networks::new(&sizes, &weights).unwrap(),
        features: Statistics::new(vec![0.0; WIDTH], vec![0.2; WIDTH]).unwrap(),
        places: Statistics::new(vec![0.0; 3 * JOINTS], vec![1.0; 3 * JOINTS]).unwrap(),
        texts: VerbTable::new(&weights, width).unwrap(),
    }
}

#[test]
fn real_motion_has_no_errors_and_a_random_model_has_large_ones() {
    let setup = setup();
    let windows = [window("a", 0.02), window("b", 0.05)];
    let nothing = vec![0.0; 24];
    let sampler = Sampler { networks: &setup.networks, features: &setup.features, no_text: &nothing };
    let sampling = SamplingOptions { steps: Steps::Ddim(2), guidance: None, ..SamplingOptions::default() };
    let mut table = ControlTable { rows: Vec::new() };
    for (protocol, clips) in [(Protocol::Average, 12), (Protocol::Cross, 2)] {
        let options =
            |plane| ControlOptions { protocol, plane, footing: plane, sampling: sampling.clone(), seed: 3 };
        let [real, back] = bounds(&setup.networks.vae, &setup.features, &windows, &options(false)).unwrap();
        assert_eq!((real.clips, real.pose, real.places, real.failed), (clips, [0.0; 2], [0.0; 2], [0.0; 2]));
        assert!(back.pose[0] > 0.05 && back.places[0] > 0.05);
        for plane in [false, true] {
            let run = || {
                control(&sampler, &setup.places, &setup.texts, &windows, &options(plane), &|done, all| {
                    assert!(done <= all);
                    true
                })
                .unwrap()
            };
            let row = run();
            assert_eq!(row, run(), "the same seed gives the same");
            assert_eq!(row.clips, clips);
            // The picture loses a dimension, and distances only become smaller by it.
            assert!(row.pose[0] > 0.05 && row.pose[1] < row.pose[0] && row.places[1] < row.places[0]);
            table.rows.push((format!("plane {plane}"), protocol, row));
        }
    }
    assert_eq!(table.text().lines().count(), 6);
    let options =
        ControlOptions { protocol: Protocol::Cross, plane: false, footing: true, sampling, seed: 3 };
    let stopped = control(&sampler, &setup.places, &setup.texts, &windows, &options, &|_, _| false);
    assert!(matches!(stopped, Err(TrainError::Stopped)));
}

#[test]
fn reconstruction_is_told_by_subject() {
    let setup = setup();
    let windows = [window("a", 0.02), window("b", 0.05), window("b", 0.04)];
    let rows = reconstruction(&setup.networks.vae, &setup.features, &windows).unwrap();
    let names: Vec<(&str, usize)> = rows.iter().map(|row| (row.name.as_str(), row.windows)).collect();
    assert_eq!(names, [("all", 3), ("own a", 1), ("own b", 2)]);
    let mean = (rows[1].global_mm + 2.0 * rows[2].global_mm) / 3.0;
    assert!((rows[0].global_mm - mean).abs() < 1e-6 && rows[0].aligned_mm > 10.0);
}
