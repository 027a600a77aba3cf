//! The autoencoder gives what the published code gives, with weights that follow from their names.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod reference;

use inkrig_generate::networks::{Decoding, Parts, Sizes, Vae};
use inkrig_generate::weights::{Tensors, hashed};
use inkrig_motion::humanml::WIDTH;
use reference::{Vectors, assert_near};
use std::sync::LazyLock;

static WEIGHTS: LazyLock<Tensors> = LazyLock::new(|| hashed(&Sizes::full(), Parts::VAE));

#[test]
fn weights_follow_from_their_names() {
    let Some(vectors) = Vectors::open("fill_check") else { return };
    for (name, rows) in [
        ("vae.encoder.middle_block.norm1.weight", ""),
        ("vae.final_layer.bias", ""),
        ("vae.global_motion_token", ""),
        ("vae.query_pos_encoder.pe", "[:3]"),
        ("vae.skel_embedding.weight", "[:4]"),
    ] {
        let expected = vectors.numbers(&format!("{name}{rows}"));
        assert_eq!(WEIGHTS.get(name).unwrap().data()[..expected.len()], expected, "{name}");
    }
}

#[test]
fn clips_are_encoded_and_decoded_as_by_the_published_network() {
    let Some(vectors) = Vectors::open("vae") else { return };
    let vae = Vae::new(&Sizes::full(), &WEIGHTS).unwrap();
    let (features, lengths) = (vectors.numbers("features"), vectors.whole("lengths"));
    let (mut mean, mut log_variance) = (Vec::new(), Vec::new());
    for (clip, &length) in features.chunks_exact(40 * WIDTH).zip(&lengths) {
        let encoded = vae.encode(&clip[..length * WIDTH]).unwrap();
        mean.extend(encoded.mean);
        log_variance.extend(encoded.log_variance);
    }
    assert_near("mean", &mean, &vectors.numbers("mu"), 1e-4);
    assert_near("logarithm of the variance", &log_variance, &vectors.numbers("logvar"), 1e-4);

    let mut work = Decoding::default();
    vae.decode(&vectors.numbers("z_in"), &lengths, &mut work).unwrap();
    let decoded = vectors.numbers("decoded");
    let clips = decoded.chunks_exact(40 * WIDTH).zip(&lengths);
    let expected: Vec<f32> = clips.flat_map(|(clip, &length)| clip[..length * WIDTH].to_vec()).collect();
    assert_near("decoded features", work.features(), &expected, 1e-4);
}
