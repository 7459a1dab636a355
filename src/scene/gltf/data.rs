//! Buffers, buffer views and accessors of a glTF file, with every bound checked (glTF 2.0, section 3.6).
//!
//! Only the binary chunk, `data:` URIs and regular files in the model's folder are read, each when something
//! first asks for it. The same file named by many buffers is read once.

use std::cell::{Cell, OnceCell, RefCell};
use std::collections::BTreeMap;
use std::ops::Deref;
use std::path::Path;
use std::rc::Rc;

use base64::Engine as _;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};

use super::codec;
use super::file::{Accessor, Gltf, Index, Sparse};
use crate::scene::source::MODEL_LIMIT_BYTES;
use crate::scene::text::{beside, read_file};

/// Items without data behind them (all zeros) that every file may have.
const FREE_ZEROS: usize = 1 << 20;
/// Bytes that compressed views may come to in every file, and for each byte of a longer one.
const FREE_UNPACKED: usize = 1 << 26;
const UNPACKED_FOR_EACH: usize = 64;

/// The bytes of a buffer.
enum Bytes<'a> {
    Chunk(&'a [u8]),
    Decoded(Vec<u8>),
    File(Rc<[u8]>),
}

impl Deref for Bytes<'_> {
    type Target = [u8];
    fn deref(&self) -> &[u8] {
        match self {
            Self::Chunk(bytes) => bytes,
            Self::Decoded(bytes) => bytes,
            Self::File(bytes) => bytes,
        }
    }
}

/// What is made when it is first asked for, or why it cannot be.
type Lazy<T> = OnceCell<Result<T, String>>;

/// The binary data of a file.
pub(super) struct Data<'a> {
    gltf: &'a Gltf,
    chunk: Option<&'a [u8]>,
    folder: Option<&'a Path>,
    buffers: Vec<Lazy<Bytes<'a>>>,
    files: RefCell<BTreeMap<&'a str, Rc<[u8]>>>,
    unpacked: RefCell<BTreeMap<Index, Rc<Lazy<Vec<u8>>>>>,
    file_bytes: Cell<usize>,
    zeros: Cell<usize>,
    unpacked_bytes: Cell<usize>,
    fault: OnceCell<String>,
}

impl<'a> Data<'a> {
    /// `file_bytes` long is the file itself; without a `folder` no buffer file is opened.
    pub(super) fn new(
        gltf: &'a Gltf,
        chunk: Option<&'a [u8]>,
        folder: Option<&'a Path>,
        file_bytes: usize,
    ) -> Self {
        Self {
            gltf,
            chunk,
            folder,
            buffers: gltf.buffers.iter().map(|_| OnceCell::new()).collect(),
            files: RefCell::default(),
            unpacked: RefCell::default(),
            file_bytes: Cell::new(file_bytes),
            zeros: Cell::new(0),
            unpacked_bytes: Cell::new(0),
            fault: OnceCell::new(),
        }
    }

    /// Bytes of the file and of those that were read with it so far: what work and memory are measured by.
    pub(super) fn file_bytes(&self) -> usize {
        self.file_bytes.get()
    }

    /// Why the first buffer that cannot be read cannot.
    pub(super) fn fault(&self) -> Option<&str> {
        self.fault.get().map(String::as_str)
    }

    fn buffer(&self, index: Index) -> Result<&[u8], String> {
        let at = index as usize;
        let Some(cell) = self.buffers.get(at) else {
            return Err(format!("there is no buffer {index}"));
        };
        let bytes = cell.get_or_init(|| self.read_buffer(at)).as_ref().map_err(|why| {
            self.fault.get_or_init(|| why.clone());
            why.clone()
        })?;
        Ok(&bytes[..self.gltf.buffers[at].byte_length])
    }

    fn read_buffer(&self, index: usize) -> Result<Bytes<'a>, String> {
        let buffer = &self.gltf.buffers[index];
        let bytes = match buffer.uri.as_deref() {
            // "glTF Buffer referring to GLB-stored BIN chunk MUST be the first element" (3.6.1.2).
            None if index > 0 => {
                return Err(format!(
                    "buffer {index} has no URI, and only buffer 0 may be the binary chunk of a GLB"
                ));
            }
            None => Bytes::Chunk(
                self.chunk.ok_or_else(|| format!("buffer {index} is the binary chunk, but there is none"))?,
            ),
            Some(uri) if uri.starts_with("data:") => {
                Bytes::Decoded(decode(uri).map_err(|why| format!("buffer {index}: {why}"))?)
            }
            Some(uri) => Bytes::File(self.read_beside(uri)?),
        };
        if bytes.len() < buffer.byte_length {
            return Err(format!(
                "buffer {index} should have {} bytes, but there are only {}",
                buffer.byte_length,
                bytes.len()
            ));
        }
        Ok(bytes)
    }

    fn read_beside(&self, uri: &'a str) -> Result<Rc<[u8]>, String> {
        if let Some(read) = self.files.borrow().get(uri) {
            return Ok(read.clone());
        }
        let shown: String = uri.chars().take(80).collect();
        let fail = |why: String| format!("buffer file {shown}: {why}");
        if ["http://", "https://", "ftp://", "//"].iter().any(|scheme| uri.starts_with(scheme)) {
            let name = uri.rsplit('/').next().unwrap_or_default();
            return Err(fail(format!(
                "it is an address on the web, and nothing is fetched; put `{name}` beside the model and \
                 name it there"
            )));
        }
        let folder = self.folder.ok_or_else(|| fail("there is no folder to look in".into()))?;
        let path = beside(folder, &unescape(uri)).map_err(fail)?;
        let left = MODEL_LIMIT_BYTES.saturating_sub(self.file_bytes() as u64);
        let bytes: Rc<[u8]> = read_file(&path, &shown, left).map_err(|e| format!("buffer file {e}"))?.into();
        self.file_bytes.set(self.file_bytes() + bytes.len());
        self.files.borrow_mut().insert(uri, bytes.clone());
        Ok(bytes)
    }

    fn part(&self, buffer: Index, offset: usize, length: usize, what: &str) -> Result<&[u8], String> {
        let bytes = self.buffer(buffer)?;
        let inside = offset.checked_add(length).and_then(|end| bytes.get(offset..end));
        inside.ok_or_else(|| format!("{what} lies outside of buffer {buffer}"))
    }

    /// Hands the bytes of a buffer view to `read`.
    pub(super) fn view<T>(
        &self,
        index: Index,
        read: impl FnOnce(&[u8]) -> Result<T, String>,
    ) -> Result<T, String> {
        let Some(view) = self.gltf.buffer_views.get(index as usize) else {
            return Err(format!("there is no buffer view {index}"));
        };
        let what = format!("buffer view {index}");
        let Some(packed) = view.extensions.as_ref().and_then(|e| e.meshopt.as_ref()) else {
            return read(self.part(view.buffer, view.byte_offset, view.byte_length, &what)?);
        };
        let cell = self.unpacked.borrow_mut().entry(index).or_default().clone();
        let unpacked = cell.get_or_init(|| {
            let size = packed.count.saturating_mul(packed.byte_stride);
            self.spend_unpacked(size)?;
            let from = self.part(packed.buffer, packed.byte_offset, packed.byte_length, &what)?;
            codec::meshopt(packed, from).map_err(|why| format!("{what}: {why}"))
        });
        read(unpacked.as_ref().map_err(Clone::clone)?)
    }

    fn spend_unpacked(&self, bytes: usize) -> Result<(), String> {
        let all = self.unpacked_bytes.get().saturating_add(bytes);
        self.unpacked_bytes.set(all);
        if all > FREE_UNPACKED.max(self.file_bytes().saturating_mul(UNPACKED_FOR_EACH)) {
            return Err(format!("its compressed data comes to {all} bytes, out of proportion to the file"));
        }
        Ok(())
    }

    pub(super) fn accessor(&self, index: Index) -> Result<&'a Accessor, String> {
        self.gltf
            .accessors
            .get(index as usize)
            .ok_or_else(|| format!("there is no accessor {index}, but only {}", self.gltf.accessors.len()))
    }

    /// The items of an accessor of `W` numbers each, normalized where it says so.
    pub(super) fn vectors<const W: usize>(&self, index: Index) -> Result<Vec<[f64; W]>, String> {
        let accessor = self.accessor(index)?;
        let read = || {
            if components(accessor) != W {
                return Err(format!("needs {W} numbers an item"));
            }
            match accessor.component_type {
                5126 => self.items::<W, 4, _>(accessor, |b| f64::from(f32::from_le_bytes(b))),
                5120 => self.items(accessor, number(accessor, |b: [u8; 1]| i8::from_le_bytes(b), 127.0)),
                5121 => self.items(accessor, number(accessor, |[b]: [u8; 1]| b, 255.0)),
                5122 => self.items(accessor, number(accessor, i16::from_le_bytes, 32767.0)),
                5123 => self.items(accessor, number(accessor, u16::from_le_bytes, 65535.0)),
                5125 => self.items(accessor, number(accessor, u32::from_le_bytes, f64::from(u32::MAX))),
                other => Err(format!("there is no component type {other}")),
            }
        };
        read().map_err(|why| format!("accessor {index}: {why}"))
    }

    /// The items of an accessor of `W` unsigned whole numbers each.
    pub(super) fn whole<const W: usize>(&self, index: Index) -> Result<Vec<[u32; W]>, String> {
        let accessor = self.accessor(index)?;
        let read = || {
            if components(accessor) != W {
                return Err(format!("needs {W} numbers an item"));
            }
            match accessor.component_type {
                5121 => self.items::<W, 1, _>(accessor, |[b]| u32::from(b)),
                5123 => self.items::<W, 2, _>(accessor, |b| u32::from(u16::from_le_bytes(b))),
                5125 => self.items::<W, 4, _>(accessor, u32::from_le_bytes),
                _ => Err("its numbers must be unsigned and whole".into()),
            }
        };
        read().map_err(|why| format!("accessor {index}: {why}"))
    }

    /// `W` components of `S` bytes an item, sparse values in their places.
    fn items<const W: usize, const S: usize, T: Copy + Default>(
        &self,
        accessor: &Accessor,
        number: impl Fn([u8; S]) -> T,
    ) -> Result<Vec<[T; W]>, String> {
        let item = |bytes: &[u8]| {
            let parts = bytes.as_chunks::<S>().0;
            std::array::from_fn(|k| number(parts[k]))
        };
        let mut all = match accessor.buffer_view {
            Some(view) => {
                let stride = self.gltf.buffer_views.get(view as usize).and_then(|v| v.byte_stride);
                let stride = stride.unwrap_or(W * S);
                self.run(view, accessor.byte_offset, stride, accessor.count, W * S, |run| {
                    run.map(item).collect()
                })?
            }
            None => {
                self.spend_zeros(accessor.count)?;
                vec![[T::default(); W]; accessor.count]
            }
        };
        if let Some(sparse) = &accessor.sparse {
            self.sparse(sparse, W * S, |at, bytes| match all.get_mut(at as usize) {
                Some(place) => {
                    *place = item(bytes);
                    Ok(())
                }
                None => Err(format!("sparse index {at} is past its {} items", accessor.count)),
            })?;
        }
        Ok(all)
    }

    /// "When undefined, the accessor MUST be initialized with zeros" (5.1.1); the file holds none of them.
    fn spend_zeros(&self, count: usize) -> Result<(), String> {
        let all = self.zeros.get().saturating_add(count);
        self.zeros.set(all);
        if all > FREE_ZEROS.max(self.file_bytes()) {
            return Err(format!("{count} items and no data, out of proportion to the file"));
        }
        Ok(())
    }

    fn sparse(
        &self,
        sparse: &Sparse,
        size: usize,
        mut set: impl FnMut(u32, &[u8]) -> Result<(), String>,
    ) -> Result<(), String> {
        let bytes = match sparse.indices.component_type {
            5121 => 1,
            5123 => 2,
            5125 => 4,
            other => return Err(format!("sparse indices cannot be of component type {other}")),
        };
        let little = |bytes: &[u8]| bytes.iter().rev().fold(0, |n, b| n << 8 | u32::from(*b));
        let (at, count) = (&sparse.indices, sparse.count);
        let places: Vec<u32> =
            self.run(at.buffer_view, at.byte_offset, bytes, count, bytes, |run| run.map(little).collect())?;
        let values = &sparse.values;
        self.run(values.buffer_view, values.byte_offset, size, count, size, |run| {
            places.iter().zip(run).try_for_each(|(at, bytes)| set(*at, bytes))
        })?
    }

    /// Hands `count` items of at least `size` bytes to `read`; they lie in the view.
    fn run<T>(
        &self,
        view: Index,
        offset: usize,
        stride: usize,
        count: usize,
        size: usize,
        read: impl FnOnce(std::slice::Chunks<'_, u8>) -> T,
    ) -> Result<T, String> {
        self.view(view, |bytes| {
            let length =
                count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size));
            let run = length.and_then(|l| bytes.get(offset..offset.checked_add(l)?));
            match run.filter(|_| stride >= size) {
                Some(run) => Ok(read(run.chunks(stride))),
                None => Err(format!("{count} items of {size} bytes do not fit into buffer view {view}")),
            }
        })
    }
}

/// Numbers an item of an accessor; 0 for a type that is none.
pub(super) fn components(accessor: &Accessor) -> usize {
    match accessor.shape.as_str() {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" | "MAT2" => 4,
        "MAT3" => 9,
        "MAT4" => 16,
        _ => 0,
    }
}

/// A whole number as it is, or as a part of `most` (3.6.2.2).
fn number<const S: usize, N: Into<f64>>(
    accessor: &Accessor,
    whole: impl Fn([u8; S]) -> N,
    most: f64,
) -> impl Fn([u8; S]) -> f64 {
    let normalized = accessor.normalized;
    move |bytes| {
        let value = whole(bytes).into();
        if normalized { (value / most).max(-1.0) } else { value }
    }
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
