//! A project that is open: its document, its history, and the folder in which both are kept at every moment.

mod folder;
mod history;
mod journal;

pub use folder::{Folder, Kind};
pub use history::HistoryState;
pub use journal::StrokeJournal;

use crate::StudioError;
use crate::document::{Command, Document, is_id};
use history::{Entry, History};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;

/// An open project. Whatever has returned is on the disk.
#[derive(Debug)]
pub struct Project {
    folder: Arc<Folder>,
    saved: Saved,
}

/// The file `project.json`.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Saved {
    /// The form of this file.
    version: u32,
    revision: u32,
    /// The next number of an id or a step.
    next: u64,
    document: Document,
    history: History,
}

const VERSION: u32 = 1;
/// Ids that a project ever gives.
const MOST_IDS: u64 = 1 << 53;

impl Project {
    /// Opens the project of a folder, or begins one there. A stroke that was cut off is brought in as a step.
    ///
    /// # Errors
    /// When the folder cannot be used, holds something else, or is open already.
    pub fn open(path: &Path) -> Result<Self, StudioError> {
        let folder = Arc::new(Folder::open(path)?);
        let saved = match folder.read_json::<Saved>("project.json")? {
            Some(saved) if saved.version == VERSION => saved,
            Some(saved) => {
                let what =
                    format!("it has the form {}, and this program knows form {VERSION}", saved.version);
                return Err(StudioError::Folder { path: path.to_path_buf(), what });
            }
            None => Saved {
                version: VERSION,
                revision: 1,
                next: 1,
                document: Document::default(),
                history: History::default(),
            },
        };
        saved.document.check()?;
        // Ids become names of files, also of files that are removed.
        let steps = saved.history.undo.iter().chain(&saved.history.redo);
        if saved.next >= MOST_IDS || !steps.into_iter().all(|step| is_id(&step.id)) {
            let what = "its history names what is no step".to_string();
            return Err(StudioError::Folder { path: path.to_path_buf(), what });
        }
        let mut project = Self { folder, saved };
        project.save()?;
        if let Some(journal) = StrokeJournal::left_behind(&project.folder)? {
            // A stroke without a point is none.
            if let Some(control) = journal.control(project.document())? {
                project.change("Draw", None, |document| {
                    document.apply(Command::SetControl { control: Some(control) })
                })?;
            }
            journal.remove()?;
        }
        Ok(project)
    }

    /// The folder.
    pub fn folder(&self) -> &Arc<Folder> {
        &self.folder
    }

    /// The document as it is.
    pub fn document(&self) -> &Document {
        &self.saved.document
    }

    /// Rises with every change.
    pub fn revision(&self) -> u32 {
        self.saved.revision
    }

    /// What can be undone and redone.
    pub fn history(&self) -> HistoryState {
        self.saved.history.state()
    }

    /// A new id that begins with a letter: no other has it, nor had it.
    ///
    /// # Errors
    /// When the folder cannot be written to.
    pub fn new_id(&mut self, letter: char) -> Result<String, StudioError> {
        let id = format!("{letter}{}", self.saved.next);
        self.saved.next += 1;
        Ok(id)
    }

    /// Changes the document as one step of the history; steps of one gesture that follow each other are one. Nothing has
    /// happened where `change` fails.
    ///
    /// # Errors
    /// What `change` says; when the folder cannot be written to.
    pub fn change(
        &mut self,
        label: &str,
        gesture: Option<&str>,
        change: impl FnOnce(&mut Document) -> Result<(), StudioError>,
    ) -> Result<(), StudioError> {
        let mut after = self.saved.document.clone();
        change(&mut after)?;
        after.check()?;
        let parts = self.saved.document.changed_parts(&after);
        if parts.is_empty() {
            return Ok(());
        }
        let before = self.saved.clone();
        self.saved.document = after;
        self.saved.revision = self.saved.revision.wrapping_add(1);
        let step = self.add_step(label, gesture, parts);
        let done = step.and_then(|old| self.save().map(|()| old));
        match done {
            Ok(old) => self.forget(&old),
            Err(error) => {
                self.saved = before;
                return Err(error);
            }
        }
        Ok(())
    }

    /// Takes the last step back.
    ///
    /// # Errors
    /// When there is none; when the folder cannot be read or written.
    pub fn undo(&mut self) -> Result<(), StudioError> {
        let step = self.saved.history.undo.last().cloned().ok_or(StudioError::NoStep("undo"))?;
        self.swap(&step.id, |history, id| {
            history.undo.pop();
            history.redo.push(history::Step { id, gesture: None, ..step.clone() });
        })
    }

    /// Takes the last undone step again.
    ///
    /// # Errors
    /// As for [`undo`](Self::undo).
    pub fn redo(&mut self) -> Result<(), StudioError> {
        let step = self.saved.history.redo.last().cloned().ok_or(StudioError::NoStep("redo"))?;
        self.swap(&step.id, |history, id| {
            history.redo.pop();
            history.undo.push(history::Step { id, gesture: None, ..step.clone() });
        })
    }

    /// What was done cannot be undone any more.
    ///
    /// # Errors
    /// When the folder cannot be written to.
    pub fn forget_history(&mut self) -> Result<(), StudioError> {
        let history = std::mem::take(&mut self.saved.history);
        self.save()?;
        let steps: Vec<String> = history.undo.into_iter().chain(history.redo).map(|step| step.id).collect();
        self.forget(&steps);
        Ok(())
    }

    /// Puts the parts of a step in; those that were there are kept for the way back.
    fn swap(&mut self, id: &str, moved: impl FnOnce(&mut History, String)) -> Result<(), StudioError> {
        let entry: Entry =
            self.folder.read_json(&history::file(id))?.ok_or_else(|| StudioError::unknown("step", id))?;
        let before = self.saved.clone();
        let parts = entry.parts.into_iter().map(|part| self.saved.document.put(part)).collect();
        self.saved.revision = self.saved.revision.wrapping_add(1);
        let back = self.new_id('h')?;
        moved(&mut self.saved.history, back.clone());
        let written = self.saved.document.check();
        let written = written.and_then(|()| self.folder.write_json(&history::file(&back), &Entry { parts }));
        if let Err(error) = written.and_then(|()| self.save()) {
            self.saved = before;
            return Err(error);
        }
        self.forget(&[id.to_string()]);
        Ok(())
    }

    /// Writes a step; returns those that are no longer needed.
    fn add_step(
        &mut self,
        label: &str,
        gesture: Option<&str>,
        parts: Vec<crate::document::Part>,
    ) -> Result<Vec<String>, StudioError> {
        let mut old: Vec<String> = self.saved.history.redo.drain(..).map(|step| step.id).collect();
        if let Some(last) = self.saved.history.undo.last()
            && gesture.is_some()
            && last.gesture.as_deref() == gesture
        {
            let file = history::file(&last.id);
            let mut entry: Entry = self.folder.read_json(&file)?.unwrap_or_default();
            let count = entry.parts.len();
            for part in parts {
                if !entry.parts.iter().any(|known| known.same_piece(&part)) {
                    entry.parts.push(part);
                }
            }
            if entry.parts.len() > count {
                self.folder.write_json(&file, &entry)?;
            }
            return Ok(old);
        }
        let id = self.new_id('h')?;
        self.folder.write_json(&history::file(&id), &Entry { parts })?;
        let label = label.chars().take(80).collect();
        self.saved.history.undo.push(history::Step { id, label, gesture: gesture.map(Into::into) });
        let excess = self.saved.history.undo.len().saturating_sub(history::MOST_STEPS);
        old.extend(self.saved.history.undo.drain(..excess).map(|step| step.id));
        Ok(old)
    }

    fn save(&mut self) -> Result<(), StudioError> {
        self.folder.write_json("project.json", &self.saved)
    }

    /// Files that are left over do no harm.
    fn forget(&self, steps: &[String]) {
        for id in steps {
            self.folder.remove(&history::file(id));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Settings;

    fn named(project: &mut Project, name: &str, gesture: Option<&str>) {
        let command = Command::SetName { name: name.into() };
        project.change(&format!("Call it {name}"), gesture, |document| document.apply(command)).unwrap();
    }

    #[test]
    fn undo_survives_reopening() {
        let folder = tempfile::tempdir().unwrap();
        let mut project = Project::open(folder.path()).unwrap();
        named(&mut project, "one", None);
        named(&mut project, "two", None);
        project.undo().unwrap();
        drop(project);
        let mut project = Project::open(folder.path()).unwrap();
        assert_eq!(project.document().name, "one");
        project.redo().unwrap();
        assert_eq!(project.document().name, "two");
        project.undo().unwrap();
        project.undo().unwrap();
        assert_eq!(project.document(), &Document::default());
        assert!(matches!(project.undo(), Err(StudioError::NoStep("undo"))));
    }

    #[test]
    fn a_gesture_is_one_step_and_always_on_the_disk() {
        let folder = tempfile::tempdir().unwrap();
        let mut project = Project::open(folder.path()).unwrap();
        named(&mut project, "start", None);
        for index in 0..20 {
            named(&mut project, &format!("drag {index}"), Some("g1"));
            let on_disk = std::fs::read_to_string(folder.path().join("project.json")).unwrap();
            assert!(on_disk.contains(&format!("drag {index}")), "{on_disk}");
        }
        let settings = Settings { seed: 3, ..Settings::default() };
        project
            .change("Seed", Some("g1"), |document| document.apply(Command::SetSettings { settings }))
            .unwrap();
        assert_eq!(project.history().undo.len(), 2);
        project.undo().unwrap();
        assert_eq!((project.document().name.as_str(), project.document().settings.seed), ("start", 0));
    }

    #[test]
    fn a_new_step_ends_what_could_be_redone_and_files_do_not_pile_up() {
        let folder = tempfile::tempdir().unwrap();
        let mut project = Project::open(folder.path()).unwrap();
        for index in 0..history::MOST_STEPS + 30 {
            named(&mut project, &format!("n{index}"), None);
        }
        (0..5).for_each(|_| project.undo().unwrap());
        named(&mut project, "else", None);
        assert_eq!(project.history().redo.len(), 0);
        let files = std::fs::read_dir(folder.path().join("history")).unwrap().count();
        assert_eq!(files, project.history().undo.len());
        assert!(files <= history::MOST_STEPS);
    }

    #[test]
    fn nothing_happens_where_a_change_fails() {
        let folder = tempfile::tempdir().unwrap();
        let mut project = Project::open(folder.path()).unwrap();
        let failed = project.change("Bad", None, |document| {
            document.name = "half".into();
            document.apply(Command::RemoveKey { id: "k".into() })
        });
        assert!(failed.is_err());
        assert_eq!((project.document(), project.revision()), (&Document::default(), 1));
    }

    #[test]
    fn a_project_is_open_once() {
        let folder = tempfile::tempdir().unwrap();
        let project = Project::open(folder.path()).unwrap();
        let error = Project::open(folder.path()).unwrap_err().to_string();
        assert!(error.contains("open already"), "{error}");
        drop(project);
        assert!(Project::open(folder.path()).is_ok());
    }

    #[test]
    fn a_folder_of_something_else_stays_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("notes.txt"), "mine").unwrap();
        let error = Project::open(folder.path()).unwrap_err().to_string();
        assert!(error.contains("notes.txt"), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        std::fs::remove_file(folder.path().join("notes.txt")).unwrap();
        drop(Project::open(folder.path()).unwrap());
        let path = folder.path().join("project.json");
        let saved = std::fs::read_to_string(&path).unwrap();
        let step = "\"undo\":[{\"id\":\"../../notes\",\"label\":\"x\"}]";
        std::fs::write(&path, saved.replace("\"undo\":[]", step)).unwrap();
        let error = Project::open(folder.path()).unwrap_err().to_string();
        assert!(error.contains("no step"), "{error}");
        std::fs::write(folder.path().join("project.json"), "{ \"version\": 1, ").unwrap();
        let error = Project::open(folder.path()).unwrap_err().to_string();
        assert!(error.contains("project.json"), "{error}");
    }
}
