//! The pen on the drawing: a stroke that goes on is kept point by point, and is one step of the project once it is lifted.

use super::{Applied, Studio, lock};
use crate::StudioError;
use crate::document::{Control, CurveTiming, Document, PenPoint};
use crate::engine::solver::Live;
use crate::project::StrokeJournal;
use crate::strokes::StrokeMode;
use std::sync::Arc;
use std::time::Instant;

/// A stroke that goes on.
#[derive(Debug)]
pub(super) struct Stroke {
    /// Whose it is.
    client: u64,
    number: u32,
    messages: u32,
    journal: StrokeJournal,
    base: Arc<Document>,
    revision: u32,
}

impl Studio {
    /// Whether a pen is down on the drawing.
    pub(crate) fn is_drawn_on(&self) -> bool {
        lock(&self.stroke).is_some()
    }

    /// The pen is set down. A stroke of the same client that was never lifted is finished first.
    ///
    /// # Errors
    /// When another client draws; when the folder cannot be written to.
    pub fn begin_stroke(
        &self,
        client: u64,
        number: u32,
        mode: StrokeMode,
        timing: Option<CurveTiming>,
    ) -> Result<(), StudioError> {
        if lock(&self.stroke).as_ref().is_some_and(|stroke| stroke.client == client) {
            self.end_stroke(client, None)?;
        }
        let mut stroke = lock(&self.stroke);
        if stroke.is_some() {
            return Err(StudioError::invalid("another window draws: lift its pen first"));
        }
        let (base, revision) = self.now();
        let folder = self.project().folder().clone();
        let journal = StrokeJournal::begin(&folder, mode, timing)?;
        *stroke = Some(Stroke { client, number, messages: 0, journal, base, revision });
        Ok(())
    }

    /// More ink. Returns what the document follows with it.
    ///
    /// # Errors
    /// When there is no such stroke, it is too long, or cannot be written.
    pub fn push_points(
        &self,
        client: u64,
        number: u32,
        points: &[PenPoint],
        arrived: Instant,
    ) -> Result<Option<Control>, StudioError> {
        let mut stroke = lock(&self.stroke);
        let stroke = own(&mut stroke, client, number)?;
        let good = |point: &PenPoint| {
            let small = |value: f64| value.is_finite() && value.abs() <= 1e6;
            small(point.0)
                && small(point.1)
                && point.2.is_none_or(small)
                && point.3.is_none_or(|p| (0.0..=100.0).contains(&p))
        };
        if !points.iter().all(good) {
            return Err(StudioError::invalid("a point of the drawing is beyond a million units"));
        }
        stroke.journal.push(points)?;
        stroke.messages += 1;
        let Some(control) = stroke.journal.control(&stroke.base)? else { return Ok(None) };
        if !stroke.base.source.clips.is_empty() {
            let document = Document { control: Some(control.clone()), ..Document::clone(&stroke.base) };
            let live = Live {
                document: Arc::new(document),
                revision: stroke.revision,
                stroke: (stroke.number, stroke.messages),
                arrived,
            };
            self.solver.show(live);
        }
        Ok(Some(control))
    }

    /// The pen is lifted: the stroke of that number, or whichever the client draws, is one step. `None` where there is none.
    ///
    /// # Errors
    /// When the folder cannot be written to; the stroke then stays on the disk.
    pub fn end_stroke(
        &self,
        client: u64,
        number: Option<u32>,
    ) -> Result<Option<(u32, Applied, Option<Control>)>, StudioError> {
        let mut slot = lock(&self.stroke);
        let own =
            |stroke: &Stroke| stroke.client == client && number.is_none_or(|number| stroke.number == number);
        if !slot.as_ref().is_some_and(own) {
            return Ok(None);
        }
        let Some(stroke) = slot.take() else { return Ok(None) };
        let label = match stroke.journal.mode() {
            StrokeMode::Draw | StrokeMode::Add => "Draw",
            StrokeMode::Redraw => "Redraw",
            StrokeMode::Wave => "Draw a wave",
        };
        let number = stroke.number;
        let applied = self.change(label, None, |document| {
            // What was changed elsewhere in the meantime stays.
            if let Some(control) = stroke.journal.control(&stroke.base)? {
                document.control = Some(control);
            }
            Ok(())
        })?;
        let control = self.project().document().control.clone();
        stroke.journal.remove()?;
        Ok(Some((number, applied, control)))
    }

    /// As if nothing had happened.
    ///
    /// # Errors
    /// When the file of the stroke cannot be removed.
    pub fn cancel_stroke(&self, client: u64, number: u32) -> Result<(), StudioError> {
        let mut slot = lock(&self.stroke);
        if slot.as_ref().is_some_and(|stroke| stroke.client == client && stroke.number == number)
            && let Some(stroke) = slot.take()
        {
            stroke.journal.remove()?;
            drop(slot);
            let (document, revision) = self.now();
            self.solve(document, revision);
        }
        Ok(())
    }
}

fn own(stroke: &mut Option<Stroke>, client: u64, number: u32) -> Result<&mut Stroke, StudioError> {
    let stroke = stroke.as_mut().filter(|stroke| stroke.client == client && stroke.number == number);
    stroke.ok_or_else(|| StudioError::invalid(format!("stroke {number} was not begun, or is over")))
}
