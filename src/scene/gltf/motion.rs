//! The first animation of a glTF file as rigid motions of objects and cameras (glTF 2.0, section 3.11).
//!
//! Sampled at 24 frames a second. A node moves by its world transform then, times the inverse of the one at
//! rest; where that is no rotation and translation (something is scaled), its objects stand still and a note
//! says so. Only nodes that move and carry something, and those between, are looked at frame by frame.

use std::collections::BTreeMap;
use std::rc::Rc;

use glam::{DMat3, DMat4, DQuat, DVec3, Vec3};

use super::data::{Data, components};
use super::file::{Animation, Channel, Gltf, Index, Interpolation};
use super::tree::{Stand, Tree, local, turn};
use crate::scene::report::counted;
use crate::scene::{Pose, Progress, Report};

/// Frames of a second of animation.
const FRAMES_PER_SECOND: f64 = 24.0;
/// Most frames of a motion: 25 seconds.
const MAX_FRAMES: usize = 600;
/// Most transforms of all nodes in all frames together.
const MAX_POSES: usize = 1 << 21;
/// Numbers of key frames that every file may have; a longer one has at most one a byte.
const FREE_NUMBERS: usize = 1 << 20;

#[derive(Clone, Copy, PartialEq)]
enum Property {
    Translation,
    Rotation,
    Scale,
}

/// A curve of one property of one node.
struct Curve {
    property: Property,
    times: Rc<[f64]>,
    /// Of a cubic spline: in-tangent, value and out-tangent of each key.
    values: Vec<[f64; 4]>,
    interpolation: Interpolation,
}

impl Curve {
    /// The value at a time (Appendix C).
    fn at(&self, time: f64) -> [f64; 4] {
        let next = self.times.partition_point(|t| *t <= time);
        let cubic = self.interpolation == Interpolation::CubicSpline;
        let key = |k: usize| self.values[if cubic { 3 * k + 1 } else { k }];
        if next == 0 || next == self.times.len() {
            return key(next.saturating_sub(1));
        }
        let (before, span) = (next - 1, self.times[next] - self.times[next - 1]);
        let t = (time - self.times[before]) / span;
        let (a, b) = (key(before), key(next));
        match self.interpolation {
            Interpolation::Step => a,
            Interpolation::Linear if self.property == Property::Rotation => {
                turn(a).slerp(turn(b), t).to_array()
            }
            Interpolation::Linear => std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t),
            Interpolation::CubicSpline => {
                let (out, into) = (self.values[3 * before + 2], self.values[3 * next]);
                let (t2, t3) = (t * t, t * t * t);
                std::array::from_fn(|k| {
                    (2.0 * t3 - 3.0 * t2 + 1.0) * a[k]
                        + span * (t3 - 2.0 * t2 + t) * out[k]
                        + (3.0 * t2 - 2.0 * t3) * b[k]
                        + span * (t3 - t2) * into[k]
                })
            }
        }
    }

    fn apply(&self, stand: &mut Stand, time: f64) {
        let value = self.at(time);
        match self.property {
            Property::Translation => stand.translation = DVec3::from_slice(&value),
            Property::Scale => stand.scale = DVec3::from_slice(&value),
            Property::Rotation => stand.rotation = turn(value),
        }
    }
}

/// The animation that is shown.
pub(super) struct Clip {
    curves: BTreeMap<Index, Vec<Curve>>,
    pub(super) frames: usize,
    /// Nodes that move by themselves or with a node above them.
    pub(super) moving: Vec<bool>,
}

impl Clip {
    /// The first animation, if there is one that can be read; what is left out becomes a note.
    pub(super) fn read(gltf: &Gltf, data: &Data, tree: &Tree, report: &mut Report) -> Option<Self> {
        let first = gltf.animations.first()?;
        if gltf.animations.len() > 1 {
            let name = first.0.as_ref().ok().and_then(|a| a.name.as_deref());
            let name = name.map_or(String::new(), |n| format!(", `{}`,", super::file::short(n)));
            report.note(format!("only the first{name} of {} animations is used", gltf.animations.len()));
        }
        let mut curves = Curves { data, left: FREE_NUMBERS.max(data.file_bytes()), times: BTreeMap::new() };
        let read = first.0.as_ref().map_err(Clone::clone);
        let curves = match read.and_then(|animation| curves.of(animation, gltf, report)) {
            Ok(curves) => curves,
            Err(why) => {
                report.note(format!("animation left out: {why}"));
                return None;
            }
        };
        let last = curves.values().flatten().filter_map(|c| c.times.last());
        let duration = last.copied().fold(0.0, f64::max);
        let frames = ((duration * FRAMES_PER_SECOND) as usize).saturating_add(1).min(MAX_FRAMES);
        if frames as f64 + 1.0 < duration * FRAMES_PER_SECOND {
            report.note(format!(
                "animation of {duration:.1} s cut to {MAX_FRAMES} frames at {FRAMES_PER_SECOND} a second"
            ));
        }
        let mut moving = vec![false; gltf.nodes.len()];
        for node in &tree.order {
            let with = tree.parents[*node as usize].is_some_and(|p| moving[p as usize]);
            moving[*node as usize] = with || curves.contains_key(node);
        }
        Some(Self { curves, frames, moving })
    }

    /// The world transforms of these nodes, of those that move, frame by frame; `Err` when there are too many
    /// or `progress` asks to stop.
    pub(super) fn sample(
        &self,
        gltf: &Gltf,
        tree: &Tree,
        nodes: impl Iterator<Item = Index>,
        progress: &dyn Progress,
    ) -> Result<BTreeMap<Index, Vec<DMat4>>, String> {
        let mut worlds: BTreeMap<Index, Vec<DMat4>> =
            nodes.filter(|n| self.moving[*n as usize]).map(|n| (n, Vec::new())).collect();
        let mut needed = vec![false; gltf.nodes.len()];
        let mut path: Vec<Index> = Vec::new();
        for node in tree.order.iter().rev().filter(|n| self.moving[**n as usize]) {
            if needed[*node as usize] || worlds.contains_key(node) {
                path.push(*node);
                if let Some(parent) = tree.parents[*node as usize] {
                    needed[parent as usize] = true;
                }
            }
        }
        path.reverse();
        if path.len().saturating_mul(self.frames) > MAX_POSES {
            return Err(format!("{} frames of {} nodes are too many", self.frames, path.len()));
        }
        let rest: Vec<DMat4> = path.iter().map(|n| local(&gltf.nodes[*n as usize])).collect();
        let mut now = tree.worlds.clone();
        for frame in 0..self.frames {
            if frame % 16 == 0 && progress.cancelled() {
                return Err("cancelled".into());
            }
            for (node, rest) in path.iter().zip(&rest) {
                let above = tree.parents[*node as usize].map_or(DMat4::IDENTITY, |p| now[p as usize]);
                now[*node as usize] = above * self.local(gltf, *node, rest, frame);
            }
            worlds.iter_mut().for_each(|(node, list)| list.push(now[*node as usize]));
        }
        Ok(worlds)
    }

    fn local(&self, gltf: &Gltf, node: Index, rest: &DMat4, frame: usize) -> DMat4 {
        let Some(curves) = self.curves.get(&node) else { return *rest };
        let mut stand = Stand::of(&gltf.nodes[node as usize]);
        curves.iter().for_each(|c| c.apply(&mut stand, frame as f64 / FRAMES_PER_SECOND));
        stand.matrix()
    }
}

/// Reads curves, each list of times once.
struct Curves<'a, 'd> {
    data: &'a Data<'d>,
    /// Numbers that may still be read.
    left: usize,
    times: BTreeMap<Index, Rc<[f64]>>,
}

impl Curves<'_, '_> {
    /// The curves that move nodes, by node.
    fn of(
        &mut self,
        animation: &Animation,
        gltf: &Gltf,
        report: &mut Report,
    ) -> Result<BTreeMap<Index, Vec<Curve>>, String> {
        let mut curves: BTreeMap<Index, Vec<Curve>> = BTreeMap::new();
        let (mut shapes, mut pointers) = (0, 0);
        for channel in &animation.channels {
            let property = match channel.target.path.as_str() {
                "translation" => Property::Translation,
                "rotation" => Property::Rotation,
                "scale" => Property::Scale,
                "weights" => {
                    shapes += 1;
                    continue;
                }
                "pointer" => {
                    pointers += 1;
                    continue;
                }
                _ => return Err("it names a sampler, node or property that is not there".into()),
            };
            // A channel without a node is for an extension (5.7).
            let Some(node) = channel.target.node else { continue };
            if node as usize >= gltf.nodes.len() {
                return Err("it names a sampler, node or property that is not there".into());
            }
            curves.entry(node).or_default().push(self.read(animation, channel, property)?);
        }
        for (count, what) in [(shapes, "for morph targets"), (pointers, "for what is no node")] {
            if count > 0 {
                let channels = counted(count, "channel");
                report.note(format!("{channels} of the animation {what} left out"));
            }
        }
        Ok(curves)
    }

    /// Counts are compared before anything is read: many channels may name one long list.
    fn read(
        &mut self,
        animation: &Animation,
        channel: &Channel,
        property: Property,
    ) -> Result<Curve, String> {
        let Some(sampler) = animation.samplers.get(channel.sampler as usize) else {
            return Err("it names a sampler, node or property that is not there".into());
        };
        let keys = self.data.accessor(sampler.input)?.count;
        let output = self.data.accessor(sampler.output)?;
        let each = if sampler.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        if keys == 0 || keys.checked_mul(each) != Some(output.count) {
            return Err(format!("a channel has {keys} times and {} values", output.count));
        }
        let known = self.times.get(&sampler.input).cloned();
        let needed = output.count.saturating_mul(4).saturating_add(if known.is_none() { keys } else { 0 });
        let Some(left) = self.left.checked_sub(needed) else {
            return Err("its key frames are out of proportion to the file".into());
        };
        self.left = left;
        let times = match known {
            Some(times) => times,
            None => self.data.vectors::<1>(sampler.input)?.into_flattened().into(),
        };
        self.times.insert(sampler.input, times.clone());
        let rising = times.windows(2).all(|w| w[0] < w[1]) && times.iter().all(|t| t.is_finite());
        let values: Vec<[f64; 4]> = match components(output) {
            4 if property == Property::Rotation => self.data.vectors::<4>(sampler.output)?,
            _ if property == Property::Rotation => return Err("a rotation of it is no rotation".into()),
            _ => {
                self.data.vectors::<3>(sampler.output)?.into_iter().map(|[x, y, z]| [x, y, z, 0.0]).collect()
            }
        };
        if !rising || !values.as_flattened().iter().all(|v| v.is_finite()) {
            return Err("its times do not rise, or its values are not finite".into());
        }
        let keys = values.iter().skip(each / 2).step_by(each);
        if property == Property::Rotation && keys.clone().any(|q| *q == [0.0; 4]) {
            return Err("a rotation of it is no rotation".into());
        }
        Ok(Curve { property, times, values, interpolation: sampler.interpolation })
    }
}

/// Poses of what stands at `rest`, where it moves at all; `None` if it is not rigid in some frame.
pub(super) fn poses(worlds: &[DMat4], rest: &DMat4, origin: DVec3) -> Option<Vec<Pose>> {
    let back = rest.inverse();
    worlds.iter().map(|world| rigid(*world * back, origin)).collect()
}

/// A transform as a pose of points that had `origin` subtracted, if it is rigid within rounding.
fn rigid(transform: DMat4, origin: DVec3) -> Option<Pose> {
    /// Files hold 32-bit numbers; products of a few transforms are off by some of their roundings.
    const TOLERANCE: f64 = 1e-4;
    let turn = DMat3::from_mat4(transform);
    let off = turn * turn.transpose() - DMat3::IDENTITY;
    let orthogonal = off.to_cols_array().iter().all(|v| v.abs() < TOLERANCE);
    if !transform.is_finite() || !orthogonal || turn.determinant() < 0.0 {
        return None;
    }
    let rotation = DQuat::from_mat3(&turn).normalize();
    let translation = transform.w_axis.truncate() + rotation * origin - origin;
    let snap = |v: f64| if v.abs() < 1e-9 { 0.0 } else { v as f32 };
    let mut rotation = rotation.to_array().map(snap);
    if (rotation[3] - 1.0).abs() < 1e-7 && rotation[..3] == [0.0; 3] {
        rotation[3] = 1.0;
    }
    let translation = Vec3::from_array(translation.to_array().map(snap));
    translation.is_finite().then_some(Pose { rotation, translation: translation.to_array() })
}
