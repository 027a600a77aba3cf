//! A certificate in words and as JSON.

use crate::guide::round;
use crate::printable::{counted, fixed, text};
use inkrig_motion::retarget::{Broken, Certificate, CertificateLimits, Spread};
use serde::Serialize;
use std::fmt::Write;

/// How exact a motion on another character is; the names are stable.
#[derive(Debug, Serialize)]
pub(super) struct CertificateRecord {
    /// `pass`, or `warn` where a limit is not kept.
    verdict: &'static str,
    broken: Vec<BrokenRecord>,
    limits: LimitsRecord,
    /// Length of the character over that of the one in the motion.
    scale: f64,
    /// The character's joints that turn with the motion's.
    pairs: Vec<PairRecord>,
    /// The character's joints that keep their rest, without end sites.
    unmapped: Vec<String>,
    /// Degrees between upper and lower arms and legs of both, over all frames.
    direction_degrees: SpreadRecord,
    limbs: Vec<LimbRecord>,
    /// How often a foot stands.
    contacts: usize,
    /// Millimetres from frame to frame of what stands of a foot.
    slide_mm: SpreadRecord,
    /// Millimetres of the lowest mapped joint below the ground, over all frames.
    below_ground_mm: SpreadRecord,
}

#[derive(Debug, Serialize)]
struct BrokenRecord {
    what: &'static str,
    value: f64,
    limit: f64,
}

#[derive(Debug, Serialize)]
struct LimitsRecord {
    direction_p95_degrees: f64,
    slide_max_mm: f64,
    below_ground_max_mm: f64,
}

#[derive(Debug, Serialize)]
struct PairRecord {
    character: String,
    motion: String,
}

#[derive(Debug, Serialize)]
struct LimbRecord {
    limb: String,
    #[serde(flatten)]
    degrees: SpreadRecord,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct SpreadRecord {
    mean: f64,
    p95: f64,
    max: f64,
}

impl From<Spread> for SpreadRecord {
    fn from(spread: Spread) -> Self {
        Self { mean: round(spread.mean, 4), p95: round(spread.p95, 4), max: round(spread.max, 4) }
    }
}

impl CertificateRecord {
    pub(super) fn of(certificate: &Certificate, broken: &[Broken]) -> Self {
        let limits = CertificateLimits::default();
        Self {
            verdict: if broken.is_empty() { "pass" } else { "warn" },
            broken: (broken.iter())
                .map(|broken| BrokenRecord {
                    what: broken.what,
                    value: round(broken.value, 4),
                    limit: broken.limit,
                })
                .collect(),
            limits: LimitsRecord {
                direction_p95_degrees: limits.direction_degrees,
                slide_max_mm: limits.slide_mm,
                below_ground_max_mm: limits.penetration_mm,
            },
            scale: round(f64::from(certificate.scale), 6),
            pairs: (certificate.pairs.iter())
                .map(|(own, other)| PairRecord { character: own.clone(), motion: other.clone() })
                .collect(),
            unmapped: certificate.unmapped.clone(),
            direction_degrees: certificate.direction.into(),
            limbs: (certificate.limbs.iter())
                .map(|limb| LimbRecord {
                    limb: format!("{:?} {:?}", limb.side, limb.part),
                    degrees: limb.degrees.into(),
                })
                .collect(),
            contacts: certificate.contacts,
            slide_mm: certificate.slide.into(),
            below_ground_mm: certificate.penetration.into(),
        }
    }

    /// A few lines for people.
    pub(super) fn text(&self) -> String {
        let mut lines = format!("certificate: {}\n", self.verdict);
        let mut line = |name: &str, value: &str, note: &str| {
            // Writing to a string cannot fail.
            let _ = writeln!(lines, "  {name:<16} {value:<22} {note}");
        };
        let of = |spread: SpreadRecord| {
            format!("mean {}, largest {}", fixed(spread.mean, 1), fixed(spread.max, 1))
        };
        line("scale", &fixed(self.scale, 3), "size of the character over that of the one in the motion");
        line(
            "limbs point off",
            &format!("{} degrees (P95)", fixed(self.direction_degrees.p95, 1)),
            &format!(
                "{}; at most {} are wanted",
                of(self.direction_degrees),
                self.limits.direction_p95_degrees
            ),
        );
        let slide = self.slide_mm;
        if self.contacts == 0 {
            line("feet slide", "-", "no foot stands in this motion");
        } else {
            line(
                "feet slide",
                &format!("{} mm a frame", fixed(slide.max, 1)),
                &format!(
                    "mean {}, P95 {}, while they stand ({}); at most {} are wanted",
                    fixed(slide.mean, 1),
                    fixed(slide.p95, 1),
                    counted(self.contacts, "time"),
                    self.limits.slide_max_mm
                ),
            );
        }
        line(
            "below the ground",
            &format!("{} mm", fixed(self.below_ground_mm.max, 1)),
            &format!(
                "mean {}; at most {} are wanted",
                fixed(self.below_ground_mm.mean, 1),
                self.limits.below_ground_max_mm
            ),
        );
        let pairs = self.pairs.iter().map(|pair| {
            if pair.character == pair.motion {
                text(&pair.character)
            } else {
                format!("{} <- {}", text(&pair.character), text(&pair.motion))
            }
        });
        list(&mut lines, "joints", pairs);
        list(&mut lines, "at rest", self.unmapped.iter().map(text));
        for broken in &self.broken {
            let _ = writeln!(lines, "warning: {}", broken.text());
        }
        lines.trim_end().to_string()
    }

    /// What is not kept, in one line.
    pub(super) fn broken_text(&self) -> String {
        self.broken.iter().map(BrokenRecord::text).collect::<Vec<_>>().join("; ")
    }
}

impl BrokenRecord {
    fn text(&self) -> String {
        format!("{}: {}, more than {}", self.what, fixed(self.value, 1), self.limit)
    }
}

/// Names behind each other, in lines of a terminal's width.
fn list(lines: &mut String, heading: &str, names: impl Iterator<Item = String>) {
    const WIDTH: usize = 100;
    let mut line = format!("  {heading:<16}");
    let mut first = true;
    for name in names {
        if !first {
            line.push(',');
            if line.chars().count() + 1 + name.chars().count() > WIDTH {
                let _ = writeln!(lines, "{line}");
                line = format!("  {:<16}", "");
            }
        }
        line.push(' ');
        line.push_str(&name);
        first = false;
    }
    if !first {
        let _ = writeln!(lines, "{line}");
    }
}
