//! A wave as text that reads back as the same wave.

use std::fmt::{Display, Formatter, Result};

use super::expression::{Expression, Sign, Sweep};
use super::generator::{Oscillator, Shape};
use super::{Segment, Wave};

impl Display for Wave {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        for (index, segment) in self.segments.iter().enumerate() {
            out.write_str(if index > 0 { "; " } else { "" })?;
            segment.fmt(out)?;
        }
        Ok(())
    }
}

impl Display for Segment {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        self.expression.fmt(out)?;
        self.length.map_or(Ok(()), |length| write!(out, " for {}s", Plain(length)))
    }
}

impl Display for Expression {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        match self {
            Self::Number(value) => Plain(*value).fmt(out),
            Self::Time => out.write_str("t"),
            Self::Ramp(sweep) => write!(out, "ramp({sweep})"),
            Self::Oscillator(oscillator) => oscillator.fmt(out),
            Self::Alternate { inner, centres, every } => {
                write!(out, "alternate({inner}, centres=")?;
                for (index, centre) in centres.iter().enumerate() {
                    write!(out, "{}{}", if index > 0 { "|" } else { "" }, Plain(*centre))?;
                }
                write!(out, ", every={}s)", Plain(*every))
            }
            Self::Negated(inner) => {
                out.write_str("-")?;
                factor(inner, out)
            }
            Self::Sum(terms) => {
                for (index, (sign, term)) in terms.iter().enumerate() {
                    out.write_str(match sign {
                        Sign::Plus if index == 0 => "",
                        Sign::Plus => " + ",
                        Sign::Minus => " - ",
                    })?;
                    match term {
                        Self::Sum(_) => write!(out, "({term})")?,
                        _ => term.fmt(out)?,
                    }
                }
                Ok(())
            }
            Self::Product(factors) => {
                for (index, inner) in factors.iter().enumerate() {
                    out.write_str(if index > 0 { " * " } else { "" })?;
                    factor(inner, out)?;
                }
                Ok(())
            }
        }
    }
}

/// Sums and products need parentheses where a factor stands.
fn factor(inner: &Expression, out: &mut Formatter<'_>) -> Result {
    match inner {
        Expression::Sum(_) | Expression::Product(_) => write!(out, "({inner})"),
        _ => inner.fmt(out),
    }
}

impl Display for Oscillator {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        let Self { shape, hertz, amplitude, centre, phase } = *self;
        let standard = Self::new(shape);
        write!(out, "{}({}Hz", shape.name(), Plain(hertz.from))?;
        if hertz.to != hertz.from {
            write!(out, "..{}Hz", Plain(hertz.to))?;
        }
        match shape {
            Shape::Square { duty } if duty != Shape::DUTY => write!(out, ", duty={}", Plain(duty))?,
            Shape::Noise { seed } if seed != 0 => write!(out, ", seed={seed}")?,
            _ => {}
        }
        if amplitude != standard.amplitude {
            write!(out, ", amplitude={amplitude}")?;
        }
        if centre != standard.centre {
            write!(out, ", centre={centre}")?;
        }
        if phase != standard.phase {
            write!(out, ", phase={}", Plain(phase))?;
        }
        out.write_str(")")
    }
}

impl Display for Sweep {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        Plain(self.from).fmt(out)?;
        if self.to == self.from { Ok(()) } else { write!(out, "..{}", Plain(self.to)) }
    }
}

/// A number that reads back exactly, with an exponent where it would be long without.
struct Plain(f64);

impl Display for Plain {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        let Self(value) = self;
        if *value != 0.0 && value.abs() < 1e-6 { write!(out, "{value:e}") } else { write!(out, "{value}") }
    }
}
