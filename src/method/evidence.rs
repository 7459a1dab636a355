//! Evidence that several methods record: a box against the frustum, a primitive's orientation; and how
//! evidence in general is worded and drawn.

use super::{Claim, Field, Tally, Value};
use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Role, Subject};
use crate::geometry::{Aabb, Frustum, FrustumTest, PlaneTest, PrimId, Space, Vector, View, faces_away};
use crate::scene::Scene;

/// Size of labels beside evidence.
const LABEL_PT: f32 = 8.0;

/// A box was tested against the planes of the frustum.
#[derive(Clone, Copy, Debug)]
pub struct Tested<S: Space> {
    /// Whose box.
    subject: Subject,
    bounds: Aabb<S::Vector>,
    /// The tests in order, up to the first that says outside.
    tests: [PlaneTest; 6],
    count: u8,
    /// Planes that still cut the box; meaningless if outside.
    cutting: u8,
    outside: bool,
}

impl<S: Space> Tested<S> {
    /// The operands of `frustum.test(bounds, planes)`, which returned `result`.
    pub fn of(
        subject: Subject,
        frustum: &Frustum<S::Vector>,
        bounds: &Aabb<S::Vector>,
        planes: u8,
        result: FrustumTest,
    ) -> Self {
        let mut tested = Self {
            subject,
            bounds: *bounds,
            tests: [PlaneTest { plane: 0, far_corner: 0.0, near_corner: 0.0, error: 0.0 }; 6],
            count: 0,
            cutting: if let FrustumTest::Partial(cutting) = result { cutting } else { 0 },
            outside: matches!(result, FrustumTest::Outside(_)),
        };
        for plane in (0..Frustum::<S::Vector>::PLANES).filter(|p| planes >> p & 1 == 1) {
            let test = frustum.test_plane(plane, bounds);
            tested.tests[tested.count as usize] = test;
            tested.count += 1;
            if test.is_outside() {
                break;
            }
        }
        tested
    }
    fn tests(&self) -> &[PlaneTest] {
        &self.tests[..self.count as usize]
    }
    /// The test that decided: the one that says outside, or else the one with the least margin.
    fn decisive(&self) -> Option<PlaneTest> {
        if self.outside {
            self.tests().last().copied()
        } else {
            self.tests().iter().copied().min_by(|a, b| a.near_corner.total_cmp(&b.near_corner))
        }
    }
    fn name(&self) -> String {
        match self.subject {
            Subject::Node(n) => format!("Node {n}"),
            Subject::Object(o) => format!("Object {o}"),
            Subject::Prim(p) => format!("The box of {} {p}", S::PRIM),
            _ => "The box".into(),
        }
    }
    /// Whether it is `outside`, `inside` or `partial`.
    pub fn result(&self) -> &'static str {
        match (self.outside, self.cutting) {
            (true, _) => "outside",
            (false, 0) => "inside",
            (false, _) => "partial",
        }
    }

    /// Whose box it is.
    pub(crate) fn subject(&self) -> Subject {
        self.subject
    }
    /// That it lies outside, if it does.
    pub(crate) fn claim(&self) -> Option<Claim<S::Vector>> {
        let test = self.tests().last().filter(|_| self.outside)?;
        Some(Claim::Outside {
            plane: Frustum::<S::Vector>::plane_name(test.plane as usize),
            far_corner: test.far_corner.into(),
            error: test.error.into(),
            bounds: self.bounds,
        })
    }
    /// What kind of note this is.
    pub(crate) fn kind(&self) -> &'static str {
        match self.subject {
            Subject::Node(_) => "NodeClassified",
            Subject::Object(_) => "ObjectClassified",
            _ => "PrimClassified",
        }
    }
    pub(crate) fn tally(&self, tally: &mut Tally) {
        tally.add("boxes_tested", 1);
        tally.add("planes_tested", self.count.into());
    }
    pub(crate) fn fields(&self) -> Vec<Field> {
        let id = match self.subject {
            Subject::Prim(p) => integer("prim", p.0),
            Subject::Node(id) => integer("node", id.0),
            Subject::Object(id) => integer("object", id.0),
            _ => integer("subject", 0),
        };
        let list = |f: fn(&PlaneTest) -> f64| Value::List(self.tests().iter().map(f).collect());
        let planes = self
            .tests()
            .iter()
            .map(|t| Frustum::<S::Vector>::plane_name(t.plane as usize))
            .collect::<Vec<_>>()
            .join(" ");
        vec![
            id,
            Field { name: "result", value: Value::Word(self.result().into()) },
            Field { name: "planes", value: Value::Word(planes) },
            Field { name: "far_corner_units", value: list(|t| t.far_corner.into()) },
            Field { name: "near_corner_units", value: list(|t| t.near_corner.into()) },
            Field { name: "error_units", value: list(|t| t.error.into()) },
            Field { name: "box_min", value: axes(self.bounds.min) },
            Field { name: "box_max", value: axes(self.bounds.max) },
        ]
    }

    pub(crate) fn sentence(&self) -> String {
        let name = self.name();
        let plane = |t: &PlaneTest| Frustum::<S::Vector>::plane_name(t.plane as usize);
        match (self.outside, self.cutting, self.decisive()) {
            (true, _, Some(t)) => format!(
                "{name} lies outside the {} plane: even its corner that reaches farthest in is {} units \
                 outside (rounding could account for {}).",
                plane(&t),
                short(-t.far_corner),
                short(t.error)
            ),
            (_, 0, Some(t)) => {
                format!(
                    "{name} lies inside every plane tested; the closest is the {} plane, {} units away.",
                    plane(&t),
                    short(t.near_corner)
                )
            }
            (_, 0, None) => format!("{name} lies inside all planes: its parents already did."),
            _ => {
                let cut: Vec<_> = self
                    .tests()
                    .iter()
                    .filter(|t| self.cutting >> t.plane & 1 == 1)
                    .map(|t| plane(t).to_owned())
                    .collect();
                let (plural, verb) = if cut.len() == 1 { ("", "cuts") } else { ("s", "cut") };
                let cut = match cut.split_last() {
                    Some((last, [])) => last.clone(),
                    Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
                    None => String::new(),
                };
                format!("The {cut} plane{plural} {verb} {}: part of it may be in view.", name.to_lowercase())
            }
        }
    }

    pub(crate) fn draw(&self, view: &View<S>, to: &mut Drawing<S::Vector>) {
        to.bounds(Layer::Emphasis, Role::Current, self.subject, &self.bounds);
        let Some(test) = self.decisive() else { return };
        let frustum = view.frustum();
        let corners = Frustum::corners(&view.projection(), view.eye.near, view.eye.far);
        let side: &[usize] = match (S::Vector::AXES, test.plane) {
            (2, 0) => &[0, 2],
            (2, 1) => &[1, 3],
            (2, 2) => &[0, 1],
            (2, _) => &[2, 3],
            (_, 0) => &[0, 3, 7, 4],
            (_, 1) => &[1, 2, 6, 5],
            (_, 2) => &[0, 1, 5, 4],
            (_, 3) => &[3, 2, 6, 7],
            (_, 4) => &[0, 1, 2, 3],
            _ => &[4, 5, 6, 7],
        };
        let points: Vec<_> = side.iter().map(|&i| corners[i]).collect();
        let mark = if points.len() == 2 { Mark::Line { points, closed: false } } else { Mark::Area(points) };
        to.push(Layer::Evidence, Role::Evidence, Subject::Plane(test.plane), mark);

        // The corner that decided, and its distance from the plane.
        let (normal, _) = frustum.plane(test.plane as usize);
        let inward = if self.outside { normal } else { -normal };
        let corner = S::Vector::from_fn(|a| {
            if inward.get(a) >= 0.0 { self.bounds.max.get(a) } else { self.bounds.min.get(a) }
        });
        let distance = if self.outside { test.far_corner } else { test.near_corner };
        let foot = corner - normal * distance;
        to.line(Layer::Evidence, Role::Evidence, Subject::None, [corner, foot]);
        to.push(Layer::Evidence, Role::Evidence, Subject::None, Mark::Dot { at: corner, radius_pt: 2.5 });
        label(
            to,
            (corner + foot) * 0.5,
            format!("{} units {}", short(distance.abs()), if distance < 0.0 { "outside" } else { "inside" }),
        );
    }
}

/// A primitive was asked whether it faces the eye.
#[derive(Clone, Copy, Debug)]
pub struct Facing {
    prim: PrimId,
    /// Signed distance of the eye from the primitive's plane, world units; negative behind it.
    eye_distance: f32,
}

impl Facing {
    /// The operands of [`crate::geometry::faces_away`] for a primitive.
    pub fn of<S: Space>(scene: &Scene<S>, view: &View<S>, prim: PrimId) -> Self {
        let normal = scene.normal(prim);
        let corner = scene.prim_points(prim).next().unwrap_or_default();
        Self {
            prim,
            eye_distance: normal.dot(view.eye.position - corner) / normal.length().max(f32::MIN_POSITIVE),
        }
    }
    pub(crate) fn subject(&self) -> Subject {
        Subject::Prim(self.prim)
    }
    /// That it faces away, if it does.
    pub(crate) fn claim<V>(&self) -> Option<Claim<V>> {
        (self.eye_distance < 0.0).then(|| Claim::FacesAway { eye_distance: self.eye_distance.into() })
    }
    pub(crate) fn tally(tally: &mut Tally) {
        tally.add("orientations_tested", 1);
    }
    pub(crate) fn fields(&self) -> Vec<Field> {
        vec![integer("prim", self.prim.0), number("eye_distance_units", self.eye_distance.into())]
    }
    pub(crate) fn sentence<S: Space>(&self) -> String {
        let (side, verdict) =
            if self.eye_distance < 0.0 { ("behind", "away from") } else { ("in front of", "toward") };
        format!(
            "The eye is {} units {side} the plane of {} {}, so it faces {verdict} the eye.",
            short(self.eye_distance.abs()),
            S::PRIM,
            self.prim
        )
    }
    pub(crate) fn draw<S: Space>(&self, scene: &Scene<S>, view: &View<S>, to: &mut Drawing<S::Vector>) {
        outline(scene, self.prim, to);
        let (center, normal) = (middle(scene, self.prim), scene.normal(self.prim));
        let length = 0.25 * (view.eye.position - center).length() / normal.length().max(f32::MIN_POSITIVE);
        to.push(
            Layer::Evidence,
            Role::Evidence,
            Subject::Prim(self.prim),
            Mark::Arrow(center, center + normal * length),
        );
        to.line(Layer::Evidence, Role::Faint, Subject::None, [center, view.eye.position]);
    }
}

/// Outlines a primitive as what the step is about.
pub(crate) fn outline<S: Space>(scene: &Scene<S>, prim: PrimId, to: &mut Drawing<S::Vector>) {
    let points: Vec<_> = scene.prim_points(prim).collect();
    to.outline(Layer::Emphasis, Role::Current, Subject::Prim(prim), points);
}

/// Writes beside the evidence.
pub(crate) fn label<V>(to: &mut Drawing<V>, at: V, text: String) {
    let mark = Mark::Text { at, text, size_pt: LABEL_PT, anchor: Anchor::Start, font: Font::Regular };
    to.push(Layer::Labels, Role::Evidence, Subject::None, mark);
}

/// A length with as many digits as a person reads.
pub(crate) fn short(v: f32) -> String {
    match v.abs() {
        0.0 => "0".into(),
        a if !(1e-3..1e5).contains(&a) => format!("{v:.1e}"),
        a if a < 1.0 => format!("{v:.3}"),
        a if a < 100.0 => format!("{v:.2}"),
        _ => format!("{v:.0}"),
    }
}

/// A number as a field.
pub(crate) fn number(name: &'static str, v: f64) -> Field {
    Field { name, value: Value::Number(v) }
}

/// A count or an id as a field.
pub(crate) fn integer(name: &'static str, v: u32) -> Field {
    Field { name, value: Value::Integer(v.into()) }
}

/// The components of a point.
pub(crate) fn axes<V: Vector>(v: V) -> Value {
    Value::List((0..V::AXES).map(|a| v.get(a).into()).collect())
}

/// Mean of a live primitive's corners.
pub(crate) fn middle<S: Space>(scene: &Scene<S>, prim: PrimId) -> S::Vector {
    scene.prim_points(prim).fold(S::Vector::default(), |sum, p| sum + p) * (1.0 / S::CORNERS as f32)
}

/// Whether a live primitive turns its back to the eye.
#[inline]
pub(crate) fn prim_faces_away<S: Space>(scene: &Scene<S>, eye: S::Vector, prim: PrimId) -> bool {
    let mut corners = [S::Vector::default(); 3];
    for (to, from) in corners.iter_mut().zip(scene.prim_points(prim)) {
        *to = from;
    }
    faces_away::<S>(eye, &corners[..S::CORNERS])
}
