//! A viewport's own color and depth, its uniforms, and what it showed last.

use eframe::wgpu;

use super::camera::SpaceCamera;
use super::pack::{NEVER, SegmentWords, step_word};
use super::pipelines::{COLOR_FORMAT, DEPTH_FORMAT, Pipelines};
use super::style::{ColorBy, NodeBoxes, Shown, SpaceStyle, Surface};
use crate::drawing::Role;
use crate::render::theme::Hatch;

/// Words of the uniform `Frame`.
const FRAME_WORDS: usize = 4 * (11 + 6 * Role::ALL.len());

/// The part of a whole picture that a target shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tile {
    pub whole_px: [u32; 2],
    pub origin_px: [u32; 2],
    pub size_px: [u32; 2],
}

pub(super) struct Target {
    pub size_px: [u32; 2],
    pub color: wgpu::Texture,
    pub color_view: wgpu::TextureView,
    pub depth_view: wgpu::TextureView,
    pub blit: wgpu::BindGroup,
    uniforms: wgpu::Buffer,
    pub frame: wgpu::BindGroup,
    /// Outlines of highlights; few.
    pub outlines: wgpu::Buffer,
    pub outline_count: u32,
    /// What the texture holds, so that an unchanged viewport is not drawn again.
    pub shows: Option<(SpaceCamera, SpaceStyle, u64)>,
}

impl Target {
    pub fn new(device: &wgpu::Device, pipelines: &Pipelines, size_px: [u32; 2]) -> Self {
        let texture = |format, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("viewport"),
                size: wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let color = texture(
            COLOR_FORMAT,
            attachment | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC,
        );
        let color_view = color.create_view(&Default::default());
        let uniforms = buffer(device, "frame", 4 * FRAME_WORDS as u64, wgpu::BufferUsages::UNIFORM);
        let frame = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("frame"),
            layout: &pipelines.frame_layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniforms.as_entire_binding() }],
        });
        let blit = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("blit"),
            layout: &pipelines.blit_layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(&color_view),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::Sampler(&pipelines.nearest),
                },
            ],
        });
        Self {
            size_px,
            depth_view: texture(DEPTH_FORMAT, attachment).create_view(&Default::default()),
            color,
            color_view,
            blit,
            frame,
            uniforms,
            outlines: buffer(
                device,
                "outlines",
                16 * size_of::<SegmentWords>() as u64,
                wgpu::BufferUsages::VERTEX,
            ),
            outline_count: 0,
            shows: None,
        }
    }

    /// Hands over what one picture needs: uniforms and outlines.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        camera: &SpaceCamera,
        style: &SpaceStyle,
        tile: Tile,
        outlines: &[SegmentWords],
    ) {
        queue.write_buffer(&self.uniforms, 0, bytemuck::cast_slice(&frame_words(camera, style, tile)));
        let bytes = bytemuck::cast_slice(outlines);
        if bytes.len() as u64 > self.outlines.size() {
            self.outlines = buffer(
                device,
                "outlines",
                bytes.len().next_power_of_two() as u64,
                wgpu::BufferUsages::VERTEX,
            );
        }
        queue.write_buffer(&self.outlines, 0, bytes);
        self.outline_count = outlines.len() as u32;
    }

    pub fn bytes(&self) -> usize {
        8 * self.size_px[0] as usize * self.size_px[1] as usize
    }
}

/// An empty buffer to write to.
pub(super) fn buffer(
    device: &wgpu::Device,
    label: &str,
    size: u64,
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    let size = size.max(16);
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// A color byte triple and a fourth number.
fn color(c: [u8; 3], w: f32) -> [u32; 4] {
    let c = c.map(|v| (f32::from(v) / 255.0).to_bits());
    [c[0], c[1], c[2], w.to_bits()]
}

/// Number of a hatch, as in the shader.
fn hatch(hatch: Hatch) -> f32 {
    match hatch {
        Hatch::None => 0.0,
        Hatch::Diagonal => 1.0,
        Hatch::Cross => 2.0,
        Hatch::Dots => 3.0,
        Hatch::Falling => 4.0,
    }
}

/// The uniform `Frame` of the shaders, word for word.
fn frame_words(camera: &SpaceCamera, style: &SpaceStyle, tile: Tile) -> Vec<u32> {
    let mut words = Vec::with_capacity(FRAME_WORDS);
    let mut floats = |v: [f32; 4]| words.extend(v.map(f32::to_bits));
    let projection = camera.projection(tile.whole_px);
    for row in &projection.rows[..3] {
        floats(row.extend(0.0).to_array());
    }
    floats(camera.position.extend(camera.near).to_array());
    let [constant, slope] = camera.reversed_depth();
    floats([constant, slope, style.ghost, style.behind]);
    let [w, h] = tile.size_px.map(|v| v as f32);
    let [whole_w, whole_h] = tile.whole_px.map(|v| v as f32);
    let [x, y] = tile.origin_px.map(|v| v as f32);
    floats([w, h, style.pixels_per_point, 0.0]);
    floats([whole_w / w, whole_h / h, (whole_w - 2.0 * x) / w - 1.0, 1.0 - (whole_h - 2.0 * y) / h]);
    floats([x, y, 0.0, 0.0]);
    let (normal, offset) = style.section.unwrap_or_default();
    floats(normal.extend(offset).to_array());

    let wires = match style.surface {
        Surface::Solid | Surface::Hidden => 0,
        Surface::Both => 1,
        Surface::Wireframe => 2,
    };
    words.extend([
        step(style),
        (style.color_by == ColorBy::State).into(),
        wires,
        style.section.is_some().into(),
    ]);
    words.extend([
        mask(style, Shown::Solid),
        mask(style, Shown::Ghost),
        // Boxes: of all roles, but for those of nodes that have a color of their own.
        if style.stand_ins { !(1 << Role::Approximated as u32) } else { u32::MAX },
        (style.nodes == NodeBoxes::Frontier).into(),
    ]);
    let ppp = style.pixels_per_point;
    let paints = &style.palette.paints;
    words.extend(paints.iter().flat_map(|p| color(p.flat, 1.0)));
    words.extend(paints.iter().flat_map(|p| color(p.stroke, p.width_pt * ppp)));
    words.extend(paints.iter().flat_map(|p| p.dash_pt.map(|d| (d * ppp).to_bits())));
    words.extend(paints.iter().flat_map(|p| color(p.dot, p.halo_pt.1 * ppp)));
    words.extend(paints.iter().flat_map(|p| color(p.halo_pt.0, hatch(p.hatch))));
    words.extend(paints.iter().flat_map(|p| color(p.fill.0, p.fill.1)));
    words
}

/// The step as shaders compare it: before what never happens.
pub(super) fn step(style: &SpaceStyle) -> u32 {
    step_word(u32::try_from(style.step).unwrap_or(u32::MAX)).min(NEVER - 1)
}

/// A bit for each role whose triangles are drawn this way.
pub(super) fn mask(style: &SpaceStyle, shown: Shown) -> u32 {
    let on = style.surface != Surface::Hidden;
    Role::ALL.iter().filter(|&&r| on && style.shown(r) == shown).map(|&r| 1 << r as u32).sum()
}
