//! Paws that stand under a root of their own are hung on the legs that they end.

use super::figure::Figure;
use crate::{Joint, Skeleton};

/// The target as it is moved: its detached paws hang on their legs.
#[derive(Debug, Clone)]
pub(super) struct Hung {
    pub(super) skeleton: Skeleton,
    /// Joints that hang elsewhere in the file.
    pub(super) loose: Vec<usize>,
}

/// Hangs detached paws on the last joints of their legs. A paw whose joint stands before that of the leg stays.
pub(super) fn hang(skeleton: &Skeleton, figure: &Figure) -> Hung {
    let mut joints: Vec<Joint> = skeleton.joints().to_vec();
    let rest = skeleton.rest_positions();
    let mut loose = Vec::new();
    let legs = figure.quadruped().map(|body| body.hind.iter().chain(&body.fore)).into_iter().flatten();
    for leg in legs {
        let Some(place) = leg.detached.filter(|&place| place > 0) else { continue };
        let (above, paw) = (leg.joints[place - 1], leg.joints[place]);
        if above < paw {
            joints[paw].parent = Some(above);
            joints[paw].offset = rest[paw] - rest[above];
            loose.push(paw);
        }
    }
    match Skeleton::new(joints) {
        Ok(hung) => Hung { skeleton: hung, loose },
        Err(_) => Hung { skeleton: skeleton.clone(), loose: Vec::new() },
    }
}
