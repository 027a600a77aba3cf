//! `cargo xtask fuzz`: each test of the `tests/fuzz_*.rs` files for a given time, one after the other.

use anyhow::{Context as _, Result, bail};
use serde_json::Value;

use crate::process;
use crate::tools::Context;

/// Runs the fuzz tests with `filter` in their name for `seconds` each; all of them, then reports those that failed.
///
/// The dev profile is used on purpose: it checks arithmetic for overflow.
pub(crate) fn run(context: &Context, seconds: u64, filter: Option<&str>) -> Result<()> {
    let mut ran = 0;
    let mut failed = Vec::new();
    for (package, target) in fuzz_targets(&context.metadata()?)? {
        let test = || {
            let mut command = context.cargo(&["test"]);
            command.args(["--quiet", "--package", &package, "--test", &target, "--"]);
            command
        };
        for name in test_names(&process::output(test().args(["--list", "--format", "terse"]))?) {
            let full_name = format!("{package} {target} {name}");
            if filter.is_some_and(|filter| !full_name.contains(filter)) {
                continue;
            }
            println!("\n== {full_name}, {seconds} s");
            let mut command = test();
            command.args(["--exact", &name, "--nocapture"]);
            // Both are set: a test's own number of rounds would end it early.
            command.env("BOLERO_RANDOM_TEST_TIME_MS", seconds.saturating_mul(1000).to_string());
            command.env("BOLERO_RANDOM_ITERATIONS", usize::MAX.to_string());
            ran += 1;
            if let Err(error) = process::run(&mut command) {
                println!("{error:#}");
                failed.push(full_name);
            }
        }
    }
    if ran == 0 {
        bail!("there is no such fuzz test");
    }
    println!("\n{} passed, {} failed, 0 skipped", ran - failed.len(), failed.len());
    if !failed.is_empty() {
        bail!("fuzzing found something: {}", failed.join(", "));
    }
    Ok(())
}

/// Package and name of each test target whose name starts with `fuzz_`.
fn fuzz_targets(metadata: &Value) -> Result<Vec<(String, String)>> {
    let mut found = Vec::new();
    for package in metadata["packages"].as_array().context("cargo metadata names no packages")? {
        let targets = package["targets"].as_array().map_or(&[][..], Vec::as_slice);
        let is_test =
            |target: &&Value| target["kind"].as_array().is_some_and(|kinds| kinds.contains(&"test".into()));
        let names = targets.iter().filter(is_test).filter_map(|target| target["name"].as_str());
        let package = package["name"].as_str().unwrap_or_default();
        found.extend(
            names.filter(|name| name.starts_with("fuzz_")).map(|name| (package.to_owned(), name.to_owned())),
        );
    }
    Ok(found)
}

/// Names of the tests in the output of `--list --format terse`.
fn test_names(list: &str) -> Vec<String> {
    list.lines().filter_map(|line| line.strip_suffix(": test")).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fuzz_targets_are_the_test_files_of_that_name() {
        let metadata = serde_json::json!({ "packages": [
            { "name": "a", "targets": [
                { "name": "fuzz_bvh", "kind": ["test"] },
                { "name": "fuzz_tool", "kind": ["bin"] },
                { "name": "reading", "kind": ["test"] },
            ] },
            { "name": "b", "targets": [] },
        ] });
        assert_eq!(fuzz_targets(&metadata).unwrap(), [("a".to_owned(), "fuzz_bvh".to_owned())]);
        assert!(fuzz_targets(&Value::Null).is_err());
    }

    #[test]
    fn benchmarks_are_no_tests() {
        assert_eq!(test_names("any_bytes: test\nspeed: benchmark\n\n1 test, 1 benchmark\n"), ["any_bytes"]);
    }
}
