//! The thread itself, and what it keeps.

use super::Shown;
use super::inbox::{Inbox, Task};
use super::preview::Ready;
use crate::StudioError;
use crate::document::{Document, Key};
use crate::engine::media::Media;
use crate::engine::results::Results;
use crate::engine::{Prepared, SourceKey, Waiting, Wishes};
use crate::events::Events;
use crate::project::Folder;
use inkrig_align::AlignError;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// Between the beginnings of two answers to a pen.
const PACE: Duration = Duration::from_millis(30);

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
    /// Keys that the engine refused, and the document's keys and source of which they are.
    pub(super) refused: Refused,
}

/// What the engine refused of a document.
#[derive(Debug, Default)]
pub(super) struct Refused {
    of: Option<(Vec<Key>, SourceKey)>,
    waiting: Vec<Waiting>,
}

impl Worker {
    pub(super) fn run(mut self) {
        loop {
            match self.inbox.next() {
                Task::Stop => return,
                Task::Live(live) => {
                    let begun = Instant::now();
                    self.show(&live);
                    // More poses than a page shows would take from it the time to show them.
                    std::thread::sleep(PACE.saturating_sub(begun.elapsed()));
                }
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

    /// The wishes of a document, without what was refused of it before.
    pub(super) fn wishes(&mut self, document: &Document, prepared: &Prepared) -> Result<Wishes, StudioError> {
        let mut wishes = prepared.wishes(document, &self.folder, &self.media)?;
        let of = Some((document.keys.clone(), SourceKey::of(document)));
        if self.refused.of != of {
            self.refused = Refused { of, waiting: Vec::new() };
        }
        wishes.leave_out(&self.refused.waiting);
        Ok(wishes)
    }

    /// Whether an error is of a single key, without which it is worth another try.
    pub(super) fn learns(&mut self, document: &Document, error: &StudioError) -> bool {
        let StudioError::Align(AlignError::Key { what }) = error else { return false };
        let wishes = self.prepared(document).and_then(|prepared| self.wishes(document, &prepared));
        let Some(refused) = wishes.ok().and_then(|wishes| wishes.named(what)) else { return false };
        self.refused.waiting.push(refused);
        true
    }
}
