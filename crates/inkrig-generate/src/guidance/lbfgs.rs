//! L-BFGS with a line search for the strong Wolfe conditions, step by step as `torch.optim.LBFGS` does it, whose results
//! the published guidance is measured by. (Nocedal and Wright 2006, algorithms 7.4, 7.5, 3.5, 3.6.)

use std::collections::VecDeque;

/// When to stop, and how much to remember.
#[derive(Debug, Clone, PartialEq)]
pub struct LbfgsOptions {
    /// Factor of a step before the line search.
    pub rate: f64,
    /// Directions taken in one call.
    pub iterations: usize,
    /// No new direction is taken after that many evaluations in one call. A line search that has begun is finished.
    pub evaluations: usize,
    /// Steps that curvature is estimated from.
    pub history: usize,
    /// Done when no part of the gradient is larger.
    pub least_gradient: f64,
    /// Done when no part of a step, or the change of the value, is larger.
    pub least_change: f64,
}

impl Default for LbfgsOptions {
    /// As in the published guidance.
    fn default() -> Self {
        Self {
            rate: 1.0,
            iterations: 8,
            evaluations: 10,
            history: 10,
            least_gradient: 1e-7,
            least_change: 1e-9,
        }
    }
}

/// What is minimised: writes the gradient at a point, gives the value.
pub trait Objective {
    /// Why it may fail.
    type Error;

    /// The value at `x`; the gradient, as long as `x`, goes into `gradient`.
    ///
    /// # Errors
    /// Whatever can go wrong in the evaluation. The search stops and passes it on.
    fn evaluate(&mut self, x: &[f32], gradient: &mut [f32]) -> Result<f64, Self::Error>;
}

/// The optimiser with its memory, which goes on from one call to the next.
#[derive(Debug, Clone)]
pub struct Lbfgs {
    options: LbfgsOptions,
    steps: VecDeque<Step>,
    scale: f64,
    previous: Option<Previous>,
    evaluations: usize,
}

#[derive(Debug, Clone)]
struct Step {
    moved: Vec<f32>,
    gradient_change: Vec<f32>,
    inverse: f64,
}

#[derive(Debug, Clone)]
struct Previous {
    gradient: Vec<f32>,
    direction: Vec<f32>,
    length: f64,
}

/// A point on the line that is searched.
#[derive(Debug, Clone)]
struct Point {
    at: f64,
    value: f64,
    slope: f64,
    gradient: Vec<f32>,
}

const DECREASE: f64 = 1e-4;
const CURVATURE: f64 = 0.9;
const MOST_TRIALS: usize = 25;

impl Lbfgs {
    /// Without any memory.
    pub fn new(options: LbfgsOptions) -> Self {
        Self { options, steps: VecDeque::new(), scale: 1.0, previous: None, evaluations: 0 }
    }

    /// Evaluations so far, of all calls.
    pub fn evaluations(&self) -> usize {
        self.evaluations
    }

    /// Moves `x` to where the value is smaller; gives the value there.
    ///
    /// # Errors
    /// Those of the objective.
    pub fn minimise<O: Objective>(&mut self, x: &mut [f32], objective: &mut O) -> Result<f64, O::Error> {
        let mut gradient = vec![0.0; x.len()];
        let mut value = objective.evaluate(x, &mut gradient)?;
        let before = self.evaluations;
        self.evaluations += 1;
        if largest(&gradient) <= self.options.least_gradient {
            return Ok(value);
        }
        for iteration in 1..=self.options.iterations {
            let first = self.previous.is_none();
            let direction = self.direction(&gradient);
            let mut length = self.options.rate;
            if first {
                length *= (1.0 / gradient.iter().map(|g| f64::from(g.abs())).sum::<f64>()).min(1.0);
            }
            let slope = dot(&gradient, &direction);
            if slope > -self.options.least_change {
                self.previous = Some(Previous { gradient, direction, length });
                break;
            }
            let start = Point { at: 0.0, value, slope, gradient };
            let mut line =
                Line { from: x, direction: &direction, objective, trial: vec![0.0; x.len()], tries: 0 };
            let found = line.search(&start, length, self.options.least_change)?;
            self.evaluations += line.tries;
            for (x, d) in x.iter_mut().zip(&direction) {
                *x += (found.at * f64::from(*d)) as f32;
            }
            let change = (found.value - value).abs();
            let moved = largest(&direction) * found.at.abs();
            value = found.value;
            gradient = found.gradient;
            self.previous = Some(Previous { gradient: start.gradient, direction, length: found.at });
            if iteration == self.options.iterations
                || self.evaluations - before >= self.options.evaluations
                || largest(&gradient) <= self.options.least_gradient
                || moved <= self.options.least_change
                || change < self.options.least_change
            {
                break;
            }
        }
        Ok(value)
    }

    /// Downhill, bent by the curvature of the last steps (two-loop recursion).
    fn direction(&mut self, gradient: &[f32]) -> Vec<f32> {
        if let Some(previous) = &self.previous {
            let change: Vec<f32> = gradient.iter().zip(&previous.gradient).map(|(a, b)| a - b).collect();
            let moved: Vec<f32> =
                previous.direction.iter().map(|d| (f64::from(*d) * previous.length) as f32).collect();
            let along = dot(&change, &moved);
            if along > 1e-10 {
                if self.steps.len() == self.options.history {
                    self.steps.pop_front();
                }
                self.scale = along / dot(&change, &change);
                self.steps.push_back(Step { moved, gradient_change: change, inverse: 1.0 / along });
            }
        }
        let mut direction: Vec<f32> = gradient.iter().map(|g| -g).collect();
        let mut shares = Vec::with_capacity(self.steps.len());
        for step in self.steps.iter().rev() {
            let share = dot(&step.moved, &direction) * step.inverse;
            add_scaled(&mut direction, &step.gradient_change, -share);
            shares.push(share);
        }
        for d in &mut direction {
            *d = (f64::from(*d) * self.scale) as f32;
        }
        for (step, share) in self.steps.iter().zip(shares.into_iter().rev()) {
            let back = dot(&step.gradient_change, &direction) * step.inverse;
            add_scaled(&mut direction, &step.moved, share - back);
        }
        direction
    }
}

struct Line<'a, O> {
    from: &'a [f32],
    direction: &'a [f32],
    objective: &'a mut O,
    trial: Vec<f32>,
    tries: usize,
}

impl<O: Objective> Line<'_, O> {
    fn evaluate(&mut self, at: f64) -> Result<Point, O::Error> {
        for (trial, (x, d)) in self.trial.iter_mut().zip(self.from.iter().zip(self.direction)) {
            *trial = x + (at * f64::from(*d)) as f32;
        }
        let mut gradient = vec![0.0; self.trial.len()];
        let value = self.objective.evaluate(&self.trial, &mut gradient)?;
        self.tries += 1;
        Ok(Point { at, value, slope: dot(&gradient, self.direction), gradient })
    }

    /// A point that is enough lower and enough flatter than the start, or the lowest one found.
    fn search(&mut self, start: &Point, length: f64, least_change: f64) -> Result<Point, O::Error> {
        let most = largest(self.direction);
        let steep = |point: &Point| point.value > start.value + DECREASE * point.at * start.slope;
        let flat = |point: &Point| point.slope.abs() <= -CURVATURE * start.slope;
        let mut previous = start.clone();
        let mut point = self.evaluate(length)?;
        let mut trials = 0;
        // Two points between which there must be a good one.
        let mut bracket = loop {
            if trials == MOST_TRIALS {
                break [start.clone(), point];
            }
            if steep(&point) || (trials > 1 && point.value >= previous.value) {
                break [previous, point];
            }
            if flat(&point) {
                return Ok(point);
            }
            if point.slope >= 0.0 {
                break [previous, point];
            }
            let bounds = [point.at + 0.01 * (point.at - previous.at), point.at * 10.0];
            let next = cubic_minimum(&previous, &point, bounds);
            previous = std::mem::replace(&mut point, self.evaluate(next)?);
            trials += 1;
        };
        let mut stuck = false;
        let mut low = usize::from(bracket[0].value > bracket[1].value);
        while trials < MOST_TRIALS {
            let [left, right] = [bracket[0].at.min(bracket[1].at), bracket[0].at.max(bracket[1].at)];
            if (right - left) * most < least_change {
                break;
            }
            let mut next = cubic_minimum(&bracket[0], &bracket[1], [left, right]);
            let margin = 0.1 * (right - left);
            if (right - next).min(next - left) < margin {
                if stuck || next >= right || next <= left {
                    next = if (next - right).abs() < (next - left).abs() {
                        right - margin
                    } else {
                        left + margin
                    };
                    stuck = false;
                } else {
                    stuck = true;
                }
            } else {
                stuck = false;
            }
            let point = self.evaluate(next)?;
            trials += 1;
            if steep(&point) || point.value >= bracket[low].value {
                bracket[1 - low] = point;
                low = usize::from(bracket[0].value > bracket[1].value);
            } else {
                let done = flat(&point);
                if !done && point.slope * (bracket[1 - low].at - bracket[low].at) >= 0.0 {
                    bracket[1 - low] = bracket[low].clone();
                }
                bracket[low] = point;
                if done {
                    break;
                }
            }
        }
        let [left, right] = bracket;
        Ok(if low == 0 { left } else { right })
    }
}

/// Where the cubic through two values and slopes is lowest, between the bounds.
fn cubic_minimum(a: &Point, b: &Point, [left, right]: [f64; 2]) -> f64 {
    let first = a.slope + b.slope - 3.0 * (a.value - b.value) / (a.at - b.at);
    let square = first * first - a.slope * b.slope;
    if square < 0.0 || square.is_nan() {
        return (left + right) / 2.0;
    }
    let root = square.sqrt();
    let (a, b) = if a.at <= b.at { (a, b) } else { (b, a) };
    let at = b.at - (b.at - a.at) * ((b.slope + root - first) / (b.slope - a.slope + 2.0 * root));
    at.max(left).min(right)
}

fn dot(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
}

fn largest(x: &[f32]) -> f64 {
    f64::from(x.iter().fold(0.0_f32, |most, x| most.max(x.abs())))
}

fn add_scaled(out: &mut [f32], x: &[f32], scale: f64) {
    for (out, x) in out.iter_mut().zip(x) {
        *out += (scale * f64::from(*x)) as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley.
    struct Valley;

    impl Objective for Valley {
        type Error = ();

        fn evaluate(&mut self, x: &[f32], gradient: &mut [f32]) -> Result<f64, ()> {
            let (x, y) = (f64::from(x[0]), f64::from(x[1]));
            let across = y - x * x;
            gradient[0] = (-2.0 * (1.0 - x) - 400.0 * x * across) as f32;
            gradient[1] = (200.0 * across) as f32;
            Ok((1.0 - x).powi(2) + 100.0 * across * across)
        }
    }

    #[test]
    fn the_valleys_end_is_found() {
        let mut x = [-1.2, 1.0];
        let options = LbfgsOptions { iterations: 100, evaluations: 200, ..LbfgsOptions::default() };
        let mut optimiser = Lbfgs::new(options);
        let value = optimiser.minimise(&mut x, &mut Valley).unwrap();
        assert!(value < 1e-8 && (x[0] - 1.0).abs() < 1e-3, "{value} {x:?} {}", optimiser.evaluations());
        assert!(optimiser.evaluations() < 70);
    }

    #[test]
    fn steps_are_those_of_pytorch() {
        // torch.optim.LBFGS(lr=1, max_iter=8, max_eval=10, history_size=10, line_search_fn="strong_wolfe"), called twice.
        let mut x = [-1.2, 1.0];
        let mut optimiser = Lbfgs::new(LbfgsOptions::default());
        for (evaluations, expected) in PYTORCH {
            optimiser.minimise(&mut x, &mut Valley).unwrap();
            assert_eq!(optimiser.evaluations(), evaluations);
            assert!((x[0] - expected[0]).abs() < 1e-3 && (x[1] - expected[1]).abs() < 1e-3, "{x:?}");
        }
    }

    const PYTORCH: [(usize, [f32; 2]); 2] =
        [(10, [-0.880_215, 0.727_480_9]), (20, [-0.046_139_74, -0.018_041_696])];
}
