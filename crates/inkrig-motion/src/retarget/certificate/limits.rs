//! Pass or warn.

use super::Certificate;

/// What a certificate is held against. Limits in millimetres are for people, and for animals with legs of a metre; of
/// smaller and larger animals they are as much smaller and larger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CertificateLimits {
    /// Most degrees for the 95th percentile of [`Certificate::direction`]. Default: 5.
    pub direction_degrees: f64,
    /// Most degrees for the 95th percentile of [`Certificate::trunk`]: trunks of other build slope otherwise while
    /// nothing is turned. Default: 25.
    pub trunk_degrees: f64,
    /// Most degrees for the 95th percentile of [`Certificate::across`]: shoulders of
    /// other width tilt otherwise. Default: 25.
    pub across_degrees: f64,
    /// Most millimetres a frame for the largest of [`Certificate::slide`]. Default: 5.
    pub slide_mm: f64,
    /// Most millimetres for the 95th percentile of [`Certificate::floating`]. Default: 20.
    pub floating_mm: f64,
    /// Most millimetres for the largest of [`Certificate::penetration`]. Default: 20.
    pub penetration_mm: f64,
    /// Most millimetres for the largest of [`Certificate::drift`]. Default: 20.
    pub drift_mm: f64,
    /// Most degrees that a knee or an elbow may be beyond its range more than the source's. Default: 5.
    pub hinge_degrees: f64,
}

impl Default for CertificateLimits {
    fn default() -> Self {
        Self {
            direction_degrees: 5.0,
            trunk_degrees: 25.0,
            across_degrees: 25.0,
            slide_mm: 5.0,
            floating_mm: 20.0,
            penetration_mm: 20.0,
            drift_mm: 20.0,
            hinge_degrees: 5.0,
        }
    }
}

/// A limit that a result does not keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Broken {
    /// What was measured, with its unit.
    pub what: &'static str,
    /// What it is.
    pub value: f64,
    /// What it may be.
    pub limit: f64,
}

impl CertificateLimits {
    /// Those in millimetres times a size.
    #[must_use]
    pub fn sized(&self, size: f64) -> Self {
        Self {
            slide_mm: size * self.slide_mm,
            floating_mm: size * self.floating_mm,
            penetration_mm: size * self.penetration_mm,
            drift_mm: size * self.drift_mm,
            ..*self
        }
    }
}

impl Certificate {
    /// The limits that are not kept, those in millimetres times [`Certificate::size`].
    pub fn broken(&self, limits: &CertificateLimits) -> Vec<Broken> {
        let limits = limits.sized(self.size);
        let beyond = self.hinges.iter().map(super::Hinge::beyond).fold(0.0, f64::max);
        [
            (
                "direction of the limbs, degrees, 95th percentile",
                self.direction.p95,
                limits.direction_degrees,
            ),
            ("direction of the trunk, degrees, 95th percentile", self.trunk.p95, limits.trunk_degrees),
            (
                "direction from hip to hip or between shoulders, degrees, 95th percentile",
                self.across.p95,
                limits.across_degrees,
            ),
            ("slide of standing feet, mm a frame, largest", self.slide.max, limits.slide_mm),
            ("standing feet above the ground, mm, 95th percentile", self.floating.p95, limits.floating_mm),
            ("depth below the ground, mm, largest", self.penetration.max, limits.penetration_mm),
            ("way over the ground, mm off, largest", self.drift.max, limits.drift_mm),
            (
                "knees and elbows beyond their range, degrees more than the source's",
                beyond,
                limits.hinge_degrees,
            ),
        ]
        .into_iter()
        // What cannot be compared is not kept.
        .filter(|(_, value, limit)| !matches!(value.partial_cmp(limit), Some(order) if order.is_le()))
        .map(|(what, value, limit)| Broken { what, value, limit })
        .collect()
    }
}
