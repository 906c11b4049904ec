//! Vectors of accessors: floats, or integers as `KHR_mesh_quantization` and glTF 2.0 §3.6.2.2 give them a meaning.

use gltf::accessor::{Accessor, DataType, Dimensions, Item, Iter};

use super::buffers::Buffers;

/// Vectors of an accessor; `None` if it has another number of components, a type that vectors do not have, or no bytes.
pub(super) fn vectors<const N: usize>(accessor: Accessor<'_>, buffers: &Buffers) -> Option<Vec<[f64; N]>>
where
    [i8; N]: Item,
    [u8; N]: Item,
    [i16; N]: Item,
    [u16; N]: Item,
    [f32; N]: Item,
{
    let components = match accessor.dimensions() {
        Dimensions::Vec2 => 2,
        Dimensions::Vec3 => 3,
        _ => 0,
    };
    if components != N {
        return None;
    }
    // A normalised integer counts parts of the largest one. The smallest one of a signed type is −1, too.
    let is_normalised = accessor.normalized();
    let whole = move |value: f64, largest: f64| if is_normalised { (value / largest).max(-1.0) } else { value };
    match accessor.data_type() {
        DataType::F32 => collect(accessor, buffers, |value: f32| value.into()),
        DataType::I8 => collect(accessor, buffers, |value: i8| whole(value.into(), 127.0)),
        DataType::U8 => collect(accessor, buffers, |value: u8| whole(value.into(), 255.0)),
        DataType::I16 => collect(accessor, buffers, |value: i16| whole(value.into(), 32767.0)),
        DataType::U16 => collect(accessor, buffers, |value: u16| whole(value.into(), 65535.0)),
        DataType::U32 => None,
    }
}

fn collect<T, const N: usize>(
    accessor: Accessor<'_>,
    buffers: &Buffers,
    number: impl Fn(T) -> f64,
) -> Option<Vec<[f64; N]>>
where
    [T; N]: Item,
{
    let all = Iter::<[T; N]>::new(accessor, |buffer| buffers.bytes(buffer.index()))?;
    Some(all.map(|vector| vector.map(&number)).collect())
}
