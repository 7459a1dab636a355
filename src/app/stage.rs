//! What is on stage: one scene of one space, a view path, the Eye as edited, and the recorded film.
//!
//! [`Stage`] knows its space; [`Staged`] is what panels that do not care about the space read.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::culling::Methods;
use crate::drawing::words::{Room, short};
use crate::drawing::{Drawing, Role, Subject};
use crate::geometry::{Aabb, NodeId, ObjectId, PrimId, Space, Vector, View, ViewPath};
use crate::method::{Card, Event, Field, Film, Knob, KnobValue, Verdict};
use crate::raster::DepthScale;
use crate::scene::{Report, Scene, framing_view, write_views};
use crate::trace::{Counts, Moves, Stamps, State};

/// Image size of the Eye when the scene brings no view of its own, pixels.
const DEFAULT_IMAGE_PX: [u32; 2] = [1024, 768];

/// A film with what is read from it often.
pub struct Recorded<S: Space> {
    /// The film.
    pub film: Arc<dyn Film<S>>,
    /// When each node and primitive was decided.
    pub stamps: Arc<Stamps>,
    /// Where steps lead.
    pub moves: Arc<Moves>,
    /// Number of primitives that the frame draws.
    pub drawn: usize,
    /// Changes whenever another film is on stage; for caches.
    pub serial: u64,
}

/// A scene with everything that is looked at.
pub struct Stage<S: Space> {
    /// The scene.
    pub scene: Arc<Scene<S>>,
    /// Changes whenever another scene is on stage; for caches.
    pub serial: u64,
    /// View paths to choose from; never empty.
    pub paths: Vec<ViewPath<S>>,
    /// Which of them.
    pub path: usize,
    /// Which view of the path.
    pub frame: usize,
    /// The view that culling uses: that of the path until the Eye is moved.
    pub view: View<S>,
    /// The recorded film; `None` until the first recording is done.
    pub recorded: Option<Recorded<S>>,
    /// The views of a flight that is being recorded.
    flight: Option<Vec<View<S>>>,
}

impl<S: Space> Stage<S> {
    /// Puts a scene on stage, with its own view paths or one view that frames it.
    pub fn new(scene: Arc<Scene<S>>, own: Option<ViewPath<S>>, serial: u64) -> Self {
        let mut paths: Vec<_> =
            own.into_iter().chain(scene.paths().iter().cloned()).filter(|p| !p.views.is_empty()).collect();
        if paths.is_empty() {
            let view = framing_view(&scene.bounds(), DEFAULT_IMAGE_PX[0], DEFAULT_IMAGE_PX[1]);
            paths.push(ViewPath { name: "overview".into(), views: vec![view] });
        }
        let view = paths[0].views[0];
        Self { scene, serial, paths, path: 0, frame: 0, view, recorded: None, flight: None }
    }
    /// The path that is followed.
    pub fn views(&self) -> &[View<S>] {
        &self.paths[self.path].views
    }
    /// Goes to a view of a path; out of range is clamped.
    pub fn go(&mut self, path: usize, frame: usize) {
        self.path = path.min(self.paths.len() - 1);
        self.frame = frame.min(self.views().len() - 1);
        self.view = self.views()[self.frame];
    }
    /// Begins a flight at the present view (`None`), or ends it: the number of its views, and the view file's
    /// text if the Eye was moved at all. It is then the last path, and followed from its first view.
    pub fn fly(&mut self) -> Option<(usize, Option<String>)> {
        let Some(views) = self.flight.take() else {
            self.flight = Some(vec![self.view]);
            return None;
        };
        let frames = views.len();
        if frames < 2 {
            return Some((frames, None));
        }
        let path = ViewPath { name: "flight".into(), views };
        let text = write_views(&path, self.scene.origin());
        self.paths.push(path);
        self.go(self.paths.len() - 1, 0);
        Some((frames, Some(text)))
    }
    /// Adds the present view to a flight that is being recorded, if it is a new one.
    pub fn keep_flying(&mut self) {
        if let Some(flight) = &mut self.flight
            && flight.last() != Some(&self.view)
        {
            flight.push(self.view);
        }
    }
    /// Moves the Eye by a world vector, target and all.
    pub fn shift_eye(&mut self, by: S::Vector) {
        self.view.eye.position = self.view.eye.position + by;
        self.view.eye.target = self.view.eye.target + by;
    }
    fn vector(v: S::Vector) -> String {
        (0..S::Vector::AXES).map(|a| short(v.get(a), Room::Row)).collect::<Vec<_>>().join(", ")
    }
}

/// A stage as panels see it that do not care about the space.
pub trait Staged {
    /// `flatland` or `space`.
    fn space_name(&self) -> &'static str;
    /// `segment` or `triangle`.
    fn prim_name(&self) -> &'static str;
    /// Short name of the scene.
    fn scene_name(&self) -> &str;
    /// Where the scene came from.
    fn source(&self) -> &str;
    /// Hash of the scene.
    fn hash_hex(&self) -> String;
    /// What was noticed while loading.
    fn report(&self) -> &Report;
    /// Number of live primitives.
    fn prim_count(&self) -> usize;
    /// Whether there is such a primitive.
    fn has_prim(&self, prim: PrimId) -> bool;
    /// Number of objects.
    fn object_count(&self) -> usize;
    /// Name of an object.
    fn object_name(&self, object: ObjectId) -> &str;
    /// Object of a primitive.
    fn object_of(&self, prim: PrimId) -> ObjectId;
    /// Whether a film is on stage.
    fn has_film(&self) -> bool;
    /// See [`Recorded::serial`]; 0 if there is no film.
    fn film_serial(&self) -> u64;
    /// Identity of the method that was recorded.
    fn card(&self) -> Option<&'static Card>;
    /// Parameters of the recorded run.
    fn film_knobs(&self) -> Vec<(Knob, KnobValue)>;
    /// Names of the method's pictures that are not of the world.
    fn pictures(&self) -> &'static [&'static str];
    /// One of them at a step; empty if there is none.
    fn picture(&self, step: usize, which: usize, scale: DepthScale) -> Drawing;
    /// What is under a point of it, in words.
    fn probe(&self, step: usize, which: usize, at: glam::Vec2) -> Option<String>;
    /// Events of the film.
    fn events(&self) -> &[Event];
    /// Events that were not kept.
    fn lost(&self) -> u64;
    /// Bytes of the film.
    fn film_bytes(&self) -> usize;
    /// Number of primitives drawn at the end.
    fn drawn(&self) -> usize;
    /// Moves of the film.
    fn moves(&self) -> Option<&Moves>;
    /// Kind and operands of an event.
    fn fields(&self, at: usize) -> (&'static str, Vec<Field>);
    /// What an event did.
    fn sentence(&self, at: usize) -> String;
    /// Counts at a step.
    fn counts(&self, step: usize) -> Counts;
    /// The roles of the marks with which the method explains a step, for the legend.
    fn evidence_roles(&self, step: usize) -> BTreeSet<Role>;
    /// Number of nodes of the index.
    fn node_count(&self) -> usize;
    /// Parent of a node.
    fn parent(&self, node: NodeId) -> Option<NodeId>;
    /// Level of a node.
    fn level(&self, node: NodeId) -> u32;
    /// Primitives at and below a node.
    fn node_prims(&self, node: NodeId) -> &[PrimId];
    /// Smallest node that holds a primitive.
    fn leaf_of(&self, prim: PrimId) -> Option<NodeId>;
    /// State of a node at a step.
    fn node_state(&self, node: NodeId, step: usize) -> State;
    /// State of a primitive at a step.
    fn prim_state(&self, prim: PrimId, step: usize) -> State;
    /// Step from which on a node's decision holds, if it was decided itself, and the decision.
    fn node_decision(&self, node: NodeId) -> Option<(usize, Verdict)>;
    /// Step at which a node was entered.
    fn node_entered(&self, node: NodeId) -> Option<usize>;
    /// Step from which on a primitive's decision holds, and the decision.
    fn prim_decision(&self, prim: PrimId) -> Option<(usize, Verdict)>;
    /// Facts about a thing, by name.
    fn facts(&self, subject: Subject) -> Vec<(&'static str, String)>;
    /// Names and lengths of the view paths.
    fn path_names(&self) -> Vec<(String, usize)>;
    /// Path and frame.
    fn place(&self) -> (usize, usize);
    /// Whether the Eye was moved away from its path.
    fn is_eye_moved(&self) -> bool;
    /// The Eye in one line that can be pasted into a command line.
    fn eye_text(&self) -> String;
    /// Every method of the space.
    fn methods(&self) -> Vec<&'static Card>;
}

impl<S: Methods> Staged for Stage<S> {
    fn space_name(&self) -> &'static str {
        S::NAME
    }
    fn prim_name(&self) -> &'static str {
        S::PRIM
    }
    fn scene_name(&self) -> &str {
        self.scene.name()
    }
    fn source(&self) -> &str {
        self.scene.source()
    }
    fn hash_hex(&self) -> String {
        self.scene.hash_hex()
    }
    fn report(&self) -> &Report {
        self.scene.report()
    }
    fn prim_count(&self) -> usize {
        self.scene.live().len()
    }
    fn has_prim(&self, prim: PrimId) -> bool {
        prim.at() < self.scene.prim_count() && self.scene.corners(prim).is_some()
    }
    fn object_count(&self) -> usize {
        self.scene.objects().len()
    }
    fn object_name(&self, object: ObjectId) -> &str {
        self.scene.objects().get(object.at()).map_or("", |o| &o.name)
    }
    fn object_of(&self, prim: PrimId) -> ObjectId {
        self.scene.object_of(prim)
    }
    fn has_film(&self) -> bool {
        self.recorded.is_some()
    }
    fn film_serial(&self) -> u64 {
        self.recorded.as_ref().map_or(0, |r| r.serial)
    }
    fn card(&self) -> Option<&'static Card> {
        self.recorded.as_ref().map(|r| r.film.card())
    }
    fn film_knobs(&self) -> Vec<(Knob, KnobValue)> {
        self.recorded.as_ref().map_or(vec![], |r| r.film.knobs().to_vec())
    }
    fn pictures(&self) -> &'static [&'static str] {
        self.recorded.as_ref().map_or(&[], |r| r.film.pictures())
    }
    fn picture(&self, step: usize, which: usize, scale: DepthScale) -> Drawing {
        self.recorded
            .as_ref()
            .filter(|_| which < self.pictures().len())
            .map_or(Drawing::default(), |r| r.film.picture(step, which, scale))
    }
    fn probe(&self, step: usize, which: usize, at: glam::Vec2) -> Option<String> {
        self.recorded.as_ref()?.film.probe(step, which, at)
    }
    fn events(&self) -> &[Event] {
        self.recorded.as_ref().map_or(&[], |r| r.film.events())
    }
    fn lost(&self) -> u64 {
        self.recorded.as_ref().map_or(0, |r| r.film.lost())
    }
    fn film_bytes(&self) -> usize {
        self.recorded.as_ref().map_or(0, |r| r.film.bytes())
    }
    fn drawn(&self) -> usize {
        self.recorded.as_ref().map_or(0, |r| r.drawn)
    }
    fn moves(&self) -> Option<&Moves> {
        self.recorded.as_ref().map(|r| &*r.moves)
    }
    fn fields(&self, at: usize) -> (&'static str, Vec<Field>) {
        self.recorded
            .as_ref()
            .filter(|_| at < self.events().len())
            .map_or(("", vec![]), |r| r.film.fields(at))
    }
    fn sentence(&self, at: usize) -> String {
        self.recorded
            .as_ref()
            .filter(|_| at < self.events().len())
            .map_or(String::new(), |r| r.film.sentence(at))
    }
    fn evidence_roles(&self, step: usize) -> BTreeSet<Role> {
        let mut to = Drawing::default();
        if let Some(recorded) = &self.recorded {
            recorded.film.explain(step, &mut to);
        }
        to.items.iter().map(|i| i.role).collect()
    }
    fn counts(&self, step: usize) -> Counts {
        self.recorded.as_ref().map_or(Counts::default(), |r| r.stamps.counts(step))
    }
    fn node_count(&self) -> usize {
        self.recorded.as_ref().map_or(0, |r| r.film.hierarchy().node_count())
    }
    fn parent(&self, node: NodeId) -> Option<NodeId> {
        self.recorded.as_ref().and_then(|r| r.film.hierarchy().parent(node))
    }
    fn level(&self, node: NodeId) -> u32 {
        self.recorded.as_ref().map_or(0, |r| r.film.hierarchy().level(node))
    }
    fn node_prims(&self, node: NodeId) -> &[PrimId] {
        self.recorded.as_ref().map_or(&[], |r| r.film.hierarchy().prims(node))
    }
    fn leaf_of(&self, prim: PrimId) -> Option<NodeId> {
        let hierarchy = self.recorded.as_ref()?.film.hierarchy();
        let mut node = NodeId(0);
        loop {
            match hierarchy.children(node).map(NodeId).find(|&c| hierarchy.prims(c).contains(&prim)) {
                Some(child) => node = child,
                None => return Some(node),
            }
        }
    }
    fn node_state(&self, node: NodeId, step: usize) -> State {
        self.recorded.as_ref().map_or(State::Unseen, |r| r.stamps.node(node, step))
    }
    fn prim_state(&self, prim: PrimId, step: usize) -> State {
        self.recorded.as_ref().map_or(State::Unseen, |r| r.stamps.prim(prim, step))
    }
    fn node_decision(&self, node: NodeId) -> Option<(usize, Verdict)> {
        let stamp = self.recorded.as_ref()?.stamps.nodes()[node.at()];
        (stamp.step != crate::trace::Stamp::NEVER).then_some((stamp.step as usize, stamp.verdict))
    }
    fn node_entered(&self, node: NodeId) -> Option<usize> {
        Some(self.recorded.as_ref()?.stamps.entered(node))
            .filter(|&s| s != crate::trace::Stamp::NEVER)
            .map(|s| s as usize)
    }
    fn prim_decision(&self, prim: PrimId) -> Option<(usize, Verdict)> {
        let stamp = self.recorded.as_ref()?.stamps.prims()[prim.at()];
        (stamp.step != crate::trace::Stamp::NEVER).then_some((stamp.step as usize, stamp.verdict))
    }
    fn facts(&self, subject: Subject) -> Vec<(&'static str, String)> {
        match subject {
            Subject::Prim(prim) if self.has_prim(prim) => self.prim_facts(prim),
            Subject::Node(node) if node.at() < self.node_count() => self.node_facts(node),
            Subject::Object(object) => self.object_facts(object),
            Subject::Eye => self.eye_facts(),
            _ => vec![],
        }
    }
    fn path_names(&self) -> Vec<(String, usize)> {
        self.paths.iter().map(|p| (p.name.clone(), p.views.len())).collect()
    }
    fn place(&self) -> (usize, usize) {
        (self.path, self.frame)
    }
    fn is_eye_moved(&self) -> bool {
        self.view != self.views()[self.frame]
    }
    fn eye_text(&self) -> String {
        let list =
            |v: S::Vector| (0..S::Vector::AXES).map(|a| v.get(a).to_string()).collect::<Vec<_>>().join(",");
        let (v, e) = (&self.view, &self.view.eye);
        let up = if S::Vector::AXES == 3 { format!(" --up {}", list(e.up)) } else { String::new() };
        format!(
            "--eye {} --target {}{up} --fov {} --near {} --far {} --size {}x{}",
            list(e.position),
            list(e.target),
            e.fov.to_degrees(),
            e.near,
            e.far,
            v.width,
            v.height
        )
    }
    fn methods(&self) -> Vec<&'static Card> {
        S::methods().iter().map(|m| m.card()).collect()
    }
}

impl<S: Methods> Stage<S> {
    fn box_text(bounds: &Aabb<S::Vector>) -> String {
        format!("{} to {}", Self::vector(bounds.min), Self::vector(bounds.max))
    }
    fn prim_facts(&self, prim: PrimId) -> Vec<(&'static str, String)> {
        let scene = &self.scene;
        let mut facts =
            vec![("id", prim.to_string()), ("object", self.object_name(scene.object_of(prim)).to_owned())];
        facts.push(("material", scene.materials()[scene.material_of(prim).at()].name.clone()));
        facts.extend(
            scene
                .prim_points(prim)
                .zip(["corner a", "corner b", "corner c"])
                .map(|(p, name)| (name, Self::vector(p))),
        );
        if let Some(leaf) = self.leaf_of(prim) {
            facts.push(("in node", leaf.to_string()));
        }
        facts
    }
    fn node_facts(&self, node: NodeId) -> Vec<(&'static str, String)> {
        let Some(recorded) = &self.recorded else { return vec![] };
        let hierarchy = recorded.film.hierarchy();
        let children: Vec<_> = hierarchy.children(node).map(|c| c.to_string()).collect();
        vec![
            ("id", node.to_string()),
            ("level", hierarchy.level(node).to_string()),
            ("parent", hierarchy.parent(node).map_or("none: the root".into(), |p| p.to_string())),
            ("children", if children.is_empty() { "none: a leaf".into() } else { children.join(", ") }),
            ("holds", format!("{} {}s", hierarchy.prims(node).len(), S::PRIM)),
            ("box", Self::box_text(&hierarchy.bounds(node))),
        ]
    }
    fn object_facts(&self, object: ObjectId) -> Vec<(&'static str, String)> {
        let prims: Vec<_> =
            self.scene.live().iter().filter(|&&p| self.scene.object_of(p) == object).collect();
        let bounds =
            prims.iter().fold(Aabb::empty(), |b: Aabb<S::Vector>, &&p| b.union(self.scene.prim_bounds(p)));
        let mut facts = vec![
            ("name", self.object_name(object).to_owned()),
            ("holds", format!("{} {}s", prims.len(), S::PRIM)),
        ];
        if !bounds.is_empty() {
            facts.push(("box", Self::box_text(&bounds)));
        }
        facts
    }
    fn eye_facts(&self) -> Vec<(&'static str, String)> {
        let (v, e) = (&self.view, &self.view.eye);
        vec![
            ("stands at", Self::vector(e.position)),
            ("looks at", Self::vector(e.target)),
            ("angle", format!("{:.1}°", e.fov.to_degrees())),
            ("sees from", format!("{} to {} units", short(e.near, Room::Row), short(e.far, Room::Row))),
            ("image", format!("{} × {} pixels", v.width, v.height)),
        ]
    }
}
