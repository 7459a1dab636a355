//! Numbers in sets that are joined (union-find, Tarjan 1975, <https://doi.org/10.1145/321879.321884>).

/// Sets of the numbers below some count, at first each by itself.
#[derive(Clone, Debug)]
pub struct Sets(Vec<u32>);

impl Sets {
    /// Of so many numbers.
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }
    /// The least number of the set of a number. Ways there are halved as they are gone.
    pub fn root(&mut self, mut at: u32) -> u32 {
        while self.0[at as usize] != at {
            let next = self.0[self.0[at as usize] as usize];
            self.0[at as usize] = next;
            at = next;
        }
        at
    }
    /// Makes one set of those of two numbers.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
