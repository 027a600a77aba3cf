//! Every hostile or odd file has a fixture, and its message is pinned down here to the letter.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too"
)]

mod common;

use inkrig_formats::{ImportOptions, read_bvh};
use std::collections::BTreeSet;

/// Files that are refused, and what is said.
#[rustfmt::skip]
const REFUSED: &[(&str, &str)] = &[
    ("brace-missing", "line 15, column 1, joint `hip`: a closing brace is missing before `MOTION`; the file is cut off or damaged; export it again"),
    ("brace-too-many", "line 16, column 1: expected MOTION or ROOT, found `}`; after the last brace of a root comes another ROOT, or MOTION"),
    ("channels-huge", "line 10, column 3, joint `knee`: expected channel 4 of 99999999999, found `End`; channels are Xposition, Yposition, Zposition, Xrotation, Yrotation, Zrotation"),
    ("channels-late", "line 14, column 2, joint `hip`: CHANNELS after a child joint; put CHANNELS right after OFFSET: the order of the columns hangs on it"),
    ("channels-negative", "line 9, column 12, joint `knee`: expected the number of channels, found `-3`; write how many channels follow, such as `CHANNELS 3 Zrotation Xrotation Yrotation`"),
    ("channels-no-count", "line 9, column 12, joint `knee`: expected the number of channels, found `Zrotation`; write how many channels follow, such as `CHANNELS 3 Zrotation Xrotation Yrotation`"),
    ("channels-too-few", "line 9, column 34, joint `knee`: more channels than announced: `Yrotation`; set the number behind CHANNELS to how many follow"),
    ("channels-twice", "line 10, column 3, joint `knee`: a second CHANNELS in one joint; leave one of them out"),
    ("channels-unknown", "line 9, column 14, joint `knee`: expected channel 1 of 3, found `Zscale`; channels are Xposition, Yposition, Zposition, Xrotation, Yrotation, Zrotation"),
    ("cut-hierarchy", "line 10, column 1, joint `knee`: 2 closing braces are missing before the end of the file; the file is cut off or damaged; export it again"),
    ("empty", "line 1, column 1: expected HIERARCHY, found the end of the file; a BVH file begins with the word HIERARCHY; is this another format?"),
    ("end-site-channels", "line 13, column 4, joint `knee_end`: an end site with channels; an end site cannot move; make it a JOINT"),
    ("end-site-child", "line 13, column 4, joint `knee_end`: `JOINT` inside an end site; an end site is the tip of a chain; make it a JOINT"),
    ("frame-count-missing", "line 17, column 8: expected the number of frames, found nothing; write the number of rows that follow, such as `Frames: 120`"),
    ("frame-count-negative", "line 17, column 9: expected the number of frames, found `-2`; write the number of rows that follow, such as `Frames: 120`"),
    ("frame-count-twice", "line 18, column 1: `Frames:` a second time; leave one of them out"),
    ("frame-count-word", "line 17, column 9: expected the number of frames, found `two`; write the number of rows that follow, such as `Frames: 120`"),
    ("frame-header-unknown", "line 17, column 1: expected `Frames:` or `Frame Time:`, found `Frame Count: 2`; after MOTION come these two lines, then the rows"),
    ("frame-time-comma", "line 18, column 13: expected the frame time, found `0,0333333`; write decimals with a point, or give the frame rate with `--source-fps`, such as `--source-fps 30`"),
    ("frame-time-empty", "line 18, column 12: expected the frame time, found nothing; give the frame rate with `--source-fps`, such as `--source-fps 30`"),
    ("frame-time-infinite", "line 18, column 13: the frame time is `inf`, not between 0.00001 and 10 seconds; give the frame rate with `--source-fps`, such as `--source-fps 30`"),
    ("frame-time-long", "line 18, column 13: the frame time is `11`, not between 0.00001 and 10 seconds; give the frame rate with `--source-fps`, such as `--source-fps 30`"),
    ("frame-time-missing", "line 18, column 1: there is no frame time; give the frame rate with `--source-fps`, such as `--source-fps 30`"),
    ("frame-time-nan", "line 18, column 13: the frame time is `nan`, not between 0.00001 and 10 seconds; give the frame rate with `--source-fps`, such as `--source-fps 30`"),
    ("frame-time-negative", "line 18, column 13: the frame time is `-0.0333333`, not between 0.00001 and 10 seconds; give the frame rate with `--source-fps`, such as `--source-fps 30`"),
    ("frame-time-short", "line 18, column 13: the frame time is `0.000001`, not between 0.00001 and 10 seconds; give the frame rate with `--source-fps`, such as `--source-fps 30`"),
    ("frame-time-word", "line 18, column 13: expected the frame time, found `fast`; give the frame rate with `--source-fps`, such as `--source-fps 30`"),
    ("frame-time-zero", "line 18, column 13: the frame time is `0`, not between 0.00001 and 10 seconds; give the frame rate with `--source-fps`, such as `--source-fps 30`"),
    ("hierarchy-alone", "line 2, column 1: expected ROOT, found the end of the file; after HIERARCHY comes ROOT with a name"),
    ("long-row", "line 20, column 28, joint `knee`: frame 2 has more than 9 numbers: `99` comes after Yrotation, the last channel; write one frame a line, with a number for every channel"),
    ("no-channels", "line 18, column 1: no joint has channels; the file holds a skeleton only; export it again with its animation"),
    ("no-frames", "line 19, column 1: there are no frames after MOTION; the file holds a skeleton only; export it again with its animation"),
    ("no-motion", "line 16, column 1: the file has no MOTION; the file holds a skeleton only; export it again with its animation"),
    ("no-offset", "line 13, column 2, joint `knee`: a joint without OFFSET; every joint says its place as `OFFSET x y z`"),
    ("no-opening-brace", "line 7, column 3, joint `knee`: expected an opening brace, found `OFFSET`; after the name of a joint comes `{`"),
    ("no-root", "line 2, column 1: expected ROOT, found `JOINT`; after HIERARCHY comes ROOT with a name"),
    ("not-bvh", "line 2, column 3: expected HIERARCHY, found `;`; a BVH file begins with the word HIERARCHY; is this another format?"),
    ("offset-comma", "line 8, column 12, joint `knee`: expected the Y of OFFSET, found `-80,5`; write decimals with a point, and nothing but spaces between numbers"),
    ("offset-cut", "line 9, column 3, joint `knee`: expected the Z of OFFSET, found `CHANNELS`; write a decimal number, such as -12.5"),
    ("offset-nan", "line 8, column 12, joint `knee`: expected the Y of OFFSET, found `nan`; export the motion again, or put in the value of the frame before"),
    ("offset-too-large", "line 8, column 12, joint `knee`: expected the Y of OFFSET, found `-8e12`; numbers go up to 1e12; export the motion again"),
    ("offset-twice", "line 9, column 3, joint `knee`: a second OFFSET in one joint; leave one of them out"),
    ("only-row-short", "line 19, column 18, joint `knee`: frame 1 has 8 of 9 numbers: Yrotation is missing; write one frame a line, with a number for every channel"),
    ("position-twice", "line 5, column 33, joint `hip`: a second `Yposition`; a joint has one position along each axis; leave one out, with its column"),
    ("second-motion", "line 21, column 1: `HIERARCHY` a second time; keep one HIERARCHY and one MOTION a file"),
    ("short-row", "line 19, column 18, joint `knee`: frame 1 has 8 of 9 numbers: Yrotation is missing; write one frame a line, with a number for every channel"),
    ("unknown-keyword", "line 10, column 3, joint `knee`: expected OFFSET, CHANNELS, JOINT, End Site or a closing brace, found `ROTATION`; a joint holds nothing else; mend the line or export the file again"),
    ("utf16", "line 1, column 1: the file is UTF-16 text; save it as UTF-8 in a text editor"),
    ("value-comma", "line 20, column 1, joint `hip`: frame 2: expected a number for Xposition, found `1,5`; write decimals with a point, and nothing but spaces between numbers"),
    ("value-control", "line 20, column 1, joint `hip`: frame 2: expected a number for Xposition, found `�[31m`; write a decimal number, such as -12.5"),
    ("value-cut-utf8", "line 20, column 1, joint `hip`: frame 2: expected a number for Xposition, found `�`; write a decimal number, such as -12.5"),
    ("value-ind", "line 20, column 23, joint `knee`: frame 2: expected a number for Xrotation, found `-1.#IND`; write a decimal number, such as -12.5"),
    ("value-infinite", "line 20, column 15, joint `hip`: frame 2: expected a number for Xrotation, found `-inf`; export the motion again, or put in the value of the frame before"),
    ("value-nan", "line 20, column 15, joint `hip`: frame 2: expected a number for Xrotation, found `NaN`; export the motion again, or put in the value of the frame before"),
    ("value-too-large", "line 20, column 5, joint `hip`: frame 2: expected a number for Yposition, found `1e13`; numbers go up to 1e12; export the motion again"),
    ("value-word", "line 20, column 23, joint `knee`: frame 2: expected a number for Xrotation, found `4S`; write a decimal number, such as -12.5"),
];

/// Files that are read, and what is found in them beside the guessed unit.
#[rustfmt::skip]
const READ: &[(&str, &[&str])] = &[
    ("blank-lines", &[]),
    ("bom", &[]),
    ("braces-beside-names", &[]),
    ("cr", &[]),
    ("crlf", &[]),
    ("cut-number", &["warning [bvh-cut-row] line 20, column 1: the last row is cut off and left out; frames before it: 1", "warning [bvh-row-count] line 17, column 9: announced frames: 2; rows found and used: 1"]),
    ("cut-row", &["warning [bvh-cut-row] line 20, column 1: the last row is cut off and left out; frames before it: 1", "warning [bvh-row-count] line 17, column 9: announced frames: 2; rows found and used: 1"]),
    ("dos-end", &[]),
    ("duplicate-names", &["warning [bvh-duplicate-name] the joint name `hip` is used more than once; such joints are told apart by order"]),
    ("few-rotations", &[]),
    ("fewer-rows", &["warning [bvh-row-count] line 17, column 9: announced frames: 5; rows found and used: 2"]),
    ("five-rotations", &[]),
    ("giant", &[]),
    ("huge-frame-count", &["warning [bvh-row-count] line 17, column 9: announced frames: 99999999999; rows found and used: 2"]),
    ("joint-without-channels", &[]),
    ("keyword-case", &[]),
    ("large-angles", &[]),
    ("latin1-name", &["warning [bvh-name-encoding] line 6, column 8: a joint name is not UTF-8; its unreadable bytes are replaced"]),
    ("leaf-without-end-site", &[]),
    ("more-rows", &["warning [bvh-row-count] line 17, column 9: announced frames: 1; rows found and used: 2"]),
    ("no-frame-count", &["warning [bvh-row-count] there is no line `Frames:`; rows found and used: 2"]),
    ("no-name", &["warning [bvh-empty-name] line 6, column 7: a joint has no name"]),
    ("no-size", &["warning [unit-unknown] the figure has no size, so its unit is taken as a centimetre; `--unit` sets another"]),
    ("one-frame-without-time", &["info [bvh-frame-time] line 18, column 1: there is no frame time; the single frame is taken at 30 frames a second"]),
    ("one-frame-zero-time", &["info [bvh-frame-time] line 18, column 13: the frame time is `0`, not between 0.00001 and 10 seconds; the single frame is taken at 30 frames a second"]),
    ("one-line", &[]),
    ("plain", &[]),
    ("positions-after-rotations", &[]),
    ("positions-on-every-joint", &[]),
    ("repeated-axis", &[]),
    ("several-end-sites", &[]),
    ("short-frame-time", &[]),
    ("some-positions", &[]),
    ("spaced-names", &[]),
    ("tabs", &[]),
    ("two-roots", &[]),
    ("wrapped-rows", &["warning [bvh-wrapped-rows] line 19, column 1: frames do not end with their lines; the numbers are taken in order"]),
    ("zero-frame-count", &["warning [bvh-row-count] line 17, column 9: announced frames: 0; rows found and used: 2"]),
    ("zero-positions", &["warning [bvh-zero-positions] joints with an OFFSET whose positions are zero throughout: 1; they lie on their parents. If the figure collapses, take the position channels out of them"]),
];

#[test]
fn refused_files_say_what_where_and_what_to_do() {
    for (name, message) in REFUSED {
        let error = read_bvh(&common::fixture(name), &ImportOptions::default()).expect_err(name);
        assert_eq!(error.to_string(), *message, "{name}");
        assert!(!error.hint().is_empty(), "{name}");
        assert!(error.place().is_some(), "{name}");
    }
}

#[test]
fn odd_files_are_read_and_say_what_is_odd() {
    for (name, messages) in READ {
        let import = read_bvh(&common::fixture(name), &ImportOptions::default())
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let findings = import.findings.iter().filter(|finding| finding.code != "unit-guessed");
        let findings: Vec<_> = findings.map(ToString::to_string).collect();
        assert_eq!(findings, *messages, "{name}");
    }
}

#[test]
fn every_fixture_is_in_one_of_the_tables() {
    let tables = REFUSED.iter().map(|(name, _)| *name).chain(READ.iter().map(|(name, _)| *name));
    let named: BTreeSet<String> = tables.map(String::from).collect();
    assert_eq!(named.len(), REFUSED.len() + READ.len());
    assert_eq!(named, common::fixture_names());
}
