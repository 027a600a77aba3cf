use super::*;
use inkrig_generate::readers::ink::Mark;
use inkrig_generate::readers::sketch::SIDE;
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::humanml::{Camera, JOINTS, Joints, PARENTS, RAW_DIRECTIONS};

/// A body with its arms to the sides.
fn standing() -> Joints {
    let mut joints = [Vec3::ZERO; JOINTS];
    for joint in 1..JOINTS {
        let (length, way) = match joint {
            4..=5 | 7..=8 => (0.4, RAW_DIRECTIONS[joint]),
            13 | 16 | 18 | 20 => (0.2, Vec3::X),
            14 | 17 | 19 | 21 => (0.2, Vec3::NEG_X),
            15 => (0.2, Vec3::Y),
            _ => (0.12, RAW_DIRECTIONS[joint]),
        };
        joints[joint] = joints[PARENTS[joint]] + length * way;
    }
    joints
}

#[test]
fn a_drawing_has_ink_at_its_key_points_and_belongs_to_its_seed() {
    let pose = seen(&standing(), &Camera::default(), 0.1);
    let mut empty = 0;
    for seed in 0..160 {
        let make = |seed: u64| {
            let mut noise = Noise::new(seed);
            let family = Family::LEARNED[seed as usize % Family::LEARNED.len()];
            let style = Style::random(family, &mut noise);
            let drawn = draw(&pose, &style, &mut noise);
            picture(&drawn, &Conditions::LEARNED, &mut noise)
        };
        let picture = make(seed);
        assert_eq!(picture, make(seed));
        assert_ne!(picture, make(seed + 1));
        assert!(picture.ink.pixels.iter().all(|pixel| (0.0..=1.0).contains(pixel)));
        // Elbows, knees, wrists and ankles lie on ink or within a few pixels of it.
        for point in [4, 5, 6, 7, 14, 15, 16, 17] {
            let [x, y] = picture.places[point];
            if !picture.drawn[point] {
                continue;
            }
            assert!(x > 0.0 && y > 0.0 && x < SIDE as f32 && y < SIDE as f32, "{seed} {point}");
            let near = (0..SIDE * SIDE).any(|at| {
                let off = ((at % SIDE) as f32 + 0.5 - x).hypot((at / SIDE) as f32 + 0.5 - y);
                off < 7.0 && picture.ink.pixels[at] > 0.25
            });
            empty += usize::from(!near);
        }
        assert!(picture.torso > 15.0, "{seed}: {}", picture.torso);
    }
    // Erased and broken lines leave a few bare.
    assert!(empty < 20, "{empty}");
}

#[test]
fn varied_figures_are_of_their_family_and_readable() {
    let pose = seen(&standing(), &Camera::default(), 0.0);
    let mut legs = [f32::INFINITY, 0.0_f32];
    for seed in 0..120 {
        let mut noise = Noise::new(seed);
        let family = Family::LEARNED[seed as usize % Family::LEARNED.len()];
        let style = Style::varied(family, &mut noise);
        assert_eq!(style.family, family);
        legs = [legs[0].min(style.proportions.legs), legs[1].max(style.proportions.legs)];
        let picture = picture(&draw(&pose, &style, &mut noise), &Conditions::LEARNED, &mut noise);
        for (place, drawn) in picture.places.iter().zip(picture.drawn) {
            assert!(
                !drawn || place.iter().all(|along| (0.0..SIDE as f32).contains(along)),
                "{seed} {place:?}"
            );
        }
    }
    assert!(legs[0] < 0.65 && legs[1] > 1.5, "{legs:?}");
}

#[test]
fn characters_are_dressed_and_their_key_points_lie_in_the_figure() {
    let pose = seen(&standing(), &Camera::default(), 0.0);
    let (mut hair, mut clothes, mut limbs) = (Vec::new(), Vec::new(), Vec::new());
    let mut bare = 0;
    for seed in 0..200 {
        let make = |seed: u64| {
            let mut noise = Noise::new(seed);
            let style = Style::random(Family::Character, &mut noise);
            let drawn = draw(&pose, &style, &mut noise);
            (picture(&drawn, &Conditions::LEARNED, &mut noise), style)
        };
        let (picture, style) = make(seed);
        assert_eq!(picture, make(seed).0);
        let dress = style.dress.unwrap();
        hair.push(dress.hair);
        clothes.push(dress.clothes);
        limbs.push(style.limbs);
        for (point, [x, y]) in picture.places.into_iter().enumerate().filter(|(at, _)| picture.drawn[*at]) {
            let inside = (0.0..SIDE as f32).contains(&x) && (0.0..SIDE as f32).contains(&y);
            assert!(inside, "{seed} {point}: {x} {y}");
            // Around the end of a limb there is a line, be it that of a wide sleeve.
            let near = (0..SIDE * SIDE).any(|at| {
                let off = ((at % SIDE) as f32 + 0.5 - x).hypot((at / SIDE) as f32 + 0.5 - y);
                off < 10.0 && picture.ink.pixels[at] > 0.2
            });
            bare += usize::from(matches!(point, 6 | 7 | 16 | 17) && !near);
        }
        // The head is above the neck, whatever its size.
        assert!(picture.places[13][1] < picture.places[10][1], "{seed}");
    }
    assert!(bare < 10, "{bare}");
    for of in [Hair::None, Hair::Spikes, Hair::Tails, Hair::Long, Hair::Cap, Hair::Hat] {
        assert!(hair.contains(&of), "{of:?}");
    }
    for of in [Clothes::None, Clothes::Belt, Clothes::Skirt, Clothes::Buttons, Clothes::Stripes] {
        assert!(clothes.contains(&of), "{of:?}");
    }
    assert!(limbs.contains(&Limbs::Tubes) && limbs.contains(&Limbs::Line));
}

#[test]
fn a_skirt_hides_what_is_behind_it() {
    let pose = seen(&standing(), &Camera::new(0.0, 0.0), 0.0);
    // Areas of paper from above the pelvis, which is the origin, to below the hips: by how many marks before and behind them.
    let skirts = |clothes: Clothes| {
        let mut noise = Noise::new(2);
        let mut style = Style::random(Family::Character, &mut noise);
        style.proportions = Proportions::default();
        (style.hides, style.limbs, style.torso) = (true, Limbs::Line, Torso::Ellipse);
        style.dress = style.dress.map(|dress| Dress { clothes, shaded: 0.0, striped: 0.0, ..dress });
        let drawn = draw(&pose, &style, &mut noise);
        let hides = |mark: &Mark| match mark {
            Mark::Area { outlines, ink } => {
                let heights = || outlines.iter().flatten().map(|at| at[1]);
                let low = heights().fold(f32::INFINITY, f32::min);
                *ink == 0.0 && low < -0.1 && heights().fold(f32::NEG_INFINITY, f32::max) > 0.0
            }
            Mark::Stroke { .. } => false,
        };
        let legs = |mark: &Mark| match mark {
            Mark::Stroke { points, .. } => points.iter().any(|at| at[1] < -0.5),
            Mark::Area { .. } => false,
        };
        let place = |of: &dyn Fn(&Mark) -> bool| drawn.marks.iter().rposition(of);
        (place(&hides), place(&legs))
    };
    let (skirt, legs) = skirts(Clothes::Skirt);
    assert!(skirt.is_some() && legs.is_some() && skirt > legs, "{skirt:?} {legs:?}");
    assert_eq!(skirts(Clothes::Buttons).0, None);
}

#[test]
fn proportions_change_lengths_and_nothing_else() {
    let pose = seen(&standing(), &Camera::new(0.0, 0.0), 0.0);
    let same = Proportions::default().apply(&pose);
    assert!(same.iter().zip(&pose).all(|(a, b)| (*a - *b).length() < 1e-5));
    let long = Proportions { legs: 2.0, shoulders: 0.0, ..Proportions::default() }.apply(&pose);
    assert!((long[4] - long[1]).length() - 2.0 * (pose[4] - pose[1]).length() < 1e-5);
    assert!((long[16] - long[17]).length() < 1e-5);
    assert!(((long[18] - long[16]).length() - (pose[18] - pose[16]).length()).abs() < 1e-5);
}

#[test]
fn key_points_are_where_the_drawing_has_them() {
    let pose = seen(&standing(), &Camera::new(0.0, 0.0), 0.0);
    let (left_elbow, left_wrist, left_ankle) = (14, 16, 6);
    let mut ran_over = 0.0_f32;
    for seed in 0..40 {
        let mut noise = Noise::new(seed);
        let mut style = Style::random(Family::Stick, &mut noise);
        style.proportions = Proportions::default();
        (style.wobble, style.jitter, style.gaps, style.repeats) = (0.0, 0.0, 0.0, 1);
        (style.overshoot, style.hands, style.feet) = (0.1, Hands::None, Feet::None);
        style.limbs = if seed % 2 == 0 { Limbs::Line } else { Limbs::Segments };
        let drawn = draw(&pose, &style, &mut noise);
        let ends: Vec<[f32; 2]> = drawn
            .marks
            .iter()
            .filter_map(|mark| match mark {
                Mark::Stroke { points, .. } => points.last().map(|[x, y, _]| [*x, *y]),
                Mark::Area { .. } => None,
            })
            .collect();
        for point in [left_wrist, left_ankle] {
            let [x, y] = drawn.key_points[point];
            let at_an_end = ends.iter().any(|[a, b]| (a - x).hypot(b - y) < 1e-5);
            assert!(at_an_end || !drawn.drawn[point], "{seed}, {point}");
        }
        let ([x, y], [a, b]) = (drawn.key_points[left_wrist], drawn.captured[left_wrist]);
        ran_over = ran_over.max((x - a).hypot(y - b));
        let ([x, y], [a, b]) = (drawn.key_points[left_elbow], drawn.captured[left_elbow]);
        assert!((x - a).hypot(y - b) < 1e-5 || !drawn.drawn[left_wrist], "an arm's corner stays");

        // A ball says where the hand is, however far the arm's line runs into it.
        style.hands = Hands::Ball;
        let drawn = draw(&pose, &style, &mut noise);
        assert_eq!(drawn.key_points[left_wrist], drawn.captured[left_wrist]);
    }
    assert!(ran_over > 0.07 && ran_over <= 0.1 + 1e-5, "{ran_over}");

    // Bent towards the viewer, the torso is still as long as it is.
    let mut bent = pose;
    let turn = Quat::from_rotation_x(1.2);
    for joint in [3, 6, 9, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21] {
        bent[joint] = bent[0] + turn * (bent[joint] - bent[0]);
    }
    let style =
        Style { proportions: Proportions::default(), ..Style::random(Family::Stick, &mut Noise::new(1)) };
    let torso = |pose: &Joints| draw(pose, &style, &mut Noise::new(1)).torso;
    assert!((torso(&pose) - torso(&bent)).abs() < 1e-5);
}

#[test]
fn the_elbow_of_a_curved_arm_lies_on_the_line() {
    let mut pose = seen(&standing(), &Camera::new(0.0, 0.0), 0.0);
    // The left forearm straight up.
    pose[20] = pose[18] + Vec3::new(0.0, 0.2, 0.0);
    let mut noise = Noise::new(4);
    let mut style = Style::random(Family::Gesture, &mut noise);
    (style.wobble, style.jitter, style.gaps, style.overshoot) = (0.0, 0.0, 0.0, 0.0);
    (style.limbs, style.torso, style.proportions) = (Limbs::Curve, Torso::Line, Proportions::default());
    let drawn = draw(&pose, &style, &mut noise);
    let off_the_line = |[x, y]: [f32; 2]| {
        let points = drawn.marks.iter().flat_map(|mark| match mark {
            Mark::Stroke { points, .. } => points.as_slice(),
            Mark::Area { .. } => &[],
        });
        points.map(|[a, b, _]| (a - x).hypot(b - y)).fold(f32::INFINITY, f32::min)
    };
    assert!(off_the_line(drawn.key_points[14]) < 0.021, "{}", off_the_line(drawn.key_points[14]));
    let ([x, y], [a, b]) = (drawn.key_points[14], drawn.captured[14]);
    assert!((0.015..0.04).contains(&(x - a).hypot(y - b)), "{}", (x - a).hypot(y - b));
}
