//! What a project is: clips, what they shall follow, wishes, settings. Plain data that is one JSON file.

mod check;
mod command;
mod control;
mod key;
mod part;
mod settings;

pub use check::{MOST_POINTS, is_id};
pub use command::Command;
pub use control::{Control, CurveTiming, LabelSegment, PenPoint};
pub use key::{FixedPart, Key, KeyKind, Place, PoseRef};
pub use part::Part;
pub use settings::{GroundPath, Preset, RootMode, Settings};

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Everything of a project that can be undone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", default)]
pub struct Document {
    /// What people call it.
    pub name: String,
    /// The motions that are at hand.
    pub clips: Vec<ClipEntry>,
    /// The sounds that are at hand.
    pub sounds: Vec<SoundEntry>,
    /// What is arranged.
    pub source: Source,
    /// What it shall follow.
    pub control: Option<Control>,
    /// Wishes for single poses.
    pub keys: Vec<Key>,
    /// How it is solved, and what is done to the result.
    pub settings: Settings,
    /// The page's own: an object of at most 256 kB that the server never looks into.
    #[schema(value_type = Object)]
    pub page: serde_json::Value,
}

impl Default for Document {
    fn default() -> Self {
        Self {
            name: "Untitled".into(),
            clips: Vec::new(),
            sounds: Vec::new(),
            source: Source::default(),
            control: None,
            keys: Vec::new(),
            settings: Settings::default(),
            page: serde_json::Value::Object(serde_json::Map::new()),
        }
    }
}

impl Document {
    /// The clip of that id.
    pub fn clip(&self, id: &str) -> Option<&ClipEntry> {
        self.clips.iter().find(|clip| clip.id == id)
    }

    /// The sound of that id.
    pub fn sound(&self, id: &str) -> Option<&SoundEntry> {
        self.sounds.iter().find(|sound| sound.id == id)
    }
}

/// A motion file of the project, and how it is read.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", default)]
pub struct ClipEntry {
    /// Stays the same as long as the project lives.
    pub id: String,
    /// What people call it.
    pub name: String,
    /// Name of the file in the project's folder `clips`.
    pub file: String,
    /// Which clip of a file that has several, by name or number from 1.
    pub take: Option<String>,
    /// What it is for.
    pub role: ClipRole,
    /// Metres in one unit of the file; guessed without.
    pub unit: Option<f64>,
    /// The axis that points up in the file, where the file does not say it.
    pub up: Option<Up>,
    /// Frames a second of the file, where it says the wrong thing.
    pub source_fps: Option<f64>,
    /// Files that belong to it: a skeleton, buffers.
    pub beside: Vec<Beside>,
}

/// What a clip is for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum ClipRole {
    /// A motion, a character, or both.
    #[default]
    Motion,
    /// An earlier result of which a part stays.
    Locked,
}

/// Axes that can point up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum Up {
    /// y
    Y,
    /// z
    Z,
}

/// A file that belongs to a clip.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", default)]
pub struct Beside {
    /// Its name where it came from, by which the clip's file asks for it.
    pub name: String,
    /// Name of the file in the project's folder `clips`.
    pub file: String,
}

/// A sound of the project.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", default)]
pub struct SoundEntry {
    /// Stays the same as long as the project lives.
    pub id: String,
    /// What people call it.
    pub name: String,
    /// Name of the file in the project's folder `sounds`.
    pub file: String,
}

/// Which clips are arranged, and what of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", default)]
pub struct Source {
    /// Ids of clips of one skeleton, in order.
    pub clips: Vec<String>,
    /// From and to, seconds of every clip.
    #[schema(value_type = Option<(f64, f64)>)]
    pub range: Option<[f64; 2]>,
    /// How often each clip is played that is a loop.
    pub laps: usize,
}

impl Default for Source {
    fn default() -> Self {
        Self { clips: Vec::new(), range: None, laps: 1 }
    }
}

impl Document {
    /// Checks limits, and that it refers only to what is there.
    ///
    /// # Errors
    /// Says what is too much, or refers to nothing.
    pub fn check(&self) -> Result<(), crate::StudioError> {
        check::document(self)
    }
}
