//! Pictures one after another as one animated PNG file. After the first picture only the rectangle that
//! changed is written.

use std::io;
use std::sync::{Arc, Mutex, PoisonError};

use png::{BitDepth, BlendOp, ColorType, Compression, DisposeOp, Encoder, Writer};

use super::RenderError;
use super::png::describe;
use crate::drawing::Pixels;

/// How long the last picture stays, in times of the others, before the first one follows again.
const REST: u16 = 10;

/// An animated PNG file that is being written.
pub struct Animation {
    count: u32,
    /// Milliseconds that a picture stays.
    delay_ms: u16,
    dpi: f32,
    texts: Vec<(&'static str, String)>,
    bytes: Bytes,
    begun: Option<(Writer<Bytes>, Pixels)>,
    pushed: u32,
}

/// What the encoder writes into and we read at the end.
#[derive(Clone, Default)]
struct Bytes(Arc<Mutex<Vec<u8>>>);

impl io::Write for Bytes {
    fn write(&mut self, part: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(part);
        Ok(part.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Animation {
    /// Pictures a second.
    pub const RATES: std::ops::RangeInclusive<f32> = 0.1..=60.0;

    /// A file of `count` opaque pictures, of so many a second, with texts and a resolution.
    pub fn new(count: usize, rate: f32, dpi: f32, texts: Vec<(&'static str, String)>) -> Self {
        let rate = rate.clamp(*Self::RATES.start(), *Self::RATES.end());
        Self {
            count: count as u32,
            delay_ms: (1000.0 / rate).round() as u16,
            dpi,
            texts,
            bytes: Bytes::default(),
            begun: None,
            pushed: 0,
        }
    }

    /// Adds the next picture, which has the size of the first.
    ///
    /// # Errors
    /// If it has another size, or there are more than were said.
    pub fn push(&mut self, pixels: Pixels) -> Result<(), RenderError> {
        let failed = |e: png::EncodingError| RenderError::Picture(e.to_string());
        let is_last = self.pushed + 1 == self.count;
        let delay = if is_last { self.delay_ms.saturating_mul(REST) } else { self.delay_ms };
        let Some((writer, last)) = &mut self.begun else {
            let mut writer = self.begin(&pixels, delay).map_err(failed)?;
            writer.write_image_data(&rgb(&pixels, [0, 0, pixels.width, pixels.height])).map_err(failed)?;
            self.begun = Some((writer, pixels));
            self.pushed = 1;
            return Ok(());
        };
        if (pixels.width, pixels.height) != (last.width, last.height) {
            return Err(RenderError::Picture("pictures of a sequence have different sizes".into()));
        }
        let [x, y, width, height] = changed(last, &pixels);
        writer.set_frame_position(0, 0).map_err(failed)?;
        writer.set_frame_dimension(width, height).map_err(failed)?;
        writer.set_frame_position(x, y).map_err(failed)?;
        writer.set_frame_delay(delay, 1000).map_err(failed)?;
        writer.write_image_data(&rgb(&pixels, [x, y, width, height])).map_err(failed)?;
        *last = pixels;
        self.pushed += 1;
        Ok(())
    }

    fn begin(&self, pixels: &Pixels, delay_ms: u16) -> Result<Writer<Bytes>, png::EncodingError> {
        let mut encoder = Encoder::new(self.bytes.clone(), pixels.width.max(1), pixels.height.max(1));
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::Balanced);
        // Zero times: for ever.
        encoder.set_animated(self.count, 0)?;
        encoder.set_frame_delay(delay_ms, 1000)?;
        encoder.set_dispose_op(DisposeOp::None)?;
        encoder.set_blend_op(BlendOp::Source)?;
        let texts: Vec<(&str, &str)> = self.texts.iter().map(|(key, text)| (*key, text.as_str())).collect();
        describe(&mut encoder, &texts, Some(self.dpi));
        encoder.write_header()
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// If there are fewer pictures than were said.
    pub fn finish(self) -> Result<Vec<u8>, RenderError> {
        let Some((writer, _)) = self.begun.filter(|_| self.pushed == self.count) else {
            return Err(RenderError::Picture("pictures of the sequence are missing".into()));
        };
        writer.finish().map_err(|e| RenderError::Picture(e.to_string()))?;
        let bytes = std::mem::take(&mut *self.bytes.0.lock().unwrap_or_else(PoisonError::into_inner));
        Ok(bytes)
    }
}

/// Left, top, width and height of what differs between two pictures of one size; one pixel if nothing does.
fn changed(a: &Pixels, b: &Pixels) -> [u32; 4] {
    let stride = 4 * a.width as usize;
    let rows = || a.rgba.chunks_exact(stride).zip(b.rgba.chunks_exact(stride));
    let differs = |(a, b): (&[u8], &[u8])| a != b;
    let Some(top) = rows().position(differs) else { return [0, 0, 1, 1] };
    let bottom = rows().rposition(differs).unwrap_or(top);
    let (mut left, mut right) = (a.width as usize, 0);
    for (a, b) in rows().skip(top).take(bottom - top + 1) {
        let mut pixels = a.as_chunks::<4>().0.iter().zip(b.as_chunks::<4>().0);
        let Some(first) = pixels.position(|(a, b)| a != b) else { continue };
        left = left.min(first);
        right = right.max(first + pixels.rposition(|(a, b)| a != b).map_or(0, |i| i + 1));
    }
    [left as u32, top as u32, (right + 1 - left) as u32, (bottom + 1 - top) as u32]
}

/// The colors of a rectangle, row by row.
fn rgb(pixels: &Pixels, [x, y, width, height]: [u32; 4]) -> Vec<u8> {
    let (stride, left) = (4 * pixels.width as usize, 4 * x as usize);
    let rows = pixels.rgba.chunks_exact(stride).skip(y as usize).take(height as usize);
    let row = |row: &[u8]| row[left..left + 4 * width as usize].to_vec();
    rows.flat_map(row)
        .collect::<Vec<u8>>()
        .as_chunks::<4>()
        .0
        .iter()
        .flat_map(|p| [p[0], p[1], p[2]])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    /// 5 × 4 pixels, gray, with some in another color.
    fn picture(marked: &[(usize, u8)]) -> Pixels {
        let mut rgba = vec![200u8; 5 * 4 * 4];
        rgba.chunks_exact_mut(4).for_each(|p| p[3] = 255);
        marked.iter().for_each(|(at, value)| rgba[4 * at] = *value);
        Pixels { width: 5, height: 4, rgba: rgba.into() }
    }

    #[test]
    fn what_changed_is_found() {
        let plain = picture(&[]);
        assert_eq!(changed(&plain, &plain), [0, 0, 1, 1]);
        assert_eq!(changed(&plain, &picture(&[(7, 9)])), [2, 1, 1, 1]);
        assert_eq!(changed(&plain, &picture(&[(1, 9), (13, 9)])), [1, 0, 3, 3]);
        assert_eq!(changed(&plain, &picture(&[(0, 9), (19, 9)])), [0, 0, 5, 4]);
    }

    #[test]
    fn a_reader_sees_every_picture_and_the_recipe() {
        let pictures = [&[][..], &[(7, 9)], &[(7, 9)], &[(1, 3), (18, 5)]].map(picture);
        let texts = vec![(super::super::png::RECIPE_KEY, "made so".to_owned())];
        let mut animation = Animation::new(pictures.len(), 4.0, 150.0, texts);
        pictures.iter().for_each(|p| animation.push(p.clone()).expect("a picture"));
        let bytes = animation.finish().expect("a file");
        assert_eq!(super::super::png::recipe(&bytes).as_deref(), Some("made so"));
        let mut reader = png::Decoder::new(Cursor::new(&bytes)).read_info().expect("a file");
        let control = reader.info().animation_control.expect("an animation");
        assert_eq!((control.num_frames, control.num_plays), (4, 0));
        let mut shown = vec![0; 5 * 4 * 3];
        for (i, wanted) in pictures.iter().enumerate() {
            let mut part = vec![0; 5 * 4 * 3];
            reader.next_frame(&mut part).expect("a picture");
            let frame = *reader.info().frame_control().expect("its place");
            let (w, h) = (frame.width as usize, frame.height as usize);
            for y in 0..h {
                let at = 3 * ((y + frame.y_offset as usize) * 5 + frame.x_offset as usize);
                shown[at..at + 3 * w].copy_from_slice(&part[3 * y * w..3 * (y + 1) * w]);
            }
            assert_eq!(shown, rgb(wanted, [0, 0, 5, 4]), "picture {i}");
            assert_eq!(frame.delay_num, if i == 3 { 2500 } else { 250 });
        }
    }

    #[test]
    fn other_sizes_and_other_numbers_are_refused() {
        let mut animation = Animation::new(2, 10.0, 150.0, Vec::new());
        animation.push(picture(&[])).expect("a picture");
        let other = Pixels { width: 1, height: 1, rgba: vec![0, 0, 0, 255].into() };
        assert!(animation.push(other).is_err());
        assert!(animation.finish().is_err());
        assert!(Animation::new(0, 10.0, 150.0, Vec::new()).finish().is_err());
    }
}
