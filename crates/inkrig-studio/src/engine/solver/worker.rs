//! The thread itself, and what it keeps.

use super::Shown;
use super::inbox::{Inbox, Task};
use super::preview::Ready;
use crate::StudioError;
use crate::document::Document;
use crate::engine::media::Media;
use crate::engine::results::Results;
use crate::engine::{Prepared, SourceKey};
use crate::events::Events;
use crate::project::Folder;
use std::sync::{Arc, Mutex};
use tokio::sync::watch;

/// What the thread keeps.
pub(super) struct Worker {
    pub(super) inbox: Arc<Inbox>,
    pub(super) folder: Arc<Folder>,
    pub(super) media: Arc<Media>,
    pub(super) events: Events,
    pub(super) threads: usize,
    pub(super) shown: watch::Sender<Option<Shown>>,
    pub(super) results: Arc<Mutex<Results>>,
    pub(super) source: Option<(SourceKey, Prepared)>,
    pub(super) live: Option<Ready>,
}

impl Worker {
    pub(super) fn run(mut self) {
        loop {
            match self.inbox.next() {
                Task::Stop => return,
                Task::Live(live) => self.show(&live),
                Task::Job(job) => self.work(job),
            }
        }
    }

    /// The source of a document, read once for as long as it is the same.
    pub(super) fn prepared(&mut self, document: &Document) -> Result<Prepared, StudioError> {
        let key = SourceKey::of(document);
        if let Some((known, prepared)) = &self.source
            && *known == key
        {
            return Ok(prepared.clone());
        }
        let prepared = Prepared::source(document, &self.folder, &self.media)?;
        self.source = Some((key, prepared.clone()));
        Ok(prepared)
    }
}
