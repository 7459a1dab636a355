//! The pipelines of a viewport. Depth is reversed: nearer is greater.

use eframe::wgpu;
use wgpu::{BufferBindingType, CompareFunction, Face, ShaderStages, VertexStepMode};

/// Colors as sRGB values, stored as they are.
pub(super) const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Float, so that reversed depth is as fine far away as near by.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// By whether backs are left out.
pub(super) type BySide = [wgpu::RenderPipeline; 2];

pub(super) struct Pipelines {
    pub frame_layout: wgpu::BindGroupLayout,
    pub blit_layout: wgpu::BindGroupLayout,
    pub whole: BySide,
    pub cut: BySide,
    pub ghost: BySide,
    pub areas: wgpu::RenderPipeline,
    /// In front of surfaces, behind them.
    pub segments: [wgpu::RenderPipeline; 2],
    pub nodes: [wgpu::RenderPipeline; 2],
    pub blit: wgpu::RenderPipeline,
    pub nearest: wgpu::Sampler,
}

/// What tells one pipeline from another.
struct Plan<'a> {
    module: &'a wgpu::ShaderModule,
    entries: (&'a str, &'a str),
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    backs: bool,
    /// Depth is written, and blending is off.
    opaque: bool,
    depth: CompareFunction,
}

impl Pipelines {
    pub fn new(device: &wgpu::Device, blit_format: wgpu::TextureFormat) -> Self {
        let frame_layout = frame_layout(device);
        let layout = pipeline_layout(device, &frame_layout);
        let space = module(device, "space", concat!(include_str!("frame.wgsl"), include_str!("space.wgsl")));
        let lines = module(device, "lines", concat!(include_str!("frame.wgsl"), include_str!("lines.wgsl")));
        let build = |plan: Plan<'_>| pipeline(device, &layout, &plan);

        let corner = [
            buffer(
                16,
                VertexStepMode::Vertex,
                &const { wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32] },
            ),
            buffer(4, VertexStepMode::Vertex, &const { wgpu::vertex_attr_array![2 => Uint32] }),
        ];
        let triangles = |entries, opaque| {
            [true, false].map(|backs| {
                build(Plan {
                    module: &space,
                    entries,
                    buffers: &corner,
                    backs,
                    opaque,
                    depth: CompareFunction::Greater,
                })
            })
        };
        let over = |entries, buffers: &[_]| {
            let plan = |fragment, depth| Plan {
                module: &lines,
                entries: (entries, fragment),
                buffers,
                backs: true,
                opaque: false,
                depth,
            };
            [
                build(plan("fs_front", CompareFunction::GreaterEqual)),
                build(plan("fs_behind", CompareFunction::Less)),
            ]
        };
        let segment = [buffer(
            28,
            VertexStepMode::Instance,
            &const { wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Uint32] },
        )];
        let node = [buffer(
            36,
            VertexStepMode::Instance,
            &const { wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Uint32x3] },
        )];
        let area = [buffer(
            16,
            VertexStepMode::Vertex,
            &const { wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32] },
        )];
        let (blit_layout, blit) = blit(device, blit_format);
        Self {
            whole: triangles(("vs_opaque", "fs_whole"), true),
            cut: triangles(("vs_opaque", "fs_cut"), true),
            ghost: triangles(("vs_ghost", "fs_ghost"), false),
            areas: build(Plan {
                module: &lines,
                entries: ("vs_area", "fs_area"),
                buffers: &area,
                backs: true,
                opaque: false,
                depth: CompareFunction::GreaterEqual,
            }),
            segments: over("vs_segment", &segment),
            nodes: over("vs_node", &node),
            blit,
            nearest: device
                .create_sampler(&wgpu::SamplerDescriptor { label: Some("nearest"), ..Default::default() }),
            frame_layout,
            blit_layout,
        }
    }
}

/// What every viewport shader reads: the uniforms of a frame.
fn frame_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let uniforms = wgpu::BindingType::Buffer {
        ty: BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("frame"),
        entries: &[entry(0, ShaderStages::VERTEX_FRAGMENT, uniforms)],
    })
}

fn module(device: &wgpu::Device, label: &str, source: &str) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    })
}

fn entry(binding: u32, visibility: ShaderStages, ty: wgpu::BindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

fn buffer(
    array_stride: u64,
    step_mode: VertexStepMode,
    attributes: &[wgpu::VertexAttribute],
) -> Option<wgpu::VertexBufferLayout<'_>> {
    Some(wgpu::VertexBufferLayout { array_stride, step_mode, attributes })
}

fn pipeline_layout(device: &wgpu::Device, group: &wgpu::BindGroupLayout) -> wgpu::PipelineLayout {
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(group)],
        immediate_size: 0,
    })
}

fn pipeline(device: &wgpu::Device, layout: &wgpu::PipelineLayout, plan: &Plan<'_>) -> wgpu::RenderPipeline {
    let blend = (!plan.opaque).then_some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING);
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(plan.entries.1),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module: plan.module,
            entry_point: Some(plan.entries.0),
            compilation_options: Default::default(),
            buffers: plan.buffers,
        },
        primitive: wgpu::PrimitiveState {
            cull_mode: (!plan.backs).then_some(Face::Back),
            ..Default::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(plan.opaque),
            depth_compare: Some(plan.depth),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: plan.module,
            entry_point: Some(plan.entries.1),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: COLOR_FORMAT,
                blend,
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Copies a finished viewport into a pass without depth.
fn blit(device: &wgpu::Device, format: wgpu::TextureFormat) -> (wgpu::BindGroupLayout, wgpu::RenderPipeline) {
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    let group = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("blit"),
        entries: &[entry(0, ShaderStages::FRAGMENT, texture), entry(1, ShaderStages::FRAGMENT, sampler)],
    });
    let module = module(device, "blit", include_str!("blit.wgsl"));
    let fragment = if format.is_srgb() { "fs_linear" } else { "fs_encoded" };
    let target = wgpu::ColorTargetState {
        format,
        blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        write_mask: wgpu::ColorWrites::ALL,
    };
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("blit"),
        layout: Some(&pipeline_layout(device, &group)),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vs"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(fragment),
            compilation_options: Default::default(),
            targets: &[Some(target)],
        }),
        multiview_mask: None,
        cache: None,
    });
    (group, pipeline)
}
