//! Evidence that several methods record: a box against the frustum, a primitive's orientation; and how
//! evidence in general is worded and drawn.

use super::{Claim, Compared, Context, Field, Tally, Value};
use crate::drawing::words::{self, Room};
use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Role, Subject};
use crate::geometry::{Aabb, Frustum, FrustumTest, PlaneTest, PrimId, Space, Vector, View};
use crate::scene::Scene;

/// Size of labels beside evidence.
const LABEL_PT: f32 = 8.0;

/// A box was tested against the planes of the view's frustum. Only the question and the answer are kept, a
/// quarter of the bytes: the distances are computed when the note is read, by [`Frustum::test_plane`], the
/// same function that decided in the run, so they are the same to the last bit.
#[derive(Clone, Copy, Debug)]
pub struct Tested<S: Space> {
    /// Whose box.
    subject: Subject,
    bounds: Aabb<S::Vector>,
    /// Planes to test, a bit each.
    planes: u8,
    found: Found,
}

/// A [`FrustumTest`] without its distances.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Found {
    /// Outside this plane.
    Outside(u8),
    /// Neither; the bits are the planes that still cut the box.
    Partial(u8),
    /// Inside all planes tested.
    Inside,
}

impl<S: Space> Tested<S> {
    /// The view's frustum answered `test(bounds, planes)` with `result`.
    #[inline]
    pub fn of(subject: Subject, bounds: &Aabb<S::Vector>, planes: u8, result: FrustumTest) -> Self {
        let found = match result {
            FrustumTest::Outside(test) => Found::Outside(test.plane),
            FrustumTest::Partial(cutting) => Found::Partial(cutting),
            FrustumTest::Inside => Found::Inside,
        };
        Self { subject, bounds: *bounds, planes, found }
    }
    /// The planes that were tested, a bit each: those asked for, up to the one that says outside.
    #[inline]
    fn tested(&self) -> u8 {
        match self.found {
            Found::Outside(plane) => self.planes & ((2 << plane) - 1),
            Found::Partial(_) | Found::Inside => self.planes,
        }
    }
    /// The tests in order.
    fn tests(&self, frustum: &Frustum<S::Vector>) -> Vec<PlaneTest> {
        let tested = self.tested();
        (0..Frustum::<S::Vector>::PLANES)
            .filter(|plane| tested >> plane & 1 == 1)
            .map(|plane| frustum.test_plane(plane, &self.bounds))
            .collect()
    }
    /// The test that decided: the one that says outside, or else the one with the least margin.
    fn decisive(&self, tests: &[PlaneTest]) -> Option<PlaneTest> {
        match self.found {
            Found::Outside(_) => tests.last().copied(),
            _ => tests.iter().copied().min_by(|a, b| a.near_corner.total_cmp(&b.near_corner)),
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
        match self.found {
            Found::Outside(_) => "outside",
            Found::Inside => "inside",
            Found::Partial(_) => "partial",
        }
    }

    /// Whose box it is.
    pub(crate) fn subject(&self) -> Subject {
        self.subject
    }
    /// That it lies outside, if it does.
    pub(crate) fn claim(&self, context: &Context<'_, S>) -> Option<Claim<S::Vector>> {
        let Found::Outside(plane) = self.found else { return None };
        let test = context.view.frustum().test_plane(plane.into(), &self.bounds);
        Some(Claim::Outside {
            plane: Frustum::<S::Vector>::plane_name(plane.into()),
            far_corner: test.far_corner.into(),
            error: test.error.into(),
            bounds: self.bounds,
        })
    }
    /// The corner that decided, against the bound on its rounding error.
    pub(crate) fn compared(&self, context: &Context<'_, S>) -> Option<Compared> {
        let tests = self.tests(&context.view.frustum());
        let test = self.decisive(&tests)?;
        let (name, found, error) = match self.found {
            Found::Outside(_) => ("farthest corner", test.far_corner, -test.error),
            _ => ("nearest corner", test.near_corner, 0.0),
        };
        let bound = if matches!(self.found, Found::Outside(_)) { "rounding" } else { "the plane" };
        Some(Compared::of((name, found.into()), (bound, error.into())))
    }
    /// What kind of note this is.
    pub(crate) fn kind(&self) -> &'static str {
        match self.subject {
            Subject::Node(_) => "NodeClassified",
            Subject::Object(_) => "ObjectClassified",
            _ => "PrimClassified",
        }
    }
    #[inline]
    pub(crate) fn tally(&self, tally: &mut Tally) {
        tally.boxes_tested += 1;
        tally.planes_tested += u64::from(self.tested().count_ones());
    }
    pub(crate) fn fields(&self, context: &Context<'_, S>) -> Vec<Field> {
        let tests = self.tests(&context.view.frustum());
        let id = match self.subject {
            Subject::Prim(p) => integer("prim", p.0),
            Subject::Node(id) => integer("node", id.0),
            Subject::Object(id) => integer("object", id.0),
            _ => integer("subject", 0),
        };
        let list = |f: fn(&PlaneTest) -> f64| Value::List(tests.iter().map(f).collect());
        let planes = tests
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

    pub(crate) fn sentence(&self, context: &Context<'_, S>) -> String {
        let (name, tests) = (self.name(), self.tests(&context.view.frustum()));
        let plane = |t: &PlaneTest| Frustum::<S::Vector>::plane_name(t.plane as usize);
        match (self.found, self.decisive(&tests)) {
            (Found::Outside(_), Some(t)) => format!(
                "{name} lies outside the {} plane: even its corner that reaches farthest in is {} units \
                 outside (rounding could account for {}).",
                plane(&t),
                short(-t.far_corner),
                short(t.error)
            ),
            (Found::Inside, Some(t)) => {
                format!(
                    "{name} lies inside every plane tested; the closest is the {} plane, {} units away.",
                    plane(&t),
                    short(t.near_corner)
                )
            }
            (Found::Partial(cutting), _) => {
                let cut: Vec<_> = tests
                    .iter()
                    .filter(|t| cutting >> t.plane & 1 == 1)
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
            (_, None) => format!("{name} lies inside all planes: its parents already did."),
        }
    }

    pub(crate) fn draw(&self, view: &View<S>, to: &mut Drawing<S::Vector>) {
        to.bounds(Layer::Emphasis, Role::Current, self.subject, &self.bounds);
        let frustum = view.frustum();
        let Some(test) = self.decisive(&self.tests(&frustum)) else { return };
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

        // The corner that decided, and its distance from the plane; where the plane cuts, both corners.
        let (normal, _) = frustum.plane(test.plane as usize);
        let mut leg = |inward: S::Vector, distance: f32| {
            let corner = S::Vector::from_fn(|a| {
                if inward.get(a) >= 0.0 { self.bounds.max.get(a) } else { self.bounds.min.get(a) }
            });
            let foot = corner - normal * distance;
            to.line(Layer::Evidence, Role::Evidence, Subject::None, [corner, foot]);
            to.push(Layer::Evidence, Role::Evidence, Subject::None, Mark::Dot { at: corner, radius_pt: 2.5 });
            (corner + foot) * 0.5
        };
        let at = match self.found {
            Found::Outside(_) => leg(normal, test.far_corner),
            Found::Inside => leg(-normal, test.near_corner),
            Found::Partial(_) => {
                leg(normal, test.far_corner);
                leg(-normal, test.near_corner)
            }
        };
        label(to, at, self.corners_text(&test));
    }
    /// The plane by its name, and on which side of it the box reaches how far.
    fn corners_text(&self, test: &PlaneTest) -> String {
        let plane = Frustum::<S::Vector>::plane_name(test.plane as usize);
        let (reaches_in, reaches_out) = (short(test.far_corner.abs()), short(test.near_corner.abs()));
        match self.found {
            Found::Outside(_) => format!("{plane}: all out, by {reaches_in}"),
            Found::Inside => format!("{plane}: all in, by {reaches_out}"),
            Found::Partial(_) => format!("{plane}: {reaches_in} in, {reaches_out} out"),
        }
    }
}

/// A primitive was asked whether it faces the eye, and did not.
#[derive(Clone, Copy, Debug)]
pub struct Facing {
    prim: PrimId,
}

impl Facing {
    /// [`crate::geometry::faces_away`] was asked for this primitive.
    #[inline]
    pub fn of(prim: PrimId) -> Self {
        Self { prim }
    }
    /// Signed distance of the eye from the primitive's plane, world units; negative behind it.
    fn eye_distance<S: Space>(&self, context: &Context<'_, S>) -> f32 {
        let normal = context.scene.normal(self.prim);
        let corner = context.scene.prim_points(self.prim).next().unwrap_or_default();
        normal.dot(context.view.eye.position - corner) / normal.length().max(f32::MIN_POSITIVE)
    }
    pub(crate) fn subject(&self) -> Subject {
        Subject::Prim(self.prim)
    }
    /// That it faces away, if it does.
    pub(crate) fn claim<S: Space>(&self, context: &Context<'_, S>) -> Option<Claim<S::Vector>> {
        let eye_distance = self.eye_distance(context);
        (eye_distance < 0.0).then(|| Claim::FacesAway { eye_distance: eye_distance.into() })
    }
    /// The eye's distance from the plane, against the plane.
    pub(crate) fn compared<S: Space>(&self, context: &Context<'_, S>) -> Option<Compared> {
        Some(Compared::of(("eye above the plane", self.eye_distance(context).into()), ("the plane", 0.0)))
    }
    #[inline]
    pub(crate) fn tally(tally: &mut Tally) {
        tally.orientations_tested += 1;
    }
    pub(crate) fn fields<S: Space>(&self, context: &Context<'_, S>) -> Vec<Field> {
        vec![integer("prim", self.prim.0), number("eye_distance_units", self.eye_distance(context).into())]
    }
    pub(crate) fn sentence<S: Space>(&self, context: &Context<'_, S>) -> String {
        let distance = self.eye_distance(context);
        let (side, verdict) =
            if distance < 0.0 { ("behind", "away from") } else { ("in front of", "toward") };
        format!(
            "The eye is {} units {side} the plane of {} {}, so it faces {verdict} the eye.",
            short(distance.abs()),
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

/// A length as sentences and labels of evidence give it.
pub(crate) fn short(v: f32) -> String {
    words::short(v, Room::Sentence)
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
