//! Pixels with depths that surfaces, areas and lines of space are painted on, as the screen's painter does it
//! on a graphics card. Lines tell which parts of them lie before all surfaces, so that these can be vectors.

use std::f32::consts::FRAC_1_SQRT_2;
use std::ops::Range;

use glam::{Vec2, Vec3};

use crate::drawing::{Pixels, Role};
use crate::geometry::{PrimId, Projection, Solid, View};
use crate::raster::{Drawable, Options, Target};
use crate::render::theme::{Hatch, Rgb, Theme};
use crate::scene::Scene;

/// Samples of a pixel along each axis.
pub(super) const SAMPLES: u32 = 2;
/// Distance of the lines of a pattern, points, as on screen.
const PITCH_PT: f32 = 5.0;
/// How much nearer a line counts than the surface that it lies on.
const NEARER: f32 = 1.0004;
/// Shade of planes along the light, and the direction to it, as on screen: the plane alone counts, not which
/// side of it is the front.
const AMBIENT: f32 = 0.62;
const LIGHT: Vec3 = Vec3::new(0.36, 0.80, 0.48);

/// What a role looks like on surfaces.
#[derive(Clone, Copy)]
pub(super) struct Ink {
    /// Surfaces in full light.
    pub flat: Rgb,
    /// Lines and patterns.
    pub stroke: Rgb,
    pub width_pt: f32,
    pub dash: &'static [f32],
    pub hatch: Hatch,
    /// Inside of areas, and its opacity.
    pub fill: (Rgb, f32),
}

impl Ink {
    pub fn of(theme: Theme, role: Role) -> Self {
        let style = theme.style(role);
        // A surface has no outline to be dotted, so its inside is.
        let hatch = if role == Role::Outside { Hatch::Dots } else { style.hatch };
        let fill = style.fill.unwrap_or((theme.paper(), 0.0));
        let (stroke, width_pt, dash) = (style.stroke, style.width_pt, style.dash);
        Self { flat: theme.flat(role), stroke, width_pt, dash, hatch, fill }
    }
}

pub(super) struct Canvas {
    view: View<Solid>,
    projection: Projection<Vec3>,
    /// Samples a point.
    scale: f32,
    /// `1/w` of the nearest surface; 0 where there is none.
    depth: Vec<f32>,
    rgb: Vec<Rgb>,
    /// What lies higher is cut away.
    ceiling: Option<f32>,
}

impl Canvas {
    /// An empty picture of a view, of so many pixels a point.
    pub fn new(mut view: View<Solid>, pixels_per_point: f32, paper: Rgb, ceiling: Option<f32>) -> Self {
        (view.width, view.height) = (view.width * SAMPLES, view.height * SAMPLES);
        let count = view.width as usize * view.height as usize;
        Self {
            view,
            projection: view.projection(),
            scale: pixels_per_point * SAMPLES as f32,
            depth: vec![0.0; count],
            rgb: vec![paper; count],
            ceiling,
        }
    }

    /// Opaque surfaces; see-through ones leave out every second square, as a screen door does.
    pub fn surfaces(&mut self, scene: &Scene<Solid>, prims: &[PrimId], ink: impl Fn(PrimId) -> Ink) {
        let (mut whole, mut parts) = (Vec::new(), Vec::new());
        for &prim in prims {
            match self.cut(scene, prim) {
                None => {}
                Some(false) if !scene.is_see_through(prim) => whole.push(prim),
                Some(_) => parts.push(prim),
            }
        }
        let mut target = Target::default();
        let options = Options { threads: 0, ..Options::default() };
        Solid::redraw(&mut target, scene, &self.view, &whole, &options);
        let mut last = (Target::NONE, None);
        for (at, &item) in target.item.iter().enumerate().filter(|(_, item)| **item != Target::NONE) {
            if last.0 != item {
                last = (item, Some((ink(PrimId(item)), shade(scene, PrimId(item)))));
            }
            let Some((ink, shade)) = last.1 else { continue };
            self.depth[at] = target.depth[at];
            self.rgb[at] = self.patterned(at, &ink, shade);
        }
        for prim in parts {
            let (ink, shade) = (ink(prim), shade(scene, prim));
            let has_gaps = scene.is_see_through(prim);
            self.each_fragment(scene, prim, |canvas, at, depth| {
                if has_gaps && canvas.is_gap(at) {
                    return;
                }
                canvas.depth[at] = depth;
                canvas.rgb[at] = canvas.patterned(at, &ink, shade);
            });
        }
    }

    /// A surface that one sees through and that hides nothing: its pattern is stronger than its fill.
    pub fn ghost(&mut self, scene: &Scene<Solid>, prim: PrimId, ink: &Ink, fill: f32) {
        if self.cut(scene, prim).is_none() {
            return;
        }
        let lit = shaded(ink.flat, shade(scene, prim));
        self.each_fragment(scene, prim, |canvas, at, _| {
            let line = canvas.hatched(ink.hatch, at) * (3.0 * fill).min(1.0);
            canvas.blend(at, lit, fill * (1.0 - line));
            canvas.blend(at, ink.stroke, line);
        });
    }

    /// Calls `put` with the samples of a primitive before all surfaces, and their depths.
    fn each_fragment(
        &mut self,
        scene: &Scene<Solid>,
        prim: PrimId,
        mut put: impl FnMut(&mut Self, usize, f32),
    ) {
        let view = self.view;
        let crosses = self.cut(scene, prim) == Some(true);
        let options = Options::default();
        Solid::fragments(scene, &view, prim, &options, &mut |at, depth| {
            if depth > self.depth[at] && !(crosses && self.is_cut_away(at, depth)) {
                put(self, at, depth);
            }
        });
    }

    /// Whether the ceiling cuts through a primitive; `None` if it cuts all of it away.
    fn cut(&self, scene: &Scene<Solid>, prim: PrimId) -> Option<bool> {
        let Some(ceiling) = self.ceiling else { return Some(false) };
        let above = scene.prim_points(prim).filter(|p| p.y > ceiling).count();
        (above < 3).then_some(above > 0)
    }

    fn is_cut_away(&self, at: usize, depth: f32) -> bool {
        let p = self.place(at) + 0.5;
        let size = Vec2::new(self.view.width as f32, self.view.height as f32);
        let ndc = Vec2::new(p.x / size.x * 2.0 - 1.0, 1.0 - p.y / size.y * 2.0);
        let [x, y, forward, _] = self.projection.rows;
        let ray = x * (ndc.x / x.length_squared()) + y * (ndc.y / y.length_squared()) + forward;
        self.ceiling.is_some_and(|ceiling| self.projection.eye.y + ray.y / depth > ceiling)
    }

    /// Column and row of a sample.
    fn place(&self, at: usize) -> Vec2 {
        let width = self.view.width as usize;
        Vec2::new((at % width) as f32, (at / width) as f32)
    }

    fn is_gap(&self, at: usize) -> bool {
        let square = (self.place(at) / self.scale.round().max(1.0)).floor();
        (square.x + square.y) as i64 % 2 == 1
    }

    fn patterned(&self, at: usize, ink: &Ink, shade: f32) -> Rgb {
        let color = shaded(ink.flat, shade);
        match ink.hatch {
            Hatch::None => color,
            hatch => {
                let line = shaded(ink.stroke, 0.75 + 0.25 * shade);
                mixed(color, line, self.hatched(hatch, at))
            }
        }
    }

    /// How much of a sample the lines of a pattern cover.
    fn hatched(&self, hatch: Hatch, at: usize) -> f32 {
        let p = (self.place(at) + 0.5) / self.scale;
        let off = |v: f32| ((v / PITCH_PT).rem_euclid(1.0) - 0.5) * PITCH_PT;
        let (rising, falling) = (off(p.x + p.y).abs() * FRAC_1_SQRT_2, off(p.x - p.y).abs() * FRAC_1_SQRT_2);
        let away = match hatch {
            Hatch::None => return 0.0,
            Hatch::Diagonal => rising - 0.55,
            Hatch::Falling => falling - 0.55,
            Hatch::Cross => rising.min(falling) - 0.5,
            Hatch::Dots => Vec2::new(off(p.x), off(p.y)).length() - 0.95,
        };
        (0.5 - away * self.scale).clamp(0.0, 1.0)
    }

    fn blend(&mut self, at: usize, color: Rgb, alpha: f32) {
        self.rgb[at] = mixed(self.rgb[at], color, alpha);
    }

    /// A convex area with a pattern of its own, before all surfaces.
    pub fn area(&mut self, points: &[Vec3], (color, alpha): (Rgb, f32), hatch: Option<(Hatch, Rgb)>) {
        let corners: Vec<Vec3> = self.before_near(points).into_iter().map(|c| self.pixel(c)).collect();
        let rows = corners
            .iter()
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), c| (low.min(c.y), high.max(c.y)));
        let first = (rows.0 - 0.5).ceil().max(0.0) as u32;
        let end = (rows.1 + 0.5).floor().clamp(0.0, self.view.height as f32) as u32;
        for y in first..end {
            let Some([a, b]) = span(&corners, y as f32 + 0.5) else { continue };
            let columns = columns(a.x, b.x, self.view.width);
            for x in columns {
                let s = (x as f32 + 0.5 - a.x) / (b.x - a.x).max(1e-6);
                let depth = a.z + (b.z - a.z) * s.clamp(0.0, 1.0);
                let at = y as usize * self.view.width as usize + x as usize;
                if depth * NEARER < self.depth[at] {
                    continue;
                }
                let line = hatch.map_or(0.0, |(hatch, _)| self.hatched(hatch, at) * 0.6);
                self.blend(at, color, alpha * (1.0 - line));
                if let Some((_, stroke)) = hatch {
                    self.blend(at, stroke, line);
                }
            }
        }
    }

    /// Clip coordinates of the part of a polygon that is before the eye.
    fn before_near(&self, points: &[Vec3]) -> Vec<Vec3> {
        let near = self.view.eye.near;
        let clip: Vec<Vec3> = points.iter().map(|&p| self.projection.clip(p)).collect();
        let mut kept = Vec::with_capacity(clip.len() + 1);
        for (i, &b) in clip.iter().enumerate() {
            let a = clip[(i + clip.len() - 1) % clip.len()];
            if (a.z < near) != (b.z < near) {
                kept.push(a + (b - a) * ((near - a.z) / (b.z - a.z)));
            }
            kept.extend((b.z >= near).then_some(b));
        }
        kept
    }

    /// Column, row and `1/w`.
    fn pixel(&self, clip: Vec3) -> Vec3 {
        let (w, h) = (self.view.width as f32, self.view.height as f32);
        Vec3::new((clip.x / clip.z * 0.5 + 0.5) * w, (0.5 - clip.y / clip.z * 0.5) * h, 1.0 / clip.z)
    }

    /// A line of a width in points, before and behind surfaces with these opacities.
    pub fn line(&mut self, ends: [Vec3; 2], ink: &Ink, width_pt: f32, [front, behind]: [f32; 2]) {
        let half = (width_pt * self.scale * 0.5).max(0.5);
        let Some(along) = self.along(ends) else { return };
        let is_flat = (along.to.x - along.from.x).abs() >= (along.to.y - along.from.y).abs();
        let reach = half.ceil() as i64;
        let length_pt = (along.to - along.from).truncate().length() / self.scale;
        for i in 0..along.count {
            if is_between(ink.dash, along.part(i) * length_pt) {
                continue;
            }
            let p = along.at(i);
            let alpha = if self.is_before(p) { front } else { behind };
            for off in -reach..=reach {
                let (x, y) =
                    if is_flat { (p.x as i64, p.y as i64 + off) } else { (p.x as i64 + off, p.y as i64) };
                let middle = if is_flat { p.y - (y as f32 + 0.5) } else { p.x - (x as f32 + 0.5) };
                let cover = (half + 0.5 - middle.abs()).clamp(0.0, 1.0);
                if let Some(at) = self.sample(x, y).filter(|_| cover > 0.0) {
                    self.blend(at, ink.stroke, alpha * cover);
                }
            }
        }
    }

    /// The parts of a line before all surfaces, and those behind one.
    pub fn parted(&self, ends: [Vec3; 2]) -> (Vec<[Vec3; 2]>, Vec<[Vec3; 2]>) {
        let (mut front, mut behind) = (Vec::new(), Vec::new());
        let Some(along) = self.along(ends) else { return (front, behind) };
        let point = |i: u32| ends[0] + (ends[1] - ends[0]) * along.share(i);
        let mut begun = 0;
        let mut was = self.is_before(along.at(0));
        for i in 1..=along.count {
            let is = if i < along.count { self.is_before(along.at(i)) } else { !was };
            if is != was {
                let to = if was { &mut front } else { &mut behind };
                to.push([point(begun), point(i.min(along.count - 1))]);
                (begun, was) = (i, is);
            }
        }
        (front, behind)
    }

    /// Whether a point in samples lies before all surfaces or on one: those of the samples around it count
    /// too, since the rim of a surface lies half beside it.
    fn is_before(&self, p: Vec3) -> bool {
        let (x, y) = (p.x as i64, p.y as i64);
        let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
        let least =
            around.filter_map(|(x, y)| self.sample(x, y)).map(|at| self.depth[at]).fold(f32::MAX, f32::min);
        p.z * NEARER >= least || least == f32::MAX
    }

    fn sample(&self, x: i64, y: i64) -> Option<usize> {
        let (w, h) = (i64::from(self.view.width), i64::from(self.view.height));
        ((0..w).contains(&x) && (0..h).contains(&y)).then(|| (y * w + x) as usize)
    }

    /// The part of a line in the picture, sample by sample.
    fn along(&self, ends: [Vec3; 2]) -> Option<Along> {
        let [a, b] = ends.map(|p| self.projection.clip(p));
        let (near, mut t) = (self.view.eye.near, [0.0f32, 1.0]);
        let distances = |c: Vec3| [c.z - near, c.z + c.x, c.z - c.x, c.z + c.y, c.z - c.y];
        for (from, to) in distances(a).into_iter().zip(distances(b)) {
            match (from < 0.0, to < 0.0) {
                (true, true) => return None,
                (true, false) => t[0] = t[0].max(from / (from - to)),
                (false, true) => t[1] = t[1].min(from / (from - to)),
                (false, false) => {}
            }
        }
        if t[0] > t[1] || !(a.is_finite() && b.is_finite()) {
            return None;
        }
        let [from, to] = t.map(|t| self.pixel(a + (b - a) * t));
        let count = (to - from).truncate().abs().max_element().ceil() as u32 + 1;
        Some(Along { from, to, range: t, count })
    }

    /// The picture, each pixel the mean of its samples.
    pub fn pixels(self) -> Pixels {
        let (width, height) = (self.view.width / SAMPLES, self.view.height / SAMPLES);
        let mut rgba = Vec::with_capacity(4 * width as usize * height as usize);
        for y in 0..height {
            for x in 0..width {
                let mut sum = [0u32; 3];
                for i in 0..SAMPLES * SAMPLES {
                    let (dx, dy) = (i % SAMPLES, i / SAMPLES);
                    let at = (y * SAMPLES + dy) as usize * self.view.width as usize;
                    let sample = self.rgb[at + (x * SAMPLES + dx) as usize];
                    (0..3).for_each(|c| sum[c] += u32::from(sample[c]));
                }
                let half = SAMPLES * SAMPLES / 2;
                rgba.extend(sum.map(|s| ((s + half) / (SAMPLES * SAMPLES)) as u8));
                rgba.push(255);
            }
        }
        Pixels { width, height, rgba: rgba.into() }
    }
}

/// A line in the picture: ends as column, row and `1/w`, which part of the whole line it is, and its samples.
struct Along {
    from: Vec3,
    to: Vec3,
    range: [f32; 2],
    count: u32,
}

impl Along {
    /// How far along in the picture sample `i` is, 0 to 1.
    fn part(&self, i: u32) -> f32 {
        i as f32 / (self.count - 1).max(1) as f32
    }
    fn at(&self, i: u32) -> Vec3 {
        self.from + (self.to - self.from) * self.part(i)
    }
    /// How far along the whole line in the world sample `i` is, 0 to 1.
    fn share(&self, i: u32) -> f32 {
        let s = self.part(i);
        let share = s * self.to.z / ((1.0 - s) * self.from.z + s * self.to.z);
        self.range[0] + (self.range[1] - self.range[0]) * share
    }
}

/// Whether a place along a line lies between two dashes, all in points.
fn is_between(dash: &[f32], at_pt: f32) -> bool {
    let period: f32 = dash.iter().sum();
    let mut rest = if period > 0.0 { at_pt.rem_euclid(period) } else { return false };
    for (i, length) in dash.iter().enumerate() {
        if rest < *length {
            return i % 2 == 1;
        }
        rest -= length;
    }
    false
}

/// The part of a row inside a convex polygon.
fn span(corners: &[Vec3], y: f32) -> Option<[Vec3; 2]> {
    let mut ends: Option<[Vec3; 2]> = None;
    for (i, &b) in corners.iter().enumerate() {
        let a = corners[(i + corners.len() - 1) % corners.len()];
        if (a.y <= y) == (b.y <= y) {
            continue;
        }
        let p = a + (b - a) * ((y - a.y) / (b.y - a.y));
        ends = Some(ends.map_or([p, p], |[low, high]| {
            [if p.x < low.x { p } else { low }, if p.x > high.x { p } else { high }]
        }));
    }
    ends
}

/// The columns whose middles lie between two places.
fn columns(from: f32, to: f32, width: u32) -> Range<u32> {
    let bound = |x: f32| (x - 0.5).ceil().clamp(0.0, width as f32) as u32;
    bound(from)..bound(to)
}

pub(super) fn shade(scene: &Scene<Solid>, prim: PrimId) -> f32 {
    AMBIENT + (1.0 - AMBIENT) * scene.normal(prim).normalize_or(LIGHT).dot(LIGHT).abs().min(1.0)
}

pub(super) fn shaded(color: Rgb, shade: f32) -> Rgb {
    color.map(|c| (f32::from(c) * shade + 0.5) as u8)
}

/// One color over another, on the values that screens are given, as they mix them.
fn mixed(under: Rgb, over: Rgb, alpha: f32) -> Rgb {
    let mix = |(u, o): (u8, u8)| (f32::from(u) + (f32::from(o) - f32::from(u)) * alpha + 0.5) as u8;
    [mix((under[0], over[0])), mix((under[1], over[1])), mix((under[2], over[2]))]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Eye;
    use crate::scene::Parts;

    const PAPER: Rgb = [255; 3];

    /// A square 2 wide, 5 before an eye at the origin, and the picture of it.
    fn picture(ceiling: Option<f32>) -> Canvas {
        let corners =
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, -5.0));
        let parts = Parts::<Solid>::simple("square", corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
        let scene = Scene::new(parts).expect("a scene");
        let (position, target) = (Vec3::ZERO, Vec3::NEG_Z);
        let eye = Eye { position, target, up: Vec3::Y, fov: 1.2, near: 0.1, far: 100.0 };
        let mut canvas = Canvas::new(View { eye, width: 300, height: 200 }, 1.0, PAPER, ceiling);
        canvas.surfaces(&scene, scene.live(), |_| Ink::of(Theme::Print, Role::Visible));
        canvas
    }

    #[test]
    fn a_line_is_parted_where_a_surface_covers_it() {
        let canvas = picture(None);
        let line = |z: f32| [Vec3::new(-3.0, 0.2, z), Vec3::new(3.0, 0.2, z)];
        let (front, behind) = canvas.parted(line(-6.0));
        assert_eq!((front.len(), behind.len()), (2, 1));
        // The rim of the square, seen 6 away, where two samples are 0.041: the rim is in front.
        let [from, to] = behind[0];
        assert!((-1.2..-1.15).contains(&from.x) && (1.15..1.2).contains(&to.x), "{from} {to}");
        for z in [-4.0, -5.0] {
            let (front, behind) = canvas.parted(line(z));
            assert!(front.len() == 1 && behind.is_empty(), "before it and on it: {z}");
            assert!((front[0][1] - front[0][0]).length() > 5.0);
        }
        let outside = canvas.parted([Vec3::new(90.0, 0.0, -5.0), Vec3::new(99.0, 0.0, -5.0)]);
        assert!(outside.0.is_empty() && outside.1.is_empty());
    }

    #[test]
    fn surfaces_hide_areas_behind_them_and_are_cut_by_the_ceiling() {
        let at = |pixels: &Pixels, x: usize, y: usize| {
            let from = 4 * (y * pixels.width as usize + x);
            [pixels.rgba[from], pixels.rgba[from + 1], pixels.rgba[from + 2]]
        };
        let mut canvas = picture(None);
        let wide = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]].map(|[x, y]| Vec3::new(x, y, -7.0));
        canvas.area(&wide, ([200, 0, 0], 1.0), None);
        let pixels = canvas.pixels();
        let square = at(&pixels, 150, 100);
        assert!(square[2] > square[0] && at(&pixels, 20, 20) == [200, 0, 0], "{square:?}");
        // 2 of 6.84 units of 200 pixels: rows 71 to 129.
        let cut = picture(Some(0.0)).pixels();
        assert_eq!((at(&cut, 150, 85), at(&cut, 150, 115)), (PAPER, square));
    }
}
