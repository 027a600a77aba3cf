use super::*;
use inkrig_generate::readers::sketch::SIDE;
use inkrig_motion::glam::Vec3;
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
fn proportions_change_lengths_and_nothing_else() {
    let pose = seen(&standing(), &Camera::new(0.0, 0.0), 0.0);
    let same = Proportions::default().apply(&pose);
    assert!(same.iter().zip(&pose).all(|(a, b)| (*a - *b).length() < 1e-5));
    let long = Proportions { legs: 2.0, shoulders: 0.0, ..Proportions::default() }.apply(&pose);
    assert!((long[4] - long[1]).length() - 2.0 * (pose[4] - pose[1]).length() < 1e-5);
    assert!((long[16] - long[17]).length() < 1e-5);
    assert!(((long[18] - long[16]).length() - (pose[18] - pose[16]).length()).abs() < 1e-5);
}
