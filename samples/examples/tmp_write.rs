#![allow(missing_docs)]
#[allow(clippy::unwrap_used)]
fn main() {
    inkrig_samples::make::write_all(std::path::Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
}
