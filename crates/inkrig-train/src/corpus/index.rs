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

/// Rows by the name of their file.
#[derive(Debug, Clone, Default)]
pub(super) struct Index {
    rows: HashMap<String, Row>,
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
        let mut rows = HashMap::new();
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
            rows.insert(file_name(&name).to_string(), row);
        }
        Ok(Self { rows })
    }

    /// What it says of a file.
    pub(super) fn row(&self, path: &Path) -> Option<&Row> {
        self.rows.get(path.file_name()?.to_str()?)
    }
}

fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_found_by_file_name_and_columns_by_theirs() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("index.csv");
        std::fs::write(
            &path,
            "Actor,file,fps,split,label\nann,a/b/one.bvh,,duplicate,\"jump, turn\"\n,two.amc,60,test,\n",
        )
        .unwrap();
        let index = Index::read(&path).unwrap();
        let one = index.row(Path::new("z/one.bvh")).unwrap();
        assert_eq!((one.subject.as_deref(), one.text.as_deref()), (Some("ann"), Some("jump, turn")));
        assert_eq!((one.split.clone(), one.frame_rate), (Some(Err("duplicate".into())), None));
        let two = index.row(Path::new("two.amc")).unwrap();
        assert_eq!(
            (two.split.clone(), two.frame_rate, &two.text),
            (Some(Ok(Split::Test)), Some(60.0), &None)
        );
        assert!(index.row(Path::new("three.amc")).is_none());
        std::fs::write(&path, "name\nx\n").unwrap();
        assert!(Index::read(&path).unwrap_err().to_string().contains("no column `file`"));
    }
}
