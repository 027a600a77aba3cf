//! Ctrl-C.
#![cfg(unix)]

use crate::{ALIGN, desk};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Ctrl-C ends a long run with the shell's usual code and leaves no file.
#[test]
fn ctrl_c_stops_and_leaves_nothing() {
    let (_keep, folder) = desk();
    let mut child = Command::new(env!("CARGO_BIN_EXE_inkrig"))
        .current_dir(&folder)
        .args([&ALIGN[..], &["--iterations", "20000"]].concat())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(700));
    interrupt(&child);
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(130));
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 2);
}

/// Where no bar asks for it, one Ctrl-C is enough: here while a pipe is read that nobody writes to.
#[test]
fn ctrl_c_ends_a_wait_at_once() {
    let (_keep, folder) = desk();
    assert!(Command::new("mkfifo").arg(folder.join("pipe.bvh")).status().unwrap().success());
    let mut child = Command::new(env!("CARGO_BIN_EXE_inkrig"))
        .current_dir(&folder)
        .args(["align", "pipe.bvh", "--curve", "circles.csv", "-o", "new.bvh"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(500));
    interrupt(&child);
    let begin = Instant::now();
    let code = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status.code();
        }
        if begin.elapsed() > Duration::from_secs(10) {
            child.kill().unwrap();
            child.wait().unwrap();
            break None;
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    assert_eq!(code, Some(130));
    let mut said = String::new();
    std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut said).unwrap();
    assert!(said.contains("cancelled"), "{said}");
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 3, "no temporary file stays");
}

fn interrupt(child: &Child) {
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
}
