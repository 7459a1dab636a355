//! What is on stage: one scene of one space, a view path, the Eye as edited, and the recorded film.
//!
//! [`Stage`] knows its space; [`Staged`] is what panels that do not care about the space read.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::DVec3;

use super::layers::Layers;
use crate::culling::Methods;
use crate::drawing::words::{Room, short};
use crate::drawing::{Drawing, Role, Subject};
use crate::geometry::{Aabb, Eye, NodeId, ObjectId, PrimId, Space, Vector, View, ViewPath};
use crate::index::Hierarchy;
use crate::method::{Card, Film, Reel, settings_for};
use crate::raster::Drawable;
use crate::scene::{Report, Scene, SceneError, framing_view, motion_path, parse_views, write_views};
use crate::trace::{Moves, Stamps};
use crate::truth::Judgement;

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
    /// Changes whenever another film is on stage; for caches.
    pub serial: u64,
    /// What it draws by layers, once someone has asked.
    pub layers: Option<Layers>,
    /// How what its run drew compares with the truth.
    pub truth: Arc<Judgement>,
}

/// A scene with everything that is looked at.
pub struct Stage<S: Space> {
    /// The scene as it was loaded; see [`Stage::posed`].
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
    /// Objects that are not shown.
    pub unshown: BTreeSet<ObjectId>,
    /// Changes with these; for caches.
    pub(super) shown_serial: u64,
    /// The recorded film; `None` until the first recording is done.
    pub recorded: Option<Recorded<S>>,
    /// The views of a flight that is being recorded.
    flight: Option<Vec<View<S>>>,
}

/// A scene on stage by [`Stage::serial`], its frame, and what of it is shown.
pub type PoseKey = (u64, Option<usize>, u64);

/// What became of a flight.
pub enum Flight {
    /// It is recorded from now on.
    Begun,
    /// The Eye was not moved, so there is nothing to keep.
    Dropped,
    /// It is a path now.
    Ended {
        /// Number of views, at least 2.
        frames: usize,
        /// The view file.
        text: String,
    },
}

impl<S: Space> Stage<S> {
    /// Puts a scene on stage, with its own view paths or one view that frames it; where things move, with a
    /// path through the motions.
    pub fn new(scene: Arc<Scene<S>>, own: Option<ViewPath<S>>, serial: u64) -> Self {
        let mut paths: Vec<_> =
            own.into_iter().chain(scene.paths().iter().cloned()).filter(|p| !p.views.is_empty()).collect();
        let framing = || framing_view(&scene.bounds(), DEFAULT_IMAGE_PX[0], DEFAULT_IMAGE_PX[1]);
        let first = paths.first().map_or_else(framing, |p| p.views[0]);
        paths.extend(motion_path(&scene, &paths, first));
        if paths.is_empty() {
            paths.push(ViewPath { name: "overview".into(), views: vec![first] });
        }
        let view = paths[0].views[0];
        let (unshown, shown_serial) = (BTreeSet::new(), 0);
        let (path, frame, recorded, flight) = (0, 0, None, None);
        Self { scene, serial, paths, path, frame, view, unshown, shown_serial, recorded, flight }
    }
    /// The scene as the film knows it: where objects move, in the frame of the film. As it was loaded before
    /// there is a film.
    pub fn posed(&self) -> &Arc<Scene<S>> {
        self.recorded.as_ref().map_or(&self.scene, |r| r.film.scene())
    }
    /// What the pictures of the scene depend on; for caches.
    pub fn pose_key(&self) -> PoseKey {
        (self.serial, self.posed().frame(), self.shown_serial)
    }
    /// The path that is followed.
    pub fn views(&self) -> &[View<S>] {
        &self.paths[self.path].views
    }
    /// A view moved away from the path, with depths that fit where it stands now. It sees as near and as far
    /// as its path's view as long as that does the scene justice: its far plane goes back where the scene
    /// reaches beyond it as it did not before, and its near plane comes forward where the scene does.
    pub fn fitted(&self, mut view: View<S>) -> View<S> {
        let (bounds, base) = (self.posed().bounds(), self.views()[self.frame].eye);
        let at = view.eye.position;
        let reach = |p: S::Vector| bounds.corners().map(|c| (c - p).length()).fold(0.0, f32::max);
        let gap = |p: S::Vector| (p.max(bounds.min).min(bounds.max) - p).length();
        let is_near = gap(at) >= base.near.min(gap(base.position));
        let least = (bounds.diagonal() * 1e-3).max(f32::MIN_POSITIVE);
        view.eye.near = if is_near { base.near } else { base.near.min(least) };
        let is_far = reach(at) <= base.far.max(reach(base.position));
        view.eye.far = if is_far { base.far } else { reach(at) * 1.1 };
        view
    }
    /// Adds a path as the first, from a view file.
    ///
    /// # Errors
    /// If the text is none.
    pub fn bring(&mut self, text: &str) -> Result<(), SceneError> {
        let path = parse_views(text.as_bytes(), "views of the session", self.scene.origin())?;
        self.paths.insert(0, path);
        Ok(())
    }
    /// Goes to a view of a path; out of range is clamped.
    pub fn go(&mut self, path: usize, frame: usize) {
        self.path = path.min(self.paths.len() - 1);
        self.frame = frame.min(self.views().len() - 1);
        self.view = self.views()[self.frame];
    }
    /// Begins a flight at the present view, or ends it. It is then the last path, and followed from its first
    /// view.
    pub fn fly(&mut self) -> Flight {
        let Some(views) = self.flight.take() else {
            self.flight = Some(vec![self.view]);
            return Flight::Begun;
        };
        let frames = views.len();
        if frames < 2 {
            return Flight::Dropped;
        }
        let path = ViewPath { name: "flight".into(), views };
        let text = write_views(&path, self.scene.origin());
        self.paths.push(path);
        self.go(self.paths.len() - 1, 0);
        Flight::Ended { frames, text }
    }
    /// Adds the present view to a flight that is being recorded, if it is a new one.
    pub fn keep_flying(&mut self) {
        if let Some(flight) = &mut self.flight
            && flight.last() != Some(&self.view)
        {
            flight.push(self.view);
        }
    }
    /// The box of a primitive, an object or a node; `None` of anything else.
    pub fn bounds_of(&self, subject: Subject) -> Option<Aabb<S::Vector>> {
        match subject {
            Subject::Prim(prim) if prim.at() < self.scene.prim_count() => {
                Some(self.posed().prim_bounds(prim))
            }
            Subject::Object(object) => {
                let boxes = self.scene.prims_of(object).into_iter().map(|p| self.posed().prim_bounds(p));
                Some(boxes.fold(Aabb::empty(), |all: Aabb<S::Vector>, b| all.union(b)))
            }
            Subject::Node(node) => {
                self.hierarchy().filter(|h| node.at() < h.node_count()).map(|h| h.bounds(node))
            }
            _ => None,
        }
    }
    /// What is brought into the picture with this selection: the thing, or else everything. The Eye too, in
    /// space unless it stands so far off that the scene would be a spot.
    pub fn framed(&self, selection: Subject) -> Aabb<S::Vector> {
        let (whole, eye) = (self.posed().bounds(), &self.view.eye);
        let is_flat = S::Vector::AXES == 2;
        match selection {
            Subject::Eye if is_flat => Aabb::of([eye.position, eye.target]),
            Subject::Eye => {
                let around = S::Vector::splat(whole.diagonal() * 0.1);
                Aabb { min: eye.position - around, max: eye.position + around }
            }
            selected => self.bounds_of(selected).unwrap_or_else(|| {
                let is_by = (eye.position - whole.center()).length() < 1.2 * whole.diagonal();
                if is_flat || is_by { whole.with(eye.position) } else { whole }
            }),
        }
    }
    /// The index of the film.
    fn hierarchy(&self) -> Option<&dyn Hierarchy<S>> {
        self.recorded.as_ref().map(|r| r.film.hierarchy())
    }
    fn vector(v: S::Vector) -> String {
        (0..S::Vector::AXES).map(|a| short(v.get(a), Room::Row)).collect::<Vec<_>>().join(", ")
    }
}

/// A scene as panels read it that do not care about the space.
pub trait SceneFacts {
    /// Short name.
    fn name(&self) -> &str;
    /// Where it came from.
    fn source(&self) -> &str;
    /// Hash of its content.
    fn hash_hex(&self) -> String;
    /// What was noticed while loading.
    fn report(&self) -> &Report;
    /// `segment` or `triangle`.
    fn prim_name(&self) -> &'static str;
    /// Number of live primitives.
    fn live_count(&self) -> usize;
    /// Whether there is such a live primitive.
    fn has_prim(&self, prim: PrimId) -> bool;
    /// Whether light comes through a primitive.
    fn is_see_through(&self, prim: PrimId) -> bool;
    /// Object of a primitive.
    fn object_of(&self, prim: PrimId) -> ObjectId;
    /// Live primitives of an object.
    fn prims_of(&self, object: ObjectId) -> Vec<PrimId>;
    /// Number of objects.
    fn object_count(&self) -> usize;
    /// Name of an object; empty if there is none.
    fn object_name(&self, object: ObjectId) -> &str;
    /// Number of objects that move, and of the frames of the longest motion.
    fn motions(&self) -> (usize, usize);
}

impl<S: Space> SceneFacts for Scene<S> {
    fn name(&self) -> &str {
        self.name()
    }
    fn source(&self) -> &str {
        self.source()
    }
    fn hash_hex(&self) -> String {
        self.hash_hex()
    }
    fn report(&self) -> &Report {
        self.report()
    }
    fn prim_name(&self) -> &'static str {
        S::PRIM
    }
    fn live_count(&self) -> usize {
        self.live().len()
    }
    fn has_prim(&self, prim: PrimId) -> bool {
        prim.at() < self.prim_count() && self.corners(prim).is_some()
    }
    fn is_see_through(&self, prim: PrimId) -> bool {
        self.is_see_through(prim)
    }
    fn object_of(&self, prim: PrimId) -> ObjectId {
        self.object_of(prim)
    }
    fn prims_of(&self, object: ObjectId) -> Vec<PrimId> {
        self.live().iter().copied().filter(|&p| self.object_of(p) == object).collect()
    }
    fn object_count(&self) -> usize {
        self.objects().len()
    }
    fn object_name(&self, object: ObjectId) -> &str {
        self.objects().get(object.at()).map_or("", |o| &o.name)
    }
    fn motions(&self) -> (usize, usize) {
        (self.objects().iter().filter(|o| o.motion.is_some()).count(), self.frame_count())
    }
}

/// A primitive at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtPixel {
    /// Which.
    pub prim: PrimId,
    /// View depth there, world units.
    pub depth: f32,
    /// Whether one sees through it.
    pub is_through: bool,
}

/// What hides a thing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HiddenBy {
    /// A sentence or two; empty where the evidence names it already.
    pub text: String,
    /// The things that hide it, what hides most of it first, with their names.
    pub by: Vec<(Subject, String)>,
    /// Whether there are more than these.
    pub is_part: bool,
}

/// A recorded film as panels read it that do not care about the space.
#[derive(Clone, Copy)]
pub struct Reading<'a> {
    /// The film.
    pub reel: &'a dyn Reel,
    /// When each node and primitive was decided.
    pub stamps: &'a Stamps,
    /// Where steps lead.
    pub moves: &'a Moves,
    /// See [`Recorded::serial`].
    pub serial: u64,
    /// See [`Recorded::layers`].
    pub layers: Option<&'a Layers>,
    /// See [`Recorded::truth`].
    pub truth: &'a Judgement,
}

impl Reading<'_> {
    /// Number of nodes of the index.
    pub fn node_count(&self) -> usize {
        self.stamps.nodes().len()
    }
}

/// A stage as panels read it that do not care about the space.
pub trait Staged {
    /// The scene.
    fn scene(&self) -> &dyn SceneFacts;
    /// The recorded film, once there is one.
    fn film(&self) -> Option<Reading<'_>>;
    /// The roles of the marks with which the method explains a step, for the legend.
    fn evidence_roles(&self, step: usize) -> BTreeSet<Role>;
    /// Parent of a node of the film's index.
    fn parent(&self, node: NodeId) -> Option<NodeId>;
    /// Number of primitives at and below a node.
    fn prims_below(&self, node: NodeId) -> usize;
    /// Smallest node that holds a primitive.
    fn leaf_of(&self, prim: PrimId) -> Option<NodeId>;
    /// Primitives at and below a node.
    fn prims_of_node(&self, node: NodeId) -> Vec<PrimId>;
    /// What hides primitives that are left out as hidden on the ground of the evidence that is event `at`;
    /// `None` where the method cannot tell.
    fn hidden_by(&self, at: usize, prims: &[PrimId]) -> Option<HiddenBy>;
    /// What covers the center of a pixel of the film's image, if nothing is culled, front to back.
    fn layers_at(&self, pixel: [u32; 2]) -> Vec<AtPixel>;
    /// Columns and rows of the film's image.
    fn image_size(&self) -> Option<[u32; 2]>;
    /// Facts about a thing, by name.
    fn facts(&self, subject: Subject) -> Vec<(&'static str, String)>;
    /// Names and lengths of the view paths.
    fn paths(&self) -> Vec<(String, usize)>;
    /// Path and frame.
    fn place(&self) -> (usize, usize);
    /// Which frame of its motions the scene shows, and of how many; `None` where nothing moves.
    fn frame_of_motion(&self) -> Option<(usize, usize)>;
    /// Whether the Eye was moved away from its path.
    fn is_eye_moved(&self) -> bool;
    /// What became of near and far where the Eye was moved out of the range of its path's view, in a line.
    fn changed_depths(&self) -> Option<String>;
    /// The Eye in one line that can be pasted into a command line, every bit of it.
    fn eye_text(&self) -> String;
    /// Where the Eye stands and looks, for people.
    fn eye_words(&self) -> String;
    /// Whether the path that is followed is the scene's, with the same number that it has there: then the
    /// place names the view.
    fn is_path_of_scene(&self) -> bool;
    /// The path that is followed as a view file, if it did not come with the scene.
    fn brought_path(&self) -> Option<String>;
    /// Parameters of the film that are not by default, as the command line takes them.
    fn changed(&self) -> Vec<(&'static str, String)>;
    /// Every method of the space.
    fn methods(&self) -> Vec<&'static Card>;
}

impl<S: Methods + Drawable> Staged for Stage<S> {
    fn scene(&self) -> &dyn SceneFacts {
        &*self.scene
    }
    fn film(&self) -> Option<Reading<'_>> {
        let r = self.recorded.as_ref()?;
        let (layers, truth) = (r.layers.as_ref(), &*r.truth);
        Some(Reading { reel: &*r.film, stamps: &r.stamps, moves: &r.moves, serial: r.serial, layers, truth })
    }
    fn evidence_roles(&self, step: usize) -> BTreeSet<Role> {
        let mut to = Drawing::default();
        if let Some(recorded) = &self.recorded {
            recorded.film.explain(step, &mut to);
        }
        to.items.iter().map(|i| i.role).collect()
    }
    fn parent(&self, node: NodeId) -> Option<NodeId> {
        self.hierarchy()?.parent(node)
    }
    fn prims_below(&self, node: NodeId) -> usize {
        self.hierarchy().map_or(0, |h| h.prims(node).len())
    }
    fn prims_of_node(&self, node: NodeId) -> Vec<PrimId> {
        self.hierarchy().map_or(vec![], |h| h.prims(node).to_vec())
    }
    fn hidden_by(&self, at: usize, prims: &[PrimId]) -> Option<HiddenBy> {
        self.hiders_of(at, prims)
    }
    fn layers_at(&self, pixel: [u32; 2]) -> Vec<AtPixel> {
        self.covering(pixel)
    }
    fn image_size(&self) -> Option<[u32; 2]> {
        self.recorded.as_ref().map(|r| [r.film.view().width, r.film.view().height])
    }
    fn leaf_of(&self, prim: PrimId) -> Option<NodeId> {
        let hierarchy = self.hierarchy()?;
        let mut node = NodeId(0);
        while let Some(child) =
            hierarchy.children(node).map(NodeId).find(|&c| hierarchy.prims(c).contains(&prim))
        {
            node = child;
        }
        Some(node)
    }
    fn facts(&self, subject: Subject) -> Vec<(&'static str, String)> {
        match subject {
            Subject::Prim(prim) if self.scene.has_prim(prim) => self.prim_facts(prim),
            Subject::Node(node) => self.node_facts(node),
            Subject::Object(object) => self.object_facts(object),
            Subject::Eye => self.eye_facts(),
            _ => vec![],
        }
    }
    fn paths(&self) -> Vec<(String, usize)> {
        self.paths.iter().map(|p| (p.name.clone(), p.views.len())).collect()
    }
    fn place(&self) -> (usize, usize) {
        (self.path, self.frame)
    }
    fn frame_of_motion(&self) -> Option<(usize, usize)> {
        let count = self.scene.frame_count();
        self.posed().frame().map(|frame| (frame % count, count))
    }
    fn is_eye_moved(&self) -> bool {
        self.view != self.views()[self.frame]
    }
    fn changed_depths(&self) -> Option<String> {
        let (now, base) = (&self.view.eye, &self.views()[self.frame].eye);
        let range = |e: &Eye<S>| format!("{} to {}", short(e.near, Room::Row), short(e.far, Room::Row));
        ((now.near, now.far) != (base.near, base.far)).then(|| {
            format!("near and far fitted to this place: {} units, on its path {}", range(now), range(base))
        })
    }
    fn eye_text(&self) -> String {
        view_text(&self.view, self.scene.origin())
    }
    fn eye_words(&self) -> String {
        let eye = &self.view.eye;
        format!("Eye at ({}) toward ({})", Self::vector(eye.position), Self::vector(eye.target))
    }
    fn is_path_of_scene(&self) -> bool {
        let own = Self::new(self.scene.clone(), None, 0).paths;
        own.get(self.path).is_some_and(|path| path.views == self.paths[self.path].views)
    }
    fn brought_path(&self) -> Option<String> {
        (!self.is_path_of_scene()).then(|| write_views(&self.paths[self.path], self.scene.origin()))
    }
    fn changed(&self) -> Vec<(&'static str, String)> {
        let Some(film) = self.recorded.as_ref().map(|r| &r.film) else { return vec![] };
        S::method(film.card().key).map_or(vec![], |entry| settings_for(entry, film.knobs()))
    }
    fn methods(&self) -> Vec<&'static Card> {
        S::methods().iter().map(|m| m.card()).collect()
    }
}

/// A view in the words of the command line, every bit of it.
pub fn view_text<S: Space>(view: &View<S>, origin: DVec3) -> String {
    let list = |v: S::Vector, origin: DVec3| {
        let number = |a: usize| match origin[a] {
            0.0 => v.get(a).to_string(),
            far => (f64::from(v.get(a)) + far).to_string(),
        };
        (0..S::Vector::AXES).map(number).collect::<Vec<_>>().join(",")
    };
    let e = &view.eye;
    let up = if S::Vector::AXES == 3 { format!(" --up {}", list(e.up, DVec3::ZERO)) } else { String::new() };
    format!(
        "--eye {} --target {}{up} --fov {} --near {} --far {} --size {}x{}",
        list(e.position, origin),
        list(e.target, origin),
        degrees(e.fov),
        e.near,
        e.far,
        view.width,
        view.height
    )
}

/// The shortest number of degrees that is this angle.
fn degrees(radians: f32) -> String {
    let exact = f64::from(radians).to_degrees();
    let is_it = |text: &String| text.parse::<f64>().is_ok_and(|d| d.to_radians() as f32 == radians);
    (0..12).map(|decimals| format!("{exact:.decimals$}")).find(is_it).unwrap_or_else(|| exact.to_string())
}

impl<S: Methods + Drawable> Stage<S> {
    fn box_text(bounds: &Aabb<S::Vector>) -> String {
        format!("{} to {}", Self::vector(bounds.min), Self::vector(bounds.max))
    }
    fn prim_facts(&self, prim: PrimId) -> Vec<(&'static str, String)> {
        let scene = &self.scene;
        let mut facts =
            vec![("id", prim.to_string()), ("object", scene.object_name(scene.object_of(prim)).to_owned())];
        facts.push(("material", scene.materials()[scene.material_of(prim).at()].name.clone()));
        match (scene.is_see_through(prim), scene.is_two_sided(prim)) {
            (false, false) => {}
            (true, false) => facts.push(("surface", "see-through".into())),
            (false, true) => facts.push(("surface", "two-sided".into())),
            (true, true) => facts.push(("surface", "see-through, two-sided".into())),
        }
        facts.extend(
            self.posed()
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
        let Some(hierarchy) = self.hierarchy().filter(|h| node.at() < h.node_count()) else { return vec![] };
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
        let mut facts = vec![
            ("name", self.scene.object_name(object).to_owned()),
            ("holds", format!("{} {}s", self.scene.prims_of(object).len(), S::PRIM)),
        ];
        if let Some(motion) = self.scene.objects().get(object.at()).and_then(|o| o.motion.as_ref()) {
            facts.push(("moves", format!("{} frames, repeated", motion.len())));
        }
        if let Some(bounds) = self.bounds_of(Subject::Object(object)).filter(|b| !b.is_empty()) {
            facts.push(("box", Self::box_text(&bounds)));
        }
        facts
    }
    fn eye_facts(&self) -> Vec<(&'static str, String)> {
        let (v, e) = (&self.view, &self.view.eye);
        let mut facts = vec![
            ("stands at", Self::vector(e.position)),
            ("looks at", Self::vector(e.target)),
            ("angle", format!("{:.1}°", e.fov.to_degrees())),
            ("sees from", format!("{} to {} units", short(e.near, Room::Row), short(e.far, Room::Row))),
            ("image", format!("{} × {} pixels", v.width, v.height)),
        ];
        facts.extend(self.changed_depths().map(|text| ("depths", text)));
        facts
    }
}
