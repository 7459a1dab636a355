//! Buffers and accessors of a glTF file, with every bound checked.
//!
//! Only the binary chunk, `data:` URIs and regular files in the model's folder are read. The same file named
//! by many buffers is read once.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use ::gltf::accessor::{DataType, Dimensions};
use ::gltf::buffer::{Source, View};
use ::gltf::{Accessor, Document};
use base64::Engine as _;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};

use crate::scene::source::MODEL_LIMIT_BYTES;
use crate::scene::text::{beside, read_file};

/// Items of an accessor without data (all zeros) beyond which the file is taken to be broken.
const MAX_ZEROS: usize = 1 << 24;

/// The bytes of all buffers.
pub(super) struct Data {
    buffers: Vec<Arc<[u8]>>,
}

impl Data {
    pub(super) fn read(
        document: &Document,
        blob: Option<&[u8]>,
        folder: Option<&Path>,
    ) -> Result<Self, String> {
        let mut files: BTreeMap<String, Arc<[u8]>> = BTreeMap::new();
        let mut buffers = Vec::new();
        let mut left_bytes = MODEL_LIMIT_BYTES;
        for buffer in document.buffers() {
            let bytes: Arc<[u8]> = match buffer.source() {
                Source::Bin => blob
                    .ok_or_else(|| {
                        format!("buffer {} is the binary chunk, but there is none", buffer.index())
                    })?
                    .into(),
                Source::Uri(uri) if uri.starts_with("data:") => {
                    decode(uri).map_err(|why| format!("buffer {}: {why}", buffer.index()))?.into()
                }
                Source::Uri(uri) => match files.get(uri) {
                    Some(read) => read.clone(),
                    None => {
                        let shown: String = uri.chars().take(80).collect();
                        let folder = folder
                            .ok_or_else(|| format!("buffer file {shown}: there is no folder to look in"))?;
                        let path = beside(folder, &unescape(uri))
                            .map_err(|why| format!("buffer file {shown}: {why}"))?;
                        let bytes: Arc<[u8]> = read_file(&path, &shown, left_bytes)
                            .map_err(|e| format!("buffer file {e}"))?
                            .into();
                        left_bytes = left_bytes.saturating_sub(bytes.len() as u64);
                        files.insert(uri.to_owned(), bytes.clone());
                        bytes
                    }
                },
            };
            if bytes.len() < buffer.length() {
                return Err(format!(
                    "buffer {} should have {} bytes, but there are only {}",
                    buffer.index(),
                    buffer.length(),
                    bytes.len()
                ));
            }
            buffers.push(bytes);
        }
        Ok(Self { buffers })
    }

    fn view(&self, view: &View<'_>) -> Result<&[u8], String> {
        let bytes = self
            .buffers
            .get(view.buffer().index())
            .map_or(&[][..], |b| &b[..view.buffer().length().min(b.len())]);
        let inside = view.offset().checked_add(view.length()).and_then(|end| bytes.get(view.offset()..end));
        inside.ok_or_else(|| {
            format!("buffer view {} lies outside of buffer {}", view.index(), view.buffer().index())
        })
    }

    /// All numbers of an accessor of `width` components an item, normalized where it says so.
    pub(super) fn floats(&self, accessor: &Accessor, width: usize) -> Result<Vec<f64>, String> {
        let fail = |why: &str| format!("accessor {}: {why}", accessor.index());
        if components(accessor.dimensions()) != width {
            return Err(fail(&format!("needs {width} numbers an item")));
        }
        let (kind, count) = (accessor.data_type(), accessor.count());
        let number = |bytes: &[u8]| component(kind, accessor.normalized(), bytes);
        let mut all = self.items(accessor, width, number)?;
        if let Some(sparse) = accessor.sparse() {
            let indices = self.strided(
                &sparse.indices().view(),
                sparse.indices().offset(),
                None,
                sparse.count(),
                index_bytes(&sparse.indices()),
            );
            let values = self.strided(
                &sparse.values().view(),
                sparse.values().offset(),
                None,
                sparse.count(),
                width * kind.size(),
            );
            let (indices, values) = (indices.map_err(|why| fail(&why))?, values.map_err(|why| fail(&why))?);
            for (index, value) in indices.zip(values) {
                let at = little(index) as usize;
                if at >= count {
                    return Err(fail(&format!("sparse index {at} is past its {count} items")));
                }
                for (k, bytes) in value.chunks_exact(kind.size()).enumerate() {
                    all[at * width + k] = number(bytes);
                }
            }
        }
        Ok(all)
    }

    /// All indices of an accessor of unsigned numbers.
    pub(super) fn indices(&self, accessor: &Accessor) -> Result<Vec<u32>, String> {
        if !matches!(accessor.data_type(), DataType::U8 | DataType::U16 | DataType::U32)
            || accessor.sparse().is_some()
        {
            return Err(format!("accessor {}: indices must be plain unsigned numbers", accessor.index()));
        }
        self.items(accessor, components(accessor.dimensions()).min(1), little)
    }

    fn items<T: Clone + Default>(
        &self,
        accessor: &Accessor,
        width: usize,
        read: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, String> {
        let fail = |why: &str| format!("accessor {}: {why}", accessor.index());
        let (count, size) = (accessor.count(), accessor.data_type().size());
        let Some(view) = accessor.view() else {
            if count > MAX_ZEROS {
                return Err(fail(&format!("{count} items and no data")));
            }
            return Ok(vec![T::default(); count * width]);
        };
        let items = self
            .strided(&view, accessor.offset(), view.stride(), count, width * size)
            .map_err(|why| fail(&why))?;
        Ok(items.flat_map(|item| item.chunks_exact(size)).map(read).collect())
    }

    /// `count` items of `size` bytes; checked to lie in the view before the first is read.
    fn strided<'s>(
        &'s self,
        view: &View<'_>,
        offset: usize,
        stride: Option<usize>,
        count: usize,
        size: usize,
    ) -> Result<impl Iterator<Item = &'s [u8]> + use<'s>, String> {
        let stride = stride.unwrap_or(size);
        let bytes = self.view(view)?;
        let end = count
            .checked_sub(1)
            .map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size)?.checked_add(offset));
        if stride < size || end.is_none_or(|end| end > bytes.len()) {
            return Err(format!(
                "{count} items of {size} bytes do not fit into buffer view {}",
                view.index()
            ));
        }
        Ok((0..count).map(move |i| &bytes[offset + i * stride..][..size]))
    }
}

fn components(dimensions: Dimensions) -> usize {
    dimensions.multiplicity()
}

fn index_bytes(indices: &::gltf::accessor::sparse::Indices) -> usize {
    use ::gltf::accessor::sparse::IndexType::{U8, U16, U32};
    match indices.index_type() {
        U8 => 1,
        U16 => 2,
        U32 => 4,
    }
}

/// An unsigned number of one, two or four bytes.
fn little(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |n, b| n << 8 | u32::from(*b))
}

fn component(kind: DataType, normalized: bool, bytes: &[u8]) -> f64 {
    let raw = little(bytes);
    let (value, scale) = match kind {
        DataType::F32 => return f64::from(f32::from_bits(raw)),
        DataType::I8 => (f64::from(raw as u8 as i8), 127.0),
        DataType::U8 => (f64::from(raw), 255.0),
        DataType::I16 => (f64::from(raw as u16 as i16), 32767.0),
        DataType::U16 => (f64::from(raw), 65535.0),
        DataType::U32 => (f64::from(raw), f64::from(u32::MAX)),
    };
    if normalized { (value / scale).max(-1.0) } else { value }
}

/// The bytes of a base64 `data:` URI.
fn decode(uri: &str) -> Result<Vec<u8>, String> {
    let (head, body) = uri.split_once(',').ok_or("a data URI without a comma")?;
    if !head.ends_with(";base64") {
        return Err("only base64 data URIs are read".into());
    }
    let lenient =
        GeneralPurposeConfig::new().with_decode_padding_mode(base64::engine::DecodePaddingMode::Indifferent);
    let engine = GeneralPurpose::new(&base64::alphabet::STANDARD, lenient);
    engine.decode(body.trim_ascii()).map_err(|e| format!("its base64 is broken: {e}"))
}

/// `%20` and the like; what is no escape stays.
fn unescape(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let (mut out, mut at) = (Vec::with_capacity(bytes.len()), 0);
    while at < bytes.len() {
        let hex = bytes
            .get(at + 1..at + 3)
            .and_then(|h| std::str::from_utf8(h).ok())
            .and_then(|h| u8::from_str_radix(h, 16).ok());
        match (bytes[at], hex) {
            (b'%', Some(byte)) => {
                out.push(byte);
                at += 3;
            }
            (byte, _) => {
                out.push(byte);
                at += 1;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}
