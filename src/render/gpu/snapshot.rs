//! A viewport as a picture of any size, without a window.
//!
//! The picture is drawn tile by tile, each pixel as a square of `samples` by `samples`, and averaged on the
//! CPU, so its size is bounded by memory and not by the device, and its edges are smooth.

use eframe::wgpu;

use super::SpaceLayer;
use super::camera::SpaceCamera;
use super::headless::{GpuError, read};
use super::style::SpaceStyle;
use super::target::{Target, Tile};

/// Width, height and RGBA bytes, not premultiplied, row 0 at the top.
pub type Picture = (u32, u32, Vec<u8>);

/// Largest side of a picture: 400 megapixels and 1.6 GB at most.
const MOST_PX: u32 = 20_000;
/// Largest side of a tile before averaging; every backend has textures of this size.
const TILE_PX: u32 = 2048;

impl SpaceLayer {
    /// Draws a picture of `size_px` with `samples` by `samples` samples a pixel (1 to 8). Waits.
    ///
    /// # Errors
    /// [`GpuError::Size`] for a side of 0 or above 20 000, [`GpuError::Read`] if the device is lost.
    pub fn snapshot(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        size_px: [u32; 2],
        samples: u32,
        camera: &SpaceCamera,
        style: &SpaceStyle,
    ) -> Result<Picture, GpuError> {
        let [width, height] = size_px;
        if !(1..=MOST_PX).contains(&width) || !(1..=MOST_PX).contains(&height) {
            return Err(GpuError::Size { width, height, most: MOST_PX });
        }
        let samples = samples.clamp(1, 8);
        let fine = SpaceStyle { pixels_per_point: style.pixels_per_point * samples as f32, ..style.clone() };
        let outlines = self.outlines(&style.highlights);
        let side = TILE_PX / samples;
        let tile_px = [width.min(side), height.min(side)];
        let mut target = Target::new(device, &self.pipelines, tile_px.map(|v| v * samples));
        let mut rgba = vec![0; width as usize * height as usize * 4];
        for y in (0..height).step_by(tile_px[1] as usize) {
            for x in (0..width).step_by(tile_px[0] as usize) {
                let tile = Tile {
                    whole_px: size_px.map(|v| v * samples),
                    origin_px: [x * samples, y * samples],
                    size_px: target.size_px,
                };
                target.prepare(device, queue, camera, &fine, tile, &outlines);
                let mut encoder = device.create_command_encoder(&Default::default());
                self.draw(&mut encoder, &target, &fine);
                queue.submit([encoder.finish()]);
                let pixels = averaged(&read(device, queue, &target.color)?, target.size_px[0], samples);
                let (columns, rows) =
                    (tile_px[0].min(width - x) as usize, tile_px[1].min(height - y) as usize);
                for row in 0..rows {
                    let from = row * tile_px[0] as usize * 4;
                    let to = ((y as usize + row) * width as usize + x as usize) * 4;
                    rgba[to..to + columns * 4].copy_from_slice(&pixels[from..from + columns * 4]);
                }
            }
        }
        Ok((width, height, straight(rgba)))
    }
}

/// Each square of `samples` by `samples` pixels averaged.
fn averaged(fine: &[u8], fine_width: u32, samples: u32) -> Vec<u8> {
    if samples == 1 {
        return fine.to_vec();
    }
    let (n, stride) = (samples as usize, fine_width as usize * 4);
    let mut out = Vec::with_capacity(fine.len() / (n * n));
    for band in fine.chunks_exact(stride * n) {
        for x in (0..stride).step_by(4 * n) {
            for channel in 0..4 {
                let sum: u32 =
                    (0..n * n).map(|k| u32::from(band[k / n * stride + x + k % n * 4 + channel])).sum();
                out.push(((sum + samples * samples / 2) / (samples * samples)) as u8);
            }
        }
    }
    out
}

/// Premultiplied colors divided by their opacity.
pub(super) fn straight(mut rgba: Vec<u8>) -> Vec<u8> {
    for pixel in rgba.as_chunks_mut::<4>().0 {
        let alpha = u32::from(pixel[3]);
        if alpha != 0 && alpha != 255 {
            for channel in &mut pixel[..3] {
                *channel = ((u32::from(*channel) * 255 + alpha / 2) / alpha).min(255) as u8;
            }
        }
    }
    rgba
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn averaging_and_straightening_by_hand() {
        // Two rows of four pixels, averaged two by two.
        let fine: Vec<u8> = (0..8u8).flat_map(|i| [i * 10, 0, 255, 255]).collect();
        assert_eq!(averaged(&fine, 4, 2), [25, 0, 255, 255, 45, 0, 255, 255]);
        assert_eq!(
            straight(vec![64, 0, 128, 128, 7, 8, 9, 0, 1, 2, 3, 255]),
            [128, 0, 255, 128, 7, 8, 9, 0, 1, 2, 3, 255]
        );
    }
}
