//! `inkrig model` on the command line.

use crate::generate::{header, model};
use crate::{desk, inkrig, text};
use inkrig_generate::checkpoint::{ModelFile, ModelHeader};
use inkrig_generate::networks::Parts;
use std::fs::File;
use std::path::{Path, PathBuf};

/// One of the models that come with the program.
fn shipped(name: &str) -> String {
    let models = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../models");
    models.join(format!("{name}.safetensors")).to_str().unwrap().into()
}

/// What is said, without its line ends.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = inkrig(folder, arguments);
    let said = text(&output.stderr).replace(['\n', '│', ' '], "");
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {said}");
    said
}

fn packed(folder: &Path, name: &str) -> ModelHeader {
    ModelFile::open(File::open(folder.join(name)).unwrap()).unwrap().header().clone()
}

#[test]
fn weights_that_name_code_are_refused_by_that_name_and_nothing_is_written() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("evil.ckpt"), b"\x80\x02cos\nsystem\n(X\x05\0\0\0touchtR.").unwrap();
    let output = inkrig(&folder, &["model", "import", "evil.ckpt", "-o", "model.safetensors"]);
    assert_eq!(output.status.code(), Some(1));
    let said = text(&output.stderr).replace(['\n', '│', ' '], "");
    assert!(said.contains("evil.ckpt:thefileasksforos.system(byte2ofitspickle)"), "{said}");
    assert!(!folder.join("model.safetensors").exists());
    let output = inkrig(&folder, &["model", "inspect", "person.bvh"]);
    let said = text(&output.stderr).replace(['\n', '│', ' '], "");
    assert!(said.contains("nonethatPyTorchsaved"), "{said}");
}

#[test]
fn what_comes_with_the_program_is_known() {
    let folder = tempfile::tempdir().unwrap();
    let inspected = |name: &str| {
        let output = inkrig(folder.path(), &["model", "inspect", &shipped(name)]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let said = inspected("clean");
    for part in ["a model file of inkrig", "estimate", "examples", "name: inkrig-clean", "credit: The data"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(!said.contains("\nnot read"), "{said}");
    let said = inspected("clean-quick");
    assert!(said.contains("name: inkrig-clean-quick") && said.contains("only what differs"), "{said}");
    assert!(inspected("sketch-reader").contains("a reader of inkrig, of drawn figures"));
    assert!(inspected("word-reader").contains("a reader of inkrig, of words"));

    let import =
        |name: &str| refused(folder.path(), &["model", "import", &shipped(name), "-o", "x.safetensors"]);
    assert!(import("clean").contains("amodelfileofinkrigalready"));
    assert!(import("word-reader").contains("areaderofinkrigalready"));
    let of = |name: &str| {
        let given = shipped(name);
        refused(folder.path(), &["generate", "--model", &given, "--word", "kick", "-o", "k.bvh"])
    };
    assert!(of("clean-quick").contains("itdiffersfromclean.safetensors,andbothcomeinsidetheprogram"));
    assert!(of("sketch-reader").contains("weightsofareaderofdrawings"));
}

#[test]
fn a_packed_model_keeps_what_its_source_says() {
    let (_keep, folder) = desk();
    let mut own = ModelHeader { data: "clips".into(), ..header(0) };
    own.licence = "free; credit: thank Ann".into();
    std::fs::write(folder.join("m.safetensors"), model(&own, Parts::ALL)).unwrap();
    let pack_of = |file: &str, more: &[&str]| {
        let pack = ["model", "pack", file, "-o", "p.safetensors", "--force"];
        let output = inkrig(&folder, &[&pack[..], more].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        (packed(&folder, "p.safetensors"), text(&output.stderr))
    };
    let pack = |more: &[&str]| pack_of("m.safetensors", more);
    let (kept, said) = pack(&[]);
    assert_eq!((kept.data, kept.licence), (own.data.clone(), own.licence.clone()));
    assert!(!said.contains("credit"), "{said}");
    let (kept, said) = pack(&["--licence", "CC0"]);
    assert_eq!(kept.licence, "CC0; credit: thank Ann");
    assert!(said.contains("its credit stays"), "{said}");
    let (kept, said) = pack(&["--licence", "CC0", "--no-credit"]);
    assert_eq!(kept.licence, "CC0");
    assert!(said.contains("thank Ann"), "{said}");

    // One that was distilled has a weight more: the rest is in the first.
    own.sizes.guidance_width = 16;
    std::fs::write(folder.join("q.safetensors"), model(&own, Parts::ALL)).unwrap();
    let (kept, _) = pack_of("q.safetensors", &["--without", "m.safetensors"]);
    assert_eq!(kept.laid_over.as_deref(), Some("tiny"));
    let said = refused(&folder, &["generate", "--model", "p.safetensors", "--word", "kick", "-o", "k.bvh"]);
    assert!(said.contains("itdiffersfromtiny:packitoncemore"), "{said}");
    let inspected = text(&inkrig(&folder, &["model", "inspect", "p.safetensors"]).stdout);
    assert!(inspected.contains("the other weights are in: tiny"), "{inspected}");
}

#[test]
fn motions_to_begin_with_need_verbs() {
    let (_keep, folder) = desk();
    std::fs::create_dir(folder.join("data")).unwrap();
    std::fs::copy(folder.join("person.bvh"), folder.join("data/person.bvh")).unwrap();
    let config = "[[source]]\nname = 'own'\nfolder = 'data'\nlicence = 'free'\ntext = 'nothing'\n";
    std::fs::write(folder.join("corpus.toml"), config).unwrap();
    let output = inkrig(&folder, &["data", "build", "corpus.toml", "-o", "corpus"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    std::fs::write(folder.join("m.safetensors"), model(&header(0), Parts::ALL)).unwrap();
    let pack = ["model", "pack", "m.safetensors", "--examples", "corpus", "-o", "x.safetensors"];
    assert!(refused(&folder, &pack).contains("noclipofitstrainingsplitsaysbyaverb"));
    assert!(!folder.join("x.safetensors").exists());

    // Settings that are no TOML, folders and numbers that are none: each is said in one line.
    std::fs::write(folder.join("bad.toml"), "hello").unwrap();
    for command in [
        &["data", "build", "bad.toml", "-o", "other"][..],
        &["train", "vae", "--corpus", "corpus", "--config", "bad.toml", "-o", "run"],
        &["train", "denoiser", "--vae", "x", "--corpus", "corpus", "--config", "bad.toml", "-o", "run"],
    ] {
        let said = refused(&folder, command);
        assert!(said.contains("bad.toml:line1,column") && !said.contains('\u{fffd}'), "{said}");
    }
    let said = refused(&folder, &["train", "vae", "--corpus", "corpus", "-o", "data"]);
    assert!(
        said.contains("holdsotherfiles") && !folder.join("data/checkpoint.safetensors").exists(),
        "{said}"
    );
    let train = ["train", "denoiser", "--vae", "person.bvh", "--corpus", "corpus", "-o", "run"];
    assert!(refused(&folder, &train).contains("thisisnosafetensorsfile"));

    let evaluate = ["evaluate", "reconstruction", "--corpus", "corpus", "--split", "train", "--windows", "1"];
    let output = inkrig(&folder, &[&evaluate[..7], &["0"]].concat());
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    let of_model = |more: &[&'static str]| [&evaluate[..], &["--model", "m.safetensors"], more].concat();
    let said = refused(&folder, &of_model(&["--frames", "1"]));
    assert!(said.contains("--framesis1frameof20asecond"), "{said}");
    // To measure, no body is needed.
    let bare = ModelHeader { skeleton: None, ..header(0) };
    std::fs::write(folder.join("m.safetensors"), model(&bare, Parts::ALL)).unwrap();
    let output = inkrig(&folder, &of_model(&["--frames", "20"]));
    assert!(output.status.success(), "{}", text(&output.stderr));
}
