//! Space as a figure has it: surfaces, boxes of nodes and areas as pixels in the style of the screen, painted
//! without a graphics card and so the same on every machine; marks before all surfaces as vectors.

use glam::Vec3;

use std::collections::BTreeMap;

use super::canvas::{Canvas, Ink, shade, shaded};
use super::shown::{LookIn, Shown, Surface, Theme};
use super::stage::{Recorded, Stage};
use crate::drawing::{Drawing, Layer, Mark, Pixels, Role, Subject, words};
use crate::figure::{self, Face, Look, role_of};
use crate::geometry::{Aabb, NodeId, PrimId, Solid, View};
use crate::index::Hierarchy;
use crate::trace::Stamp;

/// Opacity of surfaces that are seen through, of those that are translucent on demand, and of lines behind
/// surfaces.
const GHOST: f32 = 0.25;
const TRANSLUCENT: f32 = 0.3;
const BEHIND: f32 = 0.25;
/// Width of the boxes of nodes that are open and of those that are decided, of the role's lines, and how
/// strong the latter are: there are hundreds of them in the end.
const OPEN_BOX: f32 = 0.6;
const DONE_BOX: f32 = 0.44;
const DONE: f32 = 0.6;

/// What of a step is shown, and how.
pub(super) struct Ask {
    pub step: usize,
    pub look: Look,
    pub shown: Shown,
    /// Whether it is the Eye's picture, which has no help lines.
    pub is_eye: bool,
    pub theme: Theme,
    pub pixels_per_point: f32,
}

/// Something that one sees through: its role, when it was decided, and its opacity.
type Ghost = (Role, Stamp, PrimId, f32);

/// Triangles that vectors are for, at most.
const MOST_VECTORS: usize = 6_000;

/// How the triangles of a role are drawn.
#[derive(Clone, Copy, PartialEq)]
enum Drawn {
    Solid,
    Ghost(f32),
    Not,
}

impl Ask {
    fn drawn(&self, role: Role, has_stand_ins: bool) -> Drawn {
        let clear = self.shown.surface == Surface::Translucent;
        match role {
            _ if !self.shown.prims => Drawn::Not,
            Role::Approximated if has_stand_ins => Drawn::Not,
            Role::Visible | Role::Scene | Role::Undecided if clear => Drawn::Ghost(TRANSLUCENT),
            Role::Visible => Drawn::Solid,
            // In the Eye's picture a hint, so that it is never empty.
            Role::Scene | Role::Undecided if self.is_eye => Drawn::Ghost(GHOST),
            Role::Scene | Role::Undecided => Drawn::Solid,
            _ if self.is_eye => Drawn::Not,
            _ => Drawn::Ghost(if clear { TRANSLUCENT } else { GHOST }),
        }
    }
    fn ink(&self, role: Role) -> Ink {
        Ink::of(self.theme, role)
    }
}

impl Stage<Solid> {
    /// A step as `view` sees it: the picture, and what is to be drawn over it.
    pub(super) fn surfaces(&self, view: &View<Solid>, ask: &Ask) -> Option<(Pixels, Drawing<Vec3>)> {
        let recorded = self.recorded.as_ref()?;
        let ceiling = (!ask.is_eye && ask.shown.look_in == LookIn::Cut).then_some(self.view.eye.position.y);
        let mut canvas = Canvas::new(*view, ask.pixels_per_point, ask.theme.paper(), ceiling);
        self.triangles(recorded, view, ask, &mut canvas);
        if !ask.is_eye {
            let has_stand_ins = self.has_stand_ins(ask);
            boxes(recorded, ask, has_stand_ins, &mut canvas);
        }
        let look = Look { prims: false, nodes: false, ..ask.look };
        let mut marks = figure::world(&*recorded.film, &recorded.stamps, ask.step, &look);
        if ask.is_eye {
            marks.items.retain(|i| i.layer == Layer::Emphasis || i.role == Role::Current);
        }
        let over = marked(&marks, ask, &mut canvas);
        Some((canvas.pixels(), over))
    }

    fn has_stand_ins(&self, ask: &Ask) -> bool {
        ask.shown.evidence && self.drawn(0).is_some()
    }

    /// A step as vectors: surfaces that hide each other, the outlines of what was left out, and what is to be
    /// drawn over both.
    pub(super) fn faces(&self, view: &View<Solid>, ask: &Ask) -> Option<(Vec<Face>, Drawing<Vec3>)> {
        let recorded = self.recorded.as_ref()?;
        let (solid, ghosts) = self.sorted(recorded, view, ask);
        let role = |prim: PrimId| role_of(recorded.stamps.prim(prim, ask.step));
        let all = solid.iter().map(|&p| (p, true)).chain(ghosts.iter().map(|g| (g.2, false)));
        let scene = self.posed();
        let ceiling = (ask.shown.look_in == LookIn::Cut).then_some(self.view.eye.position.y);
        let faces = all.filter_map(|(prim, is_solid)| {
            let lit = || shaded(ask.ink(role(prim)).flat, shade(scene, prim));
            let points: Vec<Vec3> = lowered(scene.prim_points(prim).collect(), ceiling);
            (points.len() > 2).then(|| Face {
                is_edge: vec![true; points.len()],
                points,
                rgb: is_solid.then(lit),
                role: role(prim),
                subject: Subject::Prim(prim),
            })
        });
        let faces = without_seams(faces.collect());
        let look = Look { prims: false, nodes: false, ..ask.look };
        let mut over = figure::world(&*recorded.film, &recorded.stamps, ask.step, &look);
        for (node, role, _) in frontier(recorded, ask, false) {
            for ends in edges(recorded.film.hierarchy(), node) {
                over.line(Layer::Nodes, role, Subject::Node(node), ends);
            }
        }
        Some((faces, over))
    }

    /// Refuses vectors of a scene that is too large for them.
    ///
    /// # Errors
    /// How large it is, in a line.
    pub(super) fn refuse_vectors(&self) -> Result<(), String> {
        if self.drawn(0).is_some() {
            return Err("what stands for triangles is seen through, which vectors cannot show; leave it as \
                        pixels"
                .into());
        }
        let count = self.posed().live().len();
        if count <= MOST_VECTORS {
            return Ok(());
        }
        let [count, most] = [count, MOST_VECTORS].map(words::count);
        Err(format!(
            "{count} triangles are too many for vectors, which have up to {most}; leave them as pixels"
        ))
    }

    /// What is drawn as surfaces, and what as something that one sees through.
    fn sorted(&self, recorded: &Recorded<Solid>, view: &View<Solid>, ask: &Ask) -> (Vec<PrimId>, Vec<Ghost>) {
        let scene = self.posed();
        let has_stand_ins = self.has_stand_ins(ask);
        let only_fronts = !ask.is_eye && ask.shown.look_in == LookIn::Faces;
        let (mut solid, mut ghosts) = (Vec::new(), Vec::new());
        for &prim in scene.live() {
            if !self.shows(prim) || only_fronts && scene.faces_away(prim, view.eye.position) {
                continue;
            }
            let role = role_of(recorded.stamps.prim(prim, ask.step));
            match ask.drawn(role, has_stand_ins) {
                Drawn::Solid => solid.push(prim),
                Drawn::Ghost(fill) => ghosts.push((role, recorded.stamps.prims()[prim.at()], prim, fill)),
                Drawn::Not => {}
            }
        }
        (solid, ghosts)
    }

    fn triangles(&self, recorded: &Recorded<Solid>, view: &View<Solid>, ask: &Ask, canvas: &mut Canvas) {
        let scene = self.posed();
        let role = |prim: PrimId| role_of(recorded.stamps.prim(prim, ask.step));
        let (solid, mut ghosts) = self.sorted(recorded, view, ask);
        if ask.shown.surface == Surface::Wire {
            let strengths = ghosts.iter().map(|g| (g.2, 0.35)).chain(solid.iter().map(|p| (*p, 1.0)));
            for (prim, alpha) in strengths {
                let corners: Vec<Vec3> = scene.prim_points(prim).collect();
                for side in 0..corners.len() {
                    let ends = [corners[side], corners[(side + 1) % corners.len()]];
                    canvas.line(ends, &Ink { dash: &[], ..ask.ink(role(prim)) }, 0.5, [alpha; 2]);
                }
            }
            return;
        }
        canvas.surfaces(scene, &solid, |prim| ask.ink(role(prim)));
        // In the order of their decisions, as on screen.
        ghosts.sort_by_key(|(role, Stamp { step, .. }, prim, _)| (*role, *step, *prim));
        for (role, _, prim, fill) in ghosts {
            canvas.ghost(scene, prim, &ask.ink(role), fill);
        }
    }
}

/// Where the traversal stands: nodes that are decided as a whole, leaves, and those still open. With each its
/// role, and whether it is decided.
fn frontier(recorded: &Recorded<Solid>, ask: &Ask, has_stand_ins: bool) -> Vec<(NodeId, Role, bool)> {
    let (hierarchy, stamps) = (recorded.film.hierarchy(), &recorded.stamps);
    let mut found = Vec::new();
    if hierarchy.node_count() < 2 || !ask.shown.nodes {
        return found;
    }
    for node in (0..hierarchy.node_count() as u32).map(NodeId) {
        if stamps.entered(node) as usize > ask.step {
            continue;
        }
        let role = role_of(stamps.node(node, ask.step));
        let is_done = stamps.nodes()[node.at()].step as usize <= ask.step;
        let is_frontier = role != Role::Partial || hierarchy.children(node).is_empty() || !is_done;
        if !is_frontier || has_stand_ins && role == Role::Approximated {
            continue;
        }
        found.push((node, role, is_done));
    }
    found
}

fn boxes(recorded: &Recorded<Solid>, ask: &Ask, has_stand_ins: bool, canvas: &mut Canvas) {
    for (node, role, is_done) in frontier(recorded, ask, has_stand_ins) {
        let ink = ask.ink(role);
        let (width, strength) = if is_done { (DONE_BOX, DONE) } else { (OPEN_BOX, 1.0) };
        for ends in edges(recorded.film.hierarchy(), node) {
            canvas.line(ends, &ink, ink.width_pt * width, [strength, BEHIND * strength]);
        }
    }
}

fn edges(hierarchy: &dyn Hierarchy<Solid>, node: NodeId) -> Vec<[Vec3; 2]> {
    let bounds = hierarchy.bounds(node);
    Aabb::<Vec3>::edges().map(|(i, j)| [bounds.corner(i), bounds.corner(j)]).collect()
}

/// The part of a polygon below a ceiling.
fn lowered(points: Vec<Vec3>, ceiling: Option<f32>) -> Vec<Vec3> {
    let Some(ceiling) = ceiling else { return points };
    let mut kept = Vec::new();
    for (k, &b) in points.iter().enumerate() {
        let a = points[(k + points.len() - 1) % points.len()];
        if (a.y > ceiling) != (b.y > ceiling) {
            kept.push(a + (b - a) * ((ceiling - a.y) / (b.y - a.y)));
        }
        if b.y <= ceiling {
            kept.push(b);
        }
    }
    kept
}

/// Leaves out sides at which a surface goes on: in the same plane, with the same role. Of what is only
/// outlined a side that two share is drawn once, so that its pattern is seen.
fn without_seams(mut faces: Vec<Face>) -> Vec<Face> {
    let key = |p: Vec3| p.to_array().map(f32::to_bits);
    let mut sides: BTreeMap<_, Vec<(usize, usize)>> = BTreeMap::new();
    for (at, face) in faces.iter().enumerate() {
        for side in 0..face.points.len() {
            let (a, b) = (key(face.points[side]), key(face.points[(side + 1) % face.points.len()]));
            sides.entry((a.min(b), a.max(b))).or_default().push((at, side));
        }
    }
    for shared in sides.values().filter(|shared| shared.len() > 1) {
        let is_one = shared.len() == 2 && {
            let [one, other] = [0, 1].map(|k| &faces[shared[k].0]);
            one.role == other.role && normal(one).dot(normal(other)).abs() > FLAT
        };
        for (k, &(at, side)) in shared.iter().enumerate() {
            if is_one || k > 0 && faces[at].rgb.is_none() {
                faces[at].is_edge[side] = false;
            }
        }
    }
    faces
}

/// Cosine of the angle below which neighbors are one surface.
const FLAT: f32 = 0.9999;

fn normal(face: &Face) -> Vec3 {
    let [a, b, c] = [face.points[0], face.points[1], face.points[2]];
    (b - a).cross(c - a).normalize_or_zero()
}

/// Paints the areas of marks, and what of their lines lies behind surfaces, faintly; what is left is to be
/// drawn over the picture. What is marked as current or selected shows as a whole.
fn marked(marks: &Drawing<Vec3>, ask: &Ask, canvas: &mut Canvas) -> Drawing<Vec3> {
    let mut over = Drawing::default();
    for item in marks.painted() {
        let (layer, role, subject) = (item.layer, item.role, item.subject);
        let ink = ask.ink(role);
        let mut polyline = |points: &[Vec3], closed: bool, canvas: &mut Canvas| {
            let last = points.last().zip(points.first()).filter(|_| closed).map(|(a, b)| [*a, *b]);
            let sides = points.windows(2).map(|w| [w[0], w[1]]).chain(last);
            let mut drawn = Vec::new();
            for side in sides {
                let (front, behind) = canvas.parted(side);
                for part in behind {
                    canvas.line(part, &ink, ink.width_pt, [BEHIND; 2]);
                }
                drawn.extend(front);
            }
            joined(drawn, |points| over.push(layer, role, subject, Mark::Line { points, closed: false }));
        };
        match &item.mark {
            Mark::Line { points, closed } if !matches!(role, Role::Current | Role::Selected) => {
                polyline(points, *closed, canvas);
            }
            Mark::Area(points) => {
                canvas.area(points, ink.fill, Some((ink.hatch, ink.stroke)));
                polyline(points, true, canvas);
            }
            Mark::Swatch { points, rgba: [r, g, b, alpha] } => {
                canvas.area(points, ([*r, *g, *b], f32::from(*alpha) / 255.0), None);
            }
            _ => over.items.push(item.clone()),
        }
    }
    over
}

/// Parts that follow each other as one line.
fn joined(parts: Vec<[Vec3; 2]>, mut put: impl FnMut(Vec<Vec3>)) {
    let mut line: Vec<Vec3> = Vec::new();
    for [from, to] in parts {
        if line.last().is_some_and(|last| *last != from) {
            put(std::mem::take(&mut line));
        }
        if line.is_empty() {
            line.push(from);
        }
        line.push(to);
    }
    if line.len() > 1 {
        put(line);
    }
}
