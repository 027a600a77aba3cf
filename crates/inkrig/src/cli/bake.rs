//! What can be said about the keys of a result, for every command that writes a motion.

use crate::span::Length;
use clap::{Args, ValueEnum};
use std::fmt;
use std::str::FromStr;

/// Which frames of a motion become keys.
#[derive(Debug, Clone, Args)]
pub struct BakeArgs {
    /// How many keys the result has
    #[arg(long, value_enum, default_value_t = BakeMode::Dense, help_heading = "Keys of the result")]
    pub bake: BakeMode,
    /// How near few keys keep to the motion: every joint's place in the world, and every joint's own turn (with --bake
    /// sparse) [default: 1mm,0.5deg]
    #[arg(long, value_name = "1mm,0.5deg", help_heading = "Keys of the result")]
    pub tolerance: Option<Tolerance>,
    /// How long a pose is held (with --bake stepped): `2s` is on twos, every second frame of 24 a second, up to `12s`; `2`
    /// is frames of the result, `0.1s` seconds [default: 2s]
    #[arg(long, value_name = "2s|2|0.1s", help_heading = "Keys of the result")]
    pub on: Option<Hold>,
    /// A frame (48) or time (1.5s) of the result that becomes a key with exactly its pose; may be repeated. Exact poses of
    /// --key are such keys by themselves
    #[arg(long = "keep-key", value_name = "TIME", help_heading = "Keys of the result")]
    pub keep_keys: Vec<Length>,
}

/// Ways to make keys of frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BakeMode {
    /// One a frame
    Dense,
    /// Few, with curves between them (.glb, .fbx)
    Sparse,
    /// Poses that are held
    Stepped,
}

/// How far a motion may be from another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Places, metres.
    pub metres: f64,
    /// Rotations, degrees.
    pub degrees: f64,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { metres: 1e-3, degrees: 0.5 }
    }
}

impl FromStr for Tolerance {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "`{}` is no tolerance: give lengths and angles such as 1mm,0.5deg (mm, cm or m up to 10m; deg up to 90deg)",
                crate::printable::text(text)
            )
        };
        let mut tolerance = Self::default();
        let mut said = [false; 2];
        for part in text.split(',') {
            let part = part.trim();
            let units = [("mm", 1e-3, 0), ("cm", 1e-2, 0), ("deg", 1.0, 1), ("m", 1.0, 0)];
            let found = units.into_iter().find_map(|(unit, size, kind)| {
                let number: f64 = part.strip_suffix(unit)?.trim().parse().ok()?;
                Some((number * size, kind))
            });
            let (value, kind) = found.ok_or_else(wrong)?;
            let (slot, least, most) = match kind {
                0 => (&mut tolerance.metres, 1e-6, 10.0),
                _ => (&mut tolerance.degrees, 1e-3, 90.0),
            };
            let twice = said.get_mut(kind).is_none_or(|said| std::mem::replace(said, true));
            if twice || !(least..=most).contains(&value) {
                return Err(wrong());
            }
            *slot = value;
        }
        Ok(tolerance)
    }
}

/// How long a pose is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hold {
    /// So many frames of 24 a second, as animators count.
    Film(u32),
    /// So many frames of the result.
    Frames(u32),
    /// Seconds.
    Seconds(f64),
}

impl Hold {
    /// Frames of a result at a rate; may be a fraction.
    pub fn frames(self, rate: f64) -> f64 {
        match self {
            Self::Film(count) => rate * f64::from(count) / 24.0,
            Self::Frames(count) => f64::from(count),
            Self::Seconds(seconds) => rate * seconds,
        }
    }
}

impl FromStr for Hold {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "`{}` is no hold: 2s is on twos (1s to 12s, frames of 24 a second), 2 is frames of the result, 0.1s or 2.0s \
                 with a point is seconds (0.001s to 60.0s)",
                crate::printable::text(text)
            )
        };
        let text = text.trim();
        match text.strip_suffix('s') {
            None => text.parse().ok().filter(|count| (1..=10_000).contains(count)).map(Self::Frames),
            Some(number) if number.contains('.') => {
                number.parse().ok().filter(|seconds| (1e-3..=60.0).contains(seconds)).map(Self::Seconds)
            }
            Some(number) => number.parse().ok().filter(|count| (1..=12).contains(count)).map(Self::Film),
        }
        .ok_or_else(wrong)
    }
}

impl fmt::Display for Hold {
    /// As it is typed.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Film(count) => write!(f, "{count}s"),
            Self::Frames(count) => write!(f, "{count}"),
            Self::Seconds(seconds) => write!(f, "{seconds:?}s"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_are_read_as_animators_write_them() {
        let hold = |text: &str| text.parse::<Hold>().map(|hold| (hold, hold.to_string()));
        assert_eq!(hold("2s"), Ok((Hold::Film(2), "2s".into())));
        assert_eq!(hold(" 3 "), Ok((Hold::Frames(3), "3".into())));
        assert_eq!(hold("0.1s"), Ok((Hold::Seconds(0.1), "0.1s".into())));
        assert_eq!(hold("2.0s"), Ok((Hold::Seconds(2.0), "2.0s".into())));
        let frames =
            [Hold::Film(2).frames(24.0), Hold::Film(2).frames(60.0), Hold::Seconds(0.1).frames(30.0)];
        assert_eq!(frames, [2.0, 5.0, 3.0]);
        for bad in ["", "0", "0s", "13s", "-1", "0.0s", "nan.s", "61.0s", "s", "2x"] {
            assert!(hold(bad).unwrap_err().contains("on twos"), "{bad}");
        }
    }

    #[test]
    fn tolerances_have_units() {
        let read = |text: &str| text.parse::<Tolerance>();
        assert_eq!(read("2mm, 0.1deg"), Ok(Tolerance { metres: 2e-3, degrees: 0.1 }));
        assert_eq!(read("1deg"), Ok(Tolerance { metres: 1e-3, degrees: 1.0 }));
        assert_eq!(read("0.5cm"), Ok(Tolerance { metres: 5e-3, degrees: 0.5 }));
        for bad in ["", "1", "1mm,2mm", "0mm", "nanmm", "-1deg", "11m", "91deg", "1mm;1deg"] {
            assert!(read(bad).unwrap_err().contains("1mm,0.5deg"), "{bad}");
        }
    }
}
