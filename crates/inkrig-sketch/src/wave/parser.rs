//! Recursive descent over the grammar of [`super::Wave`], bounded in depth and in parts.

mod arguments;

use super::expression::{Expression, Sign};
use super::generator::{Oscillator, Shape};
use super::lexer::{Kind, Token, tokens};
use super::{MAX_WAVE_DEPTH, MAX_WAVE_PARTS, Segment};
use crate::SketchError;

/// What may begin an expression, for messages.
const ATOM: &str = "a number, t, ( or one of sine, triangle, square, saw, noise, ramp, constant, alternate";

pub(super) fn parse(text: &str) -> Result<Vec<Segment>, SketchError> {
    let tokens = tokens(text)?;
    Parser { tokens: &tokens, at: 0, depth: 0, parts: 0 }.wave()
}

struct Parser<'a> {
    /// Ends with [`Kind::End`], which is never passed.
    tokens: &'a [Token<'a>],
    at: usize,
    depth: usize,
    parts: usize,
}

impl<'a> Parser<'a> {
    fn wave(&mut self) -> Result<Vec<Segment>, SketchError> {
        let mut segments = vec![self.segment()?];
        while self.peek().is_sign(';') {
            let end = self.next();
            if self.peek().kind == Kind::End {
                break;
            }
            if segments.last().is_some_and(|segment| segment.length.is_none()) {
                let hint = "Only the last segment may leave it out: sine(1Hz) for 3s; sine(4Hz)";
                return Err(end.wrong("`for` and a length before the next segment", Some(hint)));
            }
            segments.push(self.segment()?);
        }
        let rest = self.peek();
        if rest.kind == Kind::End {
            Ok(segments)
        } else {
            Err(rest.wrong("+, -, *, `for`, ; or the end", after(&rest)))
        }
    }

    fn segment(&mut self) -> Result<Segment, SketchError> {
        let expression = self.sum()?;
        let length = if self.peek().is_word("for") {
            self.next();
            Some(self.length()?)
        } else {
            None
        };
        Ok(Segment { expression, length })
    }

    fn sum(&mut self) -> Result<Expression, SketchError> {
        let first = self.product()?;
        let mut terms = Vec::new();
        while let Some(sign) = match self.peek().kind {
            Kind::Sign('+') => Some(Sign::Plus),
            Kind::Sign('-') => Some(Sign::Minus),
            _ => None,
        } {
            self.next();
            terms.push((sign, self.product()?));
        }
        if terms.is_empty() {
            return Ok(first);
        }
        terms.insert(0, (Sign::Plus, first));
        Ok(Expression::Sum(terms))
    }

    fn product(&mut self) -> Result<Expression, SketchError> {
        let first = self.factor()?;
        let mut factors = Vec::new();
        while self.peek().is_sign('*') {
            self.next();
            factors.push(self.factor()?);
        }
        if factors.is_empty() {
            return Ok(first);
        }
        factors.insert(0, first);
        Ok(Expression::Product(factors))
    }

    fn factor(&mut self) -> Result<Expression, SketchError> {
        let negative = self.minus();
        let atom = self.atom()?;
        Ok(if negative { atom.negated() } else { atom })
    }

    /// Passes all minus signs; whether they make one.
    fn minus(&mut self) -> bool {
        let mut negative = false;
        while self.peek().is_sign('-') {
            self.next();
            negative = !negative;
        }
        negative
    }

    fn atom(&mut self) -> Result<Expression, SketchError> {
        let token = self.next();
        self.count(&token)?;
        match token.kind {
            Kind::Number(value) => {
                let unit = self.peek();
                if unit.kind == Kind::Word && !unit.is_word("for") {
                    return Err(unit.wrong("a plain number here", Some(unit_hint(&unit))));
                }
                Ok(Expression::Number(value))
            }
            Kind::Sign('(') => self.nested(token, |parser| {
                let inner = parser.sum()?;
                if parser.peek().is_sign(';') || parser.peek().is_word("for") {
                    let hint = "Segments stand outside of parentheses";
                    return Err(parser.peek().wrong("+, -, * or )", Some(hint)));
                }
                parser.expect(')', "+, -, * or )")?;
                Ok(inner)
            }),
            Kind::Word => self.named(token),
            Kind::End => Err(token.wrong(ATOM, Some("A wave is written as in sine(2Hz..8Hz)"))),
            _ => Err(token.wrong(ATOM, None)),
        }
    }

    fn named(&mut self, token: Token<'a>) -> Result<Expression, SketchError> {
        match token.text.to_ascii_lowercase().as_str() {
            "t" => Ok(Expression::Time),
            "sine" => self.oscillator(Shape::Sine),
            "triangle" => self.oscillator(Shape::Triangle),
            "square" => self.oscillator(Shape::Square { duty: Shape::DUTY }),
            "saw" => self.oscillator(Shape::Saw),
            "noise" => self.oscillator(Shape::Noise { seed: 0 }),
            "ramp" => {
                self.expect('(', "( and a range, as in ramp(0..1)")?;
                let sweep = self.range("a range such as 0..1")?;
                self.expect(')', ".. or )")?;
                Ok(Expression::Ramp(sweep))
            }
            "constant" => {
                self.expect('(', "( and a number, as in constant(0.5)")?;
                let value = self.signed("a number")?;
                self.expect(')', ")")?;
                Ok(Expression::Number(value))
            }
            "alternate" => self.nested(token, Self::alternate),
            _ => Err(token.wrong(ATOM, name_hint(token.text))),
        }
    }

    fn oscillator(&mut self, shape: Shape) -> Result<Expression, SketchError> {
        let mut oscillator = Oscillator::new(shape);
        if self.peek().is_sign('(') {
            self.next();
            self.arguments(&mut oscillator)?;
        }
        Ok(Expression::Oscillator(oscillator))
    }

    /// Runs a rule one level deeper than `token`.
    fn nested<T>(
        &mut self,
        token: Token<'a>,
        rule: impl FnOnce(&mut Self) -> Result<T, SketchError>,
    ) -> Result<T, SketchError> {
        self.depth += 1;
        if self.depth > MAX_WAVE_DEPTH {
            let expected = format!("at most {MAX_WAVE_DEPTH} parentheses in one another");
            return Err(token.wrong(expected, Some("Leave out those that change nothing")));
        }
        let result = rule(self)?;
        self.depth -= 1;
        Ok(result)
    }

    /// Counts a part that costs time at every sample.
    fn count(&mut self, token: &Token<'a>) -> Result<(), SketchError> {
        self.parts += 1;
        if self.parts <= MAX_WAVE_PARTS {
            return Ok(());
        }
        let expected = format!("at most {MAX_WAVE_PARTS} numbers and generators in all");
        Err(token.wrong(expected, Some("Give long waves as CSV or JSON samples")))
    }

    fn expect(&mut self, sign: char, expected: &str) -> Result<(), SketchError> {
        let token = self.next();
        if token.is_sign(sign) { Ok(()) } else { Err(token.wrong(expected, None)) }
    }

    fn peek(&self) -> Token<'a> {
        // The last token is the end; an empty list does not occur.
        let end = Token { kind: Kind::End, text: "", column: 1 };
        self.tokens.get(self.at).or(self.tokens.last()).copied().unwrap_or(end)
    }

    fn next(&mut self) -> Token<'a> {
        let token = self.peek();
        self.at += 1;
        token
    }
}

impl Shape {
    /// Where no duty is given, a square is high for half of its period.
    pub(super) const DUTY: f64 = 0.5;

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Sine => "sine",
            Self::Triangle => "triangle",
            Self::Square { .. } => "square",
            Self::Saw => "saw",
            Self::Noise { .. } => "noise",
        }
    }
}

fn unit_hint(unit: &Token<'_>) -> &'static str {
    if unit.is_word("Hz") {
        "A frequency belongs into a generator, as in sine(2Hz)"
    } else if unit.is_word("s") {
        "A length follows `for`, as in sine(2Hz) for 3s"
    } else {
        "Write * between factors, as in 2 * t"
    }
}

fn after(token: &Token<'_>) -> Option<&'static str> {
    match token.kind {
        Kind::Sign(')') => Some("This parenthesis was never opened"),
        Kind::Sign(',') => Some("Segments are separated by ;"),
        Kind::Sign('(') | Kind::Number(_) | Kind::Word => {
            Some("Write * between factors, as in 2 * sine(1Hz)")
        }
        _ => None,
    }
}

fn name_hint(name: &str) -> Option<&'static str> {
    let name = name.to_ascii_lowercase();
    match name.as_str() {
        "cos" | "cosine" => Some("Write sine(1Hz, phase=0.25)"),
        "for" => Some("The wave itself stands before `for`, as in sine(2Hz) for 3s"),
        "pi" | "tau" => Some("Frequencies are in Hz and phases in periods; pi is not needed"),
        "chirp" | "sweep" => Some("Write a sweep as a range: sine(2Hz..8Hz)"),
        "line" | "linear" => Some("Write ramp(0..1)"),
        "rand" | "random" | "perlin" => Some("Write noise(2Hz)"),
        _ if name.starts_with("si") => Some("Did you mean sine?"),
        _ if name.starts_with("tr") => Some("Did you mean triangle?"),
        _ if name.starts_with("sq") || name.starts_with("pul") => Some("Did you mean square?"),
        _ if name.starts_with("sa") => Some("Did you mean saw?"),
        _ if name.starts_with("co") => Some("Did you mean constant?"),
        _ if name.starts_with("al") => Some("Did you mean alternate?"),
        _ => None,
    }
}
