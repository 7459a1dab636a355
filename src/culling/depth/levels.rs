//! What holds depths on several levels, as pictures show it: a z-buffer with its pyramid, or tiles.

use super::buffer::Buffer;
use super::faces::Faces;
use super::tiled::Tiled;
use crate::raster::{Isa, PyramidCell, Tiles};

/// Levels of depths, from the pixels up.
pub trait Levels {
    /// All of them, the finest first.
    fn levels(&self) -> Vec<u8>;
    /// Columns and rows of one.
    fn size(&self, level: u8) -> [u32; 2];
    /// The farthest depth that is held for a cell, `1/w`.
    fn farthest(&self, cell: PyramidCell) -> f32;
    /// Whether a cell holds less than is known below it.
    fn is_stale(&self, cell: PyramidCell) -> bool;
    /// The level whose cells are stale as wholes, for those of a level below.
    fn stale_level(&self, level: u8) -> u8;
    /// A short name.
    fn title(&self, level: u8) -> String;
    /// Depths of the pixels, row by row.
    fn depths(&self) -> &[f32];
    /// What is begun of nearer layers, pixel by pixel, and the far plane's depth where nothing is.
    fn begun(&self) -> Option<&[f32]> {
        None
    }
}

impl<S: Faces> Levels for Buffer<S> {
    fn levels(&self) -> Vec<u8> {
        (0..=self.pyramid().root() as u8).collect()
    }
    fn size(&self, level: u8) -> [u32; 2] {
        self.pyramid().size(level.into()).into()
    }
    fn farthest(&self, cell: PyramidCell) -> f32 {
        Self::farthest(self, cell)
    }
    /// Something was drawn under it since it was read.
    fn is_stale(&self, cell: PyramidCell) -> bool {
        cell.level > 0 && self.pyramid().is_stale_below(cell)
    }
    fn stale_level(&self, level: u8) -> u8 {
        level.max(if level == 0 { 0 } else { 4.min(self.pyramid().root() as u8) })
    }
    fn title(&self, level: u8) -> String {
        let [columns, rows] = Levels::size(self, level);
        match level {
            // Short: with its size it would reach the next level's name.
            0 => "level 0: the z-buffer".into(),
            l => format!("level {l}, {columns} × {rows}"),
        }
    }
    fn depths(&self) -> &[f32] {
        &self.target().depth
    }
}

/// Tiles as levels: pixels, tiles of 8×4 and blocks of 32×16.
pub struct TileLevels<'a> {
    tiles: &'a Tiles,
    depths: Vec<f32>,
    begun: Vec<f32>,
}

impl<S: Faces> Tiled<S> {
    /// For pictures: all pixels are worked out, in a copy.
    pub fn levels(&self) -> TileLevels<'_> {
        let tiles = self.tiles();
        let depths = if self.projected().is_some() { tiles.clone().depths(Isa::best()) } else { Vec::new() };
        let far = self.projected().map_or(0.0, |p| 1.0 / p.view.eye.far);
        let [columns, rows] = tiles.size(0);
        let begun = |at: u32| {
            let (x, y) = (at % columns, at / columns);
            let cell = PyramidCell { level: PyramidCell::TILE, x: (x / 8) as u16, y: (y / 4) as u16 };
            let (mask, near) = tiles.begun(cell);
            if mask >> (y % 4 * 8 + x % 8) & 1 == 1 { near } else { far }
        };
        TileLevels { tiles, depths, begun: (0..columns * rows).map(begun).collect() }
    }
}

impl Levels for TileLevels<'_> {
    fn levels(&self) -> Vec<u8> {
        vec![0, PyramidCell::TILE, PyramidCell::BLOCK]
    }
    fn size(&self, level: u8) -> [u32; 2] {
        self.tiles.size(level)
    }
    fn farthest(&self, cell: PyramidCell) -> f32 {
        if cell.level == 0 {
            return self.depths[cell.y as usize * self.tiles.size(0)[0] as usize + cell.x as usize];
        }
        self.tiles.held(cell)
    }
    /// A block is where none of its tiles is as far as it holds.
    fn is_stale(&self, cell: PyramidCell) -> bool {
        let [columns, rows] = self.tiles.size(PyramidCell::TILE).map(|n| n as u16);
        let tile = |k: u16| (4 * cell.x + k % 4, 4 * cell.y + k / 4);
        let tiles = (0..16).map(tile).filter(|&(x, y)| x < columns && y < rows);
        let held = |(x, y)| self.tiles.held(PyramidCell { level: PyramidCell::TILE, x, y });
        cell.level == PyramidCell::BLOCK && tiles.map(held).all(|held| held > self.tiles.held(cell))
    }
    fn stale_level(&self, level: u8) -> u8 {
        level
    }
    fn title(&self, level: u8) -> String {
        let [columns, rows] = self.size(level);
        match level {
            PyramidCell::TILE => format!("tiles, {columns} × {rows}"),
            PyramidCell::BLOCK => format!("blocks, {columns} × {rows}"),
            _ => "pixels".into(),
        }
    }
    fn depths(&self) -> &[f32] {
        &self.depths
    }
    fn begun(&self) -> Option<&[f32]> {
        Some(&self.begun)
    }
}
