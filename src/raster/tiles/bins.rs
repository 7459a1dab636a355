//! What is kept of a frame for exact answers: primitives as they were set up, and in which tiles each may
//! show.

use crate::raster::vertex::Vertex;

/// Entries in chunks, one list for each bin of 32×64 pixels; and the primitives that they name.
#[derive(Clone, Debug, Default)]
pub(super) struct Bins {
    entries: Vec<Entry>,
    /// For each bin the place of its next entry and how many it has.
    ends: Vec<[u32; 2]>,
    /// For each chunk the one after it.
    next: Vec<u32>,
    pub kept: Vec<Batch>,
}

/// A primitive in the tiles of a bin; sets of tiles have bit `4 row + column`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Entry {
    /// The tiles that it may show in.
    pub tiles: u64,
    /// Those of them that it covers whole.
    pub whole: u64,
    /// Its number among those kept.
    pub id: u32,
    /// Its nearest depth there.
    pub nearest: f32,
}

/// Sixteen primitives: corners as they were set up, by columns x, y, z and packed; see [`Vertex`]. A segment
/// has the first two.
#[derive(Clone, Debug, Default)]
pub(super) struct Batch {
    pub corners: [[[i32; 16]; 4]; 4],
    /// A plane that it is not farther than at any pixel: depth at the center of a pixel, the changes a column
    /// and a row, and that pixel.
    pub floor: [[f32; 16]; 3],
    pub column: [i32; 16],
    pub row: [i32; 16],
}

impl Batch {
    /// A corner of one of them.
    #[inline(always)]
    pub fn corner(&self, which: usize, lane: usize) -> Vertex {
        let [x, y, z, packed] = &self.corners;
        Vertex {
            x: x[which][lane],
            y: y[which][lane],
            z: f32::from_bits(z[which][lane] as u32),
            packed: packed[which][lane] as u32,
        }
    }
    /// Sets it.
    pub fn put(&mut self, which: usize, lane: usize, v: Vertex) {
        let values = [v.x, v.y, v.z.to_bits() as i32, v.packed as i32];
        self.corners.iter_mut().zip(values).for_each(|(to, v)| to[which][lane] = v);
    }
}

/// Entries of a chunk: with 8 of 24 bytes few places stay empty, and a list jumps rarely.
const CHUNK: usize = 8;

impl Bins {
    /// Empties so many bins.
    pub fn clear(&mut self, bins: usize) {
        // Each bin begins with a chunk of its own.
        self.ends.clear();
        self.ends.extend((0..bins).map(|i| [(i * CHUNK) as u32, 0]));
        self.entries.resize(bins * CHUNK, Entry::default());
        self.next.clear();
        self.next.resize(bins, 0);
        self.kept.clear();
    }
    /// Appends an entry unless it has no tiles.
    #[inline(always)]
    pub fn push(&mut self, bin: usize, entry: Entry) {
        let end = &mut self.ends[bin];
        // Written in any case, counted if it says something: no branch that cannot be foreseen.
        self.entries[end[0] as usize] = entry;
        let more = u32::from(entry.tiles != 0);
        end[0] += more;
        end[1] += more;
        if more != 0 && (end[0] as usize).is_multiple_of(CHUNK) {
            let chunk = self.next.len();
            self.next[end[0] as usize / CHUNK - 1] = chunk as u32;
            end[0] = (chunk * CHUNK) as u32;
            self.next.push(0);
            self.entries.resize((chunk + 1) * CHUNK, Entry::default());
        }
    }
    /// The entries of a bin in their order.
    #[inline(always)]
    pub fn of(&self, bin: usize) -> impl Iterator<Item = &Entry> {
        let mut at = bin * CHUNK;
        (0..self.ends[bin][1]).map(move |_| {
            let entry = &self.entries[at];
            at += 1;
            if at.is_multiple_of(CHUNK) {
                at = CHUNK * self.next[at / CHUNK - 1] as usize;
            }
            entry
        })
    }
}

/// The same entries of the same primitives; where they lie in memory does not count, nor do the lanes of a
/// batch that no entry names.
impl PartialEq for Bins {
    fn eq(&self, other: &Self) -> bool {
        let prim = |bins: &Self, entry: &Entry| {
            let (batch, lane) = (&bins.kept[entry.id as usize / 16], entry.id as usize % 16);
            let floor = batch.floor.map(|f| f[lane].to_bits());
            ([0, 1, 2, 3].map(|k| batch.corner(k, lane)), floor, batch.column[lane], batch.row[lane])
        };
        let all = |bins: &Self, bin: usize| -> Vec<_> { bins.of(bin).map(|e| (*e, prim(bins, e))).collect() };
        self.ends.len() == other.ends.len() && (0..self.ends.len()).all(|b| all(self, b) == all(other, b))
    }
}
