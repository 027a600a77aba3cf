//! Takes in the page that `cargo xtask web` has built, packed; a build without it has none. Never calls npm.
#![allow(clippy::print_stdout, reason = "this is how a build script speaks to cargo")]

use flate2::{Compression, write::GzEncoder};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let root = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from).unwrap_or_default();
    let out = env::var_os("OUT_DIR").map(PathBuf::from).unwrap_or_default();
    let dist = root.join("../../web/dist");
    println!("cargo::rerun-if-changed=build.rs");
    let mut table = String::from("&[\n");
    if dist.join("index.html").is_file() {
        println!("cargo::rerun-if-changed={}", dist.display());
        let mut files = Vec::new();
        list(&dist, &mut files)?;
        files.sort();
        for (index, file) in files.iter().enumerate() {
            let name = file.strip_prefix(&dist).unwrap_or(file).to_string_lossy().replace('\\', "/");
            let bytes = fs::read(file)?;
            let mut packer = GzEncoder::new(Vec::new(), Compression::best());
            packer.write_all(&bytes)?;
            let packed = packer.finish()?;
            // Pictures are packed already.
            let smaller = packed.len() * 10 < bytes.len() * 9;
            let place = out.join(format!("page-{index}"));
            fs::write(&place, if smaller { packed } else { bytes })?;
            let _ = writeln!(table, "    ({name:?}, include_bytes!({place:?}), {smaller}),");
        }
    }
    table.push(']');
    fs::write(out.join("page.rs"), table)
}

fn list(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            list(&path, files)?;
        } else if path.extension().is_none_or(|ending| ending != "map") {
            files.push(path);
        }
    }
    Ok(())
}
