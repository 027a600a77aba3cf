//! Controls that cannot be followed: each is refused in words that say what to change.

use super::controls::{complaint, wav};
use super::desk;

#[test]
fn tables_that_are_no_control_are_named() {
    let (_keep, folder) = desk();
    let many: String = "0.5\n".repeat(10_000_000);
    let cases: [(&str, &str, &[&str]); 6] = [
        ("empty.csv", "", &["empty.csv"]),
        ("one.csv", "1\n", &["one.csv"]),
        ("nan.csv", "1\n2\nnan\n4\n", &["nan.csv", "3"]),
        ("still.csv", &"2\n".repeat(90), &["does not move"]),
        ("short.csv", "1\n2\n3\n", &["at least 22", "--length"]),
        ("many.csv", &many, &["many.csv", "1000000"]),
    ];
    for (name, text, parts) in cases {
        std::fs::write(folder.join(name), text).unwrap();
        let said = complaint(&folder, &["--wave", name]);
        for part in parts {
            assert!(said.contains(part), "{name}: {said}");
        }
    }
    assert!(!folder.join("never.bvh").exists());
}

#[test]
fn sounds_that_are_no_control_are_named() {
    let (_keep, folder) = desk();
    let tone = |seconds: usize, level: f64| {
        wav((0..seconds * 8000).map(move |i| ((i as f64 * 0.3).sin() * level) as i16))
    };
    std::fs::write(folder.join("silence.wav"), tone(3, 0.0)).unwrap();
    std::fs::write(folder.join("nothing.wav"), tone(0, 0.0)).unwrap();
    std::fs::write(folder.join("hours.wav"), tone(7200, 9000.0)).unwrap();
    for flag in ["--sound", "--wave"] {
        assert!(complaint(&folder, &[flag, "silence.wav"]).contains("silent throughout"), "{flag}");
        let said = complaint(&folder, &[flag, "nothing.wav"]);
        assert!(said.contains("nothing.wav"), "{flag}: {said}");
        let said = complaint(&folder, &[flag, "hours.wav"]);
        assert!(said.contains("7200 s") || said.contains("hours.wav"), "{flag}: {said}");
    }
    assert!(!folder.join("never.bvh").exists());
}

#[test]
fn labels_and_motions_that_are_no_control_are_named() {
    let (_keep, folder) = desk();
    let says = |arguments: &[&str]| complaint(&folder, arguments);
    let said = says(&["--labels", "A:90"]);
    assert!(said.contains("--labels"), "{said}");
    let said = says(&["--labels", "A:5 B:5"]);
    assert!(said.contains("at least 22"), "{said}");
    std::fs::copy(folder.join("person.bvh"), folder.join("other.bvh")).unwrap();
    let said = says(&["--like", "other.bvh", "--range", "0..15"]);
    assert!(said.contains("at least 22") && said.contains("--patch"), "{said}");
}
