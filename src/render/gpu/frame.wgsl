// What every shader of a viewport knows: the camera, the step and the looks of the roles.
// Colors are sRGB values as they stand in the palette; all mixing is done on those, as egui does.

struct Frame {
    row_x: vec4<f32>,
    row_y: vec4<f32>,
    row_w: vec4<f32>,
    // Position of the camera, then its near depth.
    eye: vec4<f32>,
    // Clip z is x + y * depth; then the opacity of ghosts and of lines behind surfaces.
    depth: vec4<f32>,
    // Size of the target in pixels, pixels a point, free.
    target_px: vec4<f32>,
    // Scale and offset of clip x, y: the tile of a larger picture.
    window: vec4<f32>,
    // Where the target's corner lies in the whole picture, so that patterns run on over tiles; free.
    origin_px: vec4<f32>,
    // Points with n·p + d < 0 are cut away.
    section: vec4<f32>,
    // Step, 1 to color by state or 0 by material, wires, 1 if there is a section.
    what: vec4<u32>,
    // Bits by role: opaque triangles, ghosts, node boxes; 1 if only the frontier of nodes.
    shown: vec4<u32>,
    // By role: color of surfaces; color of lines and their width; two dashes with their gaps; inside
    // of dots and width of halo; color of halo and hatch; color and opacity of areas.
    flat_color: array<vec4<f32>, 17>,
    stroke: array<vec4<f32>, 17>,
    dash_px: array<vec4<f32>, 17>,
    dot: array<vec4<f32>, 17>,
    halo: array<vec4<f32>, 17>,
    area: array<vec4<f32>, 17>,
}
@group(0) @binding(0) var<uniform> f: Frame;

const SCENE: u32 = 2u;
const PARTIAL: u32 = 4u;
const PAPER: u32 = 16u;

// Image coordinates times depth, and depth, of a world point; relative to the eye first.
fn clip_xyw(point: vec3<f32>) -> vec3<f32> {
    let p = point - f.eye.xyz;
    let c = vec3<f32>(dot(f.row_x.xyz, p), dot(f.row_y.xyz, p), dot(f.row_w.xyz, p));
    return vec3<f32>(c.xy * f.window.xy + f.window.zw * c.z, c.z);
}
// With reversed depth: 1 at the near plane, 0 at the far plane or at infinity.
fn clip_position(c: vec3<f32>) -> vec4<f32> {
    return vec4<f32>(c.xy, f.depth.x + f.depth.y * c.z, c.z);
}
// A vertex that no pixel hangs on.
fn nowhere() -> vec4<f32> {
    return vec4<f32>(2.0, 2.0, 0.0, 1.0);
}
// The role of a stamp at the current step.
fn role_at(stamp: u32, before: u32) -> u32 {
    return select(before, stamp & 31u, (stamp >> 5u) <= f.what.x);
}
// How much of a pixel the lines of a hatch cover; 0 none, 1 rising, 2 cross, 3 dots,
// 4 falling.
fn hatched(hatch: f32, at: vec2<f32>) -> f32 {
    let scale = f.target_px.z;
    let p = (at + f.origin_px.xy) / scale;
    let pitch = 5.0;
    let rising = abs(fract((p.x + p.y) / pitch) - 0.5) * pitch * 0.70711;
    let falling = abs(fract((p.x - p.y) / pitch) - 0.5) * pitch * 0.70711;
    let grid = (fract(p / pitch) - 0.5) * pitch;
    var d = 1e3;
    if hatch == 1.0 { d = rising - 0.55; }
    if hatch == 2.0 { d = min(rising, falling) - 0.5; }
    if hatch == 4.0 { d = falling - 0.55; }
    if hatch == 3.0 { d = length(grid) - 0.95; }
    return clamp(0.5 - d * scale, 0.0, 1.0);
}
