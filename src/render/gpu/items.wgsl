// An item buffer: each pixel shows the number of the nearest triangle, from 1. Depth is reversed, and linear
// in 1/w as ours is; the far plane lies at 0.

struct Frame {
    // Clip x, y and w of a point relative to the eye.
    x: vec4<f32>,
    y: vec4<f32>,
    w: vec4<f32>,
    // Near and far.
    depths: vec4<f32>,
}
@group(0) @binding(0) var<uniform> frame: Frame;

struct Corner {
    @builtin(position) at: vec4<f32>,
    @location(0) @interpolate(flat) item: u32,
}

@vertex
fn vs_items(@location(0) point: vec3<f32>, @location(1) item: u32) -> Corner {
    let w = dot(frame.w.xyz, point);
    let near = frame.depths.x;
    let far = frame.depths.y;
    let z = near * (far - w) / (far - near);
    var corner: Corner;
    corner.at = vec4<f32>(dot(frame.x.xyz, point), dot(frame.y.xyz, point), z, w);
    corner.item = item;
    return corner;
}

@fragment
fn fs_items(corner: Corner) -> @location(0) u32 {
    return corner.item;
}
