//! Motions, curves and storyboards that this project made and gives away, and the code that makes them.
//!
//! The files are embedded, so that a program shows them without any file on the disk. `samples/README.md` says who
//! may do what with them: everybody, everything.
//!
//! ```
//! let person = inkrig_samples::find("person").unwrap();
//! assert_eq!(person.file_name, "person.bvh");
//! assert!(person.bytes.starts_with(b"HIERARCHY"));
//! assert_eq!(inkrig_samples::curves().len(), 4);
//! ```

pub mod make;

/// An embedded file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sample {
    /// Short name, the file's without its extension.
    pub name: &'static str,
    /// Name of the file; its extension says the format.
    pub file_name: &'static str,
    /// The file itself.
    pub bytes: &'static [u8],
    /// What it shows, one sentence.
    pub description: &'static str,
}

/// The motions, BVH in centimetres: a person, a four-legged animal, a snake.
pub fn motions() -> &'static [Sample] {
    &MOTIONS
}

/// The drawn curves: JSON, CSV and SVG.
pub fn curves() -> &'static [Sample] {
    &CURVES
}

/// The storyboards: JSON.
pub fn storyboards() -> &'static [Sample] {
    &STORYBOARDS
}

/// The motion, curve or storyboard of that name (`person`) or file name (`person.bvh`).
pub fn find(name: &str) -> Option<&'static Sample> {
    MOTIONS
        .iter()
        .chain(&CURVES)
        .chain(&STORYBOARDS)
        .find(|sample| sample.name == name || sample.file_name == name)
}

static MOTIONS: [Sample; 3] = [
    Sample {
        name: "person",
        file_name: "person.bvh",
        bytes: include_bytes!("../motions/person.bvh"),
        description: "A person walks, turns, waves, crouches and sways, each from small to large; 24 s.",
    },
    Sample {
        name: "quadruped",
        file_name: "quadruped.bvh",
        bytes: include_bytes!("../motions/quadruped.bvh"),
        description: "A hound walks, trots, gallops along a curve, slows down, stops and bows; 15 s.",
    },
    Sample {
        name: "snake",
        file_name: "snake.bvh",
        bytes: include_bytes!("../motions/snake.bvh"),
        description: "A snake winds ahead with growing bends, rears its head, looks around and hurries on; 11 s.",
    },
];

static CURVES: [Sample; 4] = [
    Sample {
        name: "spiral",
        file_name: "spiral.json",
        bytes: include_bytes!("../curves/spiral.json"),
        description: "Five circles, each wider than the one before; 300 points, one a frame.",
    },
    Sample {
        name: "eight",
        file_name: "eight.csv",
        bytes: include_bytes!("../curves/eight.csv"),
        description: "A figure of eight on its side, five laps; 300 points, one a frame.",
    },
    Sample {
        name: "wave",
        file_name: "wave.svg",
        bytes: include_bytes!("../curves/wave.svg"),
        description: "A wave whose height grows from left to right; the shape only, without time.",
    },
    Sample {
        name: "heart",
        file_name: "heart.json",
        bytes: include_bytes!("../curves/heart.json"),
        description: "A heart with the time of the pen: slow in the bends, quick between them; 6 s.",
    },
];

static STORYBOARDS: [Sample; 7] = [
    Sample {
        name: "walk-and-wave",
        file_name: "walk-and-wave.json",
        bytes: include_bytes!("../storyboards/walk-and-wave.json"),
        description: "A person walks up and waves; two frames.",
    },
    Sample {
        name: "kick",
        file_name: "kick.json",
        bytes: include_bytes!("../storyboards/kick.json"),
        description: "A kick with the right foot, with lines of speed; one frame.",
    },
    Sample {
        name: "jump",
        file_name: "jump.json",
        bytes: include_bytes!("../storyboards/jump.json"),
        description: "A jump from a crouch; two frames.",
    },
    Sample {
        name: "sit-down-and-stand-up",
        file_name: "sit-down-and-stand-up.json",
        bytes: include_bytes!("../storyboards/sit-down-and-stand-up.json"),
        description: "A person sits down on a chair and stands up; two frames.",
    },
    Sample {
        name: "dance",
        file_name: "dance.json",
        bytes: include_bytes!("../storyboards/dance.json"),
        description: "Three frames of a dance: both hands, a foot, a spin.",
    },
    Sample {
        name: "turn-and-run",
        file_name: "turn-and-run.json",
        bytes: include_bytes!("../storyboards/turn-and-run.json"),
        description: "A person turns and runs away; two frames.",
    },
    Sample {
        name: "lift-and-push",
        file_name: "lift-and-push.json",
        bytes: include_bytes!("../storyboards/lift-and-push.json"),
        description: "A bar is carried and lifted in balance, then hands push against a wall; three frames with constraints.",
    },
];
