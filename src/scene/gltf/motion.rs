//! The first animation of a glTF file as rigid motions of objects.
//!
//! Sampled at 24 frames a second. A node moves by its world transform then, times the inverse of the one at
//! rest; where that is no rotation and translation (something is scaled), the object stands still and a note
//! says so.

use std::collections::BTreeMap;
use std::sync::Arc;

use ::gltf::animation::{Interpolation, Property};
use ::gltf::json::validation::Checked;
use ::gltf::scene::Transform;
use ::gltf::{Document, Node};
use glam::{DMat3, DMat4, DQuat, DVec3, Vec3};

use super::Placed;
use super::data::Data;
use crate::geometry::Solid;
use crate::scene::{Parts, Pose};

/// Frames of a second of animation.
const FRAMES_PER_SECOND: f64 = 24.0;
/// Most frames of a motion: 25 seconds.
const MAX_FRAMES: usize = 600;
/// Most poses of all objects together: 28 bytes each.
const MAX_POSES: usize = 1 << 21;

/// Translation, rotation and scale of a node.
#[derive(Clone, Copy)]
struct Joint {
    translation: DVec3,
    rotation: DQuat,
    scale: DVec3,
}

impl Joint {
    fn matrix(&self) -> DMat4 {
        DMat4::from_scale_rotation_translation(self.scale, self.rotation.normalize(), self.translation)
    }
}

fn joint(node: &Node) -> Joint {
    let (t, r, s) = node.transform().decomposed();
    let rotation = DQuat::from_array(r.map(f64::from));
    let rotation =
        if rotation.is_finite() && rotation.length_squared() > 0.0 { rotation } else { DQuat::IDENTITY };
    Joint {
        translation: DVec3::from_array(t.map(f64::from)),
        rotation,
        scale: DVec3::from_array(s.map(f64::from)),
    }
}

/// Transform of a node relative to its parent, at rest.
pub(super) fn local(node: &Node) -> DMat4 {
    match node.transform() {
        Transform::Matrix { matrix } => DMat4::from_cols_array_2d(&matrix.map(|c| c.map(f64::from))),
        Transform::Decomposed { .. } => joint(node).matrix(),
    }
}

/// A curve of one property of one node.
struct Channel {
    node: usize,
    property: Property,
    times: Vec<f64>,
    values: Vec<f64>,
    step: bool,
}

impl Channel {
    /// The key before a time, the one after, and how far between.
    fn at(&self, time: f64) -> (usize, usize, f64) {
        let next = self.times.partition_point(|t| *t <= time);
        if next == 0 || next == self.times.len() {
            let end = next.saturating_sub(usize::from(next > 0));
            return (end, end, 0.0);
        }
        let (a, b) = (self.times[next - 1], self.times[next]);
        (next - 1, next, if self.step { 0.0 } else { (time - a) / (b - a) })
    }
    fn apply(&self, joint: &mut Joint, time: f64) {
        let (a, b, t) = self.at(time);
        let vector = |k: usize| DVec3::from_slice(&self.values[3 * k..]);
        match self.property {
            Property::Translation => joint.translation = vector(a).lerp(vector(b), t),
            Property::Scale => joint.scale = vector(a).lerp(vector(b), t),
            Property::Rotation => {
                let turn = |k: usize| DQuat::from_slice(&self.values[4 * k..]).normalize();
                joint.rotation = turn(a).slerp(turn(b), t);
            }
            Property::MorphTargetWeights => {}
        }
    }
}

/// Gives the objects of a scene their motions. What keeps the animation from being used becomes a note.
pub(super) fn attach(document: &Document, data: &Data, placed: &[Placed], parts: &mut Parts<Solid>) {
    let Some(animation) = document.animations().next() else { return };
    if document.animations().len() > 1 {
        parts.report.note(format!("only the first of {} animations is used", document.animations().len()));
    }
    let channels = match channels(document, &animation, data, parts) {
        Ok(channels) => channels,
        Err(why) => return parts.report.note(format!("animation left out: {why}")),
    };
    let duration = channels.iter().filter_map(|c| c.times.last()).copied().fold(0.0, f64::max);
    let frames = ((duration * FRAMES_PER_SECOND) as usize + 1).min(MAX_FRAMES);
    if frames * placed.len() > MAX_POSES {
        return parts
            .report
            .note(format!("animation left out: {frames} frames of {} objects are too many", placed.len()));
    }
    if frames as f64 + 1.0 < duration * FRAMES_PER_SECOND {
        parts.report.note(format!(
            "animation of {duration:.1} s cut to {MAX_FRAMES} frames at {FRAMES_PER_SECOND} a second"
        ));
    }
    let moves = sample(document, &channels, placed, frames, parts.origin);
    let bent = moves.iter().filter(|m| m.is_none()).count();
    if bent > 0 {
        parts.report.note(format!("{bent} objects are scaled by the animation and stand still"));
    }
    for (object, poses) in parts.objects.iter_mut().zip(moves) {
        let still = Pose { rotation: [0.0, 0.0, 0.0, 1.0], translation: [0.0; 3] };
        object.motion = poses.filter(|p| p.iter().any(|pose| *pose != still)).map(Arc::from);
    }
}

/// The channels of an animation that move nodes.
fn channels(
    document: &Document,
    animation: &::gltf::Animation,
    data: &Data,
    parts: &mut Parts<Solid>,
) -> Result<Vec<Channel>, String> {
    // The crate validates samplers only, and then takes nodes and paths for granted.
    let json = &document.as_json().animations[animation.index()];
    let nodes = document.nodes().len();
    let exists = |c: &::gltf::json::animation::Channel| {
        c.sampler.value() < json.samplers.len()
            && c.target.node.value() < nodes
            && matches!(c.target.path, Checked::Valid(_))
    };
    if !json.channels.iter().all(exists) {
        return Err("it names a sampler, node or property that is not there".into());
    }
    let mut channels = Vec::new();
    for channel in animation.channels() {
        match read(&channel, data)? {
            Some(channel) => channels.push(channel),
            None => parts.report.note("an animation of morph targets is left out"),
        }
    }
    Ok(channels)
}

/// The poses of every object in each frame; `None` for one whose transform is not rigid in some frame.
fn sample(
    document: &Document,
    channels: &[Channel],
    placed: &[Placed],
    frames: usize,
    origin: DVec3,
) -> Vec<Option<Vec<Pose>>> {
    let mut moves: Vec<Option<Vec<Pose>>> = vec![Some(Vec::with_capacity(frames)); placed.len()];
    let parents = parents(document);
    for frame in 0..frames {
        let world = worlds(document, &parents, channels, frame as f64 / FRAMES_PER_SECOND);
        for (object, poses) in placed.iter().zip(&mut moves) {
            if let Some(list) = poses {
                match rigid(world[object.node] * object.world.inverse(), origin) {
                    Some(pose) => list.push(pose),
                    None => *poses = None,
                }
            }
        }
    }
    moves
}

fn read(channel: &::gltf::animation::Channel, data: &Data) -> Result<Option<Channel>, String> {
    let (target, sampler) = (channel.target(), channel.sampler());
    let width = match target.property() {
        Property::Rotation => 4,
        Property::MorphTargetWeights => return Ok(None),
        _ => 3,
    };
    let times = data.floats(&sampler.input(), 1)?;
    let mut values = data.floats(&sampler.output(), width)?;
    if sampler.interpolation() == Interpolation::CubicSpline {
        // In-tangent, value, out-tangent: the values alone, joined straight.
        values = values.chunks_exact(3 * width).flat_map(|k| k[width..2 * width].to_vec()).collect();
    }
    let rising = times.windows(2).all(|w| w[0] < w[1]) && times.iter().all(|t| t.is_finite());
    if times.is_empty()
        || !rising
        || values.len() < times.len() * width
        || !values.iter().all(|v| v.is_finite())
    {
        return Err("its times do not rise, or its values are too few or not finite".into());
    }
    let zero = |q: &[f64]| q.iter().all(|v| *v == 0.0);
    if width == 4 && values.chunks_exact(4).any(zero) {
        return Err("a rotation of it is no rotation".into());
    }
    Ok(Some(Channel {
        node: target.node().index(),
        property: target.property(),
        times,
        values,
        step: sampler.interpolation() == Interpolation::Step,
    }))
}

fn parents(document: &Document) -> Vec<Option<usize>> {
    let mut parents = vec![None; document.nodes().len()];
    for node in document.nodes() {
        node.children().for_each(|c| parents[c.index()] = Some(node.index()));
    }
    parents
}

/// World transforms of all nodes at a time. Nodes on a cycle, which no scene holds, stay at rest.
fn worlds(document: &Document, parents: &[Option<usize>], channels: &[Channel], time: f64) -> Vec<DMat4> {
    let mut moved: BTreeMap<usize, Joint> = BTreeMap::new();
    let nodes: Vec<Node> = document.nodes().collect();
    for channel in channels {
        channel.apply(moved.entry(channel.node).or_insert_with(|| joint(&nodes[channel.node])), time);
    }
    let locals: Vec<DMat4> =
        nodes.iter().map(|n| moved.get(&n.index()).map_or_else(|| local(n), Joint::matrix)).collect();
    let mut worlds: Vec<Option<DMat4>> = vec![None; nodes.len()];
    for start in 0..nodes.len() {
        // Up to the first ancestor that is known, then down again.
        let (mut chain, mut at) = (Vec::new(), Some(start));
        while let Some(node) = at.filter(|n| worlds[*n].is_none() && chain.len() <= nodes.len()) {
            chain.push(node);
            at = parents[node];
        }
        let mut above = at.and_then(|n| worlds[n]).unwrap_or(DMat4::IDENTITY);
        for node in chain.into_iter().rev() {
            above *= locals[node];
            worlds[node] = Some(above);
        }
    }
    worlds.into_iter().zip(locals).map(|(w, l)| w.unwrap_or(l)).collect()
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
