//! Rotations as angles about a sequence of axes, each turned by those before it, and back.
//!
//! Angles come out continuous: of the two sequences that give the same rotation, and their full turns, the one
//! nearest to the frame before. Near gimbal lock, where the first and the last axis coincide and only the sum of
//! their angles is known, the first keeps its value.

use crate::{Axis, Channel};
use inkrig_motion::glam::{DMat3, DQuat, DVec3};
use std::f64::consts::PI;

/// Rotation about an axis by an angle in degrees, of any size.
pub(crate) fn rotation(axis: Axis, degrees: f64) -> DQuat {
    // Taken modulo whole turns first: sine and cosine of large angles lose digits.
    let (sin, cos) = (0.5 * (degrees % 360.0).to_radians()).sin_cos();
    match axis {
        Axis::X => DQuat::from_xyzw(sin, 0.0, 0.0, cos),
        Axis::Y => DQuat::from_xyzw(0.0, sin, 0.0, cos),
        Axis::Z => DQuat::from_xyzw(0.0, 0.0, sin, cos),
    }
}

/// The sine of the second angle below which the first and the last axis are taken to coincide.
const LOCKED: f64 = 1e-5;

/// Finds the angles of one joint frame after frame.
#[derive(Debug, Clone)]
pub(crate) struct EulerSolver {
    axes: Vec<Axis>,
    used: Used,
    /// Angles of the frame before, radians, one an axis.
    angles: Vec<f64>,
}

/// The axes that are given an angle, by place in the sequence; the others stay at zero.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Used {
    None,
    One(usize, Axis),
    Two([usize; 2], Triple),
    Three([usize; 3], Triple),
}

/// Three axes in sequence: first and second differ, the third is either the first again or the one left over.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Triple {
    a: Axis,
    b: Axis,
    /// The axis that is neither `a` nor `b`.
    c: Axis,
    /// The last axis is `a` again, not `c`.
    proper: bool,
    /// 1 when a, b, c are in the order of x, y, z; -1 otherwise.
    sign: f64,
}

impl EulerSolver {
    /// For the rotation channels of a list, in order.
    pub(crate) fn new(channels: &[Channel]) -> Self {
        let axes: Vec<Axis> = (channels.iter())
            .filter_map(|channel| match channel {
                Channel::Rotation(axis) => Some(*axis),
                Channel::Position(_) => None,
            })
            .collect();
        Self { used: choose(&axes), angles: vec![0.0; axes.len()], axes }
    }

    /// Whether the channels can express every rotation.
    pub(crate) fn is_full(&self) -> bool {
        matches!(self.used, Used::Three(..))
    }

    /// Takes a frame whose angles are given, degrees, one a rotation channel: the next runs on from it.
    pub(crate) fn resume(&mut self, degrees: impl Iterator<Item = f64>) {
        self.angles.iter_mut().zip(degrees).for_each(|(angle, degrees)| *angle = degrees.to_radians());
    }

    /// Takes the next frame: its angles in degrees, one an axis, are then in [`Self::degrees`]. Returns by how much
    /// they miss the rotation, radians: nothing with three axes, something when there are too few.
    pub(crate) fn next(&mut self, rotation: DQuat) -> f64 {
        let m = DMat3::from_quat(rotation);
        match self.used {
            Used::None => {}
            Used::One(index, axis) => {
                let angle = 2.0 * component(rotation, axis).atan2(rotation.w);
                self.put(&[(index, angle)]);
            }
            Used::Two([first, second], triple) => {
                let Triple { a, b, c, sign, .. } = triple;
                let alpha = (sign * at(&m, c, b)).atan2(at(&m, b, b));
                let beta = (sign * at(&m, a, c)).atan2(at(&m, a, a));
                self.put(&[(first, alpha), (second, beta)]);
            }
            Used::Three(places, triple) => self.three(&m, places, triple),
        }
        self.miss(rotation)
    }

    /// The angles of the last frame taken, degrees, one a rotation channel.
    pub(crate) fn degrees(&self) -> impl Iterator<Item = f64> + '_ {
        self.angles.iter().map(|angle| angle.to_degrees())
    }

    fn three(&mut self, m: &DMat3, [first, second, third]: [usize; 3], triple: Triple) {
        let before = |index: usize| self.angles.get(index).copied().unwrap_or(0.0);
        let earlier = [before(first), before(second), before(third)];
        let alpha = triple.first_angle(m).unwrap_or(earlier[0]);
        let candidates = [alpha, alpha + PI].map(|alpha| {
            let (beta, gamma) = triple.other_angles(m, alpha);
            let near = |angle: f64, earlier: f64| earlier + wrap(angle - earlier);
            [near(alpha, earlier[0]), near(beta, earlier[1]), near(gamma, earlier[2])]
        });
        let change = |angles: &[f64; 3]| angles.iter().zip(&earlier).map(|(a, b)| (a - b).abs()).sum::<f64>();
        let [one, other] = candidates;
        // A little preference for the first, so that rounding does not decide.
        let [x, y, z] = if change(&other) < change(&one) - 1e-9 { other } else { one };
        self.put(&[(first, x), (second, y), (third, z)]);
    }

    fn put(&mut self, angles: &[(usize, f64)]) {
        for &(index, angle) in angles {
            if let Some(slot) = self.angles.get_mut(index) {
                *slot += wrap(angle - *slot);
            }
        }
    }

    fn miss(&self, wanted: DQuat) -> f64 {
        if self.is_full() {
            return 0.0;
        }
        let turns =
            self.axes.iter().zip(&self.angles).map(|(&axis, angle)| rotation(axis, angle.to_degrees()));
        let rest = turns.fold(DQuat::IDENTITY, |all, turn| all * turn).inverse() * wanted;
        2.0 * rest.xyz().length().atan2(rest.w.abs())
    }
}

impl Triple {
    fn new(a: Axis, b: Axis, proper: bool) -> Self {
        let (c, sign) = match (a, b) {
            (Axis::X, Axis::Y) => (Axis::Z, 1.0),
            (Axis::Y, Axis::Z) => (Axis::X, 1.0),
            (Axis::Z, Axis::X) => (Axis::Y, 1.0),
            (Axis::Y, Axis::X) => (Axis::Z, -1.0),
            (Axis::Z, Axis::Y) => (Axis::X, -1.0),
            (_, _) => (Axis::Y, -1.0),
        };
        Self { a, b, c, proper, sign }
    }

    /// The angle about the first axis; none in gimbal lock. The other solution is half a turn further.
    fn first_angle(&self, m: &DMat3) -> Option<f64> {
        let &Self { a, b, c, proper, sign } = self;
        let (sin, cos) =
            if proper { (at(m, b, a), -sign * at(m, c, a)) } else { (-sign * at(m, b, c), at(m, c, c)) };
        (sin.hypot(cos) > LOCKED).then(|| sin.atan2(cos))
    }

    /// The other two angles for a first one. They make up for what the first one misses in gimbal lock, and each is
    /// well defined: all come from both sine and cosine.
    fn other_angles(&self, m: &DMat3, alpha: f64) -> (f64, f64) {
        let &Self { a, b, c, proper, sign } = self;
        let (sin, cos) = alpha.sin_cos();
        // Rows of the matrix with the first turn undone; row a stays as it is.
        let row_b = |column: Axis| cos * at(m, b, column) + sign * sin * at(m, c, column);
        let row_c = |column: Axis| -sign * sin * at(m, b, column) + cos * at(m, c, column);
        if proper {
            let beta = (-sign * row_c(a)).atan2(at(m, a, a));
            let gamma = (-sign * row_b(c)).atan2(row_b(b));
            (beta, gamma)
        } else {
            let beta = (sign * at(m, a, c)).atan2(row_c(c));
            let gamma = (sign * row_b(a)).atan2(row_b(b));
            (beta, gamma)
        }
    }
}

/// The first places in a sequence that can express the most.
fn choose(axes: &[Axis]) -> Used {
    let Some((&a, rest)) = axes.split_first() else { return Used::None };
    let Some(second) = rest.iter().position(|&axis| axis != a) else { return Used::One(0, a) };
    let second = second + 1;
    let Some(&b) = axes.get(second) else { return Used::One(0, a) };
    let later = axes.iter().enumerate().skip(second + 1);
    // Three different axes are better behaved around the rest pose than one used twice.
    let left_over = later.clone().find(|&(_, &axis)| axis != a && axis != b);
    let other = left_over.or_else(|| later.clone().find(|&(_, &axis)| axis != b));
    match other {
        Some((third, &last)) => Used::Three([0, second, third], Triple::new(a, b, last == a)),
        None => Used::Two([0, second], Triple::new(a, b, false)),
    }
}

fn component(q: DQuat, axis: Axis) -> f64 {
    match axis {
        Axis::X => q.x,
        Axis::Y => q.y,
        Axis::Z => q.z,
    }
}

/// The element of a matrix in a row and a column.
fn at(m: &DMat3, row: Axis, column: Axis) -> f64 {
    let column: DVec3 = match column {
        Axis::X => m.x_axis,
        Axis::Y => m.y_axis,
        Axis::Z => m.z_axis,
    };
    match row {
        Axis::X => column.x,
        Axis::Y => column.y,
        Axis::Z => column.z,
    }
}

/// The same angle in -pi to pi, radians.
fn wrap(angle: f64) -> f64 {
    angle - 2.0 * PI * (angle / (2.0 * PI)).round()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sequences(length: usize) -> Vec<Vec<Channel>> {
        let longer = |list: Vec<Channel>| {
            Axis::ALL.map(|axis| [list.clone(), vec![Channel::Rotation(axis)]].concat()).into_iter()
        };
        (0..length).fold(vec![Vec::new()], |lists, _| lists.into_iter().flat_map(longer).collect())
    }

    fn product(channels: &[Channel], degrees: impl IntoIterator<Item = f64>) -> DQuat {
        let turns = channels.iter().zip(degrees).map(|(channel, angle)| match channel {
            Channel::Rotation(axis) => rotation(*axis, angle),
            Channel::Position(_) => DQuat::IDENTITY,
        });
        turns.fold(DQuat::IDENTITY, |all, turn| all * turn)
    }

    fn between(a: DQuat, b: DQuat) -> f64 {
        let rest = a.inverse() * b;
        2.0 * rest.xyz().length().atan2(rest.w.abs())
    }

    /// Angles that meet every kind of gimbal lock, and others.
    const ANGLES: [f64; 9] = [0.0, 90.0, -90.0, 180.0, 33.0, -170.0, 89.999_999, 90.000_5, 1e-4];

    #[test]
    fn every_sequence_of_axes_gives_back_its_own_rotations() {
        for length in 0..=4 {
            for channels in sequences(length) {
                let mut solver = EulerSolver::new(&channels);
                for seed in 0..200 {
                    let angle =
                        |place: usize| ANGLES[(seed * (place * 2 + 1) + seed / 9 + place) % ANGLES.len()];
                    let wanted = product(&channels, (0..length).map(angle));
                    let miss = solver.next(wanted);
                    let got = product(&channels, solver.degrees());
                    let full = solver.is_full();
                    assert!(!full || between(wanted, got) < 3e-5, "{channels:?} {}", between(wanted, got));
                    assert!(full || (miss - between(wanted, got)).abs() < 1e-9, "{channels:?} {miss}");
                    // One or two axes in a row hold what they made; a repeated axis adds up.
                    assert!(length == 4 || full || miss < 1e-9, "{channels:?} {miss}");
                }
            }
        }
    }

    #[test]
    fn three_different_axes_hold_any_rotation() {
        let channels = [Axis::Z, Axis::X, Axis::Y].map(Channel::Rotation);
        let mut solver = EulerSolver::new(&channels);
        for step in 0..1000 {
            let t = f64::from(step);
            let wanted =
                DQuat::from_scaled_axis(DVec3::new((t * 0.7).sin(), (t * 1.3).cos(), 1.0) * t * 0.01);
            solver.next(wanted);
            assert!(between(wanted, product(&channels, solver.degrees())) < 1e-9);
        }
    }

    #[test]
    fn angles_run_on_without_jumps() {
        // A spin of three turns, with a tilt that passes through gimbal lock.
        for channels in sequences(3).into_iter().filter(|channels| EulerSolver::new(channels).is_full()) {
            let mut solver = EulerSolver::new(&channels);
            let mut before = vec![0.0; 3];
            for step in 0..=540 {
                let angles = [f64::from(step) * 2.0, f64::from(step) / 3.0, 10.0];
                let wanted = product(&channels, angles);
                solver.next(wanted);
                let now: Vec<f64> = solver.degrees().collect();
                let jump = now.iter().zip(&before).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(step < 10 || jump < 30.0, "{channels:?} frame {step}: {before:?} to {now:?}");
                assert!(between(wanted, product(&channels, now.iter().copied())) < 3e-5);
                before = now;
            }
        }
    }

    #[test]
    fn too_few_axes_say_by_how_much_they_miss() {
        let mut solver = EulerSolver::new(&[Channel::Rotation(Axis::X)]);
        assert!((solver.next(DQuat::from_rotation_y(0.25)) - 0.25).abs() < 1e-9);
        assert!(solver.next(DQuat::from_rotation_x(-2.0)) < 1e-9);
        let mut none = EulerSolver::new(&[Channel::Position(Axis::X)]);
        assert!((none.next(DQuat::from_rotation_z(0.5)) - 0.5).abs() < 1e-9);
    }
}
