//! `inkrig model` on the command line.

use crate::{desk, inkrig, text};

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
