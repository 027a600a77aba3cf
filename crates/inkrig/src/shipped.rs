//! Weights that come inside the program: they are found wherever it is, and belong to its version.

use std::path::{Path, PathBuf};

/// A file that the program has in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shipped {
    /// As records name it.
    pub(crate) name: &'static str,
    pub(crate) bytes: &'static [u8],
}

/// The generator. Of DDIM's 50 steps.
pub(crate) const CLEAN: Shipped =
    Shipped { name: "inkrig:clean", bytes: include_bytes!("../../../models/clean.safetensors") };
/// The motions of each verb that denoising begins with; they take the place of those of [`CLEAN`], so that they can be chosen anew without its weights.
pub(crate) const EXAMPLES: Shipped = Shipped {
    name: "inkrig:clean-examples",
    bytes: include_bytes!("../../../models/clean-examples.safetensors"),
};
/// The denoiser of [`CLEAN`] once more, distilled for one to four steps; the other weights are the same.
pub(crate) const QUICK: Shipped =
    Shipped { name: "inkrig:clean-quick", bytes: include_bytes!("../../../models/clean-quick.safetensors") };
/// The reader of drawn figures.
pub(crate) const SKETCH: Shipped = Shipped {
    name: "inkrig:sketch-reader",
    bytes: include_bytes!("../../../models/sketch-reader.safetensors"),
};
/// The reader of words.
pub(crate) const WORD: Shipped =
    Shipped { name: "inkrig:word-reader", bytes: include_bytes!("../../../models/word-reader.safetensors") };

impl Shipped {
    /// What stands for a path in messages and records. No file has this name.
    pub(crate) fn path(&self) -> PathBuf {
        PathBuf::from(self.name)
    }

    /// The one that a record names.
    pub(crate) fn named(path: &Path) -> Option<Self> {
        [CLEAN, EXAMPLES, QUICK, SKETCH, WORD].into_iter().find(|own| path.as_os_str() == own.name)
    }
}
