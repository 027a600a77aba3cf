//! Two clips become one, by the model and by the ways that it is compared with.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

use inkrig_generate::blending::{BlendOptions, DoubleTakeOptions, blend, double_take, linear};
use inkrig_generate::configuration::Configuration;
use inkrig_generate::networks::{Parts, Sizes};
use inkrig_generate::sampling::{Networks, Sampler};
use inkrig_generate::weights::hashed;
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::humanml::{Joints, PARENTS, RAW_DIRECTIONS, Statistics, WIDTH};

/// A figure that walks along a heading, swaying.
fn walk(heading: f32, frames: usize) -> Vec<Joints> {
    let turn = Quat::from_rotation_y(heading);
    let mut rest = [Vec3::new(0.0, 0.9, 0.0); 22];
    for joint in 1..22 {
        rest[joint] = rest[PARENTS[joint]] + 0.2 * RAW_DIRECTIONS[joint];
    }
    (0..frames)
        .map(|frame| {
            let sway = 0.1 * (0.4 * frame as f32).sin();
            let way = Vec3::new(0.0, 0.0, 0.03 * frame as f32);
            rest.map(|place| turn * (place + way + Vec3::new(sway * place.y, 0.0, 0.0)))
        })
        .collect()
}

/// The mean distance of joints at frames outside of the transition.
fn apart(a: &[Joints], b: &[Joints], transition: std::ops::Range<usize>) -> f32 {
    let kept: Vec<usize> = (0..a.len() - 1).filter(|frame| !transition.contains(frame)).collect();
    let frame =
        |frame: &usize| a[*frame].iter().zip(&b[*frame]).map(|(a, b)| a.distance(*b)).sum::<f32>() / 22.0;
    kept.iter().map(frame).sum::<f32>() / kept.len() as f32
}

#[test]
fn clips_are_blended_and_guidance_holds_them() {
    let sizes = Sizes::tiny();
    let networks = Networks::new(&sizes, &hashed(&sizes, Parts::ALL)).unwrap();
    let statistics = Statistics::new(vec![0.0; WIDTH], vec![0.3; WIDTH]).unwrap();
    let text = vec![0.2; sizes.text_width];
    let sampler = Sampler { networks: &networks, features: &statistics, no_text: &text };
    let (first, second) = (walk(0.5, 25), walk(-1.0, 30));
    let expected = linear(&first, &second, 10).unwrap();

    let options = BlendOptions { transition: 10, steps: 10, guide_every: 2, ..BlendOptions::default() };
    let blended = blend(&sampler, &text, &first, &second, &options).unwrap();
    let unguided = BlendOptions { guidance: None, ..options.clone() };
    let free = blend(&sampler, &text, &first, &second, &unguided).unwrap();
    assert_eq!((blended.motion.len(), blended.transition.clone(), blended.guided.len()), (55, 20..30, 5));
    let [held, free] = [&blended, &free].map(|motion| apart(&motion.motion, &expected, 20..30));
    println!("clips are {held:.3} m off with guidance, {free:.3} m without");
    assert!(held < 0.8 * free, "{held} {free}");
    assert!(blend(&sampler, &text, &first, &walk(0.0, 60), &options).is_err());

    let options = DoubleTakeOptions { handshake: 10, fade: 4, steps: 5, seed: 1 };
    let taken = double_take(&sampler, &first, &second, &options).unwrap();
    assert_eq!(taken.len(), 45);
    let kept = taken[5].iter().zip(&first[5]).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    assert!(kept < 1e-3, "{kept}");
}

#[test]
fn both_configurations_say_how_to_blend() {
    for configuration in [Configuration::paper().unwrap(), Configuration::official().unwrap()] {
        assert_eq!(configuration.blend_options().transition, 20);
    }
}
