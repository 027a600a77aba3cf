//! Fuzz targets of the formats that are two files: ASF with AMC, a DeepMimic character with its motion. Whatever the
//! texts are, they are read or refused: no panic, no endless loop, no more than the limits.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "functions beside the tests may fail too")]

use inkrig_formats::{FormatError, Import, ImportOptions, Limits, read_amc, read_deepmimic};

const ASF: &str = ":units\n length 0.45\n angle deg\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n position 0 0 0\n:bonedata\n begin\n name a\n direction 0 -1 0\n length 2\n axis 0 0 20 XYZ\n dof rx ry rz\n limits (-1 1)\n end\n begin\n name b\n direction 1 0 0\n length 1\n dof rx\n end\n:hierarchy\n begin\n root a\n a b\n end\n";
const AMC: &str =
    ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 0 0 1 2 3\na 1 2 3\nb 4\n2\nroot 0 0 1 1 2 3\na 3 2 1\nb -4\n";
const CHARACTER: &str = r#"{"Skeleton":{"Joints":[{"ID":0,"Name":"root","Type":"none","Parent":-1},{"ID":1,"Name":"a","Type":"revolute","Parent":0,"AttachY":-0.4}]},"BodyDefs":[{"ID":1,"Shape":"box","AttachX":0.1,"Param0":0.2}]}"#;
const MOTION: &str =
    r#"{"Loop":"wrap","Frames":[[0.05,0,1,0,1,0,0,0,0.5],[0.1,0,1,0,1,0,0,0,1],[0,0,1,0,1,0,0,0,0]]}"#;

const WORDS: &[&str] = &[
    "\n",
    " ",
    "begin",
    "end",
    ":hierarchy\n",
    ":bonedata\n",
    ":root",
    ":units",
    "root",
    "a",
    "b",
    "dof",
    "rx",
    "tx",
    "l",
    "axis",
    "XYZ",
    "YYX",
    "length",
    "name",
    "1e300",
    "-1e12",
    "nan",
    "inf",
    "99999999999",
    "0",
    "-",
    "#",
    ":DEGREES\n",
    ":RADIANS",
    "\0",
    "\u{feff}",
    "{",
    "}",
    "[",
    "]",
    "[[",
    "]]",
    ",",
    "\"",
    "null",
    "\"Frames\":",
    "1e-300",
    "0.00001",
    "10",
];

/// Kind, place, argument, second place.
type Edit = (u8, u16, u8, u16);

fn changed(text: &str, edits: &[Edit]) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for &(kind, place, argument, other) in edits {
        let (at, to) = (usize::from(place) % (bytes.len() + 1), usize::from(other) % (bytes.len() + 1));
        match kind % 5 {
            0 => {
                let word = WORDS[usize::from(argument) % WORDS.len()];
                bytes.splice(at..at, word.bytes());
            }
            1 => drop(bytes.drain(at.min(to)..at.max(to).min(at.min(to) + 40))),
            2 => bytes.truncate(at),
            3 if at < bytes.len() => bytes[at] = argument,
            _ => {
                let piece: Vec<u8> = bytes[at.min(to)..at.max(to).min(at.min(to) + 60)].to_vec();
                bytes.splice(at..at, piece);
            }
        }
    }
    bytes
}

fn check(read: impl Fn(&ImportOptions) -> Result<Import, FormatError>, skeleton: Vec<u8>) {
    let limits = Limits { cells: 2000, joints: 40, ..Limits::default() };
    match read(&ImportOptions { skeleton: Some(skeleton), limits, ..ImportOptions::default() }) {
        Ok(import) => {
            let (frames, joints) = (import.clip.frames(), import.clip.skeleton().len());
            assert!(frames * joints <= limits.cells && joints <= limits.joints);
            assert!(
                (0..frames).all(|frame| import.clip.rotations(frame).iter().all(|turn| turn.is_normalized()))
            );
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

#[test]
fn acclaim_texts_changed_at_random() {
    bolero::check!().with_type::<(Vec<Edit>, Vec<Edit>)>().for_each(|(skeleton, motion)| {
        let motion = changed(AMC, motion);
        check(|options| read_amc(&motion, options), changed(ASF, skeleton));
    });
}

#[test]
fn deepmimic_texts_changed_at_random() {
    bolero::check!().with_type::<(Vec<Edit>, Vec<Edit>)>().for_each(|(character, motion)| {
        let motion = changed(MOTION, motion);
        check(|options| read_deepmimic(&motion, options), changed(CHARACTER, character));
    });
}
