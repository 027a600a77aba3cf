//! What is said, how often, and that it is harmless.

use crate::{ALIGN, align, desk, inkrig, text};
use std::process::{Command, Stdio};

fn said(output: &std::process::Output) -> String {
    text(&output.stderr).replace(['\n', '│', ' '], "")
}

#[test]
fn errors_are_said_once() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("broken.bvh"), "HIERARCHY\nROOT hip\n{\n  OFFSET 0 zero 0\n").unwrap();
    std::fs::write(folder.join("dot.csv"), "1,1\n1,1\n1,1\n").unwrap();
    let cases: [(&[&str], &str); 5] = [
        (&["inspect", "missing.bvh"], "os error"),
        (&["inspect", "broken.bvh"], "line 4"),
        (&["align", "person.bvh", "--curve", "dot.csv", "-o", "a.bvh"], "does not move"),
        (&["align", "person.bvh", "--curve", "circles.csv", "-o", "no/a.bvh"], "no folder"),
        (&["align", "person.bvh", "--curve", "circles.csv", "-o", "a.bvh", "--range", "1..9"], "at least 22"),
    ];
    for (arguments, part) in cases {
        let said = said(&inkrig(&folder, arguments));
        assert_eq!(said.matches(&part.replace(' ', "")).count(), 1, "{arguments:?}: {said}");
    }
}

#[test]
fn numbers_without_sense_are_refused_first() {
    let (_keep, folder) = desk();
    let cases = [
        ("--fps", "0", "from 0.1 to 1000"),
        ("--fps", "1e9", "from 0.1 to 1000"),
        ("--fps", "nan", "from 0.1 to 1000"),
        ("--source-fps", "-3", "from 0.01 to 100000"),
        ("--smooth", "-1", "from 0 to 1000"),
        ("--smooth", "inf", "from 0 to 1000"),
        ("--length", "2h", "seconds (10s)"),
        ("--length", "3601s", "at most 3333s"),
        ("--length", "-5", "frames (300)"),
        ("--threads", "0", "from 1 to 1024"),
        ("--unit", "-1", "0.01 for centimetres"),
    ];
    for (flag, value, part) in cases {
        // The clip is not there: nobody has looked for it.
        let output =
            inkrig(&folder, &["align", "none.bvh", "--curve", "none.csv", "-o", "a.bvh", flag, value]);
        assert_eq!(output.status.code(), Some(2), "{flag} {value}");
        assert!(said(&output).contains(&part.replace(' ', "")), "{flag} {value}: {}", said(&output));
    }
    let output =
        inkrig(&folder, &["align", "none.bvh", "--curve", "none.csv", "-o", "a.bvh", "--alpha", "-1"]);
    assert!(output.status.code() == Some(1) && said(&output).contains("from0to1"), "{}", said(&output));
}

#[test]
fn a_range_behind_the_end_is_told_where_the_end_is() {
    let (_keep, folder) = desk();
    let bytes = std::fs::read(folder.join("person.bvh")).unwrap();
    let clip = inkrig::formats::read_bvh(&bytes, &inkrig::formats::ImportOptions::default()).unwrap().clip;
    let said = said(&align(&folder, &["--range", "5000s.."]));
    let end = format!("theclipendsat{:.2}s,whichisframe{}", inkrig::span::seconds(&clip), clip.frames());
    assert!(said.contains("--range5000s..") && said.contains(&end), "{said}");
}

/// One frame, a joint whose name clears the screen, no travel.
const ODD: &str = "HIERARCHY\nROOT h\u{1b}[2Jip\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\nEnd Site\n\
    {\nOFFSET 0 170 0\n}\n}\nMOTION\nFrames: 2\nFrame Time: 0.04\n0 0 0\n";

#[test]
fn nothing_from_outside_steers_the_terminal_and_numbers_read_well() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("o\u{1b}[1mdd.bvh"), ODD).unwrap();
    let output = inkrig(&folder, &["inspect", "o\u{1b}[1mdd.bvh"]);
    let words = text(&output.stdout);
    assert!(output.status.success() && !words.contains('\u{1b}'), "{words:?}");
    assert!(words.contains("h\u{fffd}[2Jip") && words.contains("o\u{fffd}[1mdd.bvh"), "{words}");
    assert!(words.contains(" 0.00 m, by joint") && words.contains("1 end site\n"), "{words}");
    let output = inkrig(&folder, &["inspect", "no\u{1b}[1mne.bvh"]);
    assert!(text(&output.stderr).contains("no\u{fffd}[1mne.bvh"), "{}", text(&output.stderr));
}

#[test]
fn warnings_go_to_standard_error_or_into_the_record() {
    let (_keep, folder) = desk();
    // A row fewer than announced is a warning.
    let person = text(inkrig::samples::find("person").unwrap().bytes);
    let person = person.trim_end().rsplit_once('\n').unwrap().0;
    std::fs::write(folder.join("person.bvh"), person).unwrap();
    let output = align(&folder, &[]);
    assert!(text(&output.stderr).contains("warning [bvh-"), "{}", text(&output.stderr));
    assert!(!text(&output.stdout).contains("warning"), "{}", text(&output.stdout));
    let output = align(&folder, &["--force", "--json"]);
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(value["warnings"][0].as_str().unwrap().contains("person.bvh: warning"), "{value}");
    assert!(output.stderr.is_empty());
    assert!(align(&folder, &["--force", "--quiet"]).stderr.is_empty());
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_and_a_closed_pipe_is_none() {
    let (_keep, folder) = desk();
    for arguments in
        [&["inspect", "person.bvh"][..], &["inspect", "person.bvh", "--json"], &["completions", "bash"]]
    {
        let run = |out: Stdio| {
            let mut command = Command::new(env!("CARGO_BIN_EXE_inkrig"));
            command.current_dir(&folder).args(arguments).stdout(out).output().unwrap()
        };
        let full = run(std::fs::File::options().write(true).open("/dev/full").unwrap().into());
        assert_eq!(full.status.code(), Some(1), "{arguments:?}");
        assert!(said(&full).contains("standardoutputcouldnotbewritten"), "{}", said(&full));
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let closed = run(writer.into());
        assert!(closed.status.success() && closed.stderr.is_empty(), "{}", text(&closed.stderr));
    }
}

/// On a terminal every stage is named while it goes on; quiet says nothing.
#[cfg(target_os = "linux")]
#[test]
fn stages_are_shown_on_a_terminal() {
    let (_keep, folder) = desk();
    let on_terminal = |more: &str| {
        let line = format!(
            "{} {} --sheet s.png --preview p.html --force {more}",
            env!("CARGO_BIN_EXE_inkrig"),
            ALIGN.join(" ")
        );
        Command::new("script")
            .current_dir(&folder)
            .args(["-qec", &line, "/dev/null"])
            .stdin(Stdio::null())
            .output()
    };
    let Ok(output) = on_terminal("") else {
        println!("skipped: no `script` here to make a terminal");
        return;
    };
    let shown = String::from_utf8_lossy(&output.stdout).into_owned();
    for stage in
        ["reading person.bvh", "aligning", "writing the motion", "making the preview", "drawing the sheet"]
    {
        assert!(shown.contains(stage), "no `{stage}` in {shown}");
    }
    assert!(!String::from_utf8_lossy(&on_terminal("--quiet").unwrap().stdout).contains("aligning"));
}
