//! What is seen while something moves: quick answers, coarse ones first.

use super::worker::Worker;
use super::{Live, Shown};
use crate::StudioError;
use crate::engine::poses::{PoseHead, PoseKind, encode};
use crate::engine::{SourceKey, Wishes, over_ground};
use inkrig_align::{AlignError, LiveAlignment, LiveAnswer, LiveEvent};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// How long newer ink waits for the finer answers to what came before it.
const PATIENCE: Duration = Duration::from_millis(10);

/// A clip that is ready to follow.
pub(super) struct Ready {
    source: SourceKey,
    alignment: LiveAlignment,
    /// For every matched frame the frame counted through all clips.
    counted: Vec<u32>,
}

impl Worker {
    /// Shows a document, or says why there is nothing to see.
    pub(super) fn show(&mut self, live: &Live) {
        let waiting = |error: &StudioError| {
            live.stroke.0 > 0
                && matches!(
                    error,
                    StudioError::Align(AlignError::ControlTooShort { .. } | AlignError::StillControl)
                        | StudioError::Align(AlignError::Sketch(_))
                        | StudioError::Sketch(_)
                )
        };
        let mut done = self.update(live);
        while let Err(error) = &done
            && self.learns(&live.document, error)
        {
            done = self.update(live);
        }
        match done {
            Ok(()) | Err(StudioError::Align(AlignError::Cancelled)) => {}
            Err(error) => {
                let not = Shown::Not {
                    stroke: live.stroke.0,
                    message: error.to_string(),
                    waiting: waiting(&error),
                };
                self.shown.send_replace(Some(not));
            }
        }
    }

    fn update(&mut self, live: &Live) -> Result<(), StudioError> {
        let document = &live.document;
        let prepared = self.prepared(document)?;
        let Wishes { control, mut options, .. } = self.wishes(document, &prepared)?;
        // The browser that shows it works on the same processor.
        options.threads = (self.threads / 2).max(1);
        let key = SourceKey::of(document);
        let known = self.live.take().and_then(|mut ready| {
            (ready.source == key && ready.alignment.set_options(&options)).then_some(ready)
        });
        let ready = match known {
            Some(ready) => ready,
            None => {
                let alignment = LiveAlignment::new(&prepared.takes, &options)?;
                let counted = |frame| prepared.map.counted_through(frame).unwrap_or(0) as u32;
                let counted = alignment.moments().iter().map(|moment| counted(moment.frame)).collect();
                Ready { source: key, alignment, counted }
            }
        };
        let Ready { alignment, counted, .. } = self.live.insert(ready);
        let (inbox, shown) = (&self.inbox, &self.shown);
        let mut failed = None;
        let (mut told, begun) = (false, Instant::now());
        let done = alignment.update(&control, &mut |event| {
            match event {
                LiveEvent::Step(_) => {}
                LiveEvent::Answer(answer) => {
                    told = true;
                    match answer_bytes(*answer, live, counted, options.matching_rate) {
                        Ok(bytes) => {
                            shown.send_replace(Some(Shown::Poses(Arc::new(bytes))));
                        }
                        Err(error) => failed = Some(error),
                    }
                }
            }
            // Ink that never gets an answer would stand still under the pen, and coarse ones alone look like nothing.
            let late = begun.elapsed() >= PATIENCE;
            if told && late && inbox.urgent.load(Ordering::Acquire) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        if let Some(error) = failed {
            return Err(error);
        }
        match done {
            Ok(()) => Ok(()),
            Err(AlignError::Cancelled) => Err(AlignError::Cancelled.into()),
            Err(error) => {
                // What it kept is of a control that it could not take.
                alignment.forget();
                Err(error.into())
            }
        }
    }
}

fn answer_bytes(answer: LiveAnswer, live: &Live, counted: &[u32], rate: f64) -> Result<Vec<u8>, StudioError> {
    let settings = &live.document.settings;
    let (clip, _) = over_ground(answer.clip, settings, None)?;
    let used: Vec<u32> = (0..answer.weights.rows())
        .map(|row| {
            let row = answer.weights.row(row).iter().enumerate();
            let best = row.max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(column, _)| column);
            counted.get(best).copied().unwrap_or(0)
        })
        .collect();
    let head = PoseHead {
        stroke: live.stroke.0,
        message: live.stroke.1,
        level: answer.level as u16,
        levels: answer.levels as u16,
        is_final: answer.is_final,
        warm: answer.warm,
        milliseconds: live.arrived.elapsed().as_secs_f32() * 1000.0,
        sample_rate: rate as f32,
        ..PoseHead::of(PoseKind::Live, live.revision, settings.cyclic)
    };
    Ok(encode(&clip, &head, &used))
}
