//! Whole results, and other work that takes its time.

use super::inbox::Job;
use super::worker::Worker;
use super::{Shown, lock};
use crate::StudioError;
use crate::engine::results::{Finished, Origin};
use crate::engine::{Prepared, Wishes, over_ground};
use crate::events::{Event, JobKind, JobStatus};
use inkrig_align::{AlignError, Alternative, Progress, align, alternatives};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Between two reports of progress.
const TELL: Duration = Duration::from_millis(50);

impl Worker {
    /// Does a job, tells what came of it, and shows its result.
    pub(super) fn work(&mut self, job: Job) {
        let mut done = self.solve(&job);
        while let Err(error) = &done
            && self.learns(&job.document, error)
        {
            done = self.solve(&job);
        }
        let mut work = self.inbox.lock();
        work.current = None;
        let stopped = work.cancelled.contains(&job.id);
        work.cancelled.retain(|id| *id != job.id);
        let outcome = match done {
            Ok(ids) => Ok(ids),
            Err(StudioError::Align(AlignError::Cancelled)) if !stopped && !work.stop => {
                // A pen was in the way. What follows a change follows the next one.
                if job.automatic {
                    let newer = work.settle.is_some();
                    if !newer {
                        work.settle = Some((job.document.clone(), job.revision, Instant::now()));
                    }
                    Err(None)
                } else {
                    work.jobs.push_back(job);
                    return;
                }
            }
            Err(StudioError::Align(AlignError::Cancelled)) => Err(None),
            Err(error) => Err(Some(error)),
        };
        let Some(state) = work.states.iter_mut().find(|state| state.id == job.id) else { return };
        match &outcome {
            Ok(ids) => {
                state.state = JobStatus::Done;
                state.done = state.total;
                state.result = ids.first().cloned();
                state.results.clone_from(ids);
            }
            Err(None) => state.state = JobStatus::Cancelled,
            Err(Some(error)) => {
                state.state = JobStatus::Failed;
                state.error = Some(error.to_string());
            }
        }
        let state = state.clone();
        drop(work);
        self.events.send(Event::Job(state));
        match outcome {
            Ok(ids) => {
                let chosen = if job.kind == JobKind::Solve { ids.first() } else { None };
                if let Some(id) = chosen {
                    let result = lock(&self.results).get(id);
                    if let Some(result) = result {
                        self.shown.send_replace(Some(Shown::Poses(Arc::new(result.poses()))));
                    }
                    let job = (!job.automatic).then(|| job.id.clone());
                    self.events.send(Event::Result { id: id.clone(), revision: self.revision_of(id), job });
                }
            }
            Err(Some(error)) if job.automatic => self.events.send(Event::problem(&error)),
            Err(_) => {}
        }
    }

    fn revision_of(&self, id: &str) -> u32 {
        lock(&self.results).get(id).map_or(0, |result| result.facts.revision)
    }

    fn solve(&mut self, job: &Job) -> Result<Vec<String>, StudioError> {
        let document = &job.document;
        let prepared = self.prepared(document)?;
        let mut wishes = self.wishes(document, &prepared)?;
        wishes.options.threads = self.threads;
        let Wishes { control, options, .. } = &wishes;
        let mut told = Instant::now();
        let observer = &mut |progress: Progress| self.progress(job, progress, &mut told);
        let chosen = document.settings.solution;
        let (solutions, several) = match job.kind {
            JobKind::Solve if chosen == 0 => {
                let alignment = align(&prepared.takes, control, options, observer)?;
                (vec![Alternative { alignment, objective: 0.0, distance: 0.0 }], false)
            }
            JobKind::Solve => {
                let mut all = alternatives(&prepared.takes, control, options, chosen + 1, observer)?;
                let one = all.swap_remove(chosen.min(all.len() - 1));
                (vec![one], true)
            }
            JobKind::Alternatives { most } => {
                (alternatives(&prepared.takes, control, options, most, observer)?, true)
            }
        };
        solutions
            .into_iter()
            .map(|solution| self.finish(solution, several, job, &prepared, &wishes))
            .collect()
    }

    fn finish(
        &self,
        solution: Alternative,
        several: bool,
        job: &Job,
        prepared: &Prepared,
        wishes: &Wishes,
    ) -> Result<String, StudioError> {
        let document = &job.document;
        let mut written_as = prepared.written_as.clone();
        let (clip, notes) =
            over_ground(solution.alignment.clip.clone(), &document.settings, Some(&mut written_as))?;
        let id = lock(&self.results).new_id();
        let origin = Origin {
            id: id.clone(),
            revision: job.revision,
            document,
            map: &prepared.map,
            wishes,
            written_as,
        };
        let result = Finished::of(solution, clip, several, notes, origin);
        lock(&self.results).put(Arc::new(result));
        Ok(id)
    }

    fn progress(&self, job: &Job, progress: Progress, told: &mut Instant) -> ControlFlow<()> {
        let mut work = self.inbox.lock();
        if work.stop || work.cancelled.contains(&job.id) || work.live.is_some() {
            return ControlFlow::Break(());
        }
        // A newer document is there.
        if job.automatic && work.settle.as_ref().is_some_and(|(_, revision, _)| *revision != job.revision) {
            return ControlFlow::Break(());
        }
        if let Some(state) = work.states.iter_mut().find(|state| state.id == job.id) {
            state.see(progress);
            if told.elapsed() >= TELL {
                *told = Instant::now();
                let state = state.clone();
                drop(work);
                self.events.send(Event::Job(state));
            }
        }
        ControlFlow::Continue(())
    }
}
