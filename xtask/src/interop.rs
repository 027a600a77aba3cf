//! `cargo xtask interop`: other programs read our files, and must see every joint where we say it is.

mod tracks;

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result, bail};
use serde_json::Value;

use crate::tools::Context;
use crate::{browser, demo, process, python};
use tracks::{Comparison, Tracks};

/// The version that Blender's wheel is made for.
const PYTHON: [&str; 1] = ["python3.11"];

/// Importers: name, script, the formats they read, and how far a joint may stand off, millimetres.
///
/// Positions are f32, and a chain of thirty joints a few metres from the origin loses some micrometres; Blender keeps
/// angles and lengths of bones rather than places.
const IMPORTERS: [Importer; 3] = [
    Importer { name: "blender", script: "blender.py", reads: &["bvh", "glb", "fbx", "usda"], most: 0.1 },
    Importer { name: "usd-core", script: "usd.py", reads: &["usda"], most: 0.1 },
    Importer { name: "three", script: "three.mjs", reads: &["bvh", "glb", "fbx"], most: 0.1 },
];

struct Importer {
    name: &'static str,
    script: &'static str,
    reads: &'static [&'static str],
    /// Largest distance of a joint from where we say it is, millimetres.
    most: f64,
}

/// Writes motions, has them read, prints a table; fails when a joint is missing or stands off.
pub(crate) fn run(context: &Context, importer: Option<&str>) -> Result<()> {
    let folder = context.target()?.join("interop");
    demo::empty(&folder)?;
    let mut write = context.cargo(&["run"]);
    write.args(["--release", "--quiet", "--package", "inkrig", "--example", "interop", "--"]);
    process::run(write.arg(&folder).arg(context.reference()))?;
    let files: Vec<Value> = serde_json::from_slice(&fs::read(folder.join("files.json"))?)?;
    let mut failed = Vec::new();
    let chosen = IMPORTERS.iter().filter(|one| importer.is_none_or(|name| name == one.name));
    let mut lines = Vec::new();
    for importer in chosen {
        let out = folder.join(importer.name);
        demo::empty(&out)?;
        process::run(importer.command(context)?.arg(&folder).arg(&out))?;
        for file in &files {
            let name = file["file"].as_str().context("files.json names no file")?;
            let expected = file["expected"].as_str().context("files.json names no places")?;
            if !importer.reads.iter().any(|ending| name.ends_with(&format!(".{ending}"))) {
                continue;
            }
            let (line, good) = importer.judge(name, &folder.join(expected), &out.join(name));
            if !good {
                failed.push(format!("{name} in {}", importer.name));
            }
            lines.push(line + if good { "" } else { "  <- fails" });
        }
    }
    println!("\n{}", Comparison::HEAD);
    for line in &lines {
        println!("{line}");
    }
    if lines.is_empty() {
        bail!("nothing was compared; importers: {}", IMPORTERS.map(|one| one.name).join(", "));
    }
    if !failed.is_empty() {
        bail!("{} of {} stand off: {}", failed.len(), lines.len(), failed.join(", "));
    }
    println!("\n{} files in other programs, every joint where it should be", lines.len());
    Ok(())
}

impl Importer {
    /// A line of the table, and whether all is well. Beside `found` an importer leaves a note when it cannot read a file
    /// (`.skipped`, known of that program) or when something is wrong with it (`.failed`).
    fn judge(&self, file: &str, expected: &Path, found: &Path) -> (String, bool) {
        let note = |kind: &str| fs::read_to_string(format!("{}.{kind}", found.display())).ok();
        if let Some(why) = note("skipped") {
            return (format!("{file:<28}{:<10}  not read: {why}", self.name), true);
        }
        let compared = match note("failed") {
            Some(why) => Err(anyhow::anyhow!(why)),
            None => Tracks::read(found).and_then(|found| Tracks::read(expected)?.compare(&found)),
        };
        match compared {
            Ok(it) => (it.line(file, self.name), it.is_whole() && it.most_mm <= self.most),
            Err(error) => (format!("{file:<28}{:<10}  {error:#}", self.name), false),
        }
    }

    /// The program with its script and what the script needs.
    fn command(&self, context: &Context) -> Result<Command> {
        let script = context.root.join("xtask/interop").join(self.script);
        if script.extension().is_some_and(|extension| extension == "mjs") {
            let node = browser::node().context("not installed: nodejs")?;
            let npm = browser::npm().context("not installed: npm")?;
            let modules = browser::install_modules(context, &npm, "interop")?;
            let mut command = Command::new(node);
            command.arg(script).arg(modules);
            Ok(command)
        } else {
            let requirements = "xtask/interop/requirements.txt";
            let mut command = Command::new(python::environment(context, "interop", requirements, &PYTHON)?);
            command.arg("-B").arg(script);
            Ok(command)
        }
    }
}
