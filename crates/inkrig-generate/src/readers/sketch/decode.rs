//! From heat maps to places.

use super::limbs::together;
use super::{CELLS, KEY_POINTS, MIRRORED, SIDE};
use crate::numeric::elementwise::exp;
use crate::readers::ink::Ink;

/// Cells around the hottest one that its place is the mean of.
const AROUND: usize = 2;
/// Pixels of a cell.
const CELL: f32 = (SIDE / CELLS) as f32;

/// A figure as it was read. Places are pixels of the crop, from the left and from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Where each key point is.
    pub places: [[f32; 2]; KEY_POINTS],
    /// How sure that is, 0 to 1: the share of all heat that lies there.
    pub confidence: [f32; KEY_POINTS],
    /// How likely it is that the key point is drawn, 0 to 1: figures without feet have no toes.
    pub drawn: [f32; KEY_POINTS],
    /// What speaks for these sides of the arms: how much likelier this is than that left and right are swapped, as a logarithm.
    pub arms: f32,
    /// The same of the legs.
    pub legs: f32,
}

impl Reading {
    /// The same figure with left and right changed.
    pub fn mirrored(&self) -> Self {
        let places = MIRRORED.map(|other| self.places[other]);
        let confidence = MIRRORED.map(|other| self.confidence[other]);
        let drawn = MIRRORED.map(|other| self.drawn[other]);
        Self { places, confidence, drawn, arms: -self.arms, legs: -self.legs }
    }
}

/// Reads heat maps ([`CELLS`] x [`CELLS`] x [`KEY_POINTS`]) and the logits of presence of a crop ([`SIDE`] x [`SIDE`] pixels). Every
/// key point is where its map is hottest, but for those of limbs that are likely in more than one place: of these, those that belong
/// together by the lines between them, and `confidence` is the share of heat there.
pub fn decode(heat: &[f32], presence: &[f32], ink: &Ink) -> Reading {
    let mut reading = Reading {
        places: [[0.5 * SIDE as f32; 2]; KEY_POINTS],
        confidence: [0.0; KEY_POINTS],
        drawn: [0.0; KEY_POINTS],
        arms: 0.0,
        legs: 0.0,
    };
    let maps: Vec<Vec<f32>> = (0..KEY_POINTS).map(|point| logarithms(heat, point)).collect();
    for (point, map) in maps.iter().enumerate() {
        let (place, share) = hottest(map);
        reading.places[point] = place;
        reading.confidence[point] = share;
        reading.drawn[point] = 1.0 / (1.0 + exp(-presence.get(point).copied().unwrap_or(0.0)));
    }
    together(&maps, ink, &mut reading);
    let at = |map: &[f32], place: [f32; 2]| {
        let cell = |along: f32| ((along / CELL) as usize).min(CELLS - 1);
        map.get(cell(place[1]) * CELLS + cell(place[0])).copied().unwrap_or(0.0).max(-12.0)
    };
    let sides = |points: &[usize]| -> f32 {
        let own = |&point: &usize| {
            let sure = reading.drawn[point];
            let (here, there) = (reading.places[point], reading.places[MIRRORED[point]]);
            sure * (at(&maps[point], here) - at(&maps[point], there))
        };
        points.iter().map(own).sum()
    };
    (reading.arms, reading.legs) = (sides(&[11, 12, 14, 15, 16, 17]), sides(&[1, 2, 4, 5, 6, 7, 8, 9]));
    reading
}

/// One map as logarithms of shares.
fn logarithms(heat: &[f32], point: usize) -> Vec<f32> {
    let mut map: Vec<f32> = heat.iter().skip(point).step_by(KEY_POINTS).copied().collect();
    let most = map.iter().fold(f32::NEG_INFINITY, |most, &number| most.max(number));
    let sum: f32 = map.iter().map(|&number| exp(number - most)).sum();
    let all = most + sum.ln();
    map.iter_mut().for_each(|number| *number -= all);
    map
}

/// The mean place around the hottest cell, pixels, and the share of heat there.
pub(super) fn hottest(map: &[f32]) -> ([f32; 2], f32) {
    let (mut sum, mut place) = (0.0, [0.0; 2]);
    for (x, y) in around_the_hottest(map) {
        let share = exp(map.get(y * CELLS + x).copied().unwrap_or(f32::NEG_INFINITY));
        sum += share;
        place[0] += share * (x as f32 + 0.5);
        place[1] += share * (y as f32 + 0.5);
    }
    if sum > 0.0 {
        place.iter_mut().for_each(|along| *along *= CELL / sum);
    }
    (place, sum.min(1.0))
}

/// Takes away what [`hottest`] found.
pub(super) fn cool(map: &mut [f32]) {
    for (x, y) in around_the_hottest(map) {
        if let Some(number) = map.get_mut(y * CELLS + x) {
            *number = f32::NEG_INFINITY;
        }
    }
}

/// Columns and rows of the cells around the hottest one.
fn around_the_hottest(map: &[f32]) -> impl Iterator<Item = (usize, usize)> + use<> {
    let hottest = map.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(at, _)| at);
    let (row, column) = (hottest / CELLS, hottest % CELLS);
    let around = |at: usize| at.saturating_sub(AROUND)..(at + AROUND + 1).min(CELLS);
    around(row).flat_map(move |y| around(column).map(move |x| (x, y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_found_between_cells_and_sides_are_weighed() {
        let mut heat = vec![0.0; CELLS * CELLS * KEY_POINTS];
        let mut warm = |point: usize, x: f32, y: f32, most: f32| {
            for cell in 0..CELLS * CELLS {
                let (dx, dy) = ((cell % CELLS) as f32 + 0.5 - x, (cell / CELLS) as f32 + 0.5 - y);
                heat[cell * KEY_POINTS + point] += most * (-0.5 * (dx * dx + dy * dy)).exp();
            }
        };
        warm(6, 10.3, 20.6, 14.0);
        warm(7, 30.0, 20.0, 14.0);
        // The right ankle could as well be the left one.
        warm(7, 10.3, 20.6, 11.0);
        let mut presence = vec![3.0; KEY_POINTS];
        presence[9] = -3.0;
        let reading = decode(&heat, &presence, &Ink::new(SIDE, SIDE));
        let off = (reading.places[6][0] - 41.2).hypot(reading.places[6][1] - 82.4);
        assert!(off < 1.5, "{:?}", reading.places[6]);
        assert!(reading.confidence[6] > 0.9 && reading.confidence[0] < 0.1);
        assert!(reading.drawn[6] > 0.9 && reading.drawn[9] < 0.1);
        assert!(reading.legs > 1.0, "{}", reading.legs);
        let other = reading.mirrored();
        assert_eq!((other.places[7], other.legs), (reading.places[6], -reading.legs));
        assert_eq!(other.mirrored(), reading);
    }
}
