//! `cargo xtask gpu-check`: whether the second engine's training form still builds for graphics processors.

use anyhow::Result;

use crate::process;
use crate::tools::{self, Context};

/// Features of `inkrig-generate`, and the program that a build needs, where it needs one.
const DEVICES: [(&str, Option<&str>); 2] = [("vulkan", None), ("cuda", Some("nvcc"))];

/// Checks each, or says what is missing for it. Takes long: burn's compilers for shaders are large.
pub(crate) fn run(context: &Context) -> Result<()> {
    for (feature, needed) in DEVICES {
        if let Some(program) = needed.filter(|program| tools::find_program(&[program]).is_none()) {
            println!("skipped: --features {feature} needs {program}, which is not in PATH");
            continue;
        }
        let mut command = context.cargo(&["check", "--package", "inkrig-generate", "--features", feature]);
        process::run(&mut command)?;
        println!("--features {feature} builds");
    }
    Ok(())
}
