//! The screen of the machine: regions of pixels, their queues of messages, and the renderers that hold them.

use std::cmp::Reverse;
use std::collections::VecDeque;

use super::machine::{Allocation, Machine};
use crate::geometry::PixelRect;
use crate::raster::PyramidCell;

/// Side of a region of the screen in pixels: a renderer's array of processors (Section 5).
const REGION_PX: u32 = 1 << REGION_LEVEL;
/// The level of the pyramid whose cells are regions.
const REGION_LEVEL: u8 = 7;

/// Regions and renderers of one frame.
#[derive(Default)]
pub(super) struct Screen {
    width: u32,
    height: u32,
    columns: u32,
    /// Messages of each region, by number, in the order of arrival.
    queues: Vec<VecDeque<usize>>,
    /// The renderer that holds each region.
    holder: Vec<Option<u16>>,
    busy: Vec<bool>,
}

impl Screen {
    /// Gives regions to renderers: all of them at once, or the busiest of the last frame (Section 5.1).
    /// `load`: primitives that each region received in the last frame.
    pub fn new(width: u32, height: u32, machine: &Machine, load: &mut Vec<u32>) -> Self {
        let columns = width.div_ceil(REGION_PX);
        let regions = (columns * height.div_ceil(REGION_PX)) as usize;
        let renderers = machine.renderers as usize;
        // Loads only order the regions, so those of a window of another size do no harm.
        load.resize(regions, 0);
        // Section 5.1, static: "the only solution is to have the renderers work on several regions at once".
        let mut holder: Vec<_> = (0..regions).map(|r| Some((r % renderers) as u16)).collect();
        if machine.allocation == Allocation::Dynamic {
            // Section 5.1, dynamic: "the regions that received the most primitives last frame are assigned
            // renderers first". Equal ones go by number, so that every run is the same.
            holder.fill(None);
            let mut busiest: Vec<usize> = (0..regions).collect();
            busiest.sort_by_key(|&r| (Reverse(load[r]), r));
            for (renderer, region) in busiest.into_iter().take(renderers).enumerate() {
                holder[region] = Some(renderer as u16);
            }
        }
        Self {
            width,
            height,
            columns,
            queues: vec![VecDeque::new(); regions],
            holder,
            busy: vec![false; renderers],
        }
    }
    /// How many regions there are.
    pub fn count(&self) -> usize {
        self.queues.len()
    }
    /// The pixels of a region.
    pub fn window(&self, region: u32) -> PixelRect {
        // The last column and row may reach past the image, and are cut.
        let (x, y) = (region % self.columns * REGION_PX, region / self.columns * REGION_PX);
        PixelRect { x0: x, x1: (x + REGION_PX).min(self.width), y0: y, y1: (y + REGION_PX).min(self.height) }
    }
    /// The cell of the pyramid that a region is.
    pub fn cell(&self, region: u32) -> PyramidCell {
        // Regions and cells of their level are counted alike, from the upper left.
        let (x, y) = ((region % self.columns) as u16, (region / self.columns) as u16);
        PyramidCell { level: REGION_LEVEL, x, y }
    }
    /// The regions that a rectangle meets, row by row.
    pub fn regions(&self, pixels: PixelRect) -> Vec<u32> {
        if pixels.is_empty() {
            return vec![];
        }
        let rows = pixels.y0 / REGION_PX..=(pixels.y1 - 1) / REGION_PX;
        let columns = pixels.x0 / REGION_PX..=(pixels.x1 - 1) / REGION_PX;
        rows.flat_map(|row| columns.clone().map(move |c| row * self.columns + c)).collect()
    }
    /// Whether a renderer holds the region.
    pub fn is_held(&self, region: u32) -> bool {
        self.holder[region as usize].is_some()
    }
    /// Queues a message; returns the renderer that holds the region, if any does.
    pub fn arrive(&mut self, region: u32, message: usize) -> Option<u16> {
        self.queues[region as usize].push_back(message);
        self.holder[region as usize]
    }
    /// The oldest message of the regions that a free renderer holds, with its region. The renderer is then
    /// busy.
    pub fn begin(&mut self, renderer: u16) -> Option<(usize, u32)> {
        if self.busy[renderer as usize] {
            return None;
        }
        // In a region messages go as they arrived; between regions the one that was made first.
        let held = (0..self.queues.len()).filter(|&k| self.holder[k] == Some(renderer));
        let (message, region) = held.filter_map(|k| Some((*self.queues[k].front()?, k))).min()?;
        self.queues[region].pop_front();
        self.busy[renderer as usize] = true;
        Some((message, region as u32))
    }
    /// The renderer is free again.
    pub fn end(&mut self, renderer: u16) {
        self.busy[renderer as usize] = false;
    }
    /// Dynamic allocation, when all else is done: regions with messages that no renderer holds go to the
    /// renderers in turn. Returns these.
    pub fn release(&mut self) -> Vec<u16> {
        let renderers = self.busy.len();
        let free: Vec<usize> = (0..self.queues.len())
            // A region that nothing was sent to needs no renderer.
            .filter(|&r| self.holder[r].is_none() && !self.queues[r].is_empty())
            .collect();
        let turn = free.into_iter().enumerate().map(|(k, region)| {
            let renderer = (k % renderers) as u16;
            self.holder[region] = Some(renderer);
            renderer
        });
        turn.collect()
    }
}
