//! GLB files that the built program writes, in Khronos' glTF-Validator.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Result;

use crate::step::Verdict;
use crate::tools::Context;
use crate::{browser, demo, process, test};

/// Fails on an error or a warning about a GLB of its own, or about one that got a clip more.
pub(crate) fn check(context: &Context) -> Result<Verdict> {
    let tools = match browser::Tools::find(context)? {
        Ok(tools) => tools,
        Err(missing) => return Ok(Verdict::Skipped(missing)),
    };
    let target = context.target()?;
    let samples = target.join("demo");
    let folder = target.join("glb");
    demo::empty(&folder)?;
    let program = test::built_program(&target)?;
    let mut files: Vec<PathBuf> = Vec::new();
    for name in ["person", "quadruped", "snake"] {
        let (own, again) = (folder.join(format!("{name}.glb")), folder.join(format!("{name}-again.glb")));
        align(&program, &samples.join(format!("{name}.bvh")), &samples, &own)?;
        align(&program, &own, &samples, &again)?;
        files.extend([own, again]);
    }
    // Few keys in a file of its own and in one that was there, and poses that are held.
    for (from, name, bake) in [
        ("person.bvh", "few", "sparse"),
        ("../glb/person.glb", "few-again", "sparse"),
        ("person.bvh", "held", "stepped"),
    ] {
        let out = folder.join(format!("{name}.glb"));
        convert(&program, &samples.join(from), bake, &out)?;
        files.push(out);
    }
    let mut command = Command::new(&tools.node);
    command.arg(context.root.join("xtask/browser/validate.mjs")).arg(&tools.modules).args(files);
    process::run(&mut command)?;
    Ok(Verdict::Passed)
}

fn align(program: &Path, clip: &Path, samples: &Path, out: &Path) -> Result<()> {
    let mut command = Command::new(program);
    command.arg("align").arg(clip).arg("--curve").arg(samples.join("heart.json"));
    process::run(command.args(["--length", "4s", "--quiet", "-o"]).arg(out))
}

fn convert(program: &Path, clip: &Path, bake: &str, out: &Path) -> Result<()> {
    let mut command = Command::new(program);
    process::run(command.arg("convert").args([clip, out]).args(["--bake", bake, "--quiet"]))
}
