//! What the person does, and when: the footsteps and the acting of the upper body, from small to large.

use super::{
    super::{
        ease::{Keys, window},
        figure::{ahead, left_of},
    },
    acting::{Acting, Arm},
    footsteps::{Footsteps, Style},
};
use inkrig_motion::glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Length of the clip, seconds.
pub(crate) const LENGTH: f64 = 24.0;
const TURN: f64 = 5.98;
const WAVE: (f64, f64) = (7.75, 10.1);
const WAVE_BOTH: (f64, f64) = (9.9, 12.5);
const CROUCH: f64 = 12.4;
const DANCE: f64 = 16.0;
const OVERHEAD: (f64, f64) = (20.1, 23.0);

/// All steps: a walk along an arc from small slow steps to large ones and back, a turn on the spot, side steps.
pub(crate) fn footsteps() -> Footsteps {
    /// Duration in seconds and length in metres, right foot first.
    const WALK: [(f64, f64); 10] = [
        (0.62, 0.26),
        (0.58, 0.38),
        (0.54, 0.50),
        (0.50, 0.62),
        (0.48, 0.67),
        (0.50, 0.70),
        (0.50, 0.70),
        (0.50, 0.56),
        (0.54, 0.32),
        (0.56, 0.0),
    ];
    let mut steps = Footsteps::standing(0.095);
    let (mut time, mut middle, mut heading) = (0.5, DVec3::ZERO, 0.0);
    for (index, (duration, length)) in WALK.into_iter().enumerate() {
        heading += if index < 9 { 0.29 } else { 0.0 };
        middle += ahead(heading) * length;
        let swing = (time + 0.16 * duration, time + duration);
        steps.step(1 - index % 2, swing, (middle, heading), 0.07, Style::forward(length));
        time += duration;
    }
    // The rest of a full turn, on the spot.
    let rest = TAU - heading;
    for index in 0..6 {
        let time = TURN + 0.33 * f64::from(index);
        heading += if index < 5 { 0.2 * rest } else { 0.0 };
        let style = Style::aside(0.045);
        steps.step(index as usize % 2, (time, time + 0.29), (middle, heading), 0.11, style);
    }
    side_steps(&mut steps, middle);
    steps
}

/// Steps to the left and back to the right, wider each time, then a wide stance and back.
fn side_steps(steps: &mut Footsteps, home: DVec3) {
    // The walk and the turn have gone once around: angles go on, so that nothing spins back.
    let left = left_of(TAU);
    let mut middle = home;
    for (index, reach) in SIDE_REACH.into_iter().enumerate() {
        let start = DANCE + 1.0 * index as f64;
        let side = index % 2;
        let to = middle + left * if side == 0 { reach } else { -reach };
        let style = Style::aside(0.04 + 0.05 * reach);
        steps.step(side, (start, start + 0.36), (to, TAU), 0.11, style);
        steps.step(1 - side, (start + 0.48, start + 0.86), (to, TAU), 0.11, style);
        middle = to;
    }
    let (start, end) = OVERHEAD;
    steps.step(0, (start - 0.05, start + 0.35), (middle, TAU), 0.27, Style::aside(0.06));
    steps.step(0, (end + 0.05, end + 0.42), (middle, TAU), 0.1, Style::aside(0.05));
}

/// Slow shifts of the weight while standing: seconds, metres to the left.
const SHIFTS: [(f64, f64); 7] =
    [(0.0, 0.012), (0.5, 0.0), (WAVE.0 + 0.2, 0.0), (9.0, 0.03), (10.4, -0.03), (11.6, 0.02), (12.5, 0.0)];

const SIDE_REACH: [f64; 4] = [0.18, 0.27, 0.37, 0.46];

/// What the upper body does over the whole clip.
pub(crate) struct Script {
    crouch: Keys,
    back: Keys,
    sway: Keys,
    heels: Keys,
    lean: Keys,
    lateral: Keys,
    twist: Keys,
    nod: Keys,
    look: Keys,
    swing: Keys,
    overhead: Keys,
}

impl Script {
    /// The script of the sample.
    pub(crate) fn new() -> Self {
        let c = CROUCH;
        let (start, end) = OVERHEAD;
        let mut swing = vec![(DANCE - 0.35, 0.0)];
        let mut bounce = vec![];
        for (index, reach) in SIDE_REACH.into_iter().enumerate() {
            let beat = DANCE + index as f64;
            let way = if index % 2 == 0 { 1.0 } else { -1.0 };
            swing.push((beat + 0.5, way * (0.2 + 2.3 * reach)));
            let depth = 0.03 + 0.09 * reach;
            bounce.extend([
                (beat + 0.06, 0.02),
                (beat + 0.4, depth),
                (beat + 0.64, 0.01),
                (beat + 0.9, depth),
            ]);
        }
        swing.push((start + 0.2, 0.0));
        let sways = [(0.0, 0.0), (0.45, 1.0), (1.12, -1.0), (1.84, 1.0), (2.5, -1.0), (3.1, 0.0)];
        let sways = |size: f64| sways.map(|(time, value)| (start + time, size * value));
        let crouch: [(f64, f64); 10] = [
            (0.0, 0.0),
            (c, 0.0),
            (c + 0.65, 0.13),
            (c + 0.8, 0.13),
            (c + 1.3, -0.004),
            (c + 1.45, -0.004),
            (c + 2.25, 0.4),
            (c + 2.5, 0.4),
            (c + 3.3, 0.0),
            (c + 3.5, 0.0),
        ];
        let overhead_bounce = [
            (start, 0.02),
            (start + 0.4, 0.06),
            (start + 0.8, 0.03),
            (start + 1.12, 0.075),
            (start + 1.5, 0.04),
            (start + 1.84, 0.085),
            (start + 2.2, 0.04),
            (start + 2.5, 0.07),
            (end + 0.5, 0.0),
        ];
        let scaled = |size: f64| crouch.map(|(time, value)| (time - 0.06, size * value.max(0.0)));
        Self {
            crouch: Keys::new(&[&crouch[..], &bounce, &overhead_bounce].concat()),
            back: Keys::new(&scaled(-0.28)),
            heels: Keys::new(&[(c + 1.3, 0.0), (c + 2.2, 0.5), (c + 2.55, 0.5), (c + 3.2, 0.0)]),
            lean: Keys::new(&scaled(1.35)),
            sway: Keys::new(&[&SHIFTS[..], &sways(0.13)].concat()),
            lateral: Keys::new(&sways(0.2)),
            twist: Keys::new(&sways(0.16)),
            nod: Keys::new(&[
                (0.0, 0.02),
                (c, 0.0),
                (c + 0.6, 0.1),
                (c + 1.3, -0.03),
                (c + 2.2, 0.12),
                (c + 3.3, 0.0),
            ]),
            look: Keys::new(&[
                (0.0, 0.16),
                (0.5, 0.0),
                (WAVE.0, 0.0),
                (WAVE.0 + 0.5, -0.2),
                (WAVE.1 - 0.4, -0.2),
                (WAVE.1, 0.0),
                (LENGTH - 0.8, 0.0),
                (LENGTH, -0.1),
            ]),
            swing: Keys::new(&swing),
            overhead: Keys::new(&sways(0.42)),
        }
    }

    /// The acting at `time` seconds.
    pub(crate) fn at(&self, time: f64) -> Acting {
        let crouch = self.crouch.at(time);
        let swing = self.swing.at(time);
        let overhead = self.overhead.at(time);
        let breath = (TAU * time / 3.4).sin();
        let waves = [waving(time, 0), waving(time, 1)];
        let leaning_in = 0.05 * (waves[0].0 - waves[1].0);
        // Large waves bring the knees along.
        let bob = 0.3 * (waves[0].2 * waves[0].2 + waves[1].2 * waves[1].2);
        Acting {
            crouch: crouch + 6.0 * bob,
            sway: [self.sway.at(time), self.back.at(time)],
            heels: self.heels.at(time),
            trunk: [
                self.lean.at(time) + 0.008 * breath,
                -self.lateral.at(time) * 0.6 + 0.1 * swing + leaning_in + 0.5 * (waves[0].2 - waves[1].2),
                self.twist.at(time) + 0.22 * swing,
            ],
            head: [
                self.nod.at(time) - 0.55 * self.lean.at(time) - 0.01 * breath,
                -0.1 * swing + 0.25 * self.lateral.at(time),
                self.look.at(time) + 0.15 * swing,
            ],
            arms: [0, 1].map(|side| self.arm(time, side, waves[side], swing, overhead)),
        }
    }

    /// How much of the walking swing an arm keeps, and its acting.
    fn arm(&self, time: f64, side: usize, wave: (f64, Arm, f64), swing: f64, overhead: f64) -> (f64, Arm) {
        let outward = if side == 0 { swing } else { -swing };
        let size = (swing * swing + 0.04).sqrt() - 0.2;
        // Away from the body an arm is free; across it, it must pass in front.
        let crossing = 0.5 * (outward - (outward * outward + 0.03).sqrt()) + 0.0866;
        let dancing = Arm {
            flex: 0.12 + 0.25 * size - 0.4 * crossing,
            abduct: 0.17 + 1.05 * outward - 0.5 * crossing,
            twist: 0.25 * size,
            elbow: 0.32 + 0.45 * size + 0.25 * crossing,
            pronate: 0.3,
            wrist: [0.0, 0.15 * outward],
        };
        let leaning = if side == 0 { -overhead } else { overhead };
        let up = Arm {
            flex: 0.25,
            abduct: 2.35 - 0.75 * leaning,
            twist: 0.6,
            elbow: 0.55 + 0.4 * leaning,
            pronate: 0.2,
            wrist: [-0.5 * leaning, 0.1],
        };
        let balance =
            Arm { flex: 1.05, abduct: 0.16, twist: 0.0, elbow: 0.5, pronate: 0.9, wrist: [0.0, 0.05] };
        let c = CROUCH;
        let balancing =
            0.42 * window(time, c, c + 1.35, 0.7, 0.6) + window(time, c + 1.4, c + 3.4, 0.85, 0.85);
        let dance = window(time, DANCE - 0.4, OVERHEAD.1 + 0.8, 0.8, 1.0);
        let raised = window(time, OVERHEAD.0 - 0.15, OVERHEAD.1 + 0.75, 0.8, 1.0);
        let keep = (1.0 - wave.0) * (1.0 - balancing) * (1.0 - dance);
        let arm = Arm::default().mix(wave.1, wave.0).mix(balance, balancing);
        let mut arm = arm.mix(dancing.mix(up, raised), dance.max(raised));
        // On the way up and down the elbow bends and passes in front: no arm swings through a stiff T.
        let on_the_way = 4.0 * raised * (1.0 - raised) + 4.0 * wave.0 * (1.0 - wave.0);
        arm.elbow += 0.85 * on_the_way;
        arm.flex += 0.3 * on_the_way;
        (keep, arm)
    }
}

/// How far an arm waves (0..=1), its pose, and how far it pulls the trunk.
fn waving(time: f64, side: usize) -> (f64, Arm, f64) {
    let (start, _) = if side == 1 { WAVE } else { WAVE_BOTH };
    let end = WAVE_BOTH.1;
    let amount = window(time, start, end, 0.86, 0.8);
    // From a small wave of the forearm at the shoulder to a large one of the whole arm above the head.
    let grown =
        Keys::new(&[(WAVE.0, 0.0), (WAVE.0 + 0.9, 0.1), (WAVE_BOTH.0, 0.5), (end - 0.9, 1.0)]).at(time);
    // Larger waves are slower. The phase is the integral of the frequency.
    let passed = (time - WAVE.0).max(0.0);
    let phase = TAU * (2.15 * passed - 0.075 * passed * passed);
    let (beat, late, later) = (phase.sin(), (phase - 0.5).sin(), (phase - 1.1).sin());
    let size = 0.3 + 0.7 * grown;
    let arm = Arm {
        flex: 0.3 - 0.1 * grown,
        abduct: 1.0 + 1.3 * grown + 0.3 * grown * beat,
        twist: 1.15 - 0.35 * grown,
        elbow: 1.85 - 1.05 * grown + 0.42 * size * late,
        pronate: -0.9 + 0.6 * grown,
        wrist: [0.32 * size * later, 0.05],
    };
    (amount, arm, 0.1 * amount * grown * (phase - 0.3 + PI).sin())
}
