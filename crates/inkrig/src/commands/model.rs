//! `inkrig model`: files of weights.

use crate::cli::{ModelArgs, ModelCommand, ModelImportArgs, ModelInspectArgs, ModelPackArgs, TextArg};
use crate::console::Console;
use crate::error::CliError;
use crate::names;
use crate::output::Output;
use crate::printable::{self, counted};
use inkrig_generate::checkpoint::{
    About, CheckpointError, Import, Listed, MOST_NPY_BYTES, ModelFile, ModelHeader, NetworkRow, NumberKind,
    Safetensors, TensorSource, TorchFile, read_statistics, to_half, write_model,
};
use inkrig_generate::configuration::TextEncoderKind;
use inkrig_generate::weights::Tensor;
use inkrig_train::training::examples;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufWriter, ErrorKind, Read, Write as _};
use std::path::Path;

pub(super) fn run(args: &ModelArgs, console: &Console) -> Result<(), CliError> {
    match &args.command {
        ModelCommand::Import(args) => import(args, console),
        ModelCommand::Inspect(args) => inspect(args, console),
        ModelCommand::Pack(args) => pack(args, console),
    }
}

fn import(args: &ModelImportArgs, console: &Console) -> Result<(), CliError> {
    let wrong = |cause: CheckpointError| CliError::Model { path: args.file.clone(), cause: Box::new(cause) };
    let output = Output { force: args.force };
    output.check(&args.output)?;
    let stage = console.stage(format!("reading {}", printable::path(&args.file)));
    let mut source = open(&args.file)?;
    let plan = Import::plan(source.listed(), args.evaluator).map_err(wrong)?;
    let (statistics, skeleton) = match &args.stats {
        Some(folder) => {
            let read = read_statistics(|name| small_file(&folder.join(name)));
            let (statistics, skeleton) =
                read.map_err(|cause| CliError::Model { path: folder.clone(), cause: Box::new(cause) })?;
            (Some(statistics), skeleton)
        }
        None => (None, None),
    };
    let stem = args.file.file_stem().unwrap_or_default().to_string_lossy();
    let about = About {
        name: args.name.clone().unwrap_or_else(|| stem.into_owned()),
        data: args.data.clone(),
        licence: args.licence.clone(),
        text: args.text.map(|text| match text {
            TextArg::Verbs => TextEncoderKind::Verbs,
            TextArg::SentenceT5 => TextEncoderKind::SentenceT5,
            TextArg::Clip => TextEncoderKind::Clip,
        }),
        statistics,
        skeleton,
        half: args.half,
    };
    let mut facts = Facts::of_plan(&plan);
    if plan.missing().next().is_some() {
        drop(stage);
        console.say(facts.table())?;
    }
    let header = output.stream(&args.output, |file| {
        let mut out = BufWriter::new(file);
        let header = plan.write(source.as_mut(), &about, &mut out).map_err(wrong)?;
        out.flush().map_err(|cause| wrong(cause.into()))?;
        Ok::<_, CliError>(header)
    })?;
    for lacking in [header.statistics().err(), header.skeleton().err()].into_iter().flatten() {
        facts.remarks.push(lacking.to_string());
    }
    facts.header = Some(header);
    console.say(format!("{}: {}", printable::path(&args.file), facts.table()))?;
    console.say(format!("written: {}", printable::path(&args.output)))?;
    console.result(&facts)
}

fn inspect(args: &ModelInspectArgs, console: &Console) -> Result<(), CliError> {
    let wrong = |cause: CheckpointError| CliError::Model { path: args.file.clone(), cause: Box::new(cause) };
    let own = if is_safetensors(&args.file) { Some(ModelFile::open(file(&args.file)?)) } else { None };
    let facts = match own {
        Some(Ok(mut model)) => {
            let stage = console.stage(format!("reading {}", printable::path(&args.file)));
            // All of it is read, so that a damaged one is found.
            model.tensors().map_err(wrong)?;
            drop(stage);
            let mut facts = Facts::of_plan(&Import::plan(model.listed(), true).map_err(wrong)?);
            for lacking in
                [model.header().statistics().err(), model.header().skeleton().err()].into_iter().flatten()
            {
                facts.remarks.push(lacking.to_string());
            }
            facts.header = Some(model.header().clone());
            facts
        }
        // Without a header of ours it may still be weights to import.
        Some(Err(error)) if !matches!(error, CheckpointError::Unsupported { .. }) => {
            return Err(wrong(error));
        }
        _ => Facts::of_plan(&Import::plan(open(&args.file)?.listed(), false).map_err(wrong)?),
    };
    console.say(format!("{}: {}", printable::path(&args.file), facts.table()))?;
    console.result(&facts)
}

/// What `--json` says of a model that was packed; the names are stable.
#[derive(Serialize)]
struct Packed {
    output: String,
    tensors: usize,
    numbers: usize,
    bytes: u64,
    header: ModelHeader,
}

fn pack(args: &ModelPackArgs, console: &Console) -> Result<(), CliError> {
    let read = |path: &Path| {
        let wrong =
            |cause: CheckpointError| CliError::Model { path: path.to_path_buf(), cause: Box::new(cause) };
        let mut model = ModelFile::open(file(path)?).map_err(wrong)?;
        let tensors = model.tensors().map_err(wrong)?;
        Ok::<_, CliError>((model.header().clone(), tensors))
    };
    names::results_differ([&*args.file].into_iter().chain(args.without.as_deref()), [&*args.output])?;
    let output = Output { force: args.force };
    output.check(&args.output)?;
    let stage = console.stage(format!("reading {}", printable::path(&args.file)));
    let (header, mut tensors) = read(&args.file)?;
    if let Some(corpus) = &args.examples {
        let found = examples(corpus, &header, &tensors).map_err(|cause| CliError::Train(Box::new(cause)))?;
        tensors.extend(found);
    }
    let base = args.without.as_deref().map(read).transpose()?.map(|(_, tensors)| tensors);
    let same = |name: &str, tensor: &Tensor| {
        let base = base.as_ref().and_then(|base| base.get(name));
        base.is_some_and(|base| {
            base.shape() == tensor.shape() && halved(base.data()) == halved(tensor.data())
        })
    };
    let kept: Vec<(&str, &Tensor)> = tensors.iter().filter(|(name, tensor)| !same(name, tensor)).collect();
    let listed: Vec<Listed> = kept
        .iter()
        .map(|(name, tensor)| Listed {
            name: (*name).into(),
            shape: tensor.shape().to_vec(),
            kind: NumberKind::F16,
        })
        .collect();
    let stem = args.file.file_stem().unwrap_or_default().to_string_lossy();
    let about = ModelHeader {
        name: args.name.clone().unwrap_or_else(|| stem.into_owned()),
        data: args.data.clone(),
        licence: args.licence.clone(),
        text_weight: args.text_weight.map(|weight| weight as f32).or(header.text_weight),
        ..header
    };
    let wrong = |cause: CheckpointError| CliError::Model { path: args.file.clone(), cause: Box::new(cause) };
    let header = output.stream(&args.output, |file| {
        let mut out = BufWriter::new(file);
        let missing = || CheckpointError::Header { what: "a tensor went missing".into() };
        let next = |at: usize| kept.get(at).map(|(_, tensor)| (*tensor).clone()).ok_or_else(missing);
        let header = write_model(&mut out, &about, &listed, next).map_err(wrong)?;
        out.flush().map_err(|cause| wrong(cause.into()))?;
        Ok::<_, CliError>(header)
    })?;
    drop(stage);
    let numbers = listed.iter().map(Listed::numbers).sum();
    let bytes = std::fs::metadata(&args.output).map_or(0, |facts| facts.len());
    let facts =
        Packed { output: printable::json_path(&args.output), tensors: listed.len(), numbers, bytes, header };
    let (tensors, size) = (counted(facts.tensors, "tensor"), bytes as f64 / 1e6);
    console.say(format!("wrote {}: {tensors}, {size:.1} MB", printable::path(&args.output)))?;
    console.result(&facts)
}

/// As they are once they were written in half precision.
fn halved(numbers: &[f32]) -> Vec<u16> {
    numbers.iter().map(|number| to_half(*number)).collect()
}

fn is_safetensors(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("safetensors"))
}

fn file(path: &Path) -> Result<File, CliError> {
    File::open(path).map_err(|cause| CliError::Read { path: path.to_path_buf(), cause })
}

fn open(path: &Path) -> Result<Box<dyn TensorSource>, CliError> {
    let wrong = |cause: CheckpointError| CliError::Model { path: path.to_path_buf(), cause: Box::new(cause) };
    let file = file(path)?;
    Ok(if is_safetensors(path) {
        Box::new(Safetensors::open(file).map_err(wrong)?)
    } else {
        Box::new(TorchFile::open(file).map_err(wrong)?)
    })
}

/// A file of statistics, or one byte more than is read; `None` where there is none.
fn small_file(path: &Path) -> Result<Option<Vec<u8>>, CheckpointError> {
    let mut bytes = Vec::new();
    match File::open(path) {
        Ok(file) => file.take(MOST_NPY_BYTES as u64 + 1).read_to_end(&mut bytes)?,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    Ok(Some(bytes))
}

/// What is said of a file of weights; the names are stable.
#[derive(Serialize)]
struct Facts {
    model: &'static str,
    networks: Vec<Network>,
    not_read: Vec<NotRead>,
    remarks: Vec<String>,
    header: Option<ModelHeader>,
}

#[derive(Serialize)]
struct Network {
    name: &'static str,
    tensors: usize,
    numbers: usize,
    missing: Vec<String>,
    not_read: usize,
}

#[derive(Serialize)]
struct NotRead {
    why: &'static str,
    tensors: usize,
    first: String,
}

impl Facts {
    fn of_plan(plan: &Import) -> Self {
        let mut not_read: BTreeMap<&'static str, NotRead> = BTreeMap::new();
        for (name, why) in plan.ignored() {
            let first = || NotRead { why, tensors: 0, first: printable::text(name) };
            not_read.entry(why).or_insert_with(first).tensors += 1;
        }
        let network = |row: &NetworkRow| Network {
            name: row.network,
            tensors: row.found,
            numbers: row.numbers,
            missing: row.missing.clone(),
            not_read: row.ignored,
        };
        Self {
            model: plan.kind().name(),
            networks: plan.rows().iter().map(network).collect(),
            not_read: not_read.into_values().collect(),
            remarks: plan.remarks(),
            header: None,
        }
    }

    fn table(&self) -> String {
        let mut text = format!(
            "{}\n\n  {:26}{:>8}{:>12}{:>9}{:>10}",
            self.model, "network", "tensors", "numbers", "missing", "not read"
        );
        let mut total = (0, 0, 0, 0);
        for row in &self.networks {
            total = (
                total.0 + row.tensors,
                total.1 + row.numbers,
                total.2 + row.missing.len(),
                total.3 + row.not_read,
            );
            let _ = write!(
                text,
                "\n  {:26}{:>8}{:>12}{:>9}{:>10}",
                row.name,
                row.tensors,
                row.numbers,
                row.missing.len(),
                row.not_read
            );
        }
        let _ = write!(text, "\n  {:26}{:>8}{:>12}{:>9}{:>10}\n", "all", total.0, total.1, total.2, total.3);
        for NotRead { why, tensors, first } in &self.not_read {
            let _ = write!(text, "\nnot read: {}, such as {first}: {why}", counted(*tensors, "tensor"));
        }
        if let Some(header) = &self.header {
            let _ = write!(
                text,
                "\nname: {}\ntrained on: {}\nlicence: {}\ntext: {}",
                printable::text(&header.name),
                printable::text(&header.data),
                printable::text(&header.licence),
                match header.text {
                    TextEncoderKind::Verbs => "a table of action verbs in the model",
                    TextEncoderKind::SentenceT5 => "Sentence-T5 large, a file of its own",
                    TextEncoderKind::Clip => "CLIP ViT-L/14, a file of its own",
                }
            );
        }
        for remark in &self.remarks {
            let _ = write!(text, "\n{remark}");
        }
        text
    }
}
