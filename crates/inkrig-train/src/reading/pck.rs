//! How well key points are found: the share within a tenth of the torso's length (PCK@0.1). The torso is neck to pelvis in space, at
//! the drawing's scale, so that a figure that bends towards the viewer is not held to nothing; key points are where the drawing has
//! them. The same of where the pose has them, by the torso as it looks on paper, stands beside it.

use super::{Poses, Shares};
use crate::figures::{Conditions, Family, Picture};
use inkrig_generate::readers::ink::Ink;
use inkrig_generate::readers::network::Work;
use inkrig_generate::readers::sketch::{KEY_POINTS, MIRRORED, SketchReader};
use inkrig_generate::schedule::Noise;
use serde::{Deserialize, Serialize};

/// The share of the torso's length that a key point may be off.
const WITHIN: f32 = 0.1;
/// Key points that the torso lies between.
const NECK: usize = 10;
const PELVIS: usize = 0;

/// What figures are measured on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subset {
    /// Families that were learned, seen from the front half.
    Learned,
    /// The same, seen from any side.
    AnySide,
    /// The family that was held out.
    Unseen,
    /// Filled and outlined bodies, all with other marks on the page.
    Clutter,
    /// Characters with bodies and clothes, half of them upright with their arms out.
    Characters,
    /// One of the families that were learned, seen from the front half.
    Only(Family),
}

impl Subset {
    /// All but single families.
    pub const ALL: [Self; 5] = [Self::Learned, Self::AnySide, Self::Unseen, Self::Clutter, Self::Characters];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Learned => "learned styles",
            Self::AnySide => "learned styles, seen from any side",
            Self::Unseen => "unseen style",
            Self::Clutter => "filled or outlined bodies with clutter",
            Self::Characters => "characters with bodies and clothes",
            Self::Only(family) => family.name(),
        }
    }
}

/// What was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pck {
    /// Drawings.
    pub pictures: usize,
    /// Share of drawn key points within a tenth of the torso's length, 0 to 1.
    pub pck: f64,
    /// The same where each figure's arms, and its legs, may be left for right.
    pub pck_either_side: f64,
    /// The same by the pose and not by the drawing: of where motion capture has the points, which a line that runs over does not
    /// show, within a tenth of neck to pelvis as it looks on paper.
    pub pck_of_the_pose: f64,
    /// Share of drawn key points within a fifth of the torso's length (PCK@0.2).
    pub pck_within_a_fifth: f64,
    /// By key point.
    pub by_point: [f64; KEY_POINTS],
    /// Mean distance, as a share of the torso's length.
    pub mean_distance: f64,
    /// Share of key points of which it is said rightly whether they are drawn.
    pub presence: f64,
}

/// Drawings of poses, the same for the same seed.
pub fn rendered(poses: &Poses, subset: Subset, count: usize, seed: u64) -> Vec<Picture> {
    let conditions = match subset {
        Subset::Clutter => Conditions { clutter: 1.0, ..Conditions::READ },
        _ => Conditions::READ,
    };
    let families: &[Family] = match &subset {
        Subset::Learned | Subset::AnySide => &Family::LEARNED,
        Subset::Unseen => &[Family::Naive],
        Subset::Clutter => &[Family::Filled, Family::Outline],
        Subset::Characters => &[Family::Character],
        Subset::Only(family) => std::slice::from_ref(family),
    };
    let turned = if subset == Subset::AnySide { 1.0 } else { 0.0 };
    let characters = if subset == Subset::Characters { 1.0 } else { 0.0 };
    let shares = Shares { turned, characters, ..Shares::default() };
    let one = |at: usize| {
        let mut noise = Noise::new(seed.wrapping_mul(0x2545_F491_4F6C_DD1D).wrapping_add(at as u64));
        noise.uniform();
        poses.picture(families, &conditions, &shares, &mut noise)
    };
    (0..count).map(one).collect()
}

/// Where something found the key points of a picture, and which of them it takes for drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Pixels of the picture.
    pub places: [[f32; 2]; KEY_POINTS],
    /// Whether it is drawn.
    pub drawn: [bool; KEY_POINTS],
}

impl Found {
    /// Of a picture in which no figure was found.
    pub fn nothing() -> Self {
        Self { places: [[f32::INFINITY; 2]; KEY_POINTS], drawn: [false; KEY_POINTS] }
    }
}

/// Measures a reader.
pub fn measure(reader: &SketchReader, pictures: &[Picture]) -> Pck {
    let mut work = Work::default();
    let mut find = |ink: &Ink| {
        let reading = reader.read(ink, &mut work);
        Found { places: reading.places, drawn: reading.drawn.map(|drawn| drawn > 0.5) }
    };
    measure_by(&mut find, pictures)
}

/// Measures whatever finds key points. A point that is farther off than the torso is long counts as one torso in the mean.
pub fn measure_by(find: &mut dyn FnMut(&Ink) -> Found, pictures: &[Picture]) -> Pck {
    let (mut found, mut drawn) = ([0_usize; KEY_POINTS], [0_usize; KEY_POINTS]);
    let (mut either, mut of_the_pose, mut within_a_fifth) = (0_usize, 0_usize, 0_usize);
    let (mut distance, mut presence) = (0.0, 0_usize);
    for picture in pictures {
        let reading = find(&picture.ink);
        let off = |point: usize, read: usize| {
            (apart(picture.places[point], reading.places[read]) / picture.torso.max(1.0)).min(1.0)
        };
        for point in 0..KEY_POINTS {
            presence += usize::from(reading.drawn[point] == picture.drawn[point]);
            if picture.drawn[point] {
                drawn[point] += 1;
                found[point] += usize::from(off(point, point) <= WITHIN);
                within_a_fifth += usize::from(off(point, point) <= 2.0 * WITHIN);
                distance += f64::from(off(point, point));
                let pose = &picture.captured;
                let miss = apart(pose[point], reading.places[point]);
                of_the_pose += usize::from(miss <= WITHIN * apart(pose[NECK], pose[PELVIS]).max(1.0));
            }
        }
        // Arms and legs each the way round that finds more.
        for points in [&[0, 3, 10, 13][..], &[11, 12, 14, 15, 16, 17], &[1, 2, 4, 5, 6, 7, 8, 9]] {
            let count = |read: fn(usize) -> usize| {
                let own = points.iter().filter(|&&point| picture.drawn[point]);
                own.filter(|&&point| off(point, read(point)) <= WITHIN).count()
            };
            either += count(|point| point).max(count(|point| MIRRORED[point]));
        }
    }
    let all = drawn.iter().sum::<usize>().max(1) as f64;
    Pck {
        pictures: pictures.len(),
        pck: found.iter().sum::<usize>() as f64 / all,
        pck_either_side: either as f64 / all,
        pck_of_the_pose: of_the_pose as f64 / all,
        pck_within_a_fifth: within_a_fifth as f64 / all,
        by_point: std::array::from_fn(|point| found[point] as f64 / drawn[point].max(1) as f64),
        mean_distance: distance / all,
        presence: presence as f64 / (KEY_POINTS * pictures.len().max(1)) as f64,
    }
}

fn apart([x, y]: [f32; 2], [a, b]: [f32; 2]) -> f32 {
    (x - a).hypot(y - b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_style_is_drawn_alone_and_styles_have_names_of_their_own() {
        let mut pose = [inkrig_motion::glam::Vec3::ZERO; 22];
        pose.iter_mut().enumerate().for_each(|(at, joint)| joint.y = 0.1 * at as f32);
        let poses = Poses::of(vec![pose]);
        let shade = |family| {
            let pictures = rendered(&poses, Subset::Only(family), 12, 3);
            pictures.iter().flat_map(|picture| &picture.ink.pixels).sum::<f32>()
        };
        // Of one body a marker leaves more ink than a pencil.
        assert!(shade(Family::Pencil) < shade(Family::Marker));
        let names = Family::LEARNED.map(Family::name);
        let others = Subset::ALL.map(Subset::name);
        let all: std::collections::BTreeSet<&str> = names.iter().chain(&others).copied().collect();
        assert_eq!(all.len(), names.len() + others.len());
    }

    #[test]
    fn points_count_by_the_drawing_and_beside_it_by_the_pose() {
        let captured: [[f32; 2]; KEY_POINTS] = std::array::from_fn(|point| [50.0, 90.0 - 4.0 * point as f32]);
        let mut places = captured;
        // A left hand that was drawn too far; its line is followed.
        places[16][0] += 20.0;
        let picture = Picture {
            ink: Ink::new(1, 1),
            places,
            captured,
            drawn: std::array::from_fn(|point| point != 8),
            // Bent towards the viewer: the 40 pixels that are seen of it are half of it.
            torso: 80.0,
        };
        let found = |places| {
            let drawn = [true; KEY_POINTS];
            measure_by(&mut |_| Found { places, drawn }, std::slice::from_ref(&picture))
        };
        let own = found(places);
        assert_eq!((own.pck, own.pck_either_side), (1.0, 1.0));
        assert_eq!(own.pck_of_the_pose, 16.0 / 17.0);
        assert_eq!(own.presence, 17.0 / 18.0);
        let off = found(places.map(|[x, y]| [x + 6.0, y]));
        assert_eq!((off.pck, off.pck_of_the_pose), (1.0, 0.0));
        assert!((off.mean_distance - 6.0 / 80.0).abs() < 1e-6);
        let farther = found(places.map(|[x, y]| [x + 12.0, y]));
        assert_eq!((farther.pck, farther.pck_within_a_fifth), (0.0, 1.0));
        // Arms the other way round: six points, of which collars, elbows and hands lie too far apart to be taken for each other.
        let mut turned = places;
        [(11, 12), (14, 15), (16, 17)].iter().for_each(|(a, b)| turned.swap(*a, *b));
        let turned = found(turned);
        assert!(turned.pck < 1.0 && turned.pck_either_side == 1.0, "{turned:?}");
    }
}
