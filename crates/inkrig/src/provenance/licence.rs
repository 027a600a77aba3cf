//! Under which licence an input may be used, as far as anything says it.

use super::Sidecar;
use crate::inputs::InputFile;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::io::Read;
use std::path::{Path, PathBuf};

/// What is said about the use of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct LicenceNote {
    pub(crate) text: String,
    /// Where it stands.
    pub(crate) from: String,
}

/// What is said by the file itself: glTF and VRM have places for it.
pub(crate) fn of_bytes(path: &Path, bytes: &[u8]) -> Vec<LicenceNote> {
    match crate::load::extension(path).as_deref() {
        Some("glb" | "gltf" | "vrm" | "vrma") => {
            let notes = inkrig_formats::gltf_licence(bytes).into_iter();
            notes.map(|(field, text)| LicenceNote { text, from: field.to_string() }).collect()
        }
        _ => Vec::new(),
    }
}

/// What the user said.
pub(crate) fn given(text: &str) -> LicenceNote {
    LicenceNote { text: cut(text), from: "--licence-note".into() }
}

/// Adds what files beside an input say: its own record when inkrig made it, `NAME.license` (as REUSE has it), else a
/// licence of the folder.
pub(crate) fn add_beside(input: &mut InputFile) {
    let path = PathBuf::from(&input.path);
    if let Ok(sidecar) = Sidecar::read(&Sidecar::place(&path))
        && sidecar.output.sha256 == input.sha256
    {
        let from = |note| LicenceNote { text: note, from: "its own .inkrig.json".into() };
        input.licences.extend(sidecar.licences.into_iter().map(from));
        return;
    }
    let own = [".license", ".licence"].map(|ending| {
        let mut name = path.clone().into_os_string();
        name.push(ending);
        PathBuf::from(name)
    });
    let folder = crate::output::folder_of(&path);
    let of_folder = ["LICENSE", "LICENSE.txt", "LICENSE.md", "LICENCE", "LICENCE.txt", "COPYING"];
    let places = own.into_iter().chain(of_folder.map(|name| folder.join(name)));
    let found = places.into_iter().find_map(|place| Some((first_words(&place)?, place)));
    if let Some((text, place)) = found {
        let name = place.file_name().unwrap_or_default().to_string_lossy().into_owned();
        input.licences.push(LicenceNote { text, from: format!("{name} beside it") });
    }
}

/// The licences of all inputs, each once; what nothing is known of is said to be unknown.
pub(crate) fn union(inputs: &[InputFile]) -> Vec<String> {
    let mut all = BTreeSet::new();
    for input in inputs {
        all.extend(input.licences.iter().map(|note| note.text.clone()));
        if input.licences.is_empty() {
            all.insert(format!("unknown: {}", input.path));
        }
    }
    all.into_iter().collect()
}

/// The SPDX line of a licence file, else its first line with words.
fn first_words(path: &Path) -> Option<String> {
    if !path.is_file() {
        return None;
    }
    let mut bytes = Vec::new();
    std::fs::File::open(path).ok()?.take(1 << 16).read_to_end(&mut bytes).ok()?;
    let text = String::from_utf8_lossy(&bytes);
    let spdx =
        text.lines().find_map(|line| line.split_once("SPDX-License-Identifier:").map(|(_, id)| id.trim()));
    let line =
        spdx.or_else(|| text.lines().map(str::trim).find(|line| line.chars().any(char::is_alphanumeric)));
    line.map(cut)
}

fn cut(text: &str) -> String {
    text.trim().chars().take(300).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input(path: &Path) -> InputFile {
        InputFile {
            path: path.to_string_lossy().into_owned(),
            bytes: 0,
            sha256: String::new(),
            licences: Vec::new(),
        }
    }

    #[test]
    fn licences_beside_a_file_are_found_and_the_rest_is_unknown() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("walk.bvh");
        let notes = || {
            let mut input = input(&path);
            add_beside(&mut input);
            (union(std::slice::from_ref(&input)), input.licences.first().map(|note| note.from.clone()))
        };
        assert!(notes().0[0].starts_with("unknown: "));
        std::fs::write(folder.path().join("LICENSE"), "\n  # MIT License\n\nCopyright").unwrap();
        assert_eq!(notes(), (vec!["# MIT License".to_string()], Some("LICENSE beside it".into())));
        std::fs::write(
            folder.path().join("walk.bvh.license"),
            "Copyright me\nSPDX-License-Identifier: CC0-1.0\n",
        )
        .unwrap();
        assert_eq!(notes(), (vec!["CC0-1.0".to_string()], Some("walk.bvh.license beside it".into())));
    }
}
