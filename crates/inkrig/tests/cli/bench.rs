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

#[test]
fn a_sweep_has_a_page_a_picture_and_figures_of_every_value() {
    let (_keep, folder) = desk();
    let arguments = ["--case", "eight to snake", "--sweep", "alpha,levels", "--out", "new/sweep"];
    let sweep = bench(&folder, &arguments);
    let cells = |parameter: usize| sweep["parameters"][parameter]["cases"][0]["cells"].as_array().unwrap();
    assert_eq!((cells(0).len(), cells(1).len()), (5, 5));
    let figure = |cell: &Value, name: &str| cell[name].as_f64().unwrap();
    // What alpha is for: less of it stays nearer to the clip, more of it follows the control.
    let (least, most) = (&cells(0)[0], &cells(0)[4]);
    assert!(figure(least, "nearest_patch") < figure(most, "nearest_patch"));
    assert!(figure(least, "structure_pearson") < figure(most, "structure_pearson") + 0.02);
    let read = |name: &str| std::fs::read(folder.join("new/sweep").join(name)).unwrap();
    let page = text(&read("sweep.html"));
    assert_eq!(page.matches("data:image/png;base64,").count(), 2 * (1 + 5 * 2));
    assert_eq!(page.matches("class=\"own\"").count(), 2, "the default of either parameter is framed");
    assert!(!page.contains("http"), "nothing is loaded from elsewhere");
    assert!(read("sweep-alpha.png").starts_with(b"\x89PNG") && read("sweep-levels.png").len() > 5000);
    assert_eq!(text(&read("sweep.md")).matches("| eight to snake |").count(), 10);
    let again = inkrig(&folder, &[&["bench", "align"][..], &arguments].concat());
    assert!(
        !again.status.success() && text(&again.stderr).contains("--force"),
        "nothing is replaced without leave"
    );
}
