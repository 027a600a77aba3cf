//! What the storyboards tell.

use super::pose::{Placed, Pose};
use super::{Sketch, board};
use inkrig_motion::glam::DVec3;
use inkrig_sketch::storyboard::{Constraint, Storyboard};

/// Name and storyboard.
pub(super) fn all() -> Vec<(&'static str, Storyboard)> {
    vec![
        ("walk-and-wave", walk_and_wave()),
        ("kick", kick()),
        ("jump", jump()),
        ("sit-down-and-stand-up", sit_down_and_stand_up()),
        ("dance", dance()),
        ("turn-and-run", turn_and_run()),
        ("lift-and-push", lift_and_push()),
    ]
}

const WALK: Pose = Pose {
    lean: (4.0, 0.0),
    legs: [[(26.0, 3.0), (14.0, 3.0)], [(-14.0, 3.0), (-34.0, 3.0)]],
    arms: [[(-22.0, 10.0), (-4.0, 8.0)], [(24.0, 10.0), (50.0, 4.0)]],
    above: 0.0,
};

fn walk_and_wave() -> Storyboard {
    let wave = Pose { arms: [[(0.0, 14.0), (10.0, 10.0)], [(10.0, 80.0), (10.0, 150.0)]], ..Pose::STAND };
    let walking = Sketch::of("walk", &WALK, 1);
    let way = ahead(&walking.placed, 2.0);
    let walking = walking.way(&way).notes("Walks up to somebody.");
    let waving = Sketch::of("wave", &wave, 2);
    let wrist = waving.placed.arms[1][2];
    let to = |x: f64, y: f64| wrist + DVec3::new(x, y, 0.05);
    let way = [wrist, to(0.22, 0.02), to(-0.08, 0.0), to(0.24, 0.03), to(-0.06, -0.01), to(0.2, 0.02)];
    board("Walk and wave", vec![walking, waving.way_in(1.9, &way).notes("Hello!")])
}

fn kick() -> Storyboard {
    let ready = Pose {
        lean: (3.0, 0.0),
        legs: [[(14.0, 5.0), (-6.0, 5.0)], [(-18.0, 6.0), (-40.0, 6.0)]],
        arms: [[(40.0, 20.0), (110.0, 0.0)], [(25.0, 20.0), (95.0, 0.0)]],
        above: 0.0,
    };
    let frame = Sketch::of("kick", &ready, 3);
    let foot = frame.placed.legs[1][3];
    let through = [
        foot,
        foot + DVec3::new(-0.02, 0.1, 0.3),
        foot + DVec3::new(0.0, 0.45, 0.75),
        foot + DVec3::new(0.03, 0.95, 0.95),
        foot + DVec3::new(0.02, 0.75, 0.85),
        foot + DVec3::new(0.0, 0.2, 0.6),
        foot + DVec3::new(0.0, 0.02, 0.45),
    ];
    let ground = [DVec3::new(-0.7, 0.0, -0.5), DVec3::new(0.4, 0.0, 1.2)];
    board("Kick", vec![frame.way(&through).quick(3, 0.15..0.45).scene(&[&ground])])
}

fn jump() -> Storyboard {
    let crouched = Pose {
        lean: (38.0, 0.0),
        legs: [[(62.0, 8.0), (-28.0, 6.0)], [(60.0, 8.0), (-30.0, 6.0)]],
        arms: [[(-50.0, 12.0), (-40.0, 10.0)], [(-50.0, 12.0), (-40.0, 10.0)]],
        above: 0.0,
    };
    let flying = Pose {
        lean: (6.0, 0.0),
        legs: [[(30.0, 8.0), (-50.0, 6.0)], [(20.0, 8.0), (-60.0, 6.0)]],
        arms: [[(150.0, 25.0), (165.0, 15.0)], [(150.0, 25.0), (165.0, 15.0)]],
        above: 0.35,
    };
    let start = Sketch::of("jump", &crouched, 4);
    let pelvis = start.placed.pelvis;
    let up = [pelvis, pelvis + DVec3::new(0.0, 0.35, 0.12), pelvis + DVec3::new(0.0, 0.75, 0.35)];
    let start = start.way(&up).seconds(1.0);
    let high = Sketch::of("jump", &flying, 5);
    let pelvis = high.placed.pelvis;
    let down = [pelvis, pelvis + DVec3::new(0.0, -0.1, 0.2), pelvis + DVec3::new(0.0, -0.5, 0.4)];
    board("Jump", vec![start, high.way(&down).seconds(1.5)])
}

fn sit_down_and_stand_up() -> Storyboard {
    let seated = Pose {
        lean: (-4.0, 0.0),
        legs: [[(84.0, 8.0), (-4.0, 4.0)], [(84.0, 8.0), (-4.0, 4.0)]],
        arms: [[(24.0, 10.0), (76.0, -4.0)], [(24.0, 10.0), (76.0, -4.0)]],
        above: 0.0,
    };
    let chair = |placed: &Placed| {
        let seat = placed.pelvis - DVec3::Y * 0.1;
        let [near, far] = [0.22, -0.22].map(|x| seat + DVec3::new(x, 0.0, 0.2));
        let back = DVec3::Z * -0.45;
        let legs = DVec3::Y * -seat.y;
        vec![
            vec![near, near + back, far + back, far, near],
            vec![near, near + legs],
            vec![far, far + legs],
            vec![near + back, near + back + legs],
            vec![near + back, near + back + DVec3::Y * 0.5, far + back + DVec3::Y * 0.5, far + back],
        ]
    };
    let down = Sketch::of("sit down", &seated, 6);
    let pelvis = down.placed.pelvis;
    let high = 0.94 - pelvis.y;
    let from = [pelvis + DVec3::new(0.0, high, 0.42), pelvis + DVec3::new(0.0, 0.55 * high, 0.3), pelvis];
    let lines = chair(&down.placed);
    let lines: Vec<&[DVec3]> = lines.iter().map(Vec::as_slice).collect();
    let down = down.way(&from).scene(&lines).notes("Sits down on a chair.");
    let up = Sketch::of("stand up", &seated, 7);
    let to = [pelvis, pelvis + DVec3::new(0.0, 0.3 * high, 0.25), pelvis + DVec3::new(0.0, high, 0.42)];
    board("Sit down and stand up", vec![down, up.way(&to).scene(&lines).notes("And stands up.")])
}

fn dance() -> Storyboard {
    let open = Pose {
        lean: (0.0, 6.0),
        legs: [[(10.0, 16.0), (-14.0, 10.0)], [(0.0, 10.0), (-6.0, 8.0)]],
        arms: [[(10.0, 95.0), (20.0, 120.0)], [(10.0, 80.0), (20.0, 50.0)]],
        above: 0.0,
    };
    let crossed = Pose {
        lean: (4.0, -8.0),
        legs: [[(6.0, 6.0), (-10.0, 4.0)], [(34.0, 14.0), (-30.0, 6.0)]],
        arms: [[(60.0, 30.0), (100.0, -20.0)], [(20.0, 110.0), (30.0, 150.0)]],
        above: 0.0,
    };
    let round = |place: DVec3, x: f64, y: f64| {
        [
            place,
            place + DVec3::new(x, y, 0.1),
            place + DVec3::new(0.4 * x, 1.8 * y, 0.15),
            place + DVec3::new(-0.4 * x, y, 0.05),
        ]
    };
    let first = Sketch::of("dance", &open, 8);
    let (left, right) = (first.placed.arms[0][2], first.placed.arms[1][2]);
    let first = first.way_in(1.8, &round(left, -0.2, 0.16)).way_in(1.8, &round(right, -0.15, 0.2));
    let second = Sketch::of("dance", &crossed, 9);
    let foot = second.placed.legs[1][3];
    let way = [
        foot,
        foot + DVec3::new(-0.25, 0.15, 0.1),
        foot + DVec3::new(-0.3, -0.05, -0.1),
        foot + DVec3::new(-0.12, -0.12, -0.15),
    ];
    let second = second.way(&way);
    let third = Sketch::of("spin", &open, 10).seconds(1.5);
    board("Dance", vec![first, second, third])
}

fn turn_and_run() -> Storyboard {
    let looking = Pose {
        lean: (0.0, 0.0),
        legs: [[(6.0, 8.0), (0.0, 8.0)], [(-8.0, 8.0), (-16.0, 8.0)]],
        arms: [[(30.0, 30.0), (90.0, 0.0)], [(-10.0, 20.0), (20.0, 16.0)]],
        above: 0.0,
    };
    let run = Pose {
        lean: (16.0, 0.0),
        legs: [[(58.0, 4.0), (-30.0, 4.0)], [(-22.0, 4.0), (-60.0, 4.0)]],
        arms: [[(-50.0, 14.0), (40.0, 6.0)], [(40.0, 14.0), (120.0, 0.0)]],
        above: 0.03,
    };
    let turn = Sketch::of("turn", &looking, 11).seconds(1.5);
    let running = Sketch::of("run", &run, 12);
    let way = ahead(&running.placed, 4.0);
    board("Turn and run", vec![turn, running.way(&way).quick(2, 0.5..0.9)])
}

/// A bar is carried and lifted, then hands push against a wall.
fn lift_and_push() -> Storyboard {
    let carrying = Pose {
        lean: (4.0, 0.0),
        legs: [[(24.0, 4.0), (10.0, 4.0)], [(-14.0, 4.0), (-34.0, 4.0)]],
        arms: [[(14.0, 12.0), (84.0, -4.0)], [(14.0, 12.0), (84.0, -4.0)]],
        above: 0.0,
    };
    let lifting = Pose { arms: [[(20.0, 16.0), (110.0, 2.0)], [(20.0, 16.0), (110.0, 2.0)]], ..Pose::STAND };
    let pushing = Pose {
        lean: (14.0, 0.0),
        legs: [[(30.0, 5.0), (-8.0, 5.0)], [(-18.0, 6.0), (-34.0, 6.0)]],
        arms: [[(66.0, 10.0), (84.0, 2.0)], [(66.0, 10.0), (84.0, 2.0)]],
        above: 0.0,
    };
    let [left, right] = ["left_wrist", "right_wrist"].map(str::to_owned);
    let bar = Constraint::Distance { joints: [left.clone(), right.clone()], metres: Some(0.5), frames: None };
    let carry = Sketch::of("walk", &carrying, 13);
    let way = ahead(&carry.placed, 1.4);
    let carry = carry.way(&way).holds(bar.clone()).notes("Carries a bar, the hands half a metre apart.");
    let lift = Sketch::of("stretch", &lifting, 14);
    let wrist = lift.placed.arms[1][2];
    let up = [wrist, wrist + DVec3::new(-0.02, 0.3, 0.05), wrist + DVec3::new(-0.04, 0.62, -0.18)];
    let lift = lift.way_in(1.2, &up).holds(bar).holds(Constraint::Balance { frames: None });
    let lift = lift.seconds(1.3).notes("Lifts it, in balance.");
    let push = Sketch::of("push", &pushing, 15);
    let at = push.placed.arms[0][2].z;
    let wall = |joint: String| Constraint::Plane {
        joint,
        height: None,
        normal: Some([0.0, 0.0, -1.0]),
        through: Some([0.0, 0.0, (at * 100.0).round() / 100.0]),
        scene: None,
        frames: Some([0, 29]),
    };
    let corner = |x: f64, y: f64| DVec3::new(x, y, at + 0.05);
    let edge = [corner(0.5, 0.0), corner(0.5, 1.9), corner(-0.5, 1.9), corner(-0.5, 0.0), corner(0.5, 0.0)];
    let push = push.scene(&[&edge]).holds(wall(left)).holds(wall(right)).seconds(2.0);
    board("Carry, lift and push", vec![carry, lift, push.notes("Pushes against a wall.")])
}

/// The pelvis goes straight ahead, up and down with the steps.
fn ahead(placed: &Placed, metres: f64) -> Vec<DVec3> {
    (0..=8)
        .map(|at| {
            let part = f64::from(at) / 8.0;
            placed.pelvis + DVec3::new(0.0, 0.025 * (part * 12.0).sin(), metres * part)
        })
        .collect()
}
