//! What holds something on several levels, as pictures show it; depths in a z-buffer with its pyramid, or in
//! tiles.

use super::buffer::Buffer;
use super::evidence::{place, units};
use super::faces::Faces;
use super::tiled::Tiled;
use crate::method::evidence::short;
use crate::raster::{DepthScale, Isa, PyramidCell, Tiles, shade_depth};

/// Levels, from the finest up.
pub trait Levels {
    /// All of them, the finest first.
    fn levels(&self) -> Vec<u8>;
    /// Columns and rows of one.
    fn size(&self, level: u8) -> [u32; 2];
    /// Sides of the cells of one in pixels of the image, as powers of two.
    fn shifts(&self, level: u8) -> [u32; 2] {
        PyramidCell::shifts(level)
    }
    /// What they are as a whole.
    fn name(&self) -> &'static str;
    /// A short name of one.
    fn title(&self, level: u8) -> String;
    /// Colors of cells of one level, RGBA; `far`: the depth of an empty pixel.
    fn shades(&self, cells: &[PyramidCell], far: f32, scale: DepthScale) -> Vec<u8>;
    /// What a cell holds, as it stands in it.
    fn value(&self, cell: PyramidCell, far: f32) -> String;
    /// The same in words.
    fn words(&self, cell: PyramidCell, far: f32) -> String;
    /// Whether a cell holds less than is known below it.
    fn is_stale(&self, _: PyramidCell) -> bool {
        false
    }
    /// The level whose cells are stale as wholes, for those of a level below.
    fn stale_level(&self, level: u8) -> u8 {
        level
    }
    /// Depths of the pixels, row by row; none where there are none.
    fn depths(&self) -> &[f32] {
        &[]
    }
    /// What is begun of nearer layers, pixel by pixel, and the far plane's depth where nothing is.
    fn begun(&self) -> Option<&[f32]> {
        None
    }
}

/// A depth as it stands in a cell: a view depth, or nothing where nothing was drawn.
fn depth_text(depth: f32, far: f32) -> String {
    if depth <= far { "empty".into() } else { short(units(depth)) }
}

impl<S: Faces> Levels for Buffer<S> {
    fn levels(&self) -> Vec<u8> {
        (0..=self.pyramid().root() as u8).collect()
    }
    fn size(&self, level: u8) -> [u32; 2] {
        self.pyramid().size(level.into()).into()
    }
    fn name(&self) -> &'static str {
        "z-pyramid"
    }
    fn shades(&self, cells: &[PyramidCell], far: f32, scale: DepthScale) -> Vec<u8> {
        // On the scale of the whole image: one gray is one depth on every level.
        let depths: Vec<f32> = cells.iter().map(|&c| self.farthest(c)).collect();
        shade_depth(&depths, &self.target().depth, far, scale)
    }
    fn value(&self, cell: PyramidCell, far: f32) -> String {
        depth_text(self.farthest(cell), far)
    }
    fn words(&self, cell: PyramidCell, far: f32) -> String {
        format!("{}: farthest {}", place(cell), depth_text(self.farthest(cell), far))
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
pub struct TileLevels {
    tiles: Tiles,
    depths: Vec<f32>,
    begun: Vec<f32>,
}

impl<S: Faces> Tiled<S> {
    /// For pictures: all pixels are worked out, in a copy.
    pub fn levels(&self) -> TileLevels {
        let tiles = self.settled();
        let depths = if self.projected().is_some() { tiles.clone().depths(Isa::best()) } else { Vec::new() };
        let far = self.projected().map_or(0.0, |p| 1.0 / p.view.eye.far);
        let [columns, rows] = tiles.size(0);
        let begun = |at: u32| {
            let (x, y) = (at % columns, at / columns);
            let cell = PyramidCell { level: PyramidCell::TILE, x: (x / 8) as u16, y: (y / 4) as u16 };
            let (mask, near) = tiles.begun(cell);
            if mask >> (y % 4 * 8 + x % 8) & 1 == 1 { near } else { far }
        };
        let begun = (0..columns * rows).map(begun).collect();
        TileLevels { tiles, depths, begun }
    }
}

impl TileLevels {
    /// The farthest depth that is held for a cell, `1/w`.
    fn farthest(&self, cell: PyramidCell) -> f32 {
        if cell.level == 0 {
            return self.depths[cell.y as usize * self.tiles.size(0)[0] as usize + cell.x as usize];
        }
        self.tiles.held(cell)
    }
}

impl Levels for TileLevels {
    fn levels(&self) -> Vec<u8> {
        vec![0, PyramidCell::TILE, PyramidCell::BLOCK]
    }
    fn size(&self, level: u8) -> [u32; 2] {
        self.tiles.size(level)
    }
    fn name(&self) -> &'static str {
        "z-pyramid"
    }
    fn shades(&self, cells: &[PyramidCell], far: f32, scale: DepthScale) -> Vec<u8> {
        let depths: Vec<f32> = cells.iter().map(|&c| self.farthest(c)).collect();
        shade_depth(&depths, &self.depths, far, scale)
    }
    fn value(&self, cell: PyramidCell, far: f32) -> String {
        depth_text(self.farthest(cell), far)
    }
    fn words(&self, cell: PyramidCell, far: f32) -> String {
        format!("{}: farthest {}", place(cell), depth_text(self.farthest(cell), far))
    }
    /// A block is where none of its tiles is as far as it holds.
    fn is_stale(&self, cell: PyramidCell) -> bool {
        let [columns, rows] = self.tiles.size(PyramidCell::TILE).map(|n| n as u16);
        let tile = |k: u16| (4 * cell.x + k % 4, 4 * cell.y + k / 4);
        let tiles = (0..16).map(tile).filter(|&(x, y)| x < columns && y < rows);
        let held = |(x, y)| self.tiles.held(PyramidCell { level: PyramidCell::TILE, x, y });
        cell.level == PyramidCell::BLOCK && tiles.map(held).all(|held| held > self.tiles.held(cell))
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
