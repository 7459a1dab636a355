//! The item buffer of a view as a graphics device draws it: someone else's truth, to compare ours with.

use eframe::wgpu;
use wgpu::util::DeviceExt;

use super::headless::{GpuError, Headless, read};
use super::pipelines::DEPTH_FORMAT;
use crate::geometry::{PrimId, Solid, View};
use crate::raster::Target;
use crate::scene::Scene;

/// Triangles of one draw call.
const CHUNK: usize = 1 << 18;

/// The nearest of some triangles (ascending) at each pixel, row 0 at the top; [`Target::NONE`] where there is
/// none. Both sides are drawn, and at equal depth the first one stays.
///
/// # Errors
/// The image is too large for the device, or it could not be read back.
pub fn items(
    on: &Headless,
    scene: &Scene<Solid>,
    view: &View<Solid>,
    prims: &[PrimId],
) -> Result<Vec<u32>, GpuError> {
    let (width, height) = (view.width, view.height);
    let most = on.device.limits().max_texture_dimension_2d;
    if width == 0 || height == 0 || width.max(height) > most {
        return Err(GpuError::Size { width, height, most });
    }
    let texture = |format, usage| {
        on.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("items"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    };
    let attached = wgpu::TextureUsages::RENDER_ATTACHMENT;
    let color = texture(wgpu::TextureFormat::R32Uint, attached | wgpu::TextureUsages::COPY_SRC);
    let depth = texture(DEPTH_FORMAT, attached);
    let (pipeline, group) = prepared(on, view);
    let mut first = true;
    for some in prims.chunks(CHUNK) {
        let corners = upload(on, scene, view, some);
        let mut encoder = on.device.create_command_encoder(&Default::default());
        {
            let mut pass = begun(&mut encoder, [&color, &depth], first);
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.set_vertex_buffer(0, corners.slice(..));
            pass.draw(0..3 * some.len() as u32, 0..1);
        }
        on.queue.submit([encoder.finish()]);
        first = false;
    }
    if first {
        return Ok(vec![Target::NONE; width as usize * height as usize]);
    }
    let bytes = read(&on.device, &on.queue, &color)?;
    let item = |texel: &[u8; 4]| u32::from_le_bytes(*texel).checked_sub(1).unwrap_or(Target::NONE);
    Ok(bytes.as_chunks::<4>().0.iter().map(item).collect())
}

/// A pass over both textures, which the first one clears.
fn begun<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    [color, depth]: [&wgpu::Texture; 2],
    clears: bool,
) -> wgpu::RenderPass<'a> {
    let (color_load, depth_load) = if clears {
        (wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), wgpu::LoadOp::Clear(0.0))
    } else {
        (wgpu::LoadOp::Load, wgpu::LoadOp::Load)
    };
    let [color, depth] = [color, depth].map(|texture| texture.create_view(&Default::default()));
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("items"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &color,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: color_load, store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth,
            depth_ops: Some(wgpu::Operations { load: depth_load, store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}

/// Corners of triangles relative to the eye, as our own rasterizer takes them, each with the triangle's
/// number from 1.
fn upload(on: &Headless, scene: &Scene<Solid>, view: &View<Solid>, prims: &[PrimId]) -> wgpu::Buffer {
    let mut words: Vec<u32> = Vec::with_capacity(12 * prims.len());
    for &prim in prims {
        for point in scene.prim_points(prim) {
            let relative = point - view.eye.position;
            words.extend(relative.to_array().map(f32::to_bits));
            words.push(prim.0 + 1);
        }
    }
    on.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("corners"),
        contents: bytemuck::cast_slice(&words),
        usage: wgpu::BufferUsages::VERTEX,
    })
}

fn prepared(on: &Headless, view: &View<Solid>) -> (wgpu::RenderPipeline, wgpu::BindGroup) {
    let device = &on.device;
    let rows = view.projection().rows;
    let eye = &view.eye;
    let frame: Vec<f32> = (0..3)
        .flat_map(|row| rows[row].extend(0.0).to_array())
        .chain([eye.near, eye.far, 0.0, 0.0])
        .collect();
    let uniform = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("frame"),
        contents: bytemuck::cast_slice(&frame),
        usage: wgpu::BufferUsages::UNIFORM,
    });
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("items"),
        source: wgpu::ShaderSource::Wgsl(include_str!("items.wgsl").into()),
    });
    let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32];
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("items"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vs_items"),
            compilation_options: Default::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: 16,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &attributes,
            })],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fs_items"),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::TextureFormat::R32Uint.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("frame"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
    });
    (pipeline, group)
}
