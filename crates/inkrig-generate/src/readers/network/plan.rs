//! What a network consists of.

use crate::schedule::Noise;
use std::ops::Range;

/// How large a table is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Rows of places.
    pub height: usize,
    /// Places of a row.
    pub width: usize,
    /// Numbers of a place.
    pub channels: usize,
}

impl Shape {
    /// Places.
    pub fn places(self) -> usize {
        self.height * self.width
    }

    /// Numbers.
    pub fn numbers(self) -> usize {
        self.places() * self.channels
    }
}

/// A table that the network makes; 0 is the picture.
pub type Value = usize;

/// What a layer does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A convolution: patches `stride` apart, beginning `pad` before the border, through a linear layer; added to `skip` where there is one.
    Patch { kernel: [usize; 2], stride: [usize; 2], pad: [usize; 2], skip: Option<Value> },
    /// A block with a depthwise convolution of `kernel` x `kernel` and `hidden` channels inside.
    Block { kernel: usize, hidden: usize },
    /// A table of half the size through a linear layer, every place of it four times, added to `skip`.
    Join { skip: Value },
    /// A norm over the channels.
    Norm,
    /// A linear layer at every place.
    Linear,
    /// The mean over all places.
    Mean,
}

#[derive(Debug, Clone)]
pub(super) struct Layer {
    pub kind: Kind,
    pub from: Value,
    /// Its weights within the row of all.
    pub weights: Range<usize>,
}

/// A tensor's name, its shape, and how far its first numbers spread.
#[derive(Debug, Clone, PartialEq)]
struct Spec {
    name: String,
    shape: Vec<usize>,
    start: Start,
    /// Whether what it makes is added to what was there: with zeros the layer changes nothing.
    adds: bool,
}

/// What a tensor holds before training.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Start {
    Constant(f32),
    Normal(f32),
}

/// Layers one after the other, each with what it reads.
#[derive(Debug, Clone)]
pub struct Plan {
    pub(super) shapes: Vec<Shape>,
    pub(super) layers: Vec<Layer>,
    specs: Vec<Spec>,
    numbers: usize,
}

impl Plan {
    /// Nothing yet but a picture.
    pub fn new(picture: Shape) -> Self {
        Self { shapes: vec![picture], layers: Vec::new(), specs: Vec::new(), numbers: 0 }
    }

    /// How large a table is.
    pub fn shape(&self, value: Value) -> Shape {
        self.shapes[value]
    }

    /// How many weights there are.
    pub fn numbers(&self) -> usize {
        self.numbers
    }

    /// Names and shapes of all weights, in their order in the row of all.
    pub fn tensors(&self) -> impl Iterator<Item = (&str, &[usize])> {
        self.specs.iter().map(|spec| (spec.name.as_str(), spec.shape.as_slice()))
    }

    /// Of each of [`Plan::tensors`], whether what it makes is added to what was there: with zeros its layer changes nothing.
    pub fn additions(&self) -> impl Iterator<Item = bool> {
        self.specs.iter().map(|spec| spec.adds)
    }

    /// Weights to begin training with.
    pub fn random(&self, seed: u64) -> Vec<f32> {
        let mut noise = Noise::new(seed);
        let mut row = Vec::with_capacity(self.numbers);
        for spec in &self.specs {
            let count = spec.shape.iter().product::<usize>();
            row.extend((0..count).map(|_| match spec.start {
                Start::Constant(number) => number,
                Start::Normal(spread) => spread * noise.normal(),
            }));
        }
        row
    }

    /// Adds a convolution of patches (height, width each).
    pub fn patch(
        &mut self,
        name: &str,
        from: Value,
        kernel: [usize; 2],
        stride: [usize; 2],
        pad: [usize; 2],
        channels: usize,
    ) -> Value {
        let inner = self.shape(from);
        let along = |size: usize, axis: usize| (size + 2 * pad[axis] - kernel[axis]) / stride[axis] + 1;
        let shape = Shape { height: along(inner.height, 0), width: along(inner.width, 1), channels };
        let first = self.numbers;
        self.linear_weights(name, channels, kernel[0] * kernel[1] * inner.channels, 1.0);
        self.push(Kind::Patch { kernel, stride, pad, skip: None }, from, first, shape)
    }

    /// Adds a convolution of patches of 2 x 2, side by side, to `skip`, which has half the size.
    pub fn shrink(&mut self, name: &str, from: Value, skip: Value) -> Value {
        let (inner, shape, first) = (self.shape(from), self.shape(skip), self.numbers);
        self.linear_weights(name, shape.channels, 4 * inner.channels, 1.0);
        self.adds(2);
        let [kernel, stride, pad] = [[2, 2], [2, 2], [0, 0]];
        self.push(Kind::Patch { kernel, stride, pad, skip: Some(skip) }, from, first, shape)
    }

    /// Adds a block; `kernel` is odd.
    pub fn block(&mut self, name: &str, from: Value, kernel: usize, hidden: usize) -> Value {
        let shape = self.shape(from);
        let (width, first) = (shape.channels, self.numbers);
        let spread = Start::Normal(1.0 / kernel as f32);
        self.spec(format!("{name}.depthwise.weight"), vec![kernel, kernel, width], spread);
        self.spec(format!("{name}.depthwise.bias"), vec![width], Start::Constant(0.0));
        self.norm_weights(&format!("{name}.norm"), width);
        self.linear_weights(&format!("{name}.linear1"), hidden, width, 1.4);
        self.linear_weights(&format!("{name}.linear2"), width, hidden, 0.5);
        self.adds(2);
        self.push(Kind::Block { kernel, hidden }, from, first, shape)
    }

    /// Adds a table of half the size to `skip`.
    pub fn join(&mut self, name: &str, low: Value, skip: Value) -> Value {
        let (inner, shape, first) = (self.shape(low), self.shape(skip), self.numbers);
        self.linear_weights(name, shape.channels, inner.channels, 1.0);
        self.adds(2);
        self.push(Kind::Join { skip }, low, first, shape)
    }

    /// Adds a norm.
    pub fn norm(&mut self, name: &str, from: Value) -> Value {
        let (shape, first) = (self.shape(from), self.numbers);
        self.norm_weights(name, shape.channels);
        self.push(Kind::Norm, from, first, shape)
    }

    /// Adds a linear layer.
    pub fn linear(&mut self, name: &str, from: Value, channels: usize) -> Value {
        let (inner, first) = (self.shape(from), self.numbers);
        self.linear_weights(name, channels, inner.channels, 1.0);
        self.push(Kind::Linear, from, first, Shape { channels, ..inner })
    }

    /// Adds a mean over all places.
    pub fn mean(&mut self, from: Value) -> Value {
        let (inner, first) = (self.shape(from), self.numbers);
        self.push(Kind::Mean, from, first, Shape { height: 1, width: 1, ..inner })
    }

    fn push(&mut self, kind: Kind, from: Value, first: usize, shape: Shape) -> Value {
        self.layers.push(Layer { kind, from, weights: first..self.numbers });
        self.shapes.push(shape);
        self.layers.len()
    }

    fn linear_weights(&mut self, name: &str, outputs: usize, inputs: usize, gain: f32) {
        let spread = Start::Normal(gain / (inputs as f32).sqrt());
        self.spec(format!("{name}.weight"), vec![outputs, inputs], spread);
        self.spec(format!("{name}.bias"), vec![outputs], Start::Constant(0.0));
    }

    fn norm_weights(&mut self, name: &str, width: usize) {
        self.spec(format!("{name}.weight"), vec![width], Start::Constant(1.0));
        self.spec(format!("{name}.bias"), vec![width], Start::Constant(0.0));
    }

    fn spec(&mut self, name: String, shape: Vec<usize>, start: Start) {
        self.numbers += shape.iter().product::<usize>();
        self.specs.push(Spec { name, shape, start, adds: false });
    }

    /// What the last tensors make is added.
    fn adds(&mut self, tensors: usize) {
        self.specs.iter_mut().rev().take(tensors).for_each(|spec| spec.adds = true);
    }
}
