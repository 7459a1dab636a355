//! The two compressions of geometry: Draco for a primitive, meshopt for a buffer view.

use draco_core::{DecodeLimits, DecoderBuffer, Mesh, MeshDecoder};
use meshoptimizer_rs::codec::{self, Filter, Mode};
use meshoptimizer_rs::{Error, Workspace};

use super::file::Meshopt;

/// The bytes of a view (EXT_meshopt_compression, and KHR_meshopt_compression, which adds a version and the
/// color filter).
pub(super) fn meshopt(packed: &Meshopt, from: &[u8]) -> Result<Vec<u8>, String> {
    let fail = |e: Error| format!("its meshopt data cannot be unpacked: {e}");
    let work = &mut Workspace::default();
    let (count, stride) = (packed.count, packed.byte_stride);
    let mut bytes = match Mode::parse(&packed.mode).map_err(fail)? {
        Mode::Attributes => codec::decode_vertex_buffer(count, stride, from, work),
        Mode::Triangles => codec::decode_index_buffer(count, stride, from, work),
        Mode::Indices => codec::decode_index_sequence(count, stride, from, work),
    }
    .map_err(fail)?;
    match packed.filter.as_deref().unwrap_or("NONE") {
        "COLOR" => codec::decode_filter_color(&mut bytes, count, stride, work),
        name => match Filter::parse(name).map_err(fail)? {
            Filter::None => Ok(()),
            Filter::Octahedral => codec::decode_filter_oct(&mut bytes, count, stride, work),
            Filter::Quaternion => codec::decode_filter_quat(&mut bytes, count, stride, work),
            Filter::Exponential => codec::decode_filter_exp(&mut bytes, count, stride, work),
        },
    }
    .map_err(fail)?;
    Ok(bytes)
}

/// A primitive that was compressed with Draco.
pub(super) struct Unpacked(Mesh);

/// Unpacks a primitive of at most so many points and triangles (KHR_draco_mesh_compression).
pub(super) fn draco(from: &[u8], most: usize) -> Result<Unpacked, String> {
    let most = most as u64;
    let limits = DecodeLimits::default().with_max_points(most).with_max_faces(most);
    let mut mesh = Mesh::new();
    MeshDecoder::new()
        .decode(&mut DecoderBuffer::new(from).with_limits(limits), &mut mesh)
        .map_err(|e| format!("its Draco data cannot be unpacked: {e}"))?;
    Ok(Unpacked(mesh))
}

impl Unpacked {
    pub(super) fn corners(&self) -> impl Iterator<Item = u32> + '_ {
        self.0.faces().iter().flatten().map(|p| p.0)
    }

    /// The attribute of this id, `W` numbers a point, as they were stored.
    pub(super) fn vectors<const W: usize>(&self, id: u32) -> Result<Vec<[f64; W]>, String> {
        let attribute =
            self.0.attribute_by_unique_id(id).ok_or_else(|| format!("it has no attribute {id}"))?;
        let numbers = attribute.read_f32s(self.0.num_points(), W);
        Ok(numbers.as_chunks::<W>().0.iter().map(|v| v.map(f64::from)).collect())
    }
}
