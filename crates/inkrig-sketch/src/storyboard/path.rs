//! Ways over the ground that a frame takes over from what was made of another.

use serde::de::{Deserialize, Deserializer, Error, Visitor};
use serde::ser::{Serialize, Serializer};
use std::fmt;

/// What the file says for going on.
const CONTINUE: &str = "continue";

/// Whose way over the ground a frame goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FramePath {
    /// It goes on from the frame before: as fast, and turning as much. `"continue"` in the file.
    Continue,
    /// It goes the way of an earlier frame again, from where the frame before has come to. In the file that frame's place in the
    /// story, from 1.
    Of(u32),
}

impl Serialize for FramePath {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Continue => to.serialize_str(CONTINUE),
            Self::Of(frame) => to.serialize_u32(*frame),
        }
    }
}

impl<'de> Deserialize<'de> for FramePath {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Path;
        impl Visitor<'_> for Path {
            type Value = FramePath;

            fn expecting(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
                to.write_str("a path: \"continue\", or the place of an earlier frame, from 1")
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<FramePath, E> {
                let known = (text == CONTINUE).then_some(FramePath::Continue);
                known.ok_or_else(|| E::invalid_value(serde::de::Unexpected::Str(text), &self))
            }

            fn visit_u64<E: Error>(self, number: u64) -> Result<FramePath, E> {
                let known = u32::try_from(number).ok().filter(|number| *number > 0).map(FramePath::Of);
                known.ok_or_else(|| E::invalid_value(serde::de::Unexpected::Unsigned(number), &self))
            }
        }
        from.deserialize_any(Path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_a_word_or_a_frame() {
        for (text, path) in [("\"continue\"", FramePath::Continue), ("7", FramePath::Of(7))] {
            assert_eq!(serde_json::from_str::<FramePath>(text).unwrap(), path);
            assert_eq!(serde_json::to_string(&path).unwrap(), text);
        }
        for wrong in ["0", "-1", "1.5", "\"repeat\"", "[1]", "5000000000"] {
            let said = serde_json::from_str::<FramePath>(wrong).unwrap_err().to_string();
            assert!(said.contains("\"continue\", or the place of an earlier frame"), "{wrong}: {said}");
        }
    }
}
