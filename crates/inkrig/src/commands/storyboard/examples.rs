//! The user's clips, from a folder.

use super::making::{exactness, wrong};
use super::{Asked, Made, Workshop};
use crate::cli::ImportArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::load;
use inkrig_formats::{Format, Import};
use inkrig_motion::Clip;
use inkrig_storyboard::{Exact, Example, Generated, Library, Retrieved, animation};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// More files are not read.
const MOST_FILES: usize = 2000;
/// Folders in folders are followed so deep.
const DEPTH: usize = 6;
/// Files that say what is in the others.
const INDICES: [&str; 2] = ["words.csv", "index.csv"];

/// Clips of a folder, and how the first of them was written.
pub(super) struct Examples {
    pub(super) library: Library,
    pub(super) first: Import,
    /// The files.
    pub(super) files: Vec<PathBuf>,
}

/// Reads all motion files of a folder and the folders in it; those that cannot be read are said.
///
/// # Errors
/// When the folder cannot be read, no clip is in it, or they are of several skeletons.
pub(super) fn examples(
    folder: &Path,
    console: &Console,
    warnings: &mut Vec<String>,
) -> Result<Examples, CliError> {
    let mut files = Vec::new();
    motion_files(folder, DEPTH, &mut files)?;
    let index = index(folder)?;
    let bar = console.bar("reading the examples");
    let (mut clips, mut first) = (Vec::new(), None);
    for (number, file) in files.iter().enumerate() {
        if bar.at(number, files.len()).is_break() {
            break;
        }
        if let Err(cause) = read(file, folder, &index, &mut clips, &mut first) {
            warnings.push(format!("left out: {cause}"));
        }
    }
    bar.finish()?;
    if files.len() >= MOST_FILES {
        warnings.push(format!("only the first {MOST_FILES} files of the examples are read"));
    }
    let library = Library::new(clips).map_err(wrong(folder))?;
    let first = first.ok_or_else(|| CliError::NothingFits(folder.into()))?;
    Ok(Examples { library, first, files })
}

/// All clips of a file.
fn read(
    file: &Path,
    folder: &Path,
    index: &[(String, String)],
    clips: &mut Vec<Example>,
    first: &mut Option<Import>,
) -> Result<(), CliError> {
    let args = ImportArgs::default();
    let (import, others) = load::motions(file, &args)?;
    let relative =
        file.strip_prefix(folder).unwrap_or(file).with_extension("").to_string_lossy().into_owned();
    let listed = |name: &str| -> String {
        let stem = relative.rsplit(['/', '\\']).next().unwrap_or(&relative);
        let own = index.iter().filter(|(of, _)| {
            let of = of.strip_prefix("./").unwrap_or(of);
            let plain = Path::new(of).with_extension("").to_string_lossy().into_owned();
            plain == relative || plain == stem || of == name
        });
        own.map(|(_, words)| words.as_str()).collect::<Vec<_>>().join(" ")
    };
    let mut add = |name: String, clip: &Clip| {
        let said = format!("{relative} {name} {}", listed(&name));
        let name = if name.is_empty() { relative.clone() } else { format!("{relative} {name}") };
        clips.push(Example { name, said, clip: clip.clone() });
    };
    let plain = |name: &str| name.rsplit('|').next().unwrap_or(name).to_owned();
    let names: Vec<String> = import.clips.iter().map(|clip| plain(&clip.name)).collect();
    let own = import.clip_index.unwrap_or(0);
    add(names.get(own).filter(|_| names.len() > 1).cloned().unwrap_or_default(), &import.clip);
    let rest = names.iter().enumerate().filter(|(number, _)| *number != own);
    for ((_, name), clip) in rest.zip(&others) {
        add(name.clone(), clip);
    }
    first.get_or_insert(import);
    Ok(())
}

fn motion_files(folder: &Path, depth: usize, found: &mut Vec<PathBuf>) -> Result<(), CliError> {
    let unread = |cause| CliError::Read { path: folder.into(), cause };
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder)
        .map_err(unread)?
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<_, _>>()
        .map_err(unread)?;
    entries.sort();
    for path in entries {
        // Links may lead in circles.
        if path.is_dir() && !path.is_symlink() && depth > 0 {
            motion_files(&path, depth - 1, found)?;
        } else if found.len() < MOST_FILES
            && load::extension(&path)
                .is_some_and(|own| own != "json" && own != "txt" && Format::from_extension(&own).is_some())
        {
            found.push(path);
        }
    }
    Ok(())
}

/// Rows of a table: a file's name and what is said of it.
fn index(folder: &Path) -> Result<Vec<(String, String)>, CliError> {
    for name in INDICES {
        let path = folder.join(name);
        if path.is_file() {
            let text = String::from_utf8_lossy(&load::drawing(&path)?).into_owned();
            let row = |line: &str| {
                let (file, words) = line.split_once([',', ';', '\t'])?;
                let bare = |text: &str| text.trim().trim_matches('"').to_owned();
                Some((bare(file), words.replace([',', ';', '\t', '"'], " ")))
            };
            return Ok(text.lines().filter_map(row).collect());
        }
    }
    Ok(Vec::new())
}

/// One animation of the clips alone, and where each frame's is from.
///
/// # Errors
/// When the clips are no person's.
pub(super) fn by_example(
    asked: &[Asked<'_>],
    library: &Library,
    workshop: &Workshop<'_>,
) -> Result<(Made, Vec<Retrieved>), CliError> {
    let plans: Vec<_> = asked.iter().map(|asked| asked.read.plan.clone()).collect();
    let exact = exactness(workshop.settings.exact);
    let (body, drawn) = (workshop.model.body()?, exact != Exact::Off);
    let answers = library.answers(&plans, &body, drawn).map_err(wrong(workshop.path))?;
    let (clips, retrieved): (Vec<Generated>, Vec<Retrieved>) =
        answers.into_iter().map(|answer| (answer.clip, answer.retrieved)).unzip();
    let animation = animation(&clips, None, &body, &exact).map_err(wrong(workshop.path))?;
    let ranked = clips.iter().map(|clip| Arc::from(vec![clip.clone()])).collect();
    Ok((Made { clips, ranked, animation }, retrieved))
}
