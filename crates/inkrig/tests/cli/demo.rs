//! `inkrig demo`.

use crate::{inkrig, text};

#[test]
fn the_demo_needs_nothing_and_replaces_only_its_own_files() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("out")).unwrap();
    std::fs::write(folder.path().join("out/mine.txt"), "mine").unwrap();
    for _ in 0..2 {
        let output = inkrig(folder.path(), &["demo", "out"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(text(&output.stdout).contains("Open out/person-follows-spiral.html in a browser"));
    }
    assert_eq!(std::fs::read(folder.path().join("out/mine.txt")).unwrap(), b"mine");
    for ending in ["bvh", "html", "png"] {
        let file = folder.path().join(format!("out/quadruped-follows-eight.{ending}"));
        assert!(file.metadata().unwrap().len() > 1000, "{}", file.display());
    }
}

#[test]
fn files_of_the_same_names_are_not_the_demos() {
    for name in ["person.bvh", "heart.json", "person-follows-spiral.html", ".inkrig-demo"] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(name), "mine").unwrap();
        let output = inkrig(folder.path(), &["demo", "."]);
        assert_eq!(output.status.code(), Some(1), "{name}");
        assert!(
            text(&output.stderr).replace(['\n', ' ', '│'], "").contains("isthere"),
            "{}",
            text(&output.stderr)
        );
        assert_eq!(std::fs::read(folder.path().join(name)).unwrap(), b"mine");
        assert_eq!(
            std::fs::read_dir(folder.path()).unwrap().count(),
            1,
            "refused before anything is written"
        );
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("person.bvh"), "mine").unwrap();
    assert!(inkrig(folder.path(), &["demo", ".", "--force"]).status.success());
    assert_ne!(std::fs::read(folder.path().join("person.bvh")).unwrap(), b"mine");
}
