//! The file that says which joint follows which.

use crate::error::CliError;
use crate::load;
use inkrig_motion::Skeleton;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The version of the file that is written and read.
const VERSION: u32 = 1;
/// The most pairs that are read.
const MOST: usize = 10_000;

/// A map as it stands in its file. Lists of names under `motion_unused` and `character_at_rest` are there to be read by
/// people: what stands in them has no effect.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MapFile {
    inkrig_map: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    comment: Option<String>,
    joints: Vec<Entry>,
    #[serde(default)]
    motion_unused: Vec<String>,
    #[serde(default)]
    character_at_rest: Vec<String>,
}

/// A joint of the motion with those of the character that follow it.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    motion: String,
    character: Followers,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    comment: Option<String>,
}

/// One name or several.
#[derive(Debug, Serialize, Deserialize)]
#[serde(untagged)]
enum Followers {
    One(String),
    Several(Vec<String>),
}

/// The file for pairs of a joint of the motion and one of the character.
pub(super) fn write(
    pairs: &[(usize, usize)],
    motion: &Skeleton,
    character: &Skeleton,
) -> Result<Vec<u8>, CliError> {
    let (own, other) = (Names::of(motion), Names::of(character));
    let followers = |joint: usize| -> Vec<String> {
        pairs.iter().filter(|pair| pair.0 == joint).map(|pair| other.0[pair.1].clone()).collect()
    };
    let mut joints = Vec::new();
    for (joint, name) in own.0.iter().enumerate() {
        let mut names = followers(joint);
        let character = match names.len() {
            0 => continue,
            1 => Followers::One(names.remove(0)),
            _ => Followers::Several(names),
        };
        joints.push(Entry { motion: name.clone(), character, comment: None });
    }
    let rest = |skeleton: &Skeleton, names: &Names, used: &dyn Fn(usize) -> bool| -> Vec<String> {
        let joints = skeleton.joints().iter().enumerate();
        let free = joints.filter(|(index, joint)| !joint.end_site && !used(*index));
        free.map(|(index, _)| names.0[index].clone()).collect()
    };
    let file = MapFile {
        inkrig_map: VERSION,
        comment: Some(
            "Each joint of the motion with the joint, or the list of joints, of the character that follows it. Joints of \
             the character that stand in no entry keep their rest; the lists at the end are only to choose from."
                .into(),
        ),
        joints,
        motion_unused: rest(motion, &own, &|joint| pairs.iter().any(|pair| pair.0 == joint)),
        character_at_rest: rest(character, &other, &|joint| pairs.iter().any(|pair| pair.1 == joint)),
    };
    let mut text = serde_json::to_vec_pretty(&file)?;
    text.push(b'\n');
    Ok(text)
}

/// Pairs of a joint of the motion and one of the character that follows it.
///
/// # Errors
/// When the file cannot be read, is no map, or names joints that are not there.
pub(super) fn read(
    path: &Path,
    motion: &Skeleton,
    character: &Skeleton,
) -> Result<Vec<(usize, usize)>, CliError> {
    let bytes = load::drawing(path)?;
    parse(&bytes, motion, character).map_err(|cause| CliError::Map { path: path.to_path_buf(), cause })
}

fn parse(bytes: &[u8], motion: &Skeleton, character: &Skeleton) -> Result<Vec<(usize, usize)>, String> {
    let file: MapFile = serde_json::from_slice(bytes).map_err(|error| error.to_string())?;
    if file.inkrig_map != VERSION {
        return Err(format!("it is of version {}, and {VERSION} is read", file.inkrig_map));
    }
    let (own, other) = (Names::of(motion), Names::of(character));
    let mut pairs = Vec::new();
    for entry in file.joints {
        let source = own.find(&entry.motion, "motion")?;
        let followers = match entry.character {
            Followers::One(name) => vec![name],
            Followers::Several(names) => names,
        };
        for name in followers {
            let target = other.find(&name, "character")?;
            if let Some(&(first, _)) = pairs.iter().find(|pair: &&(usize, usize)| pair.1 == target) {
                let (first, second) = (&own.0[first], &own.0[source]);
                return Err(format!(
                    "{name} of the character follows both {first} and {second}: leave one out"
                ));
            }
            if pairs.len() == MOST {
                return Err(format!("it has more than {MOST} pairs"));
            }
            pairs.push((source, target));
        }
    }
    if pairs.is_empty() {
        return Err("it pairs no joints".into());
    }
    Ok(pairs)
}

/// Names of a skeleton's joints; of those that have one name the second ends in `#2`, and so on.
struct Names(Vec<String>);

impl Names {
    fn of(skeleton: &Skeleton) -> Self {
        let mut seen = std::collections::BTreeMap::new();
        let names = skeleton.joints().iter().map(|joint| {
            let count = seen.entry(joint.name.as_str()).or_insert(0_usize);
            *count += 1;
            if *count == 1 { joint.name.clone() } else { format!("{}#{count}", joint.name) }
        });
        Self(names.collect())
    }

    fn find(&self, name: &str, whose: &str) -> Result<usize, String> {
        self.0.iter().position(|own| own == name).ok_or_else(|| {
            let near = self.nearest(name).join(", ");
            format!("the {whose} has no joint {name}; the nearest names are {near}")
        })
    }

    /// Up to three names that are most like one.
    fn nearest(&self, name: &str) -> Vec<&str> {
        nearest_names(self.0.iter().map(String::as_str), name)
    }
}

/// Up to three of some names that are most like one.
pub(super) fn nearest_names<'a>(names: impl Iterator<Item = &'a str>, name: &str) -> Vec<&'a str> {
    let mut order: Vec<(usize, &str)> = names.map(|own| (edits(&lower(own), &lower(name)), own)).collect();
    order.sort();
    order.into_iter().take(3).map(|(_, name)| name).collect()
}

fn lower(name: &str) -> Vec<char> {
    name.chars().take(64).flat_map(char::to_lowercase).collect()
}

/// How many letters have to be put in, left out or changed to make one of the other (Levenshtein's distance).
fn edits(a: &[char], b: &[char]) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, own) in a.iter().enumerate() {
        let mut before = row[0];
        row[0] = i + 1;
        for (j, other) in b.iter().enumerate() {
            let changed = before + usize::from(own != other);
            before = row[j + 1];
            row[j + 1] = changed.min(before + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_motion::{Joint, glam::Vec3};

    fn skeleton(names: &[&str]) -> Skeleton {
        let joint = |(index, name): (usize, &&str)| Joint::new(*name, index.checked_sub(1), Vec3::Y);
        Skeleton::new(names.iter().enumerate().map(joint).collect()).unwrap()
    }

    #[test]
    fn a_map_is_read_as_it_was_written() {
        let (motion, character) =
            (skeleton(&["Hips", "Spine", "Arm", "Tail"]), skeleton(&["a", "b", "b", "c"]));
        let pairs = vec![(0, 0), (1, 1), (1, 2)];
        let written = write(&pairs, &motion, &character).unwrap();
        let text = String::from_utf8(written.clone()).unwrap();
        assert!(
            text.contains("b#2") && text.contains("\"motion_unused\": [\n    \"Arm\",\n    \"Tail\"\n  ]"),
            "{text}"
        );
        assert_eq!(parse(&written, &motion, &character), Ok(pairs));
    }

    #[test]
    fn what_is_wrong_is_said_with_the_nearest_names() {
        let skeleton = skeleton(&["LeftArm", "LeftForeArm", "RightArm", "Hips"]);
        let error = |text: &str| parse(text.as_bytes(), &skeleton, &skeleton).unwrap_err();
        let of = |motion: &str, character: &str| {
            error(&format!(
                r#"{{"inkrig_map": 1, "joints": [{{"motion": "{motion}", "character": {character}}}]}}"#
            ))
        };
        assert_eq!(
            of("leftarm2", "\"Hips\""),
            "the motion has no joint leftarm2; the nearest names are LeftArm, LeftForeArm, RightArm"
        );
        assert!(
            of("Hips", "[\"Hps\"]")
                .starts_with("the character has no joint Hps; the nearest names are Hips,")
        );
        assert!(of("Hips", "[\"Hips\", \"Hips\"]").contains("follows both Hips and Hips"));
        assert_eq!(of("Hips", "[]"), "it pairs no joints");
        assert!(error("{").contains("line 1"));
        assert!(error(r#"{"inkrig_map": 2, "joints": []}"#).contains("version 2"));
        assert!(error(r#"{"inkrig_map": 1, "joints": [], "joint": []}"#).contains("unknown field `joint`"));
    }
}
