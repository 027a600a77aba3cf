//! A corpus to train on within seconds.

use inkrig_train::corpus::{Config, Shard, build};
use inkrig_train::training::Place;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// A corpus of one walk, to learn from and to measure on.
pub(crate) fn corpus(desk: &Path) -> PathBuf {
    let person = inkrig_samples::find("person").unwrap().bytes;
    for subject in ["ann", "bob"] {
        let folder = desk.join("data").join(subject);
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("walk.bvh"), person).unwrap();
    }
    let config = "[[source]]\nname='own'\nfolder='data'\nlicence='free'\nsubjects={bob='val'}\n";
    std::fs::write(desk.join("corpus.toml"), config).unwrap();
    let config = Config::read(&desk.join("corpus.toml")).unwrap();
    let out = desk.join("corpus");
    build(&config, &out, Shard::ALL, 1, &|_| ControlFlow::Continue(())).unwrap();
    out
}

/// Where a run works.
pub(crate) fn place<'a>(corpus: &'a Path, folder: &'a Path, replicas: usize) -> Place<'a> {
    Place { corpus, folder, from: None, replicas }
}
