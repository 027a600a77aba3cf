//! What a line is, by its colour.

/// Kinds of lines of a storyboard.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// The figure: black and dark greys.
    Body,
    /// The way of a joint: cyan to blue.
    Trajectory,
    /// Dashes that make a way faster: orange and red.
    Speed,
    /// What stands around: light grey, green, brown.
    Scene,
    /// A word written by hand: violet to magenta.
    Lettering,
}

/// The kind of a colour (sRGB); `None` for paper.
pub fn kind_of_colour([red, green, blue]: [u8; 3]) -> Option<Kind> {
    let [red, green, blue] = [red, green, blue].map(|part| f32::from(part) / 255.0);
    let (most, least) = (red.max(green).max(blue), red.min(green).min(blue));
    let spread = most - least;
    if least > 0.88 {
        return None;
    }
    // Dark colours look black whatever their hue.
    if spread < 0.16 || most < 0.25 {
        return Some(if most < 0.55 { Kind::Body } else { Kind::Scene });
    }
    let hue = 60.0
        * if most == red {
            ((green - blue) / spread).rem_euclid(6.0)
        } else if most == green {
            (blue - red) / spread + 2.0
        } else {
            (red - green) / spread + 4.0
        };
    Some(match hue {
        0.0..60.0 if hue >= 12.0 && most < 0.72 => Kind::Scene,
        0.0..60.0 => Kind::Speed,
        60.0..160.0 => Kind::Scene,
        160.0..255.0 => Kind::Trajectory,
        255.0..338.0 => Kind::Lettering,
        _ => Kind::Speed,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_that_people_use_are_told() {
        for (colour, kind) in [
            ([0, 0, 0], Some(Kind::Body)),
            ([40, 40, 60], Some(Kind::Body)),
            ([255, 255, 255], None),
            ([240, 238, 230], None),
            ([0, 255, 255], Some(Kind::Trajectory)),
            ([0, 160, 190], Some(Kind::Trajectory)),
            ([30, 80, 255], Some(Kind::Trajectory)),
            ([255, 140, 0], Some(Kind::Speed)),
            ([230, 40, 40], Some(Kind::Speed)),
            ([180, 180, 180], Some(Kind::Scene)),
            ([30, 160, 60], Some(Kind::Scene)),
            ([139, 90, 43], Some(Kind::Scene)),
            ([200, 0, 200], Some(Kind::Lettering)),
        ] {
            assert_eq!(kind_of_colour(colour), kind, "{colour:?}");
        }
    }
}
