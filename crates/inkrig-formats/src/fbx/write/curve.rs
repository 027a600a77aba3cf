//! Keys over time as the format keeps them.

use super::document::{Document, Value, object_name};
use crate::FormatError;
use Value::{Double, Floats, Int, Ints, Long, Longs, Text};

/// A value at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Key {
    /// Time, in ticks of the format's clock.
    pub(super) tick: i64,
    /// Degrees, or the file's unit of length.
    pub(super) value: f64,
    pub(super) shape: Shape,
}

/// How the curve goes on from a key to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shape {
    /// Straight.
    Linear,
    /// It stays, and jumps at the next key.
    Stepped,
    /// A cubic whose handles are a third of the way long.
    Cubic {
        /// Its slope at this key, in the value's unit a second.
        slope: f64,
        /// Its slope at the next key.
        next_slope: f64,
    },
}

/// Handles of a third, twice, as the format packs them: thousandths of ten in two halves of a word.
const THIRDS: u32 = (3333 << 16) | 3333;

/// Writes an object with keys that rise in time.
pub(super) fn object(document: &mut Document, id: i64, keys: &[Key]) -> Result<(), FormatError> {
    let times: Vec<i64> = keys.iter().map(|key| key.tick).collect();
    let values: Vec<f32> = keys.iter().map(|key| key.value as f32).collect();
    // Equal shapes in a row are said once.
    let (mut flags, mut data, mut counts) = (Vec::new(), Vec::new(), Vec::<i32>::new());
    let mut before = None;
    for key in keys {
        match counts.last_mut().filter(|_| before == Some(key.shape)) {
            Some(count) => *count += 1,
            None => {
                let (flag, [slope, next_slope]) = key.shape.attributes();
                flags.push(flag);
                data.extend([slope, next_slope, f32::from_bits(THIRDS), 0.0]);
                counts.push(1);
                before = Some(key.shape);
            }
        }
    }
    document.open("AnimationCurve", &[Long(id), Text(&object_name("", "AnimCurve")), Text("")])?;
    document.leaf("Default", &[Double(keys.first().map_or(0.0, |key| key.value))])?;
    document.leaf("KeyVer", &[Int(4008)])?;
    document.leaf("KeyTime", &[Longs(&times)])?;
    document.leaf("KeyValueFloat", &[Floats(&values)])?;
    document.leaf("KeyAttrFlags", &[Ints(&flags)])?;
    document.leaf("KeyAttrDataFloat", &[Floats(&data)])?;
    document.leaf("KeyAttrRefCount", &[Ints(&counts)])?;
    document.close()
}

impl Shape {
    /// Flags of the format, and its two slopes.
    fn attributes(self) -> (i32, [f32; 2]) {
        match self {
            Self::Stepped => (0x2, [0.0; 2]),
            Self::Linear => (0x4, [0.0; 2]),
            // Cubic, with slopes of its own on either side of the key.
            Self::Cubic { slope, next_slope } => (0x8 | 0x400 | 0x800, [slope as f32, next_slope as f32]),
        }
    }
}
