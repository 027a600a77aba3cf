//! Gaits of four-legged animals: when each leg stands and swings, from walk over trot to gallop.
//!
//! Footfall patterns after Hildebrand (1965, 1977): a walk moves the legs one after the other (left hind, left fore,
//! right hind, right fore), a trot in diagonal pairs, a transverse gallop both hind legs, then both fore legs, then
//! none touches the ground.

use super::ease::{Keys, part};

/// The legs, in the order of all arrays of four.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Leg {
    /// Left hind leg.
    LeftHind,
    /// Right hind leg.
    RightHind,
    /// Left fore leg.
    LeftFore,
    /// Right fore leg.
    RightFore,
}

/// All legs.
pub const LEGS: [Leg; 4] = [Leg::LeftHind, Leg::RightHind, Leg::LeftFore, Leg::RightFore];

/// When each leg touches down, as a part of the cycle.
const WALK: [f64; 4] = [0.0, 0.5, 0.25, 0.75];
const TROT: [f64; 4] = [0.0, 0.5, 0.5, 1.0];
const GALLOP: [f64; 4] = [0.0, 0.12, 0.42, 0.55];

/// Speed over time and what follows from it.
#[derive(Debug, Clone)]
pub struct Gait {
    speed: Keys,
    /// 0 is a walk, 1 a trot, 2 a gallop.
    kind: Keys,
    /// How much of the cycle's rate is in use: 0 stands.
    active: Keys,
    frequency: Keys,
    duty: Keys,
    /// Cycles passed, every [`STEP`] seconds.
    cycles: Vec<f64>,
}

/// Step of the integration of the cycle, seconds.
pub const STEP: f64 = 1.0 / 600.0;

/// One leg's contact with the ground, seconds. A leg stands from `land` to `lift`, then swings to the next contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stance {
    /// Touch-down; far in the past for the first.
    pub land: f64,
    /// Lift-off; far in the future for the last.
    pub lift: f64,
}

impl Gait {
    /// A gait over `length` seconds from keys of speed (metres a second), kind (0 walk, 1 trot, 2 gallop) and
    /// activity (0 stands, 1 goes).
    pub fn new(length: f64, speed: &[(f64, f64)], kind: &[(f64, f64)], active: &[(f64, f64)]) -> Self {
        let mut gait = Self {
            speed: Keys::new(speed),
            kind: Keys::new(kind),
            active: Keys::new(active),
            // A large dog's: cycles a second, and the part of a cycle that a foot stands, by speed.
            frequency: Keys::new(&[(0.0, 1.15), (0.95, 1.05), (2.3, 1.7), (5.5, 2.0), (7.0, 2.15)]),
            duty: Keys::new(&[(0.0, 0.72), (0.95, 0.64), (2.3, 0.44), (5.5, 0.25), (7.0, 0.22)]),
            cycles: vec![0.0],
        };
        let mut cycle = 0.0;
        for step in 0..(length / STEP).ceil() as usize {
            let time = (step as f64 + 0.5) * STEP;
            cycle += STEP * gait.active.at(time) * gait.frequency.at(gait.speed.at(time));
            gait.cycles.push(cycle);
        }
        gait
    }

    /// Metres a second.
    pub fn speed(&self, time: f64) -> f64 {
        self.speed.at(time)
    }

    /// Cycles passed.
    pub fn cycle(&self, time: f64) -> f64 {
        let last = self.cycles.len() - 1;
        let place = (time / STEP).clamp(0.0, last as f64);
        let low = place.floor();
        let high = (low as usize + 1).min(last);
        let from = self.cycles[low as usize];
        from + (place - low) * (self.cycles[high] - from)
    }

    /// How much of each gait there is: walk, trot, gallop; the sum is the activity.
    pub fn weights(&self, time: f64) -> [f64; 3] {
        let (kind, active) = (self.kind.at(time), self.active.at(time));
        let trot = 1.0 - (kind - 1.0).abs().min(1.0);
        [active * (1.0 - kind).clamp(0.0, 1.0), active * trot, active * (kind - 1.0).clamp(0.0, 1.0)]
    }

    /// Part of the cycle at which a leg touches down.
    pub fn touch_down(&self, leg: usize, time: f64) -> f64 {
        let kind = self.kind.at(time);
        let early = part(kind, 0.0, 1.0);
        let late = part(kind, 1.0, 2.0);
        let trot = WALK[leg] + early * (TROT[leg] - WALK[leg]);
        trot + late * (GALLOP[leg] - TROT[leg])
    }

    /// Part of a cycle that a foot is on the ground.
    pub fn duty(&self, time: f64) -> f64 {
        self.duty.at(self.speed.at(time))
    }

    /// All stances of a leg over the clip. It stands at first, and at last.
    pub fn stances(&self, leg: usize) -> Vec<Stance> {
        /// A swing takes at most this long, however slow the gait, seconds.
        const LONGEST_SWING: f64 = 0.36;
        let mut stances = vec![Stance { land: -1e3, lift: 1e3 }];
        // The leg lifts where its own cycle passes the duty.
        let own = |time: f64| self.cycle(time) - self.touch_down(leg, time) - self.duty(time);
        let (mut before, mut rest) = (own(0.0), own(0.0).floor());
        for step in 1..self.cycles.len() {
            let time = step as f64 * STEP;
            let now = own(time);
            if now >= rest + 1.0 && before < rest + 1.0 {
                rest += 1.0;
                let frequency = self.frequency.at(self.speed(time));
                let swing = ((1.0 - self.duty(time)) / frequency).min(LONGEST_SWING);
                if let Some(last) = stances.last_mut() {
                    last.lift = time;
                }
                stances.push(Stance { land: time + swing, lift: 1e3 });
            }
            before = now;
        }
        stances
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steady(speed: f64, kind: f64) -> Gait {
        Gait::new(6.0, &[(0.0, speed)], &[(0.0, kind)], &[(0.0, 1.0)])
    }

    /// How many feet stand at each of the cycle's hundredths, in the middle of the clip.
    fn standing(gait: &Gait) -> Vec<[bool; 4]> {
        let stances: Vec<Vec<Stance>> = (0..4).map(|leg| gait.stances(leg)).collect();
        let period = 1.0 / gait.frequency.at(gait.speed(0.0));
        (0..100)
            .map(|part| {
                let time = 3.0 + period * 0.01 * f64::from(part);
                [0, 1, 2, 3].map(|leg: usize| stances[leg].iter().any(|s| s.land <= time && time < s.lift))
            })
            .collect()
    }

    #[test]
    fn a_walk_always_has_two_or_more_feet_down() {
        let counts = standing(&steady(0.95, 0.0));
        assert!(counts.iter().all(|feet| feet.iter().filter(|&&down| down).count() >= 2));
    }

    #[test]
    fn a_trot_moves_diagonal_pairs_together() {
        let feet = standing(&steady(2.3, 1.0));
        let apart = feet.iter().filter(|f| f[0] != f[3] || f[1] != f[2]).count();
        assert!(apart <= 2, "{apart} hundredths of the cycle");
        assert!(feet.iter().any(|f| f.iter().all(|&down| !down)), "with a moment in the air");
    }

    #[test]
    fn a_gallop_lands_hind_hind_fore_fore_and_flies_once() {
        let gait = steady(5.5, 2.0);
        let mut landings: Vec<(f64, usize)> = (0..4)
            .flat_map(|leg| gait.stances(leg).into_iter().map(move |stance| (stance.land, leg)))
            .filter(|(land, _)| *land > 2.0)
            .collect();
        landings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let order: Vec<usize> =
            landings.iter().map(|landing| landing.1).skip_while(|&leg| leg != 0).take(8).collect();
        assert_eq!(order, [0, 1, 2, 3, 0, 1, 2, 3]);
        let flight = standing(&gait).iter().filter(|f| f.iter().all(|&down| !down)).count();
        assert!((10..40).contains(&flight), "{flight} hundredths of the cycle in the air");
    }
}
