//! What is written where, and what is left alone.

use crate::{align, desk, inkrig, text};

/// What was said, without the places where it was wrapped for the terminal.
fn said(output: &std::process::Output) -> String {
    text(&output.stderr).replace(['\n', '│', ' '], "")
}

#[test]
fn two_results_of_one_name_are_seen_before_they_are_there() {
    let (_keep, folder) = desk();
    let cases = [["--report", "./new.bvh"], ["--sheet", "sub/../new.bvh"]];
    std::fs::create_dir(folder.join("sub")).unwrap();
    for more in cases {
        let output = align(&folder, &[&more[..], &["--force"]].concat());
        assert_eq!(output.status.code(), Some(1));
        assert!(said(&output).contains("namedtwice"), "{}", said(&output));
        assert!(!folder.join("new.bvh").exists());
    }
}

#[test]
fn no_kind_of_control_is_written_over() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("tune.wav"), crate::controls::tune()).unwrap();
    std::fs::write(folder.join("swell.wav"), crate::controls::swell()).unwrap();
    let beat: String = (0..120).map(|i| format!("{}\n", i / 20 % 2)).collect();
    std::fs::write(folder.join("beat.csv"), beat).unwrap();
    let names: String = (0..120).map(|i| format!("{}\n", ["walk", "turn"][i / 60])).collect();
    std::fs::write(folder.join("names.csv"), names).unwrap();
    std::fs::write(folder.join("snake.bvh"), inkrig::samples::find("snake").unwrap().bytes).unwrap();
    for (flag, file) in [
        ("--curve", "circles.csv"),
        ("--wave", "beat.csv"),
        ("--wave", "swell.wav"),
        ("--labels", "names.csv"),
        ("--sound", "tune.wav"),
        ("--like", "snake.bvh"),
    ] {
        let before = std::fs::read(folder.join(file)).unwrap();
        let arguments =
            ["align", "person.bvh", flag, file, "-o", "new.bvh", "--levels", "1", "--force", "--json"];
        let over = inkrig(&folder, &[&arguments[..], &["--report", file]].concat());
        assert!(!over.status.success() && said(&over).contains("namedtwice"), "{flag}: {}", said(&over));
        assert_eq!(std::fs::read(folder.join(file)).unwrap(), before, "{flag}");
        let good = inkrig(&folder, &[&arguments[..], &["--preview", "p.html"]].concat());
        assert!(good.status.success(), "{flag}: {}", said(&good));
        let report: serde_json::Value = serde_json::from_slice(&good.stdout).unwrap();
        assert_eq!(report["inputs"], serde_json::json!(["person.bvh", file]), "{flag}");
        let title = format!("person follows {}", file.split('.').next().unwrap());
        assert!(text(&std::fs::read(folder.join("p.html")).unwrap()).contains(&title), "{flag}: {title}");
    }
}

#[test]
fn one_input_may_be_read_for_several_things() {
    let (_keep, folder) = desk();
    for more in [["--path", "circles.csv"], ["--avoid", "person.bvh:3"]] {
        let output = align(&folder, &[&more[..], &["--force", "--levels", "1"]].concat());
        assert!(output.status.success() || said(&output).contains("doesnottravel"), "{}", said(&output));
    }
    let like = ["align", "person.bvh", "--like", "person.bvh", "-o", "new.bvh", "--levels", "1", "--force"];
    assert!(inkrig(&folder, &like).status.success());
    let over = inkrig(&folder, &[&like[..5], &["person.bvh", "--force"]].concat());
    assert!(said(&over).contains("namedtwice"), "{}", said(&over));
}

#[cfg(unix)]
#[test]
fn hard_links_of_inputs_are_no_results() {
    let (_keep, folder) = desk();
    std::fs::hard_link(folder.join("person.bvh"), folder.join("new.bvh")).unwrap();
    let output = align(&folder, &["--force"]);
    assert!(said(&output).contains("namedtwice"), "{}", said(&output));
    assert_eq!(
        std::fs::read(folder.join("new.bvh")).unwrap(),
        inkrig::samples::find("person").unwrap().bytes
    );
}

#[cfg(unix)]
#[test]
fn only_ordinary_files_are_replaced() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let (_keep, folder) = desk();
    let pipe = folder.join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    symlink("/dev/null", folder.join("null")).unwrap();
    symlink("/dev/stdout", folder.join("out")).unwrap();
    for (name, what) in
        [("pipe", "apipe"), ("null", "adevice"), ("/dev/null", "adevice"), ("out", "is"), (".", "afolder")]
    {
        let output = align(&folder, &["--report", name, "--force"]);
        assert_eq!(output.status.code(), Some(1), "{name}");
        assert!(
            said(&output).contains(what) && said(&output).contains("notanordinaryfile"),
            "{}",
            said(&output)
        );
    }
    assert!(pipe.metadata().unwrap().file_type().is_fifo());
    assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    // A link to an ordinary file stays a link.
    std::fs::write(folder.join("real.bvh"), "old").unwrap();
    symlink("real.bvh", folder.join("new.bvh")).unwrap();
    assert!(align(&folder, &["--force"]).status.success());
    assert!(folder.join("new.bvh").is_symlink());
    assert!(std::fs::read(folder.join("real.bvh")).unwrap().starts_with(b"HIERARCHY"));
}

/// `/proc` takes no files, not even from root. The clip is not even read.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_files_is_found_before_the_work() {
    let (_keep, folder) = desk();
    let output = inkrig(&folder, &["align", "missing.bvh", "--curve", "circles.csv", "-o", "/proc/new.bvh"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("/proc/new.bvhcouldnotbewritten"), "{}", said(&output));
}

#[cfg(unix)]
#[test]
fn permissions_are_those_of_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    for (mask, mode) in [("027", 0o640), ("002", 0o664)] {
        let (_keep, folder) = desk();
        let script = format!(
            "umask {mask}; exec {} align person.bvh --curve circles.csv -o new.bvh",
            env!("CARGO_BIN_EXE_inkrig")
        );
        let status =
            std::process::Command::new("sh").current_dir(&folder).args(["-c", &script]).output().unwrap();
        assert!(status.status.success());
        assert_eq!(folder.join("new.bvh").metadata().unwrap().permissions().mode() & 0o777, mode);
    }
}

/// Linux takes any bytes for a name; JSON and terminals take text.
#[cfg(target_os = "linux")]
#[test]
fn names_that_are_no_text_are_no_trouble() {
    use std::os::unix::ffi::OsStrExt;
    let (_keep, folder) = desk();
    let name = std::ffi::OsStr::from_bytes(b"n\xffw.bvh");
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_inkrig"))
        .current_dir(&folder)
        .args(["align", "person.bvh", "--curve", "circles.csv", "--report", "r.json", "--json", "-o"])
        .arg(name)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["outputs"][0], "n\u{fffd}w.bvh");
    assert!(folder.join(name).exists() && folder.join("r.json").exists());
}
