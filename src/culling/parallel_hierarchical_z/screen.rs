//! The screen of the machine: regions of pixels, the renderers that hold them, and their queues of messages.

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
    allocation: Allocation,
    /// Messages of each region that no renderer holds, in the order of arrival.
    waiting: Vec<VecDeque<usize>>,
    /// The renderer that holds each region.
    holder: Vec<Option<u16>>,
    /// Primitives that each region received in the last frame.
    load: Vec<u32>,
    renderers: Vec<Renderer>,
}

#[derive(Clone, Default)]
struct Renderer {
    /// Messages for it, of all regions that it holds, in the order of arrival.
    queue: VecDeque<usize>,
    is_busy: bool,
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
        let mut screen = Self {
            width,
            height,
            columns,
            allocation: machine.allocation,
            waiting: vec![VecDeque::new(); regions],
            // Section 5.1, static: "the only solution is to have the renderers work on several regions at
            // once".
            holder: (0..regions).map(|r| Some((r % renderers) as u16)).collect(),
            load: std::mem::take(load),
            renderers: vec![Renderer::default(); renderers],
        };
        *load = vec![0; regions];
        if screen.allocation == Allocation::Dynamic {
            // Section 5.1, dynamic: "the regions that received the most primitives last frame are assigned
            // renderers first".
            screen.holder.fill(None);
            let mut busiest: Vec<usize> = (0..regions).collect();
            busiest.sort_by_key(|&r| screen.turn(r));
            for (renderer, region) in busiest.into_iter().take(renderers).enumerate() {
                screen.holder[region] = Some(renderer as u16);
            }
        }
        screen
    }
    /// Regions by turn: the busiest first; equal ones by number, so that every run is the same.
    fn turn(&self, region: usize) -> (Reverse<u32>, usize) {
        (Reverse(self.load[region]), region)
    }
    /// How many regions there are.
    pub fn count(&self) -> usize {
        self.holder.len()
    }
    /// How many renderers there are.
    pub fn renderers(&self) -> u16 {
        self.renderers.len() as u16
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
    /// The regions that a renderer holds.
    pub fn held_by(&self, renderer: u16) -> Vec<u32> {
        (0..self.count() as u32).filter(|&r| self.holder[r as usize] == Some(renderer)).collect()
    }
    /// Queues a message for a region; returns the renderer that may begin with it: the one that holds the
    /// region, or one that is free to take it.
    pub fn arrive(&mut self, region: u32, message: usize) -> Option<u16> {
        if let Some(renderer) = self.holder[region as usize] {
            self.arrive_at(renderer, message);
            return Some(renderer);
        }
        self.waiting[region as usize].push_back(message);
        self.renderers.iter().position(|r| !r.is_busy && r.queue.is_empty()).map(|r| r as u16)
    }
    /// Queues a message for a renderer, whatever it holds.
    pub fn arrive_at(&mut self, renderer: u16, message: usize) {
        self.renderers[renderer as usize].queue.push_back(message);
    }
    /// The oldest message for a renderer that is free, if there is one. The renderer is then busy.
    pub fn begin(&mut self, renderer: u16) -> Option<usize> {
        let r = &mut self.renderers[renderer as usize];
        if r.is_busy {
            return None;
        }
        let message = r.queue.pop_front()?;
        r.is_busy = true;
        Some(message)
    }
    /// Section 5.1, dynamic: "when a renderer finishes it is assigned the next available region", one at a
    /// time. Whether this one, if it has nothing to do, takes another region.
    pub fn take_next(&mut self, renderer: u16) -> bool {
        let r = &self.renderers[renderer as usize];
        if self.allocation == Allocation::Static || r.is_busy || !r.queue.is_empty() {
            return false;
        }
        // A region that nothing was sent to needs no renderer.
        let available =
            (0..self.count()).filter(|&r| self.holder[r].is_none() && !self.waiting[r].is_empty());
        let Some(next) = available.min_by_key(|&r| self.turn(r)) else { return false };
        self.holder.iter_mut().filter(|h| **h == Some(renderer)).for_each(|h| *h = None);
        self.holder[next] = Some(renderer);
        self.renderers[renderer as usize].queue = std::mem::take(&mut self.waiting[next]);
        true
    }
    /// The renderer is free again.
    pub fn end(&mut self, renderer: u16) {
        self.renderers[renderer as usize].is_busy = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn screen(allocation: Allocation, renderers: u32, load: &[u32]) -> Screen {
        let machine = Machine { renderers, allocation, ..Machine::default() };
        Screen::new(128 * load.len() as u32, 100, &machine, &mut load.to_vec())
    }

    /// Messages of several regions go in the order of arrival, not of their numbers.
    #[test]
    fn a_renderer_takes_messages_as_they_arrive() {
        let mut screen = screen(Allocation::Static, 1, &[0, 0, 0]);
        for (region, message) in [(2, 7), (0, 3), (2, 1), (1, 0)] {
            assert_eq!(screen.arrive(region, message), Some(0));
        }
        let mut taken = Vec::new();
        while let Some(message) = screen.begin(0) {
            assert_eq!(screen.begin(0), None, "busy");
            taken.push(message);
            screen.end(0);
        }
        assert_eq!(taken, [7, 3, 1, 0]);
    }

    /// The busiest region is held first; the others are taken by turn as soon as the renderer is free.
    #[test]
    fn a_free_renderer_takes_the_next_busiest_region() {
        let mut screen = screen(Allocation::Dynamic, 1, &[5, 9, 2, 5]);
        assert_eq!([0, 1, 2, 3].map(|r| screen.is_held(r)), [false, true, false, false]);
        assert_eq!(screen.arrive(2, 0), Some(0), "free to take it");
        assert!(screen.take_next(0));
        assert_eq!((screen.begin(0), screen.held_by(0)), (Some(0), vec![2]), "one region at a time");
        for (region, message) in [(3, 1), (1, 2), (0, 3), (2, 4), (3, 5)] {
            assert_eq!(screen.arrive(region, message), (region == 2).then_some(0), "busy");
        }
        let mut taken = Vec::new();
        screen.end(0);
        loop {
            screen.take_next(0);
            let Some(message) = screen.begin(0) else { break };
            taken.push((message, screen.held_by(0)[0]));
            screen.end(0);
        }
        assert_eq!(taken, [(4, 2), (2, 1), (3, 0), (1, 3), (5, 3)]);
    }
}
