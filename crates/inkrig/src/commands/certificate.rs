//! A certificate in words and as JSON.

use crate::guide::round;
use crate::preview::Figure;
use crate::printable::{counted, fixed, text};
use inkrig_motion::retarget::{
    BoneDirection, Broken, Certificate, CertificateLimits, Hinge, HingeRange, JointPosition, Spread,
};
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
    /// The character's joints that take a share of a limb's twist.
    twist: Vec<String>,
    /// The character's joints that keep their rest, without end sites.
    unmapped: Vec<String>,
    /// The motion's joints that lead none, without end sites.
    unused: Vec<String>,
    /// Degrees between limbs of both, over all frames.
    direction_degrees: SpreadRecord,
    limbs: Vec<LimbRecord>,
    /// Degrees between the trunks of both, over all frames.
    trunk_degrees: SpreadRecord,
    /// Degrees between the lines from hip to hip and from shoulder to shoulder of both.
    across_degrees: SpreadRecord,
    /// How often a foot stands.
    contacts: usize,
    /// The motion goes on the spot: its feet stand on a ground that goes along.
    on_the_spot: bool,
    /// Millimetres from frame to frame of what stands of a foot, against a ground that may go along.
    slide_mm: SpreadRecord,
    /// Millimetres of standing feet above the ground.
    floating_mm: SpreadRecord,
    /// Millimetres of the lowest mapped joint below the ground, over all frames.
    below_ground_mm: SpreadRecord,
    /// Millimetres over the ground between the way of the hips and that of the scaled motion.
    drift_mm: SpreadRecord,
    /// Millimetres between joints and the scaled motion's: no limit, since bodies differ.
    position_mm: SpreadRecord,
    joints: Vec<PositionRecord>,
    /// Knees and elbows of a person, degrees.
    hinges: Vec<HingeRecord>,
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
    trunk_p95_degrees: f64,
    across_p95_degrees: f64,
    slide_max_mm: f64,
    floating_p95_mm: f64,
    below_ground_max_mm: f64,
    drift_max_mm: f64,
    hinge_beyond_max_degrees: f64,
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

#[derive(Debug, Serialize)]
struct PositionRecord {
    joint: String,
    motion: String,
    #[serde(flatten)]
    millimetres: SpreadRecord,
}

#[derive(Debug, Serialize)]
struct HingeRecord {
    joint: String,
    back: f64,
    bent: f64,
    aside: f64,
    /// Beyond the range of a body, more than the motion's own.
    beyond: f64,
    motion_back: f64,
    motion_bent: f64,
    motion_aside: f64,
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

impl From<&Broken> for BrokenRecord {
    fn from(broken: &Broken) -> Self {
        Self { what: broken.what, value: round(broken.value, 4), limit: broken.limit }
    }
}

impl From<&BoneDirection> for LimbRecord {
    fn from(limb: &BoneDirection) -> Self {
        Self { limb: limb.bone.clone(), degrees: limb.degrees.into() }
    }
}

impl From<&JointPosition> for PositionRecord {
    fn from(of: &JointPosition) -> Self {
        Self { joint: of.joint.clone(), motion: of.motion.clone(), millimetres: of.millimetres.into() }
    }
}

impl From<&Hinge> for HingeRecord {
    fn from(hinge: &Hinge) -> Self {
        let HingeRange { back, bent, aside } = hinge.result;
        let name = if hinge.part == inkrig_motion::rig::Part::LowerArm { "elbow" } else { "knee" };
        Self {
            joint: format!("{:?} {name}", hinge.side).to_lowercase(),
            back: round(back, 2),
            bent: round(bent, 2),
            aside: round(aside, 2),
            beyond: round(hinge.beyond(), 2),
            motion_back: round(hinge.source.back, 2),
            motion_bent: round(hinge.source.bent, 2),
            motion_aside: round(hinge.source.aside, 2),
        }
    }
}

impl CertificateRecord {
    pub(super) fn of(certificate: &Certificate, broken: &[Broken]) -> Self {
        let limits = CertificateLimits::default().sized(certificate.size);
        let pair =
            |(own, other): &(String, String)| PairRecord { character: own.clone(), motion: other.clone() };
        Self {
            verdict: if broken.is_empty() { "pass" } else { "warn" },
            broken: broken.iter().map(BrokenRecord::from).collect(),
            limits: LimitsRecord {
                direction_p95_degrees: limits.direction_degrees,
                trunk_p95_degrees: limits.trunk_degrees,
                across_p95_degrees: limits.across_degrees,
                slide_max_mm: round(limits.slide_mm, 1),
                floating_p95_mm: round(limits.floating_mm, 1),
                below_ground_max_mm: round(limits.penetration_mm, 1),
                drift_max_mm: round(limits.drift_mm, 1),
                hinge_beyond_max_degrees: limits.hinge_degrees,
            },
            scale: round(f64::from(certificate.scale), 6),
            pairs: certificate.pairs.iter().map(pair).collect(),
            twist: certificate.twists.clone(),
            unmapped: certificate.unmapped.clone(),
            unused: certificate.unused.clone(),
            direction_degrees: certificate.direction.into(),
            limbs: certificate.limbs.iter().map(LimbRecord::from).collect(),
            trunk_degrees: certificate.trunk.into(),
            across_degrees: certificate.across.into(),
            contacts: certificate.contacts,
            on_the_spot: certificate.on_the_spot,
            slide_mm: certificate.slide.into(),
            floating_mm: certificate.floating.into(),
            below_ground_mm: certificate.penetration.into(),
            drift_mm: certificate.drift.into(),
            position_mm: certificate.position.into(),
            joints: certificate.joints.iter().map(PositionRecord::from).collect(),
            hinges: certificate.hinges.iter().map(HingeRecord::from).collect(),
        }
    }

    /// The figures, for a page and for a table of text.
    pub(super) fn figures(&self) -> Vec<Figure> {
        let of = |spread: SpreadRecord| {
            format!("mean {}, largest {}", fixed(spread.mean, 1), fixed(spread.max, 1))
        };
        let wanted = |limit: f64| format!("at most {limit} are wanted");
        let stands = self.contacts > 0;
        let figure = |name: &str, value: String, note: String| Figure { name: name.into(), value, note };
        let mut figures = vec![
            figure(
                "scale",
                fixed(self.scale, 3),
                "size of the character over that of the one in the motion".into(),
            ),
            figure(
                "limbs point off",
                format!("{} degrees (P95)", fixed(self.direction_degrees.p95, 1)),
                format!("{}; {}", of(self.direction_degrees), wanted(self.limits.direction_p95_degrees)),
            ),
            figure(
                "trunk points off",
                format!("{} degrees (P95)", fixed(self.trunk_degrees.p95, 1)),
                format!("{}; {}", of(self.trunk_degrees), wanted(self.limits.trunk_p95_degrees)),
            ),
            figure(
                "hips tilt off",
                format!("{} degrees (P95)", fixed(self.across_degrees.p95, 1)),
                format!("{}; {}", of(self.across_degrees), wanted(self.limits.across_p95_degrees)),
            ),
            if stands {
                figure(
                    "feet slide",
                    format!("{} mm a frame", fixed(self.slide_mm.max, 1)),
                    format!(
                        "mean {}, P95 {}, while they stand ({}){}; {}",
                        fixed(self.slide_mm.mean, 1),
                        fixed(self.slide_mm.p95, 1),
                        counted(self.contacts, "time"),
                        if self.on_the_spot {
                            " on a ground that goes along as the motion's feet do"
                        } else {
                            ""
                        },
                        wanted(self.limits.slide_max_mm)
                    ),
                )
            } else {
                figure("feet slide", "-".into(), "no foot stands in this motion".into())
            },
        ];
        if stands {
            figures.push(figure(
                "feet float",
                format!("{} mm (P95)", fixed(self.floating_mm.p95, 1)),
                format!(
                    "{}, while they stand; {}",
                    of(self.floating_mm),
                    wanted(self.limits.floating_p95_mm)
                ),
            ));
        }
        figures.push(figure(
            "below the ground",
            format!("{} mm", fixed(self.below_ground_mm.max, 1)),
            format!(
                "mean {}; {}",
                fixed(self.below_ground_mm.mean, 1),
                wanted(self.limits.below_ground_max_mm)
            ),
        ));
        figures.push(figure(
            "way off",
            format!("{} mm", fixed(self.drift_mm.max, 1)),
            format!(
                "over the ground, mean {}; {}",
                fixed(self.drift_mm.mean, 1),
                wanted(self.limits.drift_max_mm)
            ),
        ));
        figures.push(figure(
            "joints off",
            format!("{} mm (P95)", fixed(self.position_mm.p95, 0)),
            format!("{}; from the scaled motion's: bodies differ, no limit", of(self.position_mm)),
        ));
        if let Some(worst) = self.hinges.iter().max_by(|a, b| a.beyond.total_cmp(&b.beyond)) {
            let note = match worst.beyond {
                0.0 => "degrees beyond the range of a body (10 back, 165 bent, 25 aside), more than in the motion".into(),
                _ => format!(
                    "degrees beyond, by the {}: {} back, {} bent, {} aside",
                    worst.joint, worst.back, worst.bent, worst.aside
                ),
            };
            let note = format!("{note}; {}", wanted(self.limits.hinge_beyond_max_degrees));
            figures.push(figure("knees and elbows", fixed(worst.beyond, 1), note));
        }
        figures
    }

    /// What is not kept, a sentence each.
    pub(super) fn notes(&self) -> Vec<String> {
        self.broken.iter().map(BrokenRecord::text).collect()
    }

    /// A table for people.
    pub(super) fn text(&self) -> String {
        let mut lines = format!("certificate: {}\n", self.verdict);
        for Figure { name, value, note } in self.figures() {
            // Writing to a string cannot fail.
            let _ = writeln!(lines, "  {name:<16} {value:<22} {note}");
        }
        let pairs = self.pairs.iter().map(|pair| {
            if pair.character == pair.motion {
                text(&pair.character)
            } else {
                format!("{} <- {}", text(&pair.character), text(&pair.motion))
            }
        });
        list(&mut lines, "joints", pairs);
        list(&mut lines, "share a twist", self.twist.iter().map(text));
        list(&mut lines, "at rest", self.unmapped.iter().map(text));
        list(&mut lines, "not used", self.unused.iter().map(text));
        for note in self.notes() {
            let _ = writeln!(lines, "warning: {note}");
        }
        lines.trim_end().to_string()
    }

    /// Whether a limit is not kept.
    pub(super) fn is_broken(&self) -> bool {
        !self.broken.is_empty()
    }

    /// What is not kept, in one line.
    pub(super) fn broken_text(&self) -> String {
        self.notes().join("; ")
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
