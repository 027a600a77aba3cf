//! `cargo xtask torch-check`: checkpoints that PyTorch itself writes come in whole, and a harmful one does not.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Result, bail};

use crate::tools::Context;
use crate::{demo, process, python};

const SCRIPT: &str = "xtask/torch/checkpoint.py";

/// Writes them, imports them, compares; fails when a bit differs or something was run that a file asked for.
pub(crate) fn run(context: &Context) -> Result<()> {
    let folder = context.target()?.join("torch-check");
    demo::empty(&folder)?;
    let python =
        python::environment(context, "torch", "xtask/torch/requirements.txt", &["python3", "python3.11"])?;
    let mut names = context.cargo(&["run"]);
    names.args(["--quiet", "--package", "inkrig-generate", "--example", "tensor_names"]);
    fs::write(folder.join("names.tsv"), process::output(&mut names)?)?;
    let script = |arguments: &[&Path]| {
        let mut command = Command::new(&python);
        command.arg("-B").arg(context.root.join(SCRIPT)).args(arguments);
        process::run(&mut command)
    };
    script(&["write".as_ref(), &folder.join("names.tsv"), &folder])?;
    for file in ["whole.ckpt", "legacy.pt"] {
        let out = folder.join(file).with_extension("safetensors");
        let done = import(context, &folder.join(file), &out)?;
        if file == "legacy.pt" && !done {
            // Written before 2020: the import says so, and how to save it anew.
            println!("{file}: refused, as documented");
            continue;
        }
        if !done {
            bail!("{file} was not imported");
        }
        script(&["compare".as_ref(), &folder.join(file), &out])?;
    }
    if import(context, &folder.join("harmful.ckpt"), &folder.join("harmful.safetensors"))? {
        bail!("harmful.ckpt was imported");
    }
    if folder.join("harmed").exists() {
        bail!("importing harmful.ckpt ran what it asked for");
    }
    println!("checkpoints of PyTorch come in bit for bit; a harmful one is refused");
    Ok(())
}

/// Whether `inkrig model import` took a file.
fn import(context: &Context, file: &Path, out: &Path) -> Result<bool> {
    let mut command = context.cargo(&["run"]);
    command.args(["--release", "--quiet", "--package", "inkrig", "--", "model", "import"]);
    let (status, _) = process::tee(command.arg(file).arg("-o").arg(out))?;
    Ok(status.success())
}
