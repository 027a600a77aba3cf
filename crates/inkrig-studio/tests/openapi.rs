//! The description of the interface that the page's types are made of is that of the code.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::needless_pass_by_value,
    reason = "a test may panic, and prints"
)]

use std::path::Path;

#[test]
fn the_committed_description_is_that_of_the_code() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("openapi.json");
    let now = inkrig_studio::openapi();
    if std::env::var_os("INKRIG_WRITE_OPENAPI").is_some() {
        std::fs::write(&path, &now).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default().replace("\r\n", "\n");
    let differs = now.lines().zip(committed.lines()).find(|(now, committed)| now != committed);
    assert!(
        now == committed,
        "crates/inkrig-studio/openapi.json is not what the code says, first here: {differs:?}\n\
         write it with: INKRIG_WRITE_OPENAPI=1 cargo test -p inkrig-studio --test openapi"
    );
    for path in ["/api/project/commands", "/api/clips/{id}/poses", "/api/results/{id}/plan", "/api/export"] {
        assert!(now.contains(&format!("\"{path}\"")), "{path}");
    }
}
