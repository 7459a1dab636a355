// Triangles: three vertices each, flat, colored by state or material. The state follows from the
// vertex's stamp and the step, so scrubbing changes no buffer.

struct Corner {
    @builtin(position) at: vec4<f32>,
    // The triangle's look, and its role.
    @location(0) @interpolate(flat, either) look: vec2<u32>,
    // Two of the three weights of the corners, then the distance to the section's plane.
    @location(1) place: vec3<f32>,
}

fn corner(index: u32, point: vec3<f32>, look: u32, stamp: u32, shown: u32) -> Corner {
    var out: Corner;
    let role = role_at(stamp, SCENE);
    let side = index % 3u;
    let is_shown = ((shown >> role) & 1u) == 1u;
    out.at = select(nowhere(), clip_position(clip_xyw(point)), is_shown);
    out.look = vec2<u32>(look, role);
    out.place = vec3<f32>(f32(side == 0u), f32(side == 1u), dot(f.section.xyz, point) + f.section.w);
    return out;
}
@vertex fn vs_opaque(@builtin(vertex_index) i: u32, @location(0) p: vec3<f32>, @location(1) look: u32, @location(2) stamp: u32) -> Corner {
    return corner(i, p, look, stamp, f.shown.x);
}
@vertex fn vs_ghost(@builtin(vertex_index) i: u32, @location(0) p: vec3<f32>, @location(1) look: u32, @location(2) stamp: u32) -> Corner {
    return corner(i, p, look, stamp, f.shown.y);
}

// Color of the surface by state or material, and its shade.
fn surface(look: vec2<u32>) -> vec4<f32> {
    let shade = f32((look.x >> 21u) & 127u) / 127.0;
    let material = vec3<f32>(vec3<u32>(look.x, look.x >> 7u, look.x >> 14u) & vec3<u32>(127u)) / 127.0;
    let base = select(material, f.flat_color[look.y].rgb, f.what.y == 1u);
    return vec4<f32>(base * shade, shade);
}
// How much of a pixel an edge covers: a weight falls from 1 at its corner to 0 at the side opposite.
// The upper bits of the look are the sides that lie inside a face and have no edge.
fn wired(look: u32, place: vec3<f32>) -> f32 {
    let weights = vec3<f32>(place.xy, 1.0 - place.x - place.y);
    let dx = dpdx(weights);
    let dy = dpdy(weights);
    var d = weights / max(sqrt(dx * dx + dy * dy), vec3<f32>(1e-20));
    let inner = (vec3<u32>(look >> 29u, look >> 30u, look >> 31u) & vec3<u32>(1u)) == vec3<u32>(1u);
    d = select(d, vec3<f32>(1e6), inner);
    let half_px = 0.5 * f.target_px.z;
    return clamp(half_px + 0.5 - min(d.x, min(d.y, d.z)), 0.0, 1.0);
}
fn patterned(at: vec2<f32>, color: vec4<f32>, role: u32) -> vec3<f32> {
    let hatch = f.halo[role].w;
    if hatch == 0.0 || f.what.y == 0u { return color.rgb; }
    return mix(color.rgb, f.stroke[role].rgb * mix(0.75, 1.0, color.a), hatched(hatch, at));
}
fn cut_away(place: vec3<f32>) -> bool {
    return f.what.w == 1u && place.z < 0.0;
}

// What is see-through leaves out every second square, as a screen door does: no order is needed, and one sees
// that one sees through.
fn is_gap(look: u32, at: vec2<f32>) -> bool {
    let p = vec2<i32>(floor((at + f.origin_px.xy) / max(round(f.target_px.z), 1.0)));
    return ((look >> 28u) & 1u) == 1u && ((p.x + p.y) & 1) == 1;
}

// Whole surfaces: nothing is discarded, so the depth test can come first.
@fragment fn fs_whole(in: Corner) -> @location(0) vec4<f32> {
    return vec4<f32>(patterned(in.at.xy, surface(in.look), in.look.y), 1.0);
}
// Surfaces with wires, wires alone, sections, and scenes in which some are see-through.
@fragment fn fs_cut(in: Corner) -> @location(0) vec4<f32> {
    let wire = select(0.0, wired(in.look.x, in.place), f.what.z != 0u);
    if cut_away(in.place) || (f.what.z == 2u && wire < 0.5) { discard; }
    if f.what.z != 2u && wire < 0.5 && is_gap(in.look.x, in.at.xy) { discard; }
    let color = surface(in.look);
    if f.what.z == 2u { return vec4<f32>(select(color.rgb, f.stroke[in.look.y].rgb, f.what.y == 1u), 1.0); }
    let filled = patterned(in.at.xy, color, in.look.y);
    // Edges are darker than their surface, or lighter where that is dark already.
    let luma = dot(filled, vec3<f32>(0.3, 0.6, 0.1));
    let edge = select(filled * 0.45, mix(filled, vec3<f32>(1.0), 0.4), luma < 0.25);
    return vec4<f32>(mix(filled, edge, 0.7 * wire), 1.0);
}
// See-through surfaces; premultiplied. The pattern is what tells them apart, so it is stronger than the fill.
@fragment fn fs_ghost(in: Corner) -> @location(0) vec4<f32> {
    let wire = select(0.0, wired(in.look.x, in.place), f.what.z != 0u);
    if cut_away(in.place) { discard; }
    let pattern = hatched(f.halo[in.look.y].w, in.at.xy);
    let fill = select(f.depth.z, 0.0, f.what.z == 2u);
    let line = max(pattern * min(3.0 * fill, 1.0), wire * max(fill, 0.35));
    let alpha = clamp(fill + (1.0 - fill) * line, 0.0, 1.0);
    let ink = f.stroke[in.look.y].rgb;
    return vec4<f32>(mix(surface(in.look).rgb, ink, line / max(alpha, 1e-4)) * alpha, alpha);
}
