// Lines of a width in pixels, dots, arrow heads, areas and the boxes of nodes. All premultiplied.

struct Stroke {
    @builtin(position) at: vec4<f32>,
    // Along the line from its start, across it, and the line's length: all in pixels.
    @location(0) along: vec3<f32>,
    // Half the width of the line and of its halo, pixels.
    @location(1) @interpolate(flat, either) half_px: vec2<f32>,
    // Role in the low five bits, then the kind.
    @location(2) @interpolate(flat, either) role: u32,
}
const DOT: u32 = 32u;
const HEAD: u32 = 64u;
const NODE: u32 = 128u;
// A node that is decided: there are hundreds of them in the end, and none is what the step is about.
const DONE: u32 = 256u;
const DONE_STRENGTH: f32 = 0.6;

// Where a segment enters the half-space in which `from` and `to` are the signed distances of its ends.
fn entry(from_d: f32, to_d: f32) -> f32 {
    return select(0.0, from_d / (from_d - to_d), from_d < 0.0);
}
// The part of a segment before the near plane and a little beyond the image, as two parameters.
fn clipped(a: vec3<f32>, b: vec3<f32>) -> vec2<f32> {
    var t = vec2<f32>(0.0, 1.0);
    let margin = 1.5;
    let da = array<f32, 5>(a.z - f.eye.w, margin * a.z + a.x, margin * a.z - a.x, margin * a.z + a.y, margin * a.z - a.y);
    let db = array<f32, 5>(b.z - f.eye.w, margin * b.z + b.x, margin * b.z - b.x, margin * b.z + b.y, margin * b.z - b.y);
    for (var i = 0; i < 5; i++) {
        if da[i] < 0.0 && db[i] < 0.0 { return vec2<f32>(1.0, 0.0); }
        t.x = max(t.x, entry(da[i], db[i]));
        t.y = min(t.y, 1.0 - entry(db[i], da[i]));
    }
    return t;
}

fn stroke(index: u32, from_p: vec3<f32>, to_p: vec3<f32>, role: u32, radius_px: f32) -> Stroke {
    var out: Stroke;
    let ca = clip_xyw(from_p);
    let cb = clip_xyw(to_p);
    let t = clipped(ca, cb);
    if t.x > t.y {
        out.at = nowhere();
        return out;
    }
    let a = clip_position(mix(ca, cb, t.x));
    let b = clip_position(mix(ca, cb, t.y));
    let half_target = 0.5 * f.target_px.xy;
    let pa = a.xy / a.w * half_target;
    let pb = b.xy / b.w * half_target;
    let length_px = length(pb - pa);
    let dir = select(vec2<f32>(1.0, 0.0), (pb - pa) / max(length_px, 1e-6), length_px > 1e-4);
    let across = vec2<f32>(-dir.y, dir.x);
    // Boxes of nodes are many, so they are thinner.
    let thin = select(select(0.5, 0.3, (role & NODE) != 0u), 0.22, (role & DONE) != 0u);
    let line_px = select(thin * f.stroke[role & 31u].w, radius_px, (role & DOT) != 0u);
    // A line without a halo gets a thin casing of paper, so that it is read on any ground.
    out.half_px = vec2<f32>(line_px, line_px + max(f.dot[role & 31u].w, 0.7 * f.target_px.z));
    out.role = role;
    var pixel: vec2<f32>;
    var z = b.z / b.w;
    if (role & HEAD) != 0u {
        // A triangle before the end of the line; the second triangle of the quad is empty.
        let reach = 7.0 * f.target_px.z + line_px;
        let shape = array<vec2<f32>, 3>(vec2<f32>(0.0, 0.0), vec2<f32>(-1.0, 0.38), vec2<f32>(-1.0, -0.38));
        let s = shape[min(index, 2u)] * reach;
        pixel = pb + dir * s.x + across * s.y;
        out.along = vec3<f32>(0.0);
    } else {
        let reach = out.half_px.y + 1.0;
        let ends = array<vec2<f32>, 6>(vec2(0.0, -1.0), vec2(1.0, -1.0), vec2(1.0, 1.0), vec2(0.0, -1.0), vec2(1.0, 1.0), vec2(0.0, 1.0));
        let end = ends[index];
        let side = end.y * reach;
        let u = select(-reach, length_px + reach, end.x > 0.5);
        pixel = pa + dir * u + across * side;
        z = select(a.z / a.w, z, end.x > 0.5);
        out.along = vec3<f32>(u, side, length_px);
    }
    // A hair nearer than the surface it lies on.
    out.at = vec4<f32>(pixel / half_target, min(z * 1.0004, 1.0), 1.0);
    return out;
}

@vertex fn vs_segment(@builtin(vertex_index) i: u32, @location(0) a: vec3<f32>, @location(1) b: vec3<f32>, @location(2) word: u32) -> Stroke {
    return stroke(i, a, b, word & 255u, f32((word >> 8u) & 255u) / 16.0 * f.target_px.z);
}
// A box has twelve edges: four along each axis.
@vertex fn vs_node(@builtin(vertex_index) i: u32, @location(0) low: vec3<f32>, @location(1) high: vec3<f32>, @location(2) times: vec3<u32>) -> Stroke {
    let edge = i / 6u;
    let axis = edge / 4u;
    let bits = vec2<u32>(edge & 1u, (edge >> 1u) & 1u);
    var from_c = vec3<f32>(0.0, f32(bits.x), f32(bits.y));
    var to_c = vec3<f32>(1.0, f32(bits.x), f32(bits.y));
    if axis == 1u { from_c = from_c.yxz; to_c = to_c.yxz; }
    if axis == 2u { from_c = from_c.yzx; to_c = to_c.yzx; }
    let entered = times.x <= f.what.x;
    let role = role_at(times.y, PARTIAL);
    let is_leaf = times.z == 1u;
    // The frontier: decided as a whole, a leaf, or entered and not yet decided.
    let decided = (times.y >> 5u) <= f.what.x;
    let frontier = role != PARTIAL || is_leaf || !decided;
    let kind = NODE | select(0u, DONE, decided);
    var out = stroke(i % 6u, mix(low, high, from_c), mix(low, high, to_c), role | kind, 0.0);
    if !entered || ((f.shown.z >> role) & 1u) == 0u || (f.shown.w == 1u && !frontier) { out.at = nowhere(); }
    return out;
}

fn inked(in: Stroke, strength: f32) -> vec4<f32> {
    let role = in.role & 31u;
    let u = in.along.x;
    let away = length(vec2<f32>(max(max(-u, u - in.along.z), 0.0), in.along.y));
    let d = select(away, -1.0, (in.role & HEAD) != 0u);
    let whole = clamp(in.half_px.y + 0.5 - d, 0.0, 1.0);
    var line = clamp(in.half_px.x + 0.5 - d, 0.0, 1.0) * min(2.0 * in.half_px.x, 1.0);
    let dash = f.dash_px[role];
    let period = dash.x + dash.y + dash.z + dash.w;
    if period > 0.0 && (in.role & (DOT | HEAD)) == 0u {
        let m = u - floor(u / period) * period;
        if (m > dash.x && m < dash.x + dash.y) || m > dash.x + dash.y + dash.z { line = 0.0; }
    }
    var ink = f.stroke[role].rgb;
    if (in.role & DOT) != 0u && d < in.half_px.x - f.target_px.z { ink = f.dot[role].rgb; }
    let has_halo = f.dot[role].w > 0.0;
    let is_done = (in.role & DONE) != 0u;
    let band = (1.0 - line) * whole * select(select(0.4, 1.0, has_halo), 0.0, is_done);
    let alpha = (line + band) * strength * select(1.0, DONE_STRENGTH, is_done);
    let color = mix(select(f.flat_color[PAPER].rgb, f.halo[role].rgb, has_halo), ink, line / max(line + band, 1e-4));
    return vec4<f32>(color * alpha, alpha);
}
@fragment fn fs_front(in: Stroke) -> @location(0) vec4<f32> {
    return inked(in, 1.0);
}
// What lies behind a surface shows through faintly.
@fragment fn fs_behind(in: Stroke) -> @location(0) vec4<f32> {
    return inked(in, f.depth.w);
}

struct Area {
    @builtin(position) at: vec4<f32>,
    @location(0) @interpolate(flat, either) role: u32,
}
@vertex fn vs_area(@location(0) p: vec3<f32>, @location(1) role: u32) -> Area {
    return Area(clip_position(clip_xyw(p)), role);
}
// An area in a color of its own: the color, seven bits of opacity, and this bit.
const SWATCH: u32 = 0x80000000u;
@fragment fn fs_area(in: Area) -> @location(0) vec4<f32> {
    if (in.role & SWATCH) != 0u {
        let c = vec3<f32>(vec3<u32>(in.role >> 16u, in.role >> 8u, in.role) & vec3<u32>(255u)) / 255.0;
        let opacity = f32((in.role >> 24u) & 127u) / 127.0;
        return vec4<f32>(c * opacity, opacity);
    }
    let fill = f.area[in.role];
    let pattern = hatched(f.halo[in.role].w, in.at.xy) * 0.6;
    let alpha = fill.a + (1.0 - fill.a) * pattern;
    return vec4<f32>(mix(fill.rgb, f.stroke[in.role].rgb, pattern / max(alpha, 1e-4)) * alpha, alpha);
}
