//! `inkrig data`: folders of motion become a corpus.

use crate::cli::{CorpusArgs, DataArgs, DataCommand};
use crate::console::Console;
use crate::error::CliError;
use crate::printable::{self, counted, fixed, json_path};
use inkrig_train::TrainError;
use inkrig_train::corpus::{Built, Config, Shard, Split, build, finish};
use serde::Serialize;

pub(super) fn run(args: &DataArgs, console: &Console) -> Result<(), CliError> {
    match &args.command {
        DataCommand::Build { corpus, shard, threads } => {
            let shard = shard.unwrap_or(Shard::ALL);
            let config = Config::read(&corpus.config)?;
            let bar = console.bar("reading motion");
            let threads = threads.unwrap_or(0);
            let built = build(&config, &corpus.out, shard, threads, &|at| bar.at(at.done, at.total));
            // A press of Ctrl-C is said in the usual way.
            bar.finish()?;
            match built? {
                Some(built) => say(&built, corpus, console),
                None => console.say(format!(
                    "share {}/{} is done; inkrig data merge makes a corpus of all shares",
                    shard.index, shard.count
                )),
            }
        }
        DataCommand::Merge { corpus } => {
            let config = Config::read(&corpus.config)?;
            let stage = console.stage("making the lists");
            let built = finish(&config, &corpus.out)?;
            drop(stage);
            say(&built, corpus, console)
        }
    }
}

/// What is in a corpus; the names are stable.
#[derive(Serialize)]
struct Record {
    folder: String,
    clips: usize,
    rejected: usize,
    minutes: f64,
    train_minutes: f64,
    val_minutes: f64,
    test_minutes: f64,
}

fn say(built: &Built, corpus: &CorpusArgs, console: &Console) -> Result<(), CliError> {
    let entries = built.manifest.entries();
    let minutes = |split: Option<Split>| {
        let own = entries.iter().filter(|entry| split.is_none_or(|split| entry.split == split));
        own.map(|entry| entry.frames as f64).sum::<f64>() / inkrig_motion::humanml::FRAME_RATE / 60.0
    };
    let record = Record {
        folder: json_path(&corpus.out),
        clips: entries.len(),
        rejected: built.rejected.len(),
        minutes: minutes(None),
        train_minutes: minutes(Some(Split::Train)),
        val_minutes: minutes(Some(Split::Val)),
        test_minutes: minutes(Some(Split::Test)),
    };
    console.say(format!(
        "{} in {}: {} minutes to learn from, {} to look at while learning, {} to measure on; {} left out\n\
         open {} to see it",
        counted(record.clips, "clip"),
        printable::path(&corpus.out),
        fixed(record.train_minutes, 1),
        fixed(record.val_minutes, 1),
        fixed(record.test_minutes, 1),
        record.rejected,
        printable::path(&corpus.out.join("report.html")),
    ))?;
    console.result(&record)
}

impl From<TrainError> for CliError {
    fn from(error: TrainError) -> Self {
        Self::Train(Box::new(error))
    }
}
