//! Folders of motion become a corpus: every line of it is true, a stopped build goes on, shares make the same whole.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and prints its figures")]

use inkrig_motion::humanml;
use inkrig_train::TrainError;
use inkrig_train::corpus::{Config, Manifest, Part, Progress, Shard, Split, build, finish};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// A folder with motion of our own and of nobody, and the configuration that names it.
fn desk() -> (tempfile::TempDir, Config) {
    let desk = tempfile::tempdir().unwrap();
    let put = |name: &str, bytes: &[u8]| {
        let path = desk.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    };
    let person = inkrig_samples::find("person").unwrap().bytes;
    put("data/ann/WalkLeft.bvh", person);
    put("data/bob/TurnRight.bvh", person);
    put("data/bob/broken.bvh", &person[..400]);
    put("data/eve/kick.bvh", person);
    put("data/eve/snake.bvh", inkrig_samples::find("snake").unwrap().bytes);
    put("data/notes.txt", b"not a motion");
    put("index.csv", b"file,split,description\nkick.bvh,test,a person kicks\nTurnRight.bvh,duplicate,turn\n");
    put("corpus.toml", b"[[source]]\nname = 'own'\nfolder = 'data'\nlicence = 'free'\nindex = 'index.csv'\n");
    let config = Config::read(&desk.path().join("corpus.toml")).unwrap();
    (desk, config)
}

fn go_on(_: Progress<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Every file of a folder with its bytes.
fn tree(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all.extend(tree(&path));
        } else {
            all.push((path.clone(), std::fs::read(path).unwrap()));
        }
    }
    all.sort();
    all
}

#[test]
fn every_clip_is_in_the_corpus_or_said_why_not() {
    let (desk, config) = desk();
    let out = desk.path().join("corpus");
    let built = build(&config, &out, Shard::ALL, 2, &go_on).unwrap().unwrap();
    let entries = built.manifest.entries();
    let rows: Vec<_> = entries
        .iter()
        .map(|entry| (entry.file.as_str(), entry.subject.as_str(), entry.split, entry.actions.join(" ")))
        .collect();
    assert_eq!(
        rows,
        [
            ("ann/WalkLeft.bvh", "ann", Split::Train, "walk".to_string()),
            ("eve/kick.bvh", "eve", Split::Test, "kick".to_string())
        ]
    );
    assert_eq!(entries[0].mirrored_text, "WalkRight");
    let why = |file: &str| {
        built.rejected.iter().find(|entry| entry.file == file).map(|entry| entry.kind.as_str()).unwrap()
    };
    assert_eq!(why("bob/TurnRight.bvh"), "marked in the index");
    assert_eq!(why("bob/broken.bvh"), "cannot be read");
    assert_eq!(why("eve/snake.bvh"), "no human body");
    assert_eq!(why("notes.txt"), "cannot be read");

    // The numbers are those of the clip: they give back a body that walks, and its mirror image.
    let part = Part::read(&out.join(&entries[0].part)).unwrap();
    let prepared = &part.clips[entries[0].index].prepared;
    assert_eq!(prepared.features.frames(), entries[0].frames);
    let places = humanml::recover_positions(&prepared.features).unwrap();
    let image = humanml::recover_positions(&prepared.mirrored).unwrap();
    let across = |pose: &humanml::Joints| pose[20].x - pose[0].x;
    let apart = places.iter().zip(&image).map(|(own, image)| (across(own) + image[21].x - image[0].x).abs());
    assert!(apart.fold(0.0, f32::max) < 1e-3);
    let lengths = |pose: &humanml::Joints| humanml::bone_lengths(pose).map(inkrig_motion::glam::Vec3::length);
    for (joint, bone) in built.statistics.body.iter().enumerate() {
        let length = bone.iter().map(|value| value * value).sum::<f32>().sqrt();
        assert!((lengths(&places[10])[joint] - length).abs() < 1e-3, "joint {joint}");
    }
    assert_eq!((built.statistics.mean.len(), built.statistics.joint_deviation.len()), (263, 66));
    assert!(!entries[0].key_poses.is_empty());

    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("no human body") && page.contains("WalkLeft"));
    let parts: Vec<_> = built.manifest.parts(Split::Test).collect();
    assert_eq!(parts.len(), 1);
    assert!(Manifest::read_part(&parts[0].0, parts[0].1).is_ok());
}

#[test]
fn a_stopped_build_goes_on_and_shares_make_the_same_whole() {
    let (desk, config) = desk();
    let whole = desk.path().join("whole");
    build(&config, &whole, Shard::ALL, 1, &go_on).unwrap();

    let stopped = desk.path().join("stopped");
    let done = AtomicUsize::new(0);
    let stop = |_: Progress<'_>| match done.fetch_add(1, Ordering::Relaxed) {
        0 => ControlFlow::Continue(()),
        _ => ControlFlow::Break(()),
    };
    assert!(matches!(build(&config, &stopped, Shard::ALL, 1, &stop), Err(TrainError::Stopped)));
    let kept = AtomicUsize::new(0);
    let count = |at: Progress<'_>| {
        kept.fetch_add(usize::from(at.kept), Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    build(&config, &stopped, Shard::ALL, 1, &count).unwrap();
    assert!(kept.load(Ordering::Relaxed) >= 2, "parts that were done are not made again");

    let shared = desk.path().join("shared");
    for index in 1..=3 {
        let error = finish(&config, &shared).unwrap_err().to_string();
        let said =
            ["holds no corpus", "shares 2/3, 3/3 are not built yet", "share 3/3 is not built yet"][index - 1];
        assert!(error.contains(said), "{error}");
        assert!(build(&config, &shared, Shard { index, count: 3 }, 1, &go_on).unwrap().is_none());
    }
    finish(&config, &shared).unwrap();

    let names = |folder: &Path| -> Vec<(PathBuf, Vec<u8>)> {
        tree(folder)
            .into_iter()
            .map(|(path, bytes)| (path.strip_prefix(folder).unwrap().to_path_buf(), bytes))
            .collect()
    };
    assert_eq!(names(&whole), names(&stopped));
    assert_eq!(names(&whole), names(&shared));

    // What is asked for may change, the sources may not.
    let mut other = config.clone();
    other.sources[0].include = vec!["ann".into()];
    build(&other, &shared, Shard::ALL, 1, &go_on).unwrap();
    other.sources[0].name = "other".into();
    let before = tree(&shared);
    for error in
        [build(&other, &shared, Shard::ALL, 1, &go_on).unwrap_err(), finish(&other, &shared).unwrap_err()]
    {
        assert!(
            error.to_string().contains("with the source `own`, which the configuration has not"),
            "{error}"
        );
    }
    let elsewhere = desk.path().join("elsewhere");
    std::fs::create_dir(&elsewhere).unwrap();
    std::fs::copy(desk.path().join("data/ann/WalkLeft.bvh"), elsewhere.join("WalkLeft.bvh")).unwrap();
    let mut other = config.clone();
    other.sources[0].folder = elsewhere;
    let error = build(&other, &shared, Shard::ALL, 1, &go_on).unwrap_err().to_string();
    assert!(error.contains("whose source `own` has other files"), "{error}");
    assert_eq!(before, tree(&shared));

    // A file that has changed is read again.
    let person = inkrig_samples::find("person").unwrap().bytes;
    std::fs::write(desk.path().join("data/bob/broken.bvh"), person).unwrap();
    let built = build(&config, &whole, Shard::ALL, 1, &go_on).unwrap().unwrap();
    assert_eq!(built.manifest.entries().len(), 3);
}

#[test]
fn a_corpus_takes_no_folder_of_others_and_says_when_there_is_nothing() {
    let (desk, mut config) = desk();
    let error = build(&config, &desk.path().join("data"), Shard::ALL, 1, &go_on).unwrap_err().to_string();
    assert!(error.contains("holds other files"), "{error}");
    let error = build(&config, desk.path(), Shard { index: 3, count: 2 }, 1, &go_on).unwrap_err();
    assert!(matches!(error, TrainError::Shard { .. }));
    config.sources[0].include = vec!["snake".into()];
    let error = build(&config, &desk.path().join("none"), Shard::ALL, 1, &go_on).unwrap_err().to_string();
    assert!(error.contains("no motion file of the training split"), "{error}");
    config.sources[0].folder = desk.path().join("nowhere");
    let error = build(&config, &desk.path().join("none"), Shard::ALL, 1, &go_on).unwrap_err().to_string();
    assert!(error.contains("nowhere"), "{error}");
}

#[cfg(unix)]
#[test]
fn a_corpus_has_the_permissions_of_ordinary_files() {
    use std::os::unix::fs::PermissionsExt as _;
    let (desk, config) = desk();
    let out = desk.path().join("corpus");
    build(&config, &out, Shard::ALL, 1, &go_on).unwrap();
    let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
    let ordinary = mode(&desk.path().join("corpus.toml"));
    for (path, _) in tree(&out) {
        assert_eq!(mode(&path), ordinary, "{}", path.display());
    }
}
