//! Which clip of a file that holds several is read.

use crate::{ClipChoice, ClipInfo, Finding, FormatError, finding::clean};

/// Names of clips are not cut before so many characters: they are to be copied into `--clip`.
const LONGEST: usize = 120;

/// Which clip is read: the one asked for, else the one at `usual`; `None` when there is none.
pub(crate) fn choose(
    clips: &[ClipInfo],
    choice: Option<&ClipChoice>,
    usual: usize,
    findings: &mut Vec<Finding>,
) -> Result<Option<usize>, FormatError> {
    let names = || {
        let mut names: Vec<String> =
            clips.iter().take(20).map(|clip| format!("`{}`", clean(&clip.name, LONGEST))).collect();
        names.extend((clips.len() > 20).then(|| format!("and {} more", clips.len() - 20)));
        names.join(", ")
    };
    let Some(choice) = choice else {
        if let Some(clip) = clips.get(usual).filter(|_| clips.len() > 1) {
            let which = if usual == 0 { "the first" } else { "the first that moves a joint" };
            let message = format!(
                "the file has {} clips and `{}`, {which}, is read; `--clip` chooses another",
                clips.len(),
                clean(&clip.name, LONGEST)
            );
            findings.push(Finding::warning("several-clips", message));
        }
        return Ok((usual < clips.len()).then_some(usual));
    };
    let found = match choice {
        ClipChoice::Number(number) => number.checked_sub(1).filter(|index| *index < clips.len()),
        ClipChoice::Name(name) => find(clips, name),
    };
    found.map(Some).ok_or_else(|| FormatError::Options {
        what: match choice {
            ClipChoice::Number(number) => format!("there is no clip number {number} in the file"),
            ClipChoice::Name(name) => format!("there is no clip `{}` in the file", clean(name, LONGEST)),
        },
        hint: if clips.is_empty() { "it has no clips".into() } else { format!("its clips are {}", names()) },
    })
}

/// A name as it is; else one that differs in case only; else one behind a prefix such as `Armature|`.
fn find(clips: &[ClipInfo], name: &str) -> Option<usize> {
    let same = |clip: &ClipInfo| clip.name == name;
    let nearly = |clip: &ClipInfo| clip.name.eq_ignore_ascii_case(name);
    let behind =
        |clip: &ClipInfo| clip.name.rsplit('|').next().is_some_and(|end| end.eq_ignore_ascii_case(name));
    let position = |test: &dyn Fn(&ClipInfo) -> bool| clips.iter().position(test);
    position(&same).or_else(|| position(&nearly)).or_else(|| position(&behind))
}
