// Copies a finished viewport, pixel for pixel.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var nearest: sampler;

struct Corner {
    @builtin(position) at: vec4<f32>,
    @location(0) uv: vec2<f32>,
}
@vertex fn vs(@builtin(vertex_index) i: u32) -> Corner {
    let p = vec2<f32>(f32((i << 1u) & 2u), f32(i & 2u));
    return Corner(vec4<f32>(p * 2.0 - 1.0, 0.0, 1.0), vec2<f32>(p.x, 1.0 - p.y));
}
// For targets that hold sRGB values as they are.
@fragment fn fs_encoded(in: Corner) -> @location(0) vec4<f32> {
    return textureSample(picture, nearest, in.uv);
}
// For targets that encode what they are given.
@fragment fn fs_linear(in: Corner) -> @location(0) vec4<f32> {
    let c = textureSample(picture, nearest, in.uv);
    let low = c.rgb / 12.92;
    let high = pow((c.rgb + 0.055) / 1.055, vec3<f32>(2.4));
    return vec4<f32>(select(high, low, c.rgb <= vec3<f32>(0.04045)), c.a);
}
