//! A stroke while the pen is down, on the disk before it is answered: whoever pulls the plug loses no ink.

use super::Folder;
use crate::StudioError;
use crate::document::{Control, CurveTiming, Document, MOST_POINTS, PenPoint};
use crate::strokes::{StrokeMode, with_stroke};
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::PathBuf;

const NAME: &str = "stroke.jsonl";

/// A stroke that goes on.
#[derive(Debug)]
pub struct StrokeJournal {
    path: PathBuf,
    file: Option<File>,
    head: Head,
    points: Vec<PenPoint>,
}

#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Head {
    mode: StrokeMode,
    timing: Option<CurveTiming>,
}

impl StrokeJournal {
    /// The pen is set down.
    ///
    /// # Errors
    /// When the folder cannot be written to.
    pub fn begin(
        folder: &Folder,
        mode: StrokeMode,
        timing: Option<CurveTiming>,
    ) -> Result<Self, StudioError> {
        let path = folder.file(NAME);
        let head = Head { mode, timing };
        let file = File::create(&path).map_err(|cause| StudioError::File { path: path.clone(), cause })?;
        let mut journal = Self { path, file: Some(file), head, points: Vec::new() };
        journal.line(&serde_json::json!(head))?;
        Ok(journal)
    }

    /// More of it.
    ///
    /// # Errors
    /// When it is too long, or cannot be written.
    pub fn push(&mut self, points: &[PenPoint]) -> Result<(), StudioError> {
        let count = self.points.len() + points.len();
        if count > MOST_POINTS {
            return Err(StudioError::TooMuch { what: "points of a stroke", count, most: MOST_POINTS });
        }
        self.line(&serde_json::json!(points))?;
        self.points.extend_from_slice(points);
        Ok(())
    }

    /// What the document follows with this stroke in it; `None` before its first point.
    ///
    /// # Errors
    /// When the document follows something that no stroke goes into.
    pub fn control(&self, document: &Document) -> Result<Option<Control>, StudioError> {
        if self.points.is_empty() {
            return Ok(None);
        }
        with_stroke(document.control.as_ref(), &self.points, self.head.mode, self.head.timing).map(Some)
    }

    /// How the stroke goes into the drawing.
    pub fn mode(&self) -> StrokeMode {
        self.head.mode
    }

    /// It is in the project, or shall not be.
    ///
    /// # Errors
    /// When the file cannot be removed.
    pub fn remove(self) -> Result<(), StudioError> {
        drop(self.file);
        std::fs::remove_file(&self.path).map_err(|cause| StudioError::File { path: self.path, cause })
    }

    /// The stroke that was going on when the program ended; a last line that is half written is left out.
    pub(super) fn left_behind(folder: &Folder) -> Result<Option<Self>, StudioError> {
        let path = folder.file(NAME);
        let Ok(text) = std::fs::read_to_string(&path) else { return Ok(None) };
        let mut lines = text.lines();
        let head = lines.next().and_then(|line| serde_json::from_str(line).ok());
        let Some(head) = head else {
            folder.remove(NAME);
            return Ok(None);
        };
        let points = lines.map_while(|line| serde_json::from_str::<Vec<PenPoint>>(line).ok()).flatten();
        let points = points.take(MOST_POINTS).collect();
        let file = OpenOptions::new().append(true).open(&path).ok();
        Ok(Some(Self { path, file, head, points }))
    }

    fn line(&mut self, value: &serde_json::Value) -> Result<(), StudioError> {
        let Some(file) = &mut self.file else { return Ok(()) };
        let line = format!("{value}\n");
        file.write_all(line.as_bytes()).map_err(|cause| StudioError::File { path: self.path.clone(), cause })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::project::Project;

    #[test]
    fn a_stroke_that_was_cut_off_is_there_again_and_can_be_undone() {
        let place = tempfile::tempdir().unwrap();
        let project = Project::open(place.path()).unwrap();
        let mut journal = StrokeJournal::begin(project.folder(), StrokeMode::Draw, None).unwrap();
        for index in 0..5 {
            let t = f64::from(index);
            journal.push(&[(t, t * t, Some(0.1 * t), Some(0.5))]).unwrap();
        }
        // As a kill leaves it: the journal stays, its last line is torn.
        drop(journal);
        drop(project);
        let path = place.path().join(NAME);
        let mut file = OpenOptions::new().append(true).open(&path).unwrap();
        file.write_all(b"[[9.0,9.0,0.").unwrap();
        let mut project = Project::open(place.path()).unwrap();
        let Some(Control::Curve { strokes, .. }) = &project.document().control else { panic!("no drawing") };
        assert_eq!((strokes.len(), strokes[0].len()), (1, 5));
        assert!(!path.exists());
        project.undo().unwrap();
        assert_eq!(project.document().control, None);
    }
}
