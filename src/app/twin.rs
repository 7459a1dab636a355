//! The flatland twin of a view of space: what the level plane through the Eye cuts of the scene, culled by
//! the same method from the same place.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use crate::culling::Methods;
use crate::drawing::words::count;
use crate::figure::{self, Look};
use crate::geometry::{Aabb, Eye, Flat, Solid, View};
use crate::method::{Event, Film, Settings, Verdict};
use crate::scene::{Object, Parts, Quiet, Report, Scene};
use crate::trace::Stamps;

/// Events of a film that a figure is made of.
const CAP_EVENTS: usize = 2_000_000;
/// The Eye looks up or down too steeply for a plan if less than this of its line of sight is level.
const LEVEL: f32 = 0.05;
/// Space around what is shown, of its size.
const MARGIN: f32 = 0.04;

/// A run in the plan.
pub struct Twin {
    film: Arc<dyn Film<Flat>>,
    stamps: Stamps,
}

/// The plane as flatland: x to the right, z toward the reader.
fn flat(p: Vec3) -> Vec2 {
    Vec2::new(p.x, -p.z)
}

impl Twin {
    /// Cuts a scene at the height of a view's Eye, and culls what is cut.
    ///
    /// # Errors
    /// Why there is none, in a line.
    pub fn of(
        scene: &Scene<Solid>,
        view: &View<Solid>,
        method: &str,
        settings: &Settings,
    ) -> Result<Self, String> {
        let level = flat(view.eye.forward());
        if level.length() < LEVEL {
            return Err("the Eye looks straight up or down, so that it sees nothing of its plane".into());
        }
        let cut = Scene::new(section(scene, view.eye.position.y)).map_err(|e| e.to_string())?;
        let entry = Flat::method(method).ok_or_else(|| format!("there is no {method} in flatland"))?;
        let run = entry.ready(&Arc::new(cut), settings, &Quiet).map_err(|e| e.to_string())?;
        let mut run = run.ok_or("it was stopped")?;
        let aspect = view.width as f32 / view.height.max(1) as f32;
        let position = flat(view.eye.position);
        let eye = Eye {
            position,
            target: position + level.normalize(),
            up: Vec2::Y,
            fov: 2.0 * ((view.eye.fov * 0.5).tan() * aspect).atan(),
            near: view.eye.near,
            far: view.eye.far,
        };
        let film = run.record(&View { eye, width: view.width, height: 1 }, CAP_EVENTS).film;
        let stamps = Stamps::new(&*film);
        Ok(Self { film, stamps })
    }

    /// The step at which it stands as another run does after these events: at the first decision of the same
    /// kind as the last one there; at its end where that has ended, or there is no such decision.
    pub fn moment(&self, events: &[Event], step: usize) -> usize {
        let own = self.film.events();
        let last = events[..step].iter().rev().find_map(|event| kind(*event));
        let same = last.and_then(|last| own.iter().position(|event| kind(*event) == Some(last)));
        match same {
            _ if step == events.len() => own.len(),
            _ if last.is_none() => 0,
            Some(at) => at + 1,
            None => own.len(),
        }
    }

    /// Its picture at a step.
    pub fn picture(&self, step: usize, look: &Look) -> figure::Picture {
        let world = figure::world(&*self.film, &self.stamps, step, look);
        let bounds = self.film.scene().bounds().with(self.film.view().eye.position);
        let air = Vec2::splat(bounds.diagonal() * MARGIN);
        figure::Picture::Flat(world, Aabb { min: bounds.min - air, max: bounds.max + air })
    }

    /// What a caption says of it at a step.
    pub fn caption(&self, step: usize) -> String {
        let [cut, step, last] = [self.film.scene().live().len(), step, self.film.events().len()].map(count);
        format!(
            "Flatland twin: what the level plane through the Eye cuts, {cut} segments; step {step} of {last}."
        )
    }
}

/// What an event decides, and of what kind of thing.
fn kind(event: Event) -> Option<(bool, Verdict)> {
    match event {
        Event::DecidedPrim(_, verdict) => Some((true, verdict)),
        Event::DecidedNode(_, verdict) => Some((false, verdict)),
        _ => None,
    }
}

/// What a level plane cuts of a scene; the fronts of its segments are those of the triangles.
fn section(scene: &Scene<Solid>, height: f32) -> Parts<Flat> {
    let mut parts = Parts {
        name: scene.name().to_owned(),
        source: scene.source().to_owned(),
        points: Vec::new(),
        prims: Vec::new(),
        prim_object: Vec::new(),
        prim_material: Vec::new(),
        faces: Vec::new(),
        objects: scene.objects().iter().map(|o| Object { motion: None, ..o.clone() }).collect(),
        materials: scene.materials().to_vec(),
        origin: DVec3::ZERO,
        paths: Vec::new(),
        report: Report::default(),
    };
    for &prim in scene.live() {
        let corners: Vec<Vec3> = scene.prim_points(prim).collect();
        let mut ends = Vec::with_capacity(2);
        for (k, &b) in corners.iter().enumerate() {
            let a = corners[(k + corners.len() - 1) % corners.len()];
            // A corner in the plane counts as above it, so that a cut has two ends.
            if (a.y < height) != (b.y < height) {
                ends.push(flat(a + (b - a) * ((height - a.y) / (b.y - a.y))));
            }
        }
        let [mut a, mut b] = match ends[..] {
            [a, b] if a != b => [a, b],
            _ => continue,
        };
        if (b - a).perp().dot(flat(scene.normal(prim))) < 0.0 {
            (a, b) = (b, a);
        }
        let first = parts.points.len() as u32;
        parts.points.extend([a, b]);
        parts.prims.push(Some([first, first + 1]));
        parts.prim_object.push(scene.object_of(prim));
        parts.prim_material.push(scene.material_of(prim));
    }
    parts
}
