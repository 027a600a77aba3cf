//! `inkrig bench`: cases beside simpler methods.

use super::{desk, inkrig, text};
use serde_json::Value;

fn bench(folder: &std::path::Path, more: &[&str]) -> Value {
    let arguments = [&["bench", "align", "--repeat", "1", "--json"], more].concat();
    let output = inkrig(folder, &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn align_stands_beside_simpler_methods() {
    let (_keep, folder) = desk();
    let table = bench(&folder, &["--case", "eight to snake", "--markdown", "table.md"]);
    let rows = table["rows"].as_array().unwrap();
    let methods: Vec<&str> = rows.iter().map(|row| row["method"].as_str().unwrap()).collect();
    assert_eq!(methods, ["inkrig", "one_stage", "nearest_patch", "time_warp", "random_chunks"]);
    let figure = |row: usize, name: &str| rows[row][name].as_f64().unwrap();
    // Align follows and stays near. A stretched clip is near without following, random pieces jump.
    assert!(figure(0, "structure_gain") > 0.8 && figure(0, "nearest_patch") < 0.25);
    assert!(rows[0]["misses"].as_array().unwrap().is_empty(), "{}", rows[0]["misses"]);
    assert!(figure(3, "structure_gain").abs() < 0.02 && figure(3, "nearest_patch") < 0.1);
    assert!(figure(4, "structure_gain") < 0.3 && figure(4, "jump_q999_ratio") > 4.0);
    assert_eq!(
        (rows[0]["gradients"].as_u64(), rows[3]["gradients"].as_u64()),
        (rows[1]["gradients"].as_u64(), Some(0))
    );
    assert!(rows.iter().all(|row| row["wall_seconds"].as_f64().unwrap() > 0.0));
    assert!(cfg!(not(unix)) || rows.iter().all(|row| row["cpu_seconds"].as_f64().unwrap() > 0.0));
    let page = std::fs::read_to_string(folder.join("table.md")).unwrap();
    assert!(page.contains("| eight to snake | random chunks |") && page.contains(env!("CARGO_PKG_VERSION")));
}

#[test]
fn a_folder_brings_its_clips_and_what_is_none_is_told() {
    let (_keep, folder) = desk();
    std::fs::write(folder.join("broken.bvh"), "HIERARCHY nonsense").unwrap();
    let table = bench(&folder, &[".", "--case", "chirp to person"]);
    assert_eq!(table["rows"].as_array().unwrap().len(), 5);
    assert_eq!(table["rows"][0]["source_frames"], 600, "twenty seconds of the clip");
    let reason = table["failures"][0]["reason"].as_str().unwrap();
    assert!(table["failures"].as_array().unwrap().len() == 1 && reason.contains("broken.bvh"), "{reason}");
}

#[test]
fn a_case_that_is_not_there_is_answered_with_those_that_are() {
    let (_keep, folder) = desk();
    let output = inkrig(&folder, &["bench", "align", "--case", "unicorn"]);
    let complaint = text(&output.stderr);
    assert!(
        !output.status.success() && complaint.contains("unicorn") && complaint.contains("eight to snake")
    );
}
