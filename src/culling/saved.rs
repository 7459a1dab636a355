//! A preprocess as bytes, so that it is done once: versioned, and checked against scene and parameters.
//!
//! Little-endian: the magic with the version, SHA-256 of the scene in hex, the parameters that it depends on,
//! the lengths of the tables, the tables, and SHA-256 of all that. Tables are rows of 32-bit words (reals by
//! their bits, so that nothing is rounded); the last one may be of bytes.

use sha2::{Digest, Sha256};

/// Bytes of the checksum at the end.
const CHECKSUM: usize = 32;

/// Whose bytes they are.
pub struct Format {
    /// First bytes of a file; the last one is the version.
    pub magic: &'static [u8; 12],
    /// Key of the method.
    pub method: &'static str,
    /// Whether a table of bytes follows those of words.
    pub has_bytes: bool,
}

/// What a preprocess was made for.
#[derive(Clone, Debug, PartialEq)]
pub struct Key<const PARAMS: usize> {
    /// The scene's hash.
    pub scene: String,
    pub params: [u32; PARAMS],
}

impl Format {
    /// Bytes of tables. `last`: the table of bytes, empty where the format has none.
    pub fn write<const PARAMS: usize>(&self, key: &Key<PARAMS>, tables: &[&[u32]], last: &[u8]) -> Vec<u8> {
        let mut bytes = self.magic.to_vec();
        // A hash is always equally long, so it needs no length.
        bytes.extend(key.scene.as_bytes());
        let lengths = tables.iter().map(|t| t.len() as u32);
        let lengths = lengths.chain(self.has_bytes.then_some(last.len() as u32));
        let numbers =
            key.params.into_iter().chain(lengths).chain(tables.iter().flat_map(|t| t.iter().copied()));
        numbers.for_each(|n| bytes.extend(n.to_le_bytes()));
        bytes.extend(last);
        let sum = Sha256::digest(&bytes);
        bytes.extend(sum);
        bytes
    }

    /// The tables of some bytes. `describe`: parameters, as they are set.
    ///
    /// # Errors
    /// Why they do not fit: damaged, of another version, scene or parameters.
    pub fn read<const PARAMS: usize, const TABLES: usize>(
        &self,
        bytes: &[u8],
        key: &Key<PARAMS>,
        describe: impl Fn([u32; PARAMS]) -> String,
    ) -> Result<([Vec<u32>; TABLES], Vec<u8>), String> {
        let (body, sum) = bytes.split_last_chunk::<CHECKSUM>().ok_or_else(damaged)?;
        let (magic, rest) = body.split_first_chunk::<12>().ok_or_else(damaged)?;
        // The version first, so that an older file is not called damaged; then the sum, so that what follows
        // may trust every length.
        if magic != self.magic {
            return Err(format!("it is no preprocess of {} that this version reads", self.method));
        }
        if Sha256::digest(body).as_slice() != sum {
            return Err(damaged());
        }
        let (made_for, mut rest) = rest.split_at_checked(key.scene.len()).ok_or_else(damaged)?;
        if made_for != key.scene.as_bytes() {
            return Err("it was made for another scene".into());
        }
        // Table by table, so that no length reaches past the bytes that there are.
        let mut words = |count: u32| -> Option<Vec<u32>> {
            let (taken, left) = rest.split_at_checked((count as usize).checked_mul(4)?)?;
            rest = left;
            Some(taken.chunks_exact(4).map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]])).collect())
        };
        let params = words(PARAMS as u32).ok_or_else(damaged)?;
        let params = <[u32; PARAMS]>::try_from(params).map_err(|_| damaged())?;
        if params != key.params {
            return Err(format!("it was made with {}", describe(params)));
        }
        let lengths = words((TABLES + usize::from(self.has_bytes)) as u32).ok_or_else(damaged)?;
        let mut tables = [const { Vec::new() }; TABLES];
        for (table, &length) in tables.iter_mut().zip(&lengths) {
            *table = words(length).ok_or_else(damaged)?;
        }
        let left = if self.has_bytes { lengths[TABLES] as usize } else { 0 };
        if rest.len() != left {
            return Err(damaged());
        }
        Ok((tables, rest.to_vec()))
    }
}

/// Why a file is not read whose numbers do not fit, though its sum may be right.
pub fn damaged() -> String {
    "the file is damaged".to_owned()
}
