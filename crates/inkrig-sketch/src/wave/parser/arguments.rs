//! What stands in the parentheses of a generator.

use super::Parser;
use crate::SketchError;
use crate::wave::expression::{Expression, Sweep};
use crate::wave::generator::{Oscillator, Shape};
use crate::wave::lexer::{Kind, Token};

const FREQUENCY: &str = "a frequency such as 2Hz, 2Hz..8Hz, or a period such as 0.5s";

impl<'a> Parser<'a> {
    /// The arguments of an oscillator, with the closing parenthesis.
    pub(super) fn arguments(&mut self, oscillator: &mut Oscillator) -> Result<(), SketchError> {
        let mut given: Vec<&str> = Vec::new();
        let mut position = 0;
        while !self.peek().is_sign(')') {
            let token = self.peek();
            match (token.kind, &mut oscillator.shape) {
                (Kind::Word, _) => given.push(self.named_argument(oscillator, &given)?),
                _ if position == 0 => oscillator.hertz = self.frequency()?,
                (_, Shape::Noise { seed }) if position == 1 => {
                    *seed = self.whole()?;
                    given.push("seed");
                }
                (_, shape) => return Err(token.wrong(format!("{} or )", names(*shape)), None)),
            }
            position += 1;
            if !self.peek().is_sign(',') {
                break;
            }
            self.next();
        }
        self.expect(')', "a comma or )")
    }

    fn named_argument(
        &mut self,
        oscillator: &mut Oscillator,
        given: &[&str],
    ) -> Result<&'static str, SketchError> {
        let token = self.next();
        let name = match token.text.to_ascii_lowercase().as_str() {
            "amplitude" => "amplitude",
            "centre" | "center" => "centre",
            "phase" => "phase",
            "duty" if matches!(oscillator.shape, Shape::Square { .. }) => "duty",
            "seed" if matches!(oscillator.shape, Shape::Noise { .. }) => "seed",
            _ => return Err(token.wrong(names(oscillator.shape), None)),
        };
        if given.contains(&name) {
            return Err(token.wrong("a name not given before", None));
        }
        self.expect('=', "=")?;
        match (name, &mut oscillator.shape) {
            ("amplitude", _) => oscillator.amplitude = self.range("a number or a range such as 0.5..1")?,
            ("centre", _) => oscillator.centre = self.range("a number or a range such as 0..2")?,
            ("phase", _) => {
                let value = self.peek();
                oscillator.phase = self.signed("a number of periods from -1 to 1")?;
                if oscillator.phase.abs() > 1.0 {
                    let hint = "A quarter of a period is 0.25";
                    return Err(value.wrong("a number of periods from -1 to 1", Some(hint)));
                }
            }
            (_, Shape::Square { duty }) => {
                let value = self.next();
                match value.kind {
                    Kind::Number(number) if number > 0.0 && number < 1.0 => *duty = number,
                    _ => return Err(value.wrong("a number between 0 and 1", None)),
                }
            }
            (_, Shape::Noise { seed }) => *seed = self.whole()?,
            _ => {}
        }
        Ok(name)
    }

    /// After `alternate`: its parentheses and what is in them.
    pub(super) fn alternate(&mut self) -> Result<Expression, SketchError> {
        const FORM: Option<&str> = Some("Write alternate(sine(2Hz), centres=-1|1, every=2s)");
        self.expect('(', "( and a wave, as in alternate(sine(2Hz), centres=-1|1, every=2s)")?;
        let inner = Box::new(self.sum()?);
        let (mut centres, mut every) = (Vec::new(), None);
        while self.peek().is_sign(',') {
            self.next();
            let name = self.next();
            if centres.is_empty() && (name.is_word("centres") || name.is_word("centers")) {
                self.expect('=', "=")?;
                centres = self.centres()?;
            } else if every.is_none() && name.is_word("every") {
                self.expect('=', "=")?;
                every = Some(self.length()?);
            } else {
                return Err(name.wrong("centres or every, each once", FORM));
            }
        }
        let end = self.next();
        match every {
            _ if centres.is_empty() => Err(end.wrong("`, centres=` and at least two numbers", FORM)),
            None => Err(end.wrong("`, every=` and a length", FORM)),
            Some(every) if end.is_sign(')') => Ok(Expression::Alternate { inner, centres, every }),
            Some(_) => Err(end.wrong(")", None)),
        }
    }

    fn centres(&mut self) -> Result<Vec<f64>, SketchError> {
        let mut centres = vec![self.signed("a number")?];
        while self.peek().is_sign('|') {
            let token = self.next();
            self.count(&token)?;
            centres.push(self.signed("a number")?);
        }
        if centres.len() < 2 {
            return Err(self.peek().wrong("| and a second centre, as in -1|1", None));
        }
        Ok(centres)
    }

    fn frequency(&mut self) -> Result<Sweep, SketchError> {
        let from = self.speed(true)?;
        if self.peek().kind != Kind::Range {
            return match from {
                Speed::Hertz(hertz) => Ok(Sweep::constant(hertz)),
                Speed::Bare(number) => {
                    let text = number.text;
                    let hint = format!("Write {text}Hz, or a period such as {text}s");
                    Err(self.peek().wrong("Hz or s after the number", Some(&hint)))
                }
            };
        }
        self.next();
        let end = self.tokens.get(self.at + 1).copied();
        let Speed::Hertz(to) = self.speed(false)? else {
            return Err(self.peek().wrong(FREQUENCY, None));
        };
        let from = match from {
            Speed::Hertz(hertz) => hertz,
            // 2..8Hz: the unit stands at the end for both.
            Speed::Bare(number) => in_hertz(&number, end.is_some_and(|unit| unit.is_word("s")))?,
        };
        Ok(Sweep { from, to })
    }

    fn speed(&mut self, may_be_bare: bool) -> Result<Speed<'a>, SketchError> {
        let number = self.next();
        let Kind::Number(_) = number.kind else {
            let hint = number.is_sign('-').then_some("Frequencies are above 0; phase=0.5 turns a wave over");
            return Err(number.wrong(FREQUENCY, hint));
        };
        let unit = self.peek();
        if unit.is_word("Hz") || unit.is_word("s") {
            self.next();
            return in_hertz(&number, unit.is_word("s")).map(Speed::Hertz);
        }
        if may_be_bare && unit.kind != Kind::Word {
            return Ok(Speed::Bare(number));
        }
        let hint = format!("Write {0}Hz, or a period such as {0}s", number.text);
        Err(unit.wrong("Hz or s after the number", Some(&hint)))
    }

    /// A length in seconds.
    pub(super) fn length(&mut self) -> Result<f64, SketchError> {
        const EXPECTED: &str = "a length in seconds, such as 3s";
        let number = self.next();
        let Kind::Number(length) = number.kind else {
            return Err(number.wrong(EXPECTED, None));
        };
        if length <= 0.0 {
            return Err(number.wrong("a length above 0", None));
        }
        let unit = self.next();
        if unit.is_word("s") {
            return Ok(length);
        }
        let hint = format!("Write {}s", number.text);
        Err(unit.wrong("s after the number", Some(&hint)))
    }

    pub(super) fn range(&mut self, expected: &str) -> Result<Sweep, SketchError> {
        let from = self.signed(expected)?;
        if self.peek().kind != Kind::Range {
            return Ok(Sweep::constant(from));
        }
        self.next();
        Ok(Sweep { from, to: self.signed("a number after ..")? })
    }

    pub(super) fn signed(&mut self, expected: &str) -> Result<f64, SketchError> {
        let negative = self.minus();
        let token = self.next();
        match token.kind {
            Kind::Number(value) => Ok(if negative { -value } else { value }),
            _ => Err(token.wrong(expected, None)),
        }
    }

    fn whole(&mut self) -> Result<u64, SketchError> {
        let token = self.next();
        token.text.parse().map_err(|_| token.wrong("a whole number as the seed", None))
    }
}

enum Speed<'a> {
    Hertz(f64),
    /// A number whose unit is still to come.
    Bare(Token<'a>),
}

/// The highest frequency that text may hold, in hertz; its reciprocal is the lowest.
const MAX_HERTZ: f64 = 1e9;

fn in_hertz(number: &Token<'_>, is_period: bool) -> Result<f64, SketchError> {
    let Kind::Number(value) = number.kind else {
        return Err(number.wrong(FREQUENCY, None));
    };
    let hertz = if is_period { 1.0 / value } else { value };
    if (1.0 / MAX_HERTZ..=MAX_HERTZ).contains(&hertz) {
        Ok(hertz)
    } else {
        Err(number.wrong("a frequency or period from 1e-9 to 1e9", None))
    }
}

fn names(shape: Shape) -> &'static str {
    match shape {
        Shape::Square { .. } => "one of duty=, amplitude=, centre=, phase=",
        Shape::Noise { .. } => "one of seed=, amplitude=, centre=, phase=",
        _ => "one of amplitude=, centre=, phase=",
    }
}
