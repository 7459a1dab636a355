//! Space as a figure has it: surfaces, boxes of nodes and areas as pixels in the style of the screen, painted
//! without a graphics card and so the same on every machine; marks before all surfaces as vectors.

use glam::Vec3;

use super::canvas::{Canvas, Ink};
use super::shown::{LookIn, Shown, Surface, Theme};
use super::stage::{Recorded, Stage};
use crate::drawing::{Drawing, Layer, Mark, Pixels, Role};
use crate::figure::{self, Look, role_of};
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
        if ask.shown.nodes && !ask.is_eye {
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

    fn triangles(&self, recorded: &Recorded<Solid>, view: &View<Solid>, ask: &Ask, canvas: &mut Canvas) {
        let scene = self.posed();
        let has_stand_ins = self.has_stand_ins(ask);
        let only_fronts = !ask.is_eye && ask.shown.look_in == LookIn::Faces;
        let role = |prim: PrimId| role_of(recorded.stamps.prim(prim, ask.step));
        let (mut solid, mut ghosts) = (Vec::new(), Vec::new());
        for &prim in scene.live() {
            if only_fronts && scene.faces_away(prim, view.eye.position) {
                continue;
            }
            match ask.drawn(role(prim), has_stand_ins) {
                Drawn::Solid => solid.push(prim),
                Drawn::Ghost(fill) => {
                    ghosts.push((role(prim), recorded.stamps.prims()[prim.at()], prim, fill))
                }
                Drawn::Not => {}
            }
        }
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

/// Where the traversal stands: nodes that are decided as a whole, leaves, and those still open.
fn boxes(recorded: &Recorded<Solid>, ask: &Ask, has_stand_ins: bool, canvas: &mut Canvas) {
    let (hierarchy, stamps) = (recorded.film.hierarchy(), &recorded.stamps);
    if hierarchy.node_count() < 2 {
        return;
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
        let ink = ask.ink(role);
        let (width, strength) = if is_done { (DONE_BOX, DONE) } else { (OPEN_BOX, 1.0) };
        for ends in edges(hierarchy, node) {
            canvas.line(ends, &ink, ink.width_pt * width, [strength, BEHIND * strength]);
        }
    }
}

fn edges(hierarchy: &dyn Hierarchy<Solid>, node: NodeId) -> Vec<[Vec3; 2]> {
    let bounds = hierarchy.bounds(node);
    Aabb::<Vec3>::edges().map(|(i, j)| [bounds.corner(i), bounds.corner(j)]).collect()
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
