//! What a list of files says of each.

use super::Split;
use super::config::read_text;
use crate::TrainError;
use std::collections::HashMap;
use std::path::Path;

/// A row of an index.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Row {
    pub subject: Option<String>,
    /// The split, or what stands there instead of one.
    pub split: Option<Result<Split, String>>,
    pub frame_rate: Option<f64>,
    pub text: Option<String>,
}

/// Rows by the name of their file, each with the path that it gives.
#[derive(Debug, Clone, Default)]
pub(super) struct Index {
    rows: HashMap<String, Vec<(String, Row)>>,
}

impl Index {
    /// Reads a CSV with a column `file`.
    pub(super) fn read(path: &Path) -> Result<Self, TrainError> {
        let text = read_text(path)?;
        let content = |what: String| TrainError::Content { path: path.to_path_buf(), what };
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let headers = reader.headers().map_err(|error| content(error.to_string()))?.clone();
        let column = |names: &[&str]| {
            headers.iter().position(|header| names.contains(&header.trim().to_lowercase().as_str()))
        };
        let Some(file) = column(&["file", "path"]) else {
            return Err(content("has no column `file`".into()));
        };
        let [subject, split, fps, text] =
            [&["subject", "actor"][..], &["split"], &["fps"], &["description", "label", "text", "caption"]]
                .map(column);
        let mut rows: HashMap<String, Vec<(String, Row)>> = HashMap::new();
        for record in reader.records() {
            let record = record.map_err(|error| content(error.to_string()))?;
            let cell = |column: Option<usize>| {
                let cell = record.get(column?)?.trim();
                (!cell.is_empty()).then(|| cell.to_string())
            };
            let Some(name) = cell(Some(file)) else { continue };
            let split = cell(split).map(|name| {
                Split::ALL.into_iter().find(|split| split.name() == name.to_lowercase()).ok_or(name)
            });
            let frame_rate = cell(fps).and_then(|fps| fps.parse().ok());
            let row = Row { subject: cell(subject), split, frame_rate, text: cell(text) };
            let path = name.replace('\\', "/").trim_start_matches("./").to_string();
            let of_name = rows.entry(file_name(&path).to_string()).or_default();
            match of_name.iter().find(|(other, _)| *other == path) {
                Some((_, other)) if *other != row => {
                    return Err(content(format!(
                        "has two rows for {path} that say different things: remove one"
                    )));
                }
                Some(_) => {}
                None => of_name.push((path, row)),
            }
        }
        Ok(Self { rows })
    }

    /// What it says of a file, by the end of its path. Where no path of the index is such, by its name alone, if there is one row of that
    /// name, and one file: `others` are files of the source that are named alike.
    ///
    /// # Errors
    /// When a name alone does not say which file is meant.
    pub(super) fn row(&self, path: &Path, others: &[&Path]) -> Result<Option<&Row>, String> {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let Some(rows) = self.rows.get(name) else { return Ok(None) };
        let longest = rows
            .iter()
            .filter(|(of, _)| file_name(of) != of && path.ends_with(of))
            .max_by_key(|(of, _)| of.len());
        if let Some((_, row)) = longest {
            return Ok(Some(row));
        }
        match (&rows[..], others) {
            ([(_, row)], []) => Ok(Some(row)),
            ([(first, _), (second, _), ..], []) => Err(format!(
                "the rows for {first} and {second} could both be meant for {}: write its path within the source's folder",
                path.display()
            )),
            (rows, [other, ..]) if rows.iter().any(|(of, _)| of == name) => Err(format!(
                "the row for {name} does not say which file is meant, {} or {}: write the path within the source's folder",
                path.display(),
                other.display()
            )),
            _ => Ok(None),
        }
    }
}

fn file_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_found_by_file_and_columns_by_their_names() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("index.csv");
        std::fs::write(
            &path,
            "Actor,file,fps,split,label\nann,a/b/one.bvh,,duplicate,\"jump, turn\"\n,two.amc,60,test,\n",
        )
        .unwrap();
        let index = Index::read(&path).unwrap();
        let one = index.row(Path::new("z/one.bvh"), &[]).unwrap().unwrap();
        assert_eq!((one.subject.as_deref(), one.text.as_deref()), (Some("ann"), Some("jump, turn")));
        assert_eq!((one.split.clone(), one.frame_rate), (Some(Err("duplicate".into())), None));
        let two = index.row(Path::new("two.amc"), &[]).unwrap().unwrap();
        assert_eq!(
            (two.split.clone(), two.frame_rate, &two.text),
            (Some(Ok(Split::Test)), Some(60.0), &None)
        );
        assert!(index.row(Path::new("three.amc"), &[]).unwrap().is_none());
        std::fs::write(&path, "name\nx\n").unwrap();
        assert!(Index::read(&path).unwrap_err().to_string().contains("no column `file`"));
    }

    #[test]
    fn files_that_are_named_alike_are_told_apart_by_their_paths() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("index.csv");
        let index = |rows: &str| {
            std::fs::write(&path, format!("file,subject\n{rows}")).unwrap();
            Index::read(&path)
        };
        let [a, b] = [Path::new("data/a/clip.bvh"), Path::new("data/b/clip.bvh")];
        let subject = |index: &Index, of: &Path, other: &Path| -> Option<String> {
            index.row(of, &[other]).unwrap()?.subject.clone()
        };
        let both = index("a/clip.bvh,ann\nb\\clip.bvh,bob\n").unwrap();
        assert_eq!(subject(&both, a, b).as_deref(), Some("ann"));
        assert_eq!(subject(&both, b, a).as_deref(), Some("bob"));
        let error = both.row(Path::new("data/c/clip.bvh"), &[]).unwrap_err();
        assert!(error.contains("a/clip.bvh and b/clip.bvh"), "{error}");
        let one = index("data/a/clip.bvh,ann\n").unwrap();
        assert_eq!(subject(&one, a, b).as_deref(), Some("ann"));
        assert_eq!(subject(&one, b, a), None);
        let bare = index("clip.bvh,ann\n").unwrap();
        let error = bare.row(a, &[b]).unwrap_err();
        assert!(error.contains("data/a/clip.bvh or data/b/clip.bvh"), "{error}");
        assert_eq!(bare.row(a, &[]).unwrap().unwrap().subject.as_deref(), Some("ann"));
        assert!(index("a/clip.bvh,ann\na/clip.bvh,ann\n").is_ok());
        assert!(index("a/clip.bvh,ann\na/clip.bvh,bob\n").unwrap_err().to_string().contains("two rows"));
    }
}
