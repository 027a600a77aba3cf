//! Both named configurations run from conditions to joints, on small networks of their structure.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use inkrig_generate::configuration::Configuration;
use inkrig_generate::guidance::{Ask, View};
use inkrig_generate::networks::{Decoding, Parts, Sizes};
use inkrig_generate::sampling::{Conditions, Networks, Request, Sampler, SamplingOptions};
use inkrig_generate::schedule::Noise;
use inkrig_generate::weights::hashed;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{Camera, JOINTS, Joints, Statistics, WIDTH};

/// The same blocks, but narrow ones.
fn narrow(configuration: &Configuration) -> Sizes {
    let tiny = Sizes::tiny();
    let guidance_width = if configuration.sizes.guidance_width > 0 { tiny.guidance_width } else { 0 };
    Sizes {
        width: tiny.width,
        heads: tiny.heads,
        feed_forward: tiny.feed_forward,
        positions: tiny.positions,
        text_width: tiny.text_width,
        guidance_width,
        ..configuration.sizes.clone()
    }
}

fn dry_run(configuration: &Configuration) {
    let sizes = narrow(configuration);
    let networks = Networks::new(&sizes, &hashed(&sizes, Parts::ALL)).unwrap();
    let features = Statistics::new(vec![0.0; WIDTH], vec![0.05; WIDTH]).unwrap();
    let places = Statistics::new(vec![0.1; 66], vec![0.5; 66]).unwrap();
    let no_text = vec![0.1; sizes.text_width];
    let sampler = Sampler { networks: &networks, features: &features, no_text: &no_text };
    let pose: Joints = std::array::from_fn(|joint| Vec3::new(0.05 * joint as f32, 0.9, 0.2));
    let asks = (0..6).map(|frame| Ask { frame, joint: 10, place: Vec3::new(0.1, 0.1 * frame as f32, 0.3) });
    for view in [View::Space, View::Plane(Camera::default())] {
        let text = Noise::new(1).normals(sizes.text_width);
        let request =
            Request { frames: 12, text, view, trajectory: asks.clone().collect(), keypose: Some((2, pose)) };
        let conditions = Conditions::new(&request, &places, configuration.semantics).unwrap();
        let bare = Request { trajectory: Vec::new(), keypose: None, ..request.clone() };
        let bare = Conditions::new(&bare, &places, configuration.semantics).unwrap();
        let options = configuration.sampling_options();
        let run = |conditions: &[Conditions], options: &SamplingOptions, seed| {
            sampler.sample(conditions, options, seed).unwrap()
        };
        let sampled = run(std::slice::from_ref(&conditions), &options, 1);
        assert_eq!(sampled, run(std::slice::from_ref(&conditions), &options, 1));
        assert_ne!(sampled.latents, run(std::slice::from_ref(&conditions), &options, 2).latents);
        assert!(sampled.guided.iter().all(|guided| guided.after <= guided.before && guided.evaluations > 0));
        assert!(!sampled.guided.is_empty());
        let mut decoding = Decoding::default();
        networks.vae.decode(&sampled.latents, &[12], &mut decoding).unwrap();
        assert!(decoding.features().iter().all(|x| x.is_finite()));

        let unguided = SamplingOptions { guidance: None, ..options.clone() };
        let both = run(&[conditions.clone(), conditions.clone()], &unguided, 1);
        assert_eq!(both.latents[..networks.vae.latent_width()], run(&[conditions], &unguided, 1).latents);
        assert_ne!(both.latents[networks.vae.latent_width()..], both.latents[..networks.vae.latent_width()]);
        assert!(
            sampler
                .sample(&[bare.clone(), both_kinds(&request, &places, configuration)], &options, 1)
                .is_err()
        );
        assert!(run(&[bare], &options, 1).guided.is_empty());
    }
}

fn both_kinds(request: &Request, places: &Statistics, configuration: &Configuration) -> Conditions {
    let posed = Request { trajectory: Vec::new(), ..request.clone() };
    Conditions::new(&posed, places, configuration.semantics).unwrap()
}

#[test]
fn the_papers_configuration_runs() {
    let paper = Configuration::paper().unwrap();
    assert_eq!(paper.training.joints.iter().max(), Some(&21));
    dry_run(&paper);
}

#[test]
fn the_published_configuration_runs() {
    let official = Configuration::official().unwrap();
    assert_eq!(official.training.joints.len(), JOINTS);
    dry_run(&official);
}
