//! Space on the graphics card: solid, wire and see-through triangles, node boxes and marks by state.
//!
//! A scene is uploaded once and a film once; at each vertex lies the *stamp* of its triangle, that is the
//! step and the role of its decision. What a step looks like follows in the shaders from one uniform, so
//! scrubbing through a film uploads nothing. Each viewport has a target of its own; all share the scene.
//!
//! Order of drawing: opaque triangles, then ghosts, areas and lines, which test depth and do not write it.
//! Lines behind surfaces show through faintly. Colors are mixed as sRGB values, as egui does.
//!
//! Units: pixels for targets, points for widths. Memory: 72 bytes a triangle, 36 a node, 8 a pixel.
//! Cost: every triangle that is shown, once a picture; an unchanged viewport costs nothing.

mod camera;
mod headless;
mod items;
mod pack;
mod pipelines;
mod snapshot;
mod style;
mod target;

pub use camera::SpaceCamera;
pub use headless::{GpuError, Headless, headless};
pub use items::items;
pub use snapshot::Picture;
pub use style::{ColorBy, NodeBoxes, Paint, Palette, Shown, SpaceStyle, Surface};

use std::collections::BTreeMap;
use std::sync::Arc;

use eframe::wgpu;
use glam::Vec3;
use wgpu::util::DeviceExt as _;

use crate::drawing::{Drawing, Layer, Role, Subject};
use crate::geometry::{Aabb, NodeId, ObjectId, PrimId, Solid};
use crate::index::Hierarchy;
use crate::scene::Scene;
use crate::trace::Stamps;
use pack::{Order, SegmentWords};
use pipelines::Pipelines;
use target::{Target, Tile};

/// Which viewport: the Eye's, the Observer's, or any other; the caller numbers them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ViewportId(pub u32);

/// Triangles of one pair of buffers: 48 MB, far below the least limit of any backend.
const CHUNK: usize = 1 << 20;
/// Vertices of a segment and of a node's twelve edges.
const SEGMENT_CORNERS: u32 = 6;
const NODE_CORNERS: u32 = 72;

struct Chunk {
    corners: wgpu::Buffer,
    stamps: wgpu::Buffer,
    triangles: usize,
    /// Once a film: corner numbers in the order of decisions.
    order: Option<(wgpu::Buffer, Order)>,
}

#[derive(Default)]
struct Nodes {
    buffer: Option<wgpu::Buffer>,
    /// First instance of each level, then the end.
    levels: Vec<u32>,
    bounds: Vec<Aabb<Vec3>>,
}

#[derive(Default)]
struct Marks {
    segments: Option<wgpu::Buffer>,
    areas: Option<wgpu::Buffer>,
    /// Layer, first segment, first corner of an area; the end comes last.
    layers: Vec<(Layer, u32, u32)>,
    end: (u32, u32),
}

/// The 3D viewports of one scene.
pub struct SpaceLayer {
    pipelines: Pipelines,
    scene: Option<Arc<Scene<Solid>>>,
    /// The triangles that are shown.
    prims: Vec<PrimId>,
    objects: Vec<Aabb<Vec3>>,
    chunks: Vec<Chunk>,
    nodes: Nodes,
    marks: Marks,
    targets: BTreeMap<ViewportId, Target>,
    /// Counts changes of what all viewports share.
    revision: u64,
}

impl SpaceLayer {
    /// An empty layer whose pictures can be copied into passes of `blit_format`.
    pub fn new(device: &wgpu::Device, blit_format: wgpu::TextureFormat) -> Self {
        Self {
            pipelines: Pipelines::new(device, blit_format),
            scene: None,
            prims: Vec::new(),
            objects: Vec::new(),
            chunks: Vec::new(),
            nodes: Nodes::default(),
            marks: Marks::default(),
            targets: BTreeMap::new(),
            revision: 0,
        }
    }

    /// Uploads those triangles of a scene that are shown, and forgets the film and marks of the last one.
    /// Once a scene.
    pub fn set_scene(&mut self, device: &wgpu::Device, scene: &Arc<Scene<Solid>>, prims: Vec<PrimId>) {
        let inner = pack::inner_sides(scene);
        self.chunks.clear();
        self.prims = prims;
        for prims in self.prims.chunks(CHUNK) {
            let upload = |label, contents: &[u8]| {
                let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
                device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                    label: Some(label),
                    contents,
                    usage,
                })
            };
            let corners = upload("corners", bytemuck::cast_slice(&pack::corners(scene, prims, &inner)));
            let stamps = upload("stamps", bytemuck::cast_slice(&pack::stamps(prims, None, &[])));
            self.chunks.push(Chunk { corners, stamps, triangles: prims.len(), order: None });
        }
        self.objects = vec![Aabb::empty(); scene.objects().len()];
        for &prim in scene.live() {
            let bounds = &mut self.objects[scene.object_of(prim).at()];
            *bounds = bounds.union(scene.prim_bounds(prim));
        }
        self.scene = Some(scene.clone());
        (self.nodes, self.marks) = Default::default();
        self.revision += 1;
    }

    /// Uploads when everything was decided. Once a film; `wrong` are the triangles, ascending, that were
    /// culled although they are visible. Stamps of another scene than the one set are not taken.
    pub fn set_film(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        stamps: &Stamps,
        hierarchy: &dyn Hierarchy<Solid>,
        wrong: &[PrimId],
    ) {
        if self.scene.as_ref().is_none_or(|s| s.prim_count() != stamps.prims().len()) {
            return;
        }
        for (chunk, prims) in self.chunks.iter_mut().zip(self.prims.chunks(CHUNK)) {
            let words = pack::stamps(prims, Some(stamps), wrong);
            queue.write_buffer(&chunk.stamps, 0, bytemuck::cast_slice(&words));
            let (order, indices) = Order::of(&words);
            let buffer = match chunk.order.take() {
                Some((buffer, _)) => buffer,
                None => target::buffer(device, "order", 12 * words.len() as u64, wgpu::BufferUsages::INDEX),
            };
            queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&indices));
            chunk.order = Some((buffer, order));
        }
        let (words, levels) = pack::nodes(stamps, hierarchy);
        let bounds = (0..hierarchy.node_count() as u32).map(|n| hierarchy.bounds(NodeId(n))).collect();
        self.nodes =
            Nodes { buffer: instances(device, queue, "nodes", bytemuck::cast_slice(&words)), levels, bounds };
        self.revision += 1;
    }

    /// Takes what a step draws in the world: the Eye, its frustum, evidence. Small; at each step. Text and
    /// images are not drawn: whoever paints over the viewport places them with [`SpaceCamera::project`].
    pub fn set_marks(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, drawing: &Drawing<Vec3>) {
        let words = pack::marks(drawing);
        self.marks = Marks {
            segments: instances(device, queue, "segments", bytemuck::cast_slice(&words.segments)),
            areas: instances(device, queue, "areas", bytemuck::cast_slice(&words.areas)),
            end: (words.segments.len() as u32, words.areas.len() as u32),
            layers: words.layers,
        };
        self.revision += 1;
    }

    /// Draws a viewport into its own target. Returns whether there was anything to do: a viewport that
    /// shows the same as before is left as it is. At most once a viewport and submission.
    #[expect(clippy::too_many_arguments, reason = "the three of wgpu, and what is drawn where")]
    pub fn render(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        viewport: ViewportId,
        size_px: [u32; 2],
        camera: &SpaceCamera,
        style: &SpaceStyle,
    ) -> bool {
        let most = device.limits().max_texture_dimension_2d;
        let size_px = size_px.map(|v| v.clamp(1, most));
        let mut target = self
            .targets
            .remove(&viewport)
            .filter(|t| t.size_px == size_px)
            .unwrap_or_else(|| Target::new(device, &self.pipelines, size_px));
        let same =
            target.shows.as_ref().is_some_and(|(c, s, r)| c == camera && s == style && *r == self.revision);
        if !same {
            let tile = Tile { whole_px: size_px, origin_px: [0, 0], size_px };
            target.prepare(device, queue, camera, style, tile, &self.outlines(&style.highlights));
            self.draw(encoder, &target, style);
            target.shows = Some((*camera, style.clone(), self.revision));
        }
        self.targets.insert(viewport, target);
        !same
    }

    /// Copies a viewport over the viewport of a pass that has no depth; does nothing if it was never drawn.
    pub fn blit(&self, viewport: ViewportId, pass: &mut wgpu::RenderPass<'static>) {
        if let Some(target) = self.targets.get(&viewport) {
            pass.set_pipeline(&self.pipelines.blit);
            pass.set_bind_group(0, &target.blit, &[]);
            pass.draw(0..3, 0..1);
        }
    }

    /// Frees a viewport that is no longer shown.
    pub fn release(&mut self, viewport: ViewportId) {
        self.targets.remove(&viewport);
    }

    /// Size and pixels of a viewport, RGBA, not premultiplied; `None` if it was never drawn. Waits.
    ///
    /// # Errors
    /// [`GpuError::Read`].
    pub fn read_rgba(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        viewport: ViewportId,
    ) -> Result<Option<snapshot::Picture>, GpuError> {
        let Some(target) = self.targets.get(&viewport) else { return Ok(None) };
        let rgba = snapshot::straight(headless::read(device, queue, &target.color)?);
        Ok(Some((target.size_px[0], target.size_px[1], rgba)))
    }

    /// Bytes on the device: buffers, then targets.
    pub fn bytes(&self) -> (usize, usize) {
        let chunks: u64 = self
            .chunks
            .iter()
            .map(|c| c.corners.size() + c.stamps.size() + c.order.as_ref().map_or(0, |o| o.0.size()))
            .sum();
        let small = [&self.nodes.buffer, &self.marks.segments, &self.marks.areas];
        let small: u64 = small.into_iter().flatten().map(wgpu::Buffer::size).sum();
        ((chunks + small) as usize, self.targets.values().map(Target::bytes).sum())
    }

    /// Outlines of highlighted things.
    fn outlines(&self, highlights: &[(Subject, Role)]) -> Vec<SegmentWords> {
        let mut to = Vec::new();
        let mut bounds = |b: Option<&Aabb<Vec3>>, role| {
            let b = b.filter(|b| !b.is_empty());
            to.extend(b.into_iter().flat_map(|b| {
                Aabb::<Vec3>::edges().map(move |(i, j)| pack::segment(b.corner(i), b.corner(j), role))
            }));
        };
        let mut sides = Vec::new();
        for &(subject, role) in highlights {
            match subject {
                Subject::Node(n) => bounds(self.nodes.bounds.get(n.at()), role),
                Subject::Object(ObjectId(o)) => bounds(self.objects.get(o as usize), role),
                Subject::Prim(p) => {
                    let Some(scene) = self.scene.as_ref().filter(|s| p.at() < s.prim_count()) else {
                        continue;
                    };
                    let points: Vec<_> = scene.prim_points(p).collect();
                    sides.extend(
                        (0..points.len())
                            .map(|i| pack::segment(points[i], points[(i + 1) % points.len()], role)),
                    );
                }
                Subject::None | Subject::Plane(_) | Subject::Eye | Subject::Tried(_) => {}
            }
        }
        to.extend(sides);
        to
    }

    fn draw(&self, encoder: &mut wgpu::CommandEncoder, target: &Target, style: &SpaceStyle) {
        let mut pass = begin(encoder, target, style);
        pass.set_bind_group(0, &target.frame, &[]);
        let fronts = usize::from(style.only_fronts);
        let has_gaps = self.scene.as_ref().is_some_and(|scene| scene.has_see_through());
        let cuts = style.surface != Surface::Solid || style.section.is_some() || has_gaps;
        let solid = if cuts { &self.pipelines.cut } else { &self.pipelines.whole };
        for (pipelines, shown) in [(solid, Shown::Solid), (&self.pipelines.ghost, Shown::Ghost)] {
            let mask = target::mask(style, shown);
            if mask != 0 {
                pass.set_pipeline(&pipelines[fronts]);
                self.draw_triangles(&mut pass, target::step(style), mask);
            }
        }
        self.draw_nodes(&mut pass, style);
        self.draw_marks(&mut pass, style);
        if target.outline_count > 0 {
            pass.set_vertex_buffer(0, target.outlines.slice(..));
            for pipeline in self.pipelines.segments.iter().rev() {
                pass.set_pipeline(pipeline);
                pass.draw(0..SEGMENT_CORNERS, 0..target.outline_count);
            }
        }
    }

    /// Triangles whose role has its bit in `mask`. The shader asks the same of each stamp.
    fn draw_triangles(&self, pass: &mut wgpu::RenderPass<'_>, step: u32, mask: u32) {
        for chunk in &self.chunks {
            pass.set_vertex_buffer(0, chunk.corners.slice(..));
            pass.set_vertex_buffer(1, chunk.stamps.slice(..));
            let Some((buffer, order)) = &chunk.order else {
                pass.draw(0..3 * chunk.triangles as u32, 0..1);
                continue;
            };
            pass.set_index_buffer(buffer.slice(..), wgpu::IndexFormat::Uint32);
            for range in order.shown(step, mask) {
                pass.draw_indexed(3 * range.start..3 * range.end, 0, 0..1);
            }
        }
    }

    fn draw_nodes(&self, pass: &mut wgpu::RenderPass<'_>, style: &SpaceStyle) {
        let Some(buffer) = &self.nodes.buffer else { return };
        let (first, last) = match style.nodes {
            NodeBoxes::None => return,
            NodeBoxes::Frontier => (0, u32::MAX),
            NodeBoxes::Levels(first, last) => (first, last),
        };
        let start = |level: u32| {
            self.nodes.levels.get(level as usize).or(self.nodes.levels.last()).copied().unwrap_or(0)
        };
        let range = start(first)..start(last.saturating_add(1));
        if range.is_empty() {
            return;
        }
        pass.set_vertex_buffer(0, buffer.slice(..));
        for pipeline in self.pipelines.nodes.iter().rev() {
            pass.set_pipeline(pipeline);
            pass.draw(0..NODE_CORNERS, range.clone());
        }
    }

    fn draw_marks(&self, pass: &mut wgpu::RenderPass<'_>, style: &SpaceStyle) {
        let layers = &self.marks.layers;
        for (i, &(layer, segment, area)) in layers.iter().enumerate() {
            let end = layers.get(i + 1).map_or(self.marks.end, |&(_, s, a)| (s, a));
            if style.without.contains(&layer) {
                continue;
            }
            if let (Some(buffer), true) = (&self.marks.areas, area < end.1) {
                pass.set_pipeline(&self.pipelines.areas);
                pass.set_vertex_buffer(0, buffer.slice(..));
                pass.draw(area..end.1, 0..1);
            }
            if let (Some(buffer), true) = (&self.marks.segments, segment < end.0) {
                pass.set_vertex_buffer(0, buffer.slice(..));
                for pipeline in self.pipelines.segments.iter().rev() {
                    pass.set_pipeline(pipeline);
                    pass.draw(0..SEGMENT_CORNERS, segment..end.0);
                }
            }
        }
    }
}

/// A filled vertex buffer; `None` for nothing.
fn instances(device: &wgpu::Device, queue: &wgpu::Queue, label: &str, bytes: &[u8]) -> Option<wgpu::Buffer> {
    let filled = target::buffer(device, label, bytes.len() as u64, wgpu::BufferUsages::VERTEX);
    queue.write_buffer(&filled, 0, bytes);
    (!bytes.is_empty()).then_some(filled)
}

/// A pass over a viewport's target, cleared.
fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    target: &Target,
    style: &SpaceStyle,
) -> wgpu::RenderPass<'a> {
    let [r, g, b] = style.palette.paper.map(|c| f64::from(c) / 255.0);
    let clear = if style.transparent { wgpu::Color::TRANSPARENT } else { wgpu::Color { r, g, b, a: 1.0 } };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("viewport"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &target.color_view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &target.depth_view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0.0),
                store: wgpu::StoreOp::Discard,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
