// Triangles: three vertices each, flat, colored by state or material. The state follows from the
// vertex's stamp and the step, so scrubbing changes no buffer.

struct Corner {
    @builtin(position) at: vec4<f32>,
    // Color of the surface, and its shade.
    @location(0) @interpolate(flat, either) color: vec4<f32>,
    // Role in the low four bits, then one bit for each side that is not an edge of its face.
    @location(1) @interpolate(flat, either) role: u32,
    @location(2) sides: vec3<f32>,
    @location(3) world: vec3<f32>,
}

fn corner(index: u32, point: vec3<f32>, look: u32, stamp: u32, shown: u32) -> Corner {
    var out: Corner;
    let role = role_at(stamp, SCENE);
    if ((shown >> role) & 1u) == 0u {
        out.at = nowhere();
        return out;
    }
    let shade = f32((look >> 21u) & 255u) / 255.0;
    let material = vec3<f32>(vec3<u32>(look, look >> 7u, look >> 14u) & vec3<u32>(127u)) / 127.0;
    let base = select(material, f.flat_color[role].rgb, f.what.y == 1u);
    out.at = clip_position(clip_xyw(point));
    out.color = vec4<f32>(base * shade, shade);
    out.role = role | ((look >> 29u) << 4u);
    let side = index % 3u;
    out.sides = vec3<f32>(f32(side == 0u), f32(side == 1u), f32(side == 2u));
    out.world = point;
    return out;
}
@vertex fn vs_opaque(@builtin(vertex_index) i: u32, @location(0) p: vec3<f32>, @location(1) look: u32, @location(2) stamp: u32) -> Corner {
    return corner(i, p, look, stamp, f.shown.x);
}
@vertex fn vs_ghost(@builtin(vertex_index) i: u32, @location(0) p: vec3<f32>, @location(1) look: u32, @location(2) stamp: u32) -> Corner {
    return corner(i, p, look, stamp, f.shown.y);
}

// How much of a pixel an edge covers. `sides` falls from 1 at a corner to 0 at the side opposite.
fn wired(role: u32, sides: vec3<f32>) -> f32 {
    let dx = dpdx(sides);
    let dy = dpdy(sides);
    var d = sides / max(sqrt(dx * dx + dy * dy), vec3<f32>(1e-20));
    let inner = vec3<bool>((role & 16u) != 0u, (role & 32u) != 0u, (role & 64u) != 0u);
    d = select(d, vec3<f32>(1e6), inner);
    let half_px = 0.5 * f.target_px.z;
    return clamp(half_px + 0.5 - min(d.x, min(d.y, d.z)), 0.0, 1.0);
}
fn patterned(at: vec2<f32>, color: vec4<f32>, role: u32) -> vec3<f32> {
    let hatch = f.halo[role].w;
    if hatch == 0.0 { return color.rgb; }
    return mix(color.rgb, f.stroke[role].rgb * mix(0.75, 1.0, color.a), hatched(hatch, at));
}
fn cut_away(world: vec3<f32>) -> bool {
    return f.what.w == 1u && dot(f.section.xyz, world) + f.section.w < 0.0;
}

// Whole surfaces: nothing is discarded, so the depth test can come first.
@fragment fn fs_whole(in: Corner) -> @location(0) vec4<f32> {
    return vec4<f32>(select(in.color.rgb, patterned(in.at.xy, in.color, in.role & 15u), f.what.y == 1u), 1.0);
}
// Surfaces with wires, wires alone, sections.
@fragment fn fs_cut(in: Corner) -> @location(0) vec4<f32> {
    let role = in.role & 15u;
    let wire = select(0.0, wired(in.role, in.sides), f.what.z != 0u);
    if cut_away(in.world) || (f.what.z == 2u && wire < 0.5) { discard; }
    let ink = select(in.color.rgb, f.stroke[role].rgb, f.what.y == 1u);
    if f.what.z == 2u { return vec4<f32>(ink, 1.0); }
    let surface = select(in.color.rgb, patterned(in.at.xy, in.color, role), f.what.y == 1u);
    return vec4<f32>(mix(surface, ink * 0.55, wire * 0.8), 1.0);
}
// See-through surfaces; premultiplied. The pattern is what tells them apart, so it is stronger than the fill.
@fragment fn fs_ghost(in: Corner) -> @location(0) vec4<f32> {
    let role = in.role & 15u;
    let wire = select(0.0, wired(in.role, in.sides), f.what.z != 0u);
    if cut_away(in.world) { discard; }
    let pattern = hatched(f.halo[role].w, in.at.xy);
    let fill = select(f.depth.z, 0.0, f.what.z == 2u);
    let line = max(pattern * 1.6 * fill, wire * max(fill, 0.35));
    let alpha = clamp(fill + (1.0 - fill) * line, 0.0, 1.0);
    let ink = f.stroke[role].rgb;
    return vec4<f32>(mix(in.color.rgb, ink, line / max(alpha, 1e-4)) * alpha, alpha);
}
