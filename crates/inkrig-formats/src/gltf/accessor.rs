//! Numbers in buffers: any component type, interleaved, normalised, sparse. Nothing is copied; every element is read
//! where it lies.

use super::{
    buffers::Buffers,
    damaged,
    document::{self, Document, Shape},
};
use crate::FormatError;

/// A run of elements that was checked to lie inside of its buffer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Accessor<'a> {
    /// From the first element on; `None` where all is zero but for `sparse`.
    dense: Option<&'a [u8]>,
    stride: usize,
    pub(super) count: usize,
    component: Component,
    normalised: bool,
    width: usize,
    sparse: Option<Sparse<'a>>,
}

#[derive(Debug, Clone, Copy)]
struct Sparse<'a> {
    /// Rising.
    indices: Indices<'a>,
    values: &'a [u8],
}

/// Plain unsigned numbers without gaps.
#[derive(Debug, Clone, Copy)]
struct Indices<'a> {
    bytes: &'a [u8],
    component: Component,
    count: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

/// Opens accessor `index`, whose elements must have the shape wanted. `most` bounds the elements that need no bytes.
pub(super) fn open<'a>(
    index: u32,
    shape: Shape,
    document: &Document,
    buffers: &'a Buffers<'_>,
    most: usize,
) -> Result<Accessor<'a>, FormatError> {
    let part = || format!("accessor {index}");
    let hint = "the file is damaged; export it again";
    let bad = |what: String| damaged("gltf-accessor", part(), what, hint);
    let Some(accessor) = document.accessors.0.get(index as usize) else {
        return Err(damaged("gltf-index", part(), "there is no such accessor", hint));
    };
    if accessor.shape != shape {
        return Err(bad(format!("its elements are {:?}, and {shape:?} is wanted", accessor.shape)));
    }
    let width = match shape {
        Shape::Scalar => 1,
        Shape::Vec3 => 3,
        Shape::Vec4 => 4,
        Shape::Other => return Err(bad("no motion uses such elements".into())),
    };
    let Some(component) = Component::of(accessor.component_type) else {
        return Err(bad(format!("{} is no component type", accessor.component_type)));
    };
    let size = width * component.size();
    let mut stride = size;
    let dense = match accessor.buffer_view {
        None => {
            if accessor.count > most {
                return Err(FormatError::Limit {
                    what: format!("accessor {index} has {} elements without bytes", accessor.count),
                    limit: most,
                    place: None,
                    hint: hint.into(),
                });
            }
            None
        }
        Some(view) => {
            let (bytes, view_stride) = view_bytes(view, document, buffers).map_err(bad)?;
            stride = view_stride.unwrap_or(size);
            if stride < size {
                return Err(bad(format!("elements of {size} bytes stand {stride} bytes apart")));
            }
            let needed = (accessor.count.saturating_sub(1))
                .checked_mul(stride)
                .and_then(|bytes| bytes.checked_add(if accessor.count == 0 { 0 } else { size }));
            let bytes = bytes.get(accessor.byte_offset..).unwrap_or(&[]);
            match needed.and_then(|needed| bytes.get(..needed)) {
                Some(bytes) => Some(bytes),
                None => {
                    let count = accessor.count;
                    let there = bytes.len();
                    return Err(bad(format!(
                        "{count} elements of {size} bytes, and {there} bytes are there"
                    )));
                }
            }
        }
    };
    let sparse = match &accessor.sparse {
        None => None,
        Some(sparse) => Some(open_sparse(sparse, accessor.count, size, document, buffers).map_err(bad)?),
    };
    let normalised = accessor.normalized;
    Ok(Accessor { dense, stride, count: accessor.count, component, normalised, width, sparse })
}

/// The buffers that an accessor's bytes lie in.
pub(super) fn buffers_of(index: u32, document: &Document) -> impl Iterator<Item = u32> {
    let accessor = document.accessors.0.get(index as usize);
    let sparse = accessor.and_then(|accessor| accessor.sparse.as_ref());
    let views = [
        accessor.and_then(|accessor| accessor.buffer_view),
        sparse.map(|sparse| sparse.indices.buffer_view),
        sparse.map(|sparse| sparse.values.buffer_view),
    ];
    let buffers = views.map(|view| Some(document.buffer_views.0.get(view? as usize)?.buffer));
    buffers.into_iter().flatten()
}

impl Accessor<'_> {
    /// An element; components beyond the accessor's own are 0.
    pub(super) fn get<const N: usize>(&self, element: usize) -> [f64; N] {
        let size = self.width * self.component.size();
        let sparse = self.sparse.and_then(|sparse| {
            let place = sparse.indices.find(element)?;
            sparse.values.get(place * size..)
        });
        let dense = || self.dense.and_then(|bytes| bytes.get(element.checked_mul(self.stride)?..));
        let Some(bytes) = sparse.or_else(dense) else { return [0.0; N] };
        let mut out = [0.0; N];
        let parts = bytes.chunks_exact(self.component.size());
        for (slot, part) in out.iter_mut().zip(parts.take(self.width)) {
            *slot = self.component.read(part, self.normalised);
        }
        out
    }

    /// A single number.
    pub(super) fn scalar(&self, element: usize) -> f64 {
        let [value] = self.get::<1>(element);
        value
    }
}

impl Indices<'_> {
    fn at(&self, place: usize) -> usize {
        let size = self.component.size();
        let part = self.bytes.get(place * size..).unwrap_or(&[]);
        self.component.read(part.get(..size).unwrap_or(&[]), false) as usize
    }

    fn find(&self, element: usize) -> Option<usize> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low.midpoint(high);
            if self.at(middle) < element { low = middle + 1 } else { high = middle }
        }
        (low < self.count && self.at(low) == element).then_some(low)
    }
}

fn open_sparse<'a>(
    sparse: &document::Sparse,
    count: usize,
    size: usize,
    document: &Document,
    buffers: &'a Buffers<'_>,
) -> Result<Sparse<'a>, String> {
    let kind = sparse.indices.component_type;
    let unsigned =
        |component: &Component| matches!(component, Component::U8 | Component::U16 | Component::U32);
    let Some(component) = Component::of(kind).filter(unsigned) else {
        return Err(format!("{kind} is no component type of sparse indices"));
    };
    let cut = |view: u32, offset: usize, size: usize| -> Result<&'a [u8], String> {
        let (bytes, _) = view_bytes(view, document, buffers)?;
        let needed = sparse.count.checked_mul(size);
        let bytes = bytes.get(offset..).unwrap_or(&[]);
        let (count, there) = (sparse.count, bytes.len());
        needed
            .and_then(|needed| bytes.get(..needed))
            .ok_or(format!("{count} sparse elements of {size} bytes, and {there} bytes are there"))
    };
    let bytes = cut(sparse.indices.buffer_view, sparse.indices.byte_offset, component.size())?;
    let values = cut(sparse.values.buffer_view, sparse.values.byte_offset, size)?;
    let indices = Indices { bytes, component, count: sparse.count };
    let mut places = (0..sparse.count).map(|place| indices.at(place));
    if !places.by_ref().is_sorted_by(|a, b| a < b) {
        return Err("its sparse indices do not rise".into());
    }
    if sparse.count > 0 && indices.at(sparse.count - 1) >= count {
        return Err(format!("a sparse index is beyond its {count} elements"));
    }
    Ok(Sparse { indices, values })
}

fn view_bytes<'a>(
    view: u32,
    document: &Document,
    buffers: &'a Buffers<'_>,
) -> Result<(&'a [u8], Option<usize>), String> {
    let Some(described) = document.buffer_views.0.get(view as usize) else {
        return Err(format!("buffer view {view} does not exist"));
    };
    if described.is_packed() {
        return Err(
            "it is packed with meshopt, which is not read: export the file without compression".into()
        );
    }
    let (start, length) = (described.byte_offset, described.byte_length);
    let buffer = buffers.get(described.buffer, document).unwrap_or(&[]);
    let end = start.saturating_add(length);
    match buffer.get(start..end) {
        Some(bytes) => Ok((bytes, described.byte_stride)),
        None => Err(format!("buffer view {view} ends at byte {end} of {}", buffer.len())),
    }
}

impl Component {
    fn of(kind: u32) -> Option<Self> {
        Some(match kind {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// glTF 2.0, 3.6.2.2: the largest integer stands for 1.
    fn read(self, bytes: &[u8], normalised: bool) -> f64 {
        let (value, largest) = match (self, bytes) {
            (Self::I8, &[a]) => (f64::from(a as i8), 127.0),
            (Self::U8, &[a]) => (f64::from(a), 255.0),
            (Self::I16, &[a, b]) => (f64::from(i16::from_le_bytes([a, b])), 32_767.0),
            (Self::U16, &[a, b]) => (f64::from(u16::from_le_bytes([a, b])), 65_535.0),
            (Self::U32, &[a, b, c, d]) => (f64::from(u32::from_le_bytes([a, b, c, d])), f64::from(u32::MAX)),
            (Self::F32, &[a, b, c, d]) => return f64::from(f32::from_le_bytes([a, b, c, d])),
            _ => return 0.0,
        };
        if normalised { (value / largest).max(-1.0) } else { value }
    }
}
