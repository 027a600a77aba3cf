//! Lines in space that show what holds: a bar between joints, a patch of a plane, a box, the centre of mass over the floor.

use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::Joints;
use inkrig_storyboard::{Cuboid, Rule, centre_of_mass};

/// Half of a plane's patch, and of the cross that shows the floor below the centre of mass, metres.
const PATCH: f32 = 0.2;
const CROSS: f32 = 0.06;

/// Lines for a constraint in a pose, metres.
pub(super) fn marks(rule: &Rule, pose: &Joints) -> Vec<Vec<Vec3>> {
    match rule {
        Rule::Distance([a, b], _) => vec![vec![pose[*a], pose[*b]]],
        Rule::Plane(joint, normal, along) => {
            let middle = pose[*joint] - *normal * (normal.dot(pose[*joint]) - along);
            let (a, b) = normal.any_orthonormal_pair();
            let corner = |x: f32, y: f32| middle + PATCH * (x * a + y * b);
            vec![
                [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)]
                    .map(|(x, y)| corner(x, y))
                    .to_vec(),
            ]
        }
        Rule::Box(_, cuboid) => edges(cuboid),
        Rule::Balance => {
            let centre = centre_of_mass(pose);
            let floor = Vec3::new(centre.x, 0.0, centre.z);
            let cross = |way: Vec3| vec![floor - CROSS * way, floor + CROSS * way];
            vec![vec![centre, floor], cross(Vec3::X), cross(Vec3::Z)]
        }
    }
}

fn edges(Cuboid { middle, half, turn }: &Cuboid) -> Vec<Vec<Vec3>> {
    let corner = |at: usize| {
        let side = |axis: usize| if at >> axis & 1 == 0 { -1.0 } else { 1.0 };
        *middle + *turn * (*half * Vec3::new(side(0), side(1), side(2)))
    };
    let pairs = (0..8).flat_map(|at| (0..3).map(move |axis| (at, at | 1 << axis)));
    pairs.filter(|(a, b)| a != b).map(|(a, b)| vec![corner(a), corner(b)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_twelve_edges_as_long_as_it_is() {
        let lines = edges(&Cuboid::between(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)));
        assert_eq!(lines.len(), 12);
        let sum: f32 = lines.iter().map(|line| line[0].distance(line[1])).sum();
        assert!((sum - 24.0).abs() < 1e-5, "{sum}");
    }
}
