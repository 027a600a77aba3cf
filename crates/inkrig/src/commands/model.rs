//! `inkrig model`: files of weights.

use crate::cli::{ModelArgs, ModelCommand, ModelImportArgs, ModelInspectArgs, ModelPackArgs, TextArg};
use crate::console::Console;
use crate::error::CliError;
use crate::output::Output;
use crate::printable::{self, counted};
use crate::{names, results};
use inkrig_generate::checkpoint::{
    About, CheckpointError, Import, Listed, MOST_NPY_BYTES, ModelFile, ModelHeader, NetworkRow, NumberKind,
    Safetensors, TensorSource, TorchFile, read_statistics, to_half, write_model,
};
use inkrig_generate::configuration::TextEncoderKind;
use inkrig_generate::readers::file as readers;
use inkrig_generate::sampling::Examples;
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
    if is_safetensors(&args.file) {
        let file = Safetensors::open(file(&args.file)?).map_err(wrong)?;
        let own = |what: &str, todo| wrong(CheckpointError::Unsupported { what: what.into(), todo });
        if ModelFile::is_of(&file) {
            return Err(own("this is a model file of inkrig already", "give it to --model as it is"));
        }
        if readers::header(&file).is_some() {
            let todo = "give it to --weights of inkrig sketch read or inkrig sketch word as it is";
            return Err(own("these are weights of a reader of inkrig already", todo));
        }
    }
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
            let mut facts = Facts::of_plan(&Import::of_model(model.header(), model.listed()).map_err(wrong)?);
            for lacking in
                [model.header().statistics().err(), model.header().skeleton().err()].into_iter().flatten()
            {
                facts.remarks.push(lacking.to_string());
            }
            facts.header = Some(model.header().clone());
            facts
        }
        // Without a header of ours it may still be a reader's, or weights to import.
        Some(Err(error)) => {
            let mut weights = Safetensors::open(file(&args.file)?).map_err(wrong)?;
            match readers::header(&weights) {
                _ if ModelFile::is_of(&weights) => return Err(wrong(error)),
                Some(header) => Facts::of_reader(&header, &mut weights).map_err(wrong)?,
                None => Facts::of_plan(&Import::plan(weights.listed(), false).map_err(wrong)?),
            }
        }
        None => Facts::of_plan(&Import::plan(open(&args.file)?.listed(), false).map_err(wrong)?),
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
    warnings: Vec<String>,
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
    results::check_ending(&args.output, "safetensors", "a model")?;
    let output = Output { force: args.force };
    output.check(&args.output)?;
    let stage = console.stage(format!("reading {}", printable::path(&args.file)));
    let (header, mut tensors) = read(&args.file)?;
    if let Some(corpus) = &args.examples {
        let found = examples(corpus, &header, &tensors).map_err(|cause| CliError::Train(Box::new(cause)))?;
        if found.get(Examples::VERBS).is_none_or(|verbs| verbs.data().is_empty()) {
            return Err(CliError::NoVerbs { path: corpus.clone() });
        }
        tensors.extend(found);
    }
    let base = args.without.as_deref().map(read).transpose()?;
    let same = |name: &str, tensor: &Tensor| {
        let base = base.as_ref().and_then(|(_, base)| base.get(name));
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
    let (licence, warning) = licence(args, &header.licence);
    let warnings: Vec<String> = warning.into_iter().collect();
    for warning in &warnings {
        console.warn(warning);
    }
    let said = Some(header.data.clone()).filter(|data| !data.is_empty());
    let about = ModelHeader {
        name: args.name.clone().unwrap_or_else(|| stem.into_owned()),
        data: args.data.clone().or(said).unwrap_or_else(|| "not stated".into()),
        licence,
        laid_over: match base {
            Some((base, _)) if kept.len() < tensors.len() => Some(base.name),
            _ => header.laid_over.clone(),
        },
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
    let output = printable::json_path(&args.output);
    let facts = Packed { output, tensors: listed.len(), numbers, bytes, warnings, header };
    let (tensors, size) = (counted(facts.tensors, "tensor"), bytes as f64 / 1e6);
    console.say(format!("wrote {}: {tensors}, {size:.1} MB", printable::path(&args.output)))?;
    console.result(&facts)
}

/// What may be done with a packed model, and what to say where that is not all that its source says.
fn licence(args: &ModelPackArgs, source: &str) -> (String, Option<String>) {
    const NOT_STATED: &str = "not stated: ask its authors";
    let source = if source.trim().is_empty() { NOT_STATED } else { source };
    let Some(asked) = &args.licence else { return (source.into(), None) };
    let credit = source.split_once("credit:").map_or("", |(_, credit)| credit.trim());
    if source == NOT_STATED || asked.contains(source) {
        return (asked.clone(), None);
    }
    let shown = format!("the licence of {} is: {}", printable::path(&args.file), printable::text(source));
    if credit.is_empty() || asked.contains(credit) {
        return (asked.clone(), Some(format!("{shown}; --licence takes its place: it must allow that")));
    }
    if args.no_credit {
        return (asked.clone(), Some(format!("{shown}; its credit is left out: it must allow that")));
    }
    let what = "--licence takes its place, and its credit stays (--no-credit leaves it out)";
    (format!("{asked}; credit: {credit}"), Some(format!("{shown}; {what}")))
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

    /// Of a reader of drawings. All of it is read, so that a damaged one is found.
    fn of_reader(header: &readers::Header, file: &mut Safetensors<File>) -> Result<Self, CheckpointError> {
        for at in 0..file.listed().len() {
            file.read(at)?;
        }
        let (model, name) = match header.reads.as_str() {
            "sketch" => ("a reader of inkrig, of drawn figures", "figures"),
            "word" => ("a reader of inkrig, of words written by hand", "words"),
            _ => ("a reader of inkrig, of a kind that this program does not know", "others"),
        };
        let numbers = file.listed().iter().map(Listed::numbers).sum();
        let network =
            Network { name, tensors: file.listed().len(), numbers, missing: Vec::new(), not_read: 0 };
        let remarks = Some(printable::text(&header.card)).filter(|card| !card.is_empty());
        Ok(Self {
            model,
            networks: vec![network],
            not_read: Vec::new(),
            remarks: remarks.into_iter().collect(),
            header: None,
        })
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
            if let Some(base) = &header.laid_over {
                let _ = write!(text, "\nthe other weights are in: {}", printable::text(base));
            }
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
