//! An independent checker: is what a method culled really out of view, or hidden?
//!
//! A certificate is what a film recorded as evidence of a cull, or a decision that something is hidden.
//!
//! - *Outside a plane*: the plane, the box and its distance. The checker derives the planes anew from the
//!   Eye's definition, in f64, and shares no arithmetic with [`crate::geometry::Frustum`]; it asks that the
//!   box holds every point it stands for, that every corner lies outside the plane named, and that the
//!   recorded distances are right within their recorded error and the rounding of the view's axes to 32
//!   bits, which methods and rasterizer share.
//! - *Facing away*: the eye lies strictly behind the primitive's plane, in exact arithmetic.
//! - *Behind*, of a node or of an object whose occlusion was recorded: every pixel center's ray that meets
//!   its box meets a surface of the whole scene first, and no primitive that lies in the box owns a pixel.
//!   The module `hidden` says how, and what is allowed for rounding.
//!   Below a node that was proven hidden nothing is left to prove.
//! - *Unseen*, of a primitive that was decided by itself: it owns no pixel.
//!
//! Cost: O(events + primitives culled), and of what is hidden the image once and O(pixels in the rectangle of
//! each box).

use std::cell::OnceCell;

use glam::{DVec2, DVec3};

use super::hidden::Sight;
use super::widened;
use crate::drawing::Subject;
use crate::geometry::{Aabb, NodeId, ObjectId, PrimId, Vector, View, orient2d, orient3d};
use crate::index::Hierarchy;
use crate::method::{self, Event, Film, Verdict};
use crate::raster::Drawable;
use crate::scene::{Scene, Surfaces};

/// Evidence that something cannot be seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certificate<V> {
    /// The step that showed the evidence.
    pub step: usize,
    /// A node, an object or a primitive.
    pub subject: Subject,
    /// What is claimed of it.
    pub claim: Claim<V>,
}

/// What a certificate claims.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Claim<V> {
    /// What the method's evidence claims: that it is outside, or faces away.
    Evident(method::Claim<V>),
    /// Surfaces that are shown lie before every part of this box of it.
    Behind(Aabb<V>),
    /// It owns no pixel.
    Unseen,
}

/// Why a film or certificate was not accepted.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("step {step}: {why}")]
pub struct Rejection {
    /// The step of the certificate, or of the decision that has none.
    pub step: usize,
    /// What does not hold.
    pub why: String,
}

/// The certificates of a film, in order.
pub fn certificates<S: Drawable>(film: &dyn Film<S>) -> Vec<Certificate<S::Vector>> {
    let at = |(i, event): (usize, &Event)| {
        let claim = match *event {
            Event::Noted(_) => match (film.claim(i)?, film.subject(i)) {
                (method::Claim::Hidden, Subject::Object(object)) => {
                    let points = of_object(film.scene(), object).flat_map(|p| film.scene().prim_points(p));
                    Claim::Behind(Aabb::of(points))
                }
                // What is hidden otherwise is proven where it is decided.
                (method::Claim::Hidden, _) => return None,
                (claim, _) => Claim::Evident(claim),
            },
            Event::DecidedNode(node, Verdict::Hidden) => Claim::Behind(film.hierarchy().bounds(node)),
            Event::DecidedPrim(_, Verdict::Hidden) => Claim::Unseen,
            _ => return None,
        };
        Some(Certificate { step: i + 1, subject: film.subject(i), claim })
    };
    film.events().iter().enumerate().filter_map(at).collect()
}

fn of_object<S: Drawable>(scene: &Scene<S>, object: ObjectId) -> impl Iterator<Item = PrimId> {
    scene.live().iter().copied().filter(move |&p| scene.object_of(p) == object)
}

/// Checks every certificate of a film, and that nothing was called outside without one. Returns how many
/// certificates it accepted. What lies below a node that was proven hidden is accepted with it.
///
/// # Errors
/// The first that does not hold.
pub fn check_film<S: Drawable>(film: &dyn Film<S>) -> Result<usize, Rejection> {
    let checker = Checker::of(film);
    let certificates = certificates(film);
    let mut proven = vec![false; film.hierarchy().node_count()];
    for certificate in &certificates {
        if let (Claim::Behind(_), Subject::Node(node)) = (&certificate.claim, certificate.subject) {
            let above = std::iter::successors(Some(node), |n| film.hierarchy().parent(*n));
            if above.into_iter().any(|n| proven[n.at()]) {
                continue;
            }
            proven[node.at()] = true;
        }
        checker.check(certificate)?;
    }
    for (at, event) in film.events().iter().enumerate() {
        let Some(verdict @ (Verdict::Outside | Verdict::FacesAway)) = event.verdict() else { continue };
        // The evidence of a decision says itself that its subject, or the object of that, is outside.
        let evidence = film.evidence_of(at).and_then(|evidence| film.claim(evidence));
        let is_claimed = match evidence {
            Some(method::Claim::Outside { .. }) => verdict == Verdict::Outside,
            Some(method::Claim::FacesAway { .. }) => verdict == Verdict::FacesAway,
            _ => false,
        };
        if !is_claimed {
            let why = format!("{:?} is called {} without a certificate", film.subject(at), verdict.name());
            return Err(Rejection { step: at + 1, why });
        }
    }
    Ok(certificates.len())
}

/// The least and the greatest corner of a box.
fn corners<V: Vector>(bounds: Aabb<V>) -> [DVec3; 2] {
    [widened(bounds.min), widened(bounds.max)]
}

/// Checks certificates of one view of one scene.
pub struct Checker<'a, S: Drawable> {
    scene: &'a Scene<S>,
    hierarchy: &'a dyn Hierarchy<S>,
    view: View<S>,
    surfaces: Surfaces,
    /// Drawn when it is first asked for.
    sight: OnceCell<Sight<'a, S>>,
    eye: DVec3,
    planes: Vec<Plane>,
}

/// A plane of the view volume: inside is `normal·(x − eye) + offset ≥ 0`.
struct Plane {
    name: &'static str,
    /// Unit length.
    normal: DVec3,
    offset: f64,
    /// Bound on each component's error, since the axes that it is a sum of are rounded to 32 bits.
    rounding: DVec3,
}

/// Half-ulps that an axis is off by: a difference, a length, a quotient and two products of it.
const AXIS_HALF_ULPS: f64 = 8.0;

impl<'a, S: Drawable> Checker<'a, S> {
    /// For the certificates of a film.
    pub fn of(film: &'a dyn Film<S>) -> Self {
        Self {
            surfaces: method::surfaces_of(film.knobs()),
            ..Self::new(film.scene(), film.hierarchy(), film.view())
        }
    }

    /// Derives the planes of the view volume from the Eye. Primitives have two sides.
    pub fn new(scene: &'a Scene<S>, hierarchy: &'a dyn Hierarchy<S>, view: &View<S>) -> Self {
        let eye = &view.eye;
        let position = widened(eye.position);
        let forward = (widened(eye.target) - position).normalize();
        let tan = (f64::from(eye.fov) * 0.5).tan();
        let half_ulps = AXIS_HALF_ULPS * 0.5 * f64::from(f32::EPSILON);
        let mut planes = Vec::new();
        // `blur` is how much the axis' own error exceeds that of the line of sight.
        let mut pair = |names: [&'static str; 2], axis: DVec3, slope: f64, blur: f64| {
            for (name, sum) in [(names[0], forward * slope + axis), (names[1], forward * slope - axis)] {
                let rounding = ((forward * slope).abs() + axis.abs() + DVec3::splat(blur - 1.0))
                    * (half_ulps / sum.length());
                planes.push(Plane { name, normal: sum.normalize(), offset: 0.0, rounding });
            }
        };
        if S::Vector::AXES == 2 {
            pair(["left", "right"], DVec3::new(forward.y, -forward.x, 0.0), tan, 1.0);
        } else {
            let across = forward.cross(widened(eye.up).normalize_or_zero());
            // An `up` along the line of sight says nothing: any axis will do, and it is this one.
            let right = across.try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
            let blur = if across.length() > 0.0 { 1.0 / across.length() } else { 1.0 };
            pair(["left", "right"], right, tan * f64::from(view.width) / f64::from(view.height), blur);
            pair(["bottom", "top"], right.cross(forward), tan, blur);
        }
        let rounding = forward.abs() * half_ulps;
        planes.push(Plane { name: "near", normal: forward, offset: -f64::from(eye.near), rounding });
        planes.push(Plane { name: "far", normal: -forward, offset: f64::from(eye.far), rounding });
        Self {
            scene,
            hierarchy,
            view: *view,
            surfaces: Surfaces::default(),
            sight: OnceCell::new(),
            eye: position,
            planes,
        }
    }

    /// Checks one certificate.
    ///
    /// # Errors
    /// What does not hold.
    pub fn check(&self, certificate: &Certificate<S::Vector>) -> Result<(), Rejection> {
        use method::Claim::{FacesAway, Outside};
        let checked = match (certificate.claim, certificate.subject) {
            (Claim::Evident(FacesAway { eye_distance }), Subject::Prim(prim)) if self.is_live(prim) => {
                self.faces_away(prim, eye_distance)
            }
            (Claim::Evident(Outside { plane, far_corner, error, bounds }), subject) => self
                .points(subject)
                .and_then(|points| self.beyond(&points, plane, far_corner, error, corners(bounds))),
            (Claim::Unseen, Subject::Prim(prim)) if self.is_live(prim) => self.sight().unseen(prim),
            (Claim::Behind(bounds), subject @ (Subject::Node(_) | Subject::Object(_))) => {
                self.prims(subject).and_then(|prims| self.behind(subject, prims, corners(bounds)))
            }
            _ => Err("the subject is not in the scene, or the claim cannot be made of it".into()),
        };
        checked.map_err(|why| Rejection { step: certificate.step, why })
    }

    fn is_live(&self, prim: PrimId) -> bool {
        prim.at() < self.scene.prim_count() && self.scene.corners(prim).is_some()
    }

    fn sight(&self) -> &Sight<'a, S> {
        self.sight.get_or_init(|| Sight::new(self.scene, &self.view, self.surfaces))
    }

    fn behind(
        &self,
        subject: Subject,
        mut prims: Vec<PrimId>,
        [low, high]: [DVec3; 2],
    ) -> Result<(), String> {
        let holds = |p: PrimId| {
            self.scene.prim_points(p).map(widened).all(|p| p.cmpge(low).all() && p.cmple(high).all())
        };
        // A primitive that crosses the border of a cell may stand with it and reach out of its box; an object
        // never does.
        let must_hold_all = matches!(subject, Subject::Object(_));
        let of_node = |node: NodeId| {
            (widened(self.hierarchy.bounds(node).min), widened(self.hierarchy.bounds(node).max))
        };
        if matches!(subject, Subject::Node(node) if of_node(node) != (low, high)) {
            return Err("the box is not that of the node".into());
        }
        prims.sort_unstable();
        for &prim in &prims {
            if holds(prim) {
                self.sight().unseen(prim)?;
            } else if must_hold_all {
                return Err("the box does not hold everything that it stands for".into());
            }
        }
        self.sight().behind(low, high, &prims)
    }

    /// Every point that a subject stands for.
    fn points(&self, subject: Subject) -> Result<Vec<DVec3>, String> {
        Ok(self.prims(subject)?.iter().flat_map(|&p| self.scene.prim_points(p)).map(widened).collect())
    }

    /// Every primitive that a subject stands for.
    fn prims(&self, subject: Subject) -> Result<Vec<PrimId>, String> {
        Ok(match subject {
            Subject::Node(node) if node.at() < self.hierarchy.node_count() => {
                self.hierarchy.prims(node).to_vec()
            }
            Subject::Prim(prim) if self.is_live(prim) => vec![prim],
            Subject::Object(object) if object.at() < self.scene.objects().len() => {
                of_object(self.scene, object).collect()
            }
            other => return Err(format!("{other:?} is not in the scene")),
        })
    }

    fn beyond(
        &self,
        points: &[DVec3],
        plane: &str,
        far_corner: f64,
        error: f64,
        [low, high]: [DVec3; 2],
    ) -> Result<(), String> {
        let Some(Plane { normal, offset, rounding, .. }) = self.planes.iter().find(|p| p.name == plane)
        else {
            return Err(format!("the view volume has no plane `{plane}`"));
        };
        if !low.cmple(high).all() {
            return Err("the box ends before it begins".into());
        }
        if points.iter().any(|p| p.cmplt(low).any() || p.cmpgt(high).any()) {
            return Err("the box does not hold everything that it stands for".into());
        }
        let corner = DVec3::select(normal.cmpge(DVec3::ZERO), high, low);
        let distance = normal.dot(corner - self.eye) + offset;
        let slack = rounding.dot((corner - self.eye).abs());
        if distance >= slack {
            return Err(format!("a corner of the box lies {distance} units inside the {plane} plane"));
        }
        if !(far_corner < -error && error >= 0.0) {
            return Err(format!("the recorded distance {far_corner} does not exceed its error {error}"));
        }
        if (distance - far_corner).abs() > error + slack {
            return Err(format!(
                "the recorded distance from the {plane} plane is {far_corner}, the true one {distance}"
            ));
        }
        Ok(())
    }

    fn faces_away(&self, prim: PrimId, recorded: f64) -> Result<(), String> {
        let p: Vec<DVec3> = self.scene.prim_points(prim).map(widened).collect();
        let to_eye = self.eye - p[0];
        let (sign, normal, edges) = if S::Vector::AXES == 2 {
            let edge = p[1] - p[0];
            (
                orient2d(flat(p[0]), flat(p[1]), flat(self.eye)),
                DVec3::new(-edge.y, edge.x, 0.0),
                edge.length(),
            )
        } else {
            let (u, v) = (p[1] - p[0], p[2] - p[0]);
            (orient3d(p[0], p[1], p[2], self.eye), u.cross(v), u.length() * v.length())
        };
        let distance = normal.dot(to_eye) / normal.length();
        // Two differences, a product of edges and an inner product, each rounded to 24 bits.
        let error = 16.0 * f64::from(f32::EPSILON) * edges * to_eye.length() / normal.length();
        if sign >= 0.0 {
            return Err(format!("the eye lies {distance} units before the plane, or in it"));
        }
        if (distance - recorded).abs() > error || recorded >= 0.0 {
            return Err(format!("the recorded distance of the eye is {recorded}, the true one {distance}"));
        }
        Ok(())
    }
}

fn flat(v: DVec3) -> DVec2 {
    DVec2::new(v.x, v.y)
}
