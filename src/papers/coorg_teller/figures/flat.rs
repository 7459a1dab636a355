//! Figures 2 to 4 of the paper, in flatland: from where a box is hidden by one occluder, by two connected
//! ones, and where a shared edge must not be ignored. Regions are exact: cut out by the method's own lines,
//! classified by its own test.

use glam::{DVec2, Vec2};

use super::regions::regions;
use super::setting::{Setting, draw_tangent, largest};
use crate::culling::anatomy::Occlusion;
use crate::drawing::{Drawing, Font, Role};
use crate::figure::tools::{COLUMN_PT, LABEL_PT, Maker, NAME_PT, Plan, entry};
use crate::figure::{Paper, Swatch, panels};
use crate::geometry::Aabb;
use crate::scene::SceneError;

fn frame(x: [f32; 2], y: [f32; 2]) -> Aabb<Vec2> {
    Aabb { min: Vec2::new(x[0], y[0]), max: Vec2::new(x[1], y[1]) }
}

/// What A does to T from each viewpoint on A's other side.
fn one_occluder(setting: &Setting, plan: &Plan) -> Vec<(Occlusion, Vec<DVec2>)> {
    regions(&plan.wide(), &setting.borders(), |p| {
        let eye = p.as_vec2();
        let in_front = !setting.blockers.planes(0, &setting.target, eye).is_empty();
        in_front.then(|| setting.blockers.classify(0, &setting.target, eye))
    })
}

fn region_role(occlusion: Occlusion) -> (Role, &'static str, &'static str) {
    match occlusion {
        Occlusion::None => (Role::Faint, "1", "not occluded"),
        Occlusion::Partial => (Role::Partial, "2", "partially"),
        Occlusion::Full => (Role::Hidden, "3", "fully"),
    }
}

/// Sets the number of each region and what it means into its cells.
fn name_regions(plan: &mut Plan, all: &[(Occlusion, Vec<DVec2>)]) {
    for occlusion in [Occlusion::None, Occlusion::Partial, Occlusion::Full] {
        let (_, number, words) = region_role(occlusion);
        let mut middles: Vec<Vec2> = all
            .iter()
            .filter(|(o, _)| *o == occlusion)
            .filter_map(|(_, c)| largest(std::iter::once(c)))
            .collect();
        middles.sort_by(|a, b| a.x.total_cmp(&b.x));
        for at in middles {
            // Region 2 is a wedge: wider below.
            let at = if occlusion == Occlusion::Partial { at - Vec2::Y * 12.0 * plan.unit } else { at };
            plan.plate(at + Vec2::Y * 6.0 * plan.unit, NAME_PT, Font::Bold, number);
            plan.plate(at - Vec2::Y * 6.0 * plan.unit, LABEL_PT, Font::Regular, words);
        }
    }
}

/// Figure 2: regions 1, 2 and 3.
pub(super) fn supporting_lines(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let setting = Setting::of("occluder_and_box")?;
    let mut plan = Plan::new(frame([-8.4, 8.4], [-6.4, 5.6]), COLUMN_PT);
    let all = one_occluder(&setting, &plan);
    for (occlusion, cell) in &all {
        plan.area(region_role(*occlusion).0, cell);
    }
    for [supporting, separating] in setting.tangents(0) {
        draw_tangent(&mut plan, Role::Ink, &separating);
        draw_tangent(&mut plan, Role::Evidence, &supporting);
    }
    setting.draw(&mut plan, &[1.0, 1.0]);
    name_regions(&mut plan, &all);
    let eye = setting.eye(0);
    plan.viewpoint(eye, "P");
    let (_, number, words) = region_role(setting.blockers.classify(0, &setting.target, eye));
    let content =
        panels(COLUMN_PT, 1, &[plan.panel(format!("From P, in region {number}, T is {words} occluded."))]);
    let legend = vec![
        entry(Role::Occluder, Swatch::Line, "occluder A"),
        entry(Role::Evidence, Swatch::Line, "supporting line"),
        entry(Role::Ink, Swatch::Line, "separating line"),
        entry(Role::Hidden, Swatch::Area, "3: inside all supporting lines"),
        entry(Role::Partial, Swatch::Area, "2: inside all separating lines"),
        entry(Role::Faint, Swatch::Area, "1: elsewhere before A"),
        entry(Role::Eye, Swatch::Dot, "viewpoint"),
    ];
    let caption = "An occluder A and a box T in flatland. A supporting line through an end of A has A and T \
                   on one side, a separating line has them on opposite sides. They and A's own line divide \
                   the viewpoints that have A before T into three regions: T is not occluded by A (1), \
                   partially (2), or fully (3). Scene occluder_and_box, first eye.";
    Ok(maker.page(Paper::Column, "Supporting and separating lines", legend, caption, &content))
}

/// Who hides T.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Hiding {
    Alone,
    Jointly,
}

fn who_hides(setting: &Setting, p: DVec2) -> Option<Hiding> {
    match setting.blockers.hiding(&setting.target, p.as_vec2()).len() {
        0 => None,
        1 => Some(Hiding::Alone),
        _ => Some(Hiding::Jointly),
    }
}

/// Draws the supporting lines of all occluders, those through their shared end in another role.
fn draw_supporting_lines(plan: &mut Plan, setting: &Setting, shared: Vec2) {
    for [supporting, _] in (0..setting.occluders.len()).flat_map(|id| setting.tangents(id)) {
        let role = if supporting.edge[0] == shared { Role::Outside } else { Role::Evidence };
        draw_tangent(plan, role, &supporting);
    }
}

/// Sets the name of each occluder into the region where it hides T alone.
fn name_alone(plan: &mut Plan, setting: &Setting, all: &[(Hiding, Vec<DVec2>)]) {
    for (id, (name, _)) in setting.occluders.iter().enumerate() {
        let alone = |p: DVec2| setting.blockers.classify(id, &setting.target, p.as_vec2()) == Occlusion::Full;
        if let Some(at) = largest(all.iter().filter(|(_, c)| alone(super::regions::middle(c))).map(|r| &r.1))
        {
            plan.plate(at, LABEL_PT, Font::Regular, &format!("{name} alone"));
        }
    }
}

/// Figure 3: what two connected occluders hide together.
pub(super) fn connected(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let setting = Setting::of("connected_occluders")?;
    let mut plan = Plan::new(frame([-8.4, 8.4], [-6.4, 5.8]), COLUMN_PT);
    let all = regions(&plan.wide(), &setting.borders(), |p| who_hides(&setting, p));
    for (who, cell) in &all {
        plan.area(if *who == Hiding::Jointly { Role::Hidden } else { Role::Faint }, cell);
    }
    let shared = shared_end(&setting);
    draw_supporting_lines(&mut plan, &setting, shared);
    name_alone(&mut plan, &setting, &all);
    setting.draw(&mut plan, &[1.0, 1.0]);
    plan.plate(shared + Vec2::Y * 10.0 * plan.unit, NAME_PT, Font::Bold, "E");
    if let Some(at) = largest(all.iter().filter(|r| r.0 == Hiding::Jointly).map(|r| &r.1)) {
        plan.plate(at, LABEL_PT, Font::Regular, "together");
    }
    let eye = setting.eye(0);
    plan.viewpoint(eye, "P");
    let count = setting.blockers.hiding(&setting.target, eye).len();
    let content =
        panels(COLUMN_PT, 1, &[plan.panel(format!("From P, T is hidden by {count} occluders together."))]);
    let legend = vec![
        entry(Role::Occluder, Swatch::Line, "occluders A, B"),
        entry(Role::Evidence, Swatch::Line, "supporting line"),
        entry(Role::Outside, Swatch::Line, "supporting line through E: ignored"),
        entry(Role::Hidden, Swatch::Area, "A and B hide T together"),
        entry(Role::Faint, Swatch::Area, "one of them hides T alone"),
        entry(Role::Eye, Swatch::Dot, "viewpoint"),
    ];
    let caption = "Two occluders that share the edge E, a point in flatland. From the hatched region neither \
                   hides the box T, but both do together: each of them hides it partially, and they lie on \
                   opposite sides of E, so the supporting lines through E (dotted) need not be satisfied, \
                   only those through the outer ends. Scene connected_occluders, first eye.";
    Ok(maker.page(Paper::Column, "Occlusion by connected occluders", legend, caption, &content))
}

/// The point that both occluders end in.
fn shared_end(setting: &Setting) -> Vec2 {
    let [a, b] = [setting.occluders[0].1, setting.occluders[1].1];
    a.into_iter().find(|p| b.contains(p)).expect("the occluders of these scenes are connected")
}

/// What would be said if every supporting line through a shared end were ignored, whichever side its
/// occluders lie on.
fn ignoring_every_shared_end(setting: &Setting, p: DVec2) -> bool {
    let (eye, shared) = (p.as_vec2(), shared_end(setting));
    (0..setting.occluders.len()).all(|id| {
        let planes = setting.blockers.planes(id, &setting.target, eye);
        let rest = planes.iter().flatten().filter(|[supporting, _]| supporting.edge[0] != shared);
        setting.blockers.classify(id, &setting.target, eye) == Occlusion::Partial
            && rest.into_iter().all(|[s, _]| s.eye_distance > 0.0)
    })
}

/// What is said from a viewpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Verdict {
    Hidden,
    /// It would be called hidden if the silhouette edge were ignored; it is visible.
    Wrong,
}

fn verdict(setting: &Setting, p: DVec2) -> Option<Verdict> {
    if who_hides(setting, p).is_some() {
        Some(Verdict::Hidden)
    } else {
        ignoring_every_shared_end(setting, p).then_some(Verdict::Wrong)
    }
}

/// Draws both viewpoints, what P sees of T, and what is true of T in the two kinds of regions.
fn draw_views(plan: &mut Plan, setting: &Setting, eyes: [Vec2; 2], all: &[(Verdict, Vec<DVec2>)]) {
    // The corner of T that P sees past E.
    let seen = Vec2::new(setting.target.max.x, setting.target.min.y);
    plan.line(Role::Eye, eyes[0], seen);
    plan.viewpoint(eyes[0], "P");
    plan.viewpoint(eyes[1], "Q");
    // Beside the sign of what is wrong, which stands in the middle.
    for (which, words, aside) in
        [(Verdict::Hidden, "T hidden", Vec2::ZERO), (Verdict::Wrong, "T visible", Vec2::new(24.0, -14.0))]
    {
        if let Some(at) = largest(all.iter().filter(|r| r.0 == which).map(|r| &r.1)) {
            plan.plate(at + aside * plan.unit, LABEL_PT, Font::Regular, words);
        }
    }
}

/// Figure 4: a shared silhouette edge must not be ignored.
pub(super) fn silhouette_edge(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let setting = Setting::of("silhouette_edge")?;
    let mut plan = Plan::new(frame([-9.4, 7.4], [-6.4, 5.8]), COLUMN_PT);
    let all = regions(&plan.wide(), &setting.borders(), |p| verdict(&setting, p));
    for (verdict, cell) in &all {
        plan.area(if *verdict == Verdict::Wrong { Role::Wrong } else { Role::Hidden }, cell);
    }
    let shared = shared_end(&setting);
    draw_supporting_lines(&mut plan, &setting, shared);
    setting.draw(&mut plan, &[1.0, -1.0]);
    plan.plate(shared + Vec2::new(9.0, -1.0) * plan.unit, NAME_PT, Font::Bold, "E");
    let eyes = [setting.eye(0), setting.eye(1)];
    draw_views(&mut plan, &setting, eyes, &all);
    let says = |eye: Vec2| {
        if setting.blockers.hiding(&setting.target, eye).is_empty() { "visible" } else { "hidden" }
    };
    let label = format!("The method says: T is {} from P and {} from Q.", says(eyes[0]), says(eyes[1]));
    let content = panels(COLUMN_PT, 1, &[plan.panel(label)]);
    let legend = vec![
        entry(Role::Occluder, Swatch::Line, "occluders A, B"),
        entry(Role::Evidence, Swatch::Line, "supporting line"),
        entry(Role::Outside, Swatch::Line, "supporting line through E"),
        entry(Role::Hidden, Swatch::Area, "T is hidden"),
        entry(Role::Wrong, Swatch::Area, "ignoring E would call T hidden: wrong"),
        entry(Role::Eye, Swatch::Line, "what P sees of T"),
    ];
    let caption = "A and B share E, but from P both lie on the same side of it: E is on their silhouette. If \
                   the supporting lines through E (dotted) were ignored there, T would be called hidden, yet \
                   P sees a corner of it past E. So they are ignored only where the two occluders lie on \
                   opposite sides of E. Scene silhouette_edge, both eyes.";
    Ok(maker.page(Paper::Column, "A shared silhouette edge counts", legend, caption, &content))
}

#[cfg(test)]
mod tests {
    use super::super::regions::holds;
    use super::*;
    use rand_pcg::Pcg32;
    use rand_pcg::rand_core::{Rng, SeedableRng};

    fn viewpoints(plan: &Plan, count: usize) -> Vec<DVec2> {
        let mut rng = Pcg32::seed_from_u64(3);
        let mut number = || f64::from(rng.next_u32()) / f64::from(u32::MAX);
        let frame = plan.wide();
        let mut point = || frame.min + (frame.max - frame.min) * DVec2::new(number(), number());
        // Coordinates that 32 bits hold.
        (0..count).map(|_| point().as_vec2().as_dvec2()).collect()
    }

    /// Whether the segment from the eye to a point meets an occluder before it gets there.
    fn blocked(setting: &Setting, eye: DVec2, to: DVec2) -> bool {
        setting.occluders.iter().any(|(_, [a, b])| {
            let (a, b, ray) = (a.as_dvec2(), b.as_dvec2(), to - eye);
            let across = ray.perp_dot(b - a);
            let (t, u) = ((a - eye).perp_dot(b - a) / across, (a - eye).perp_dot(ray) / across);
            across != 0.0 && t > 0.0 && t < 1.0 && (0.0..=1.0).contains(&u)
        })
    }
    /// Which part of the box's border is seen from an eye, by many rays: none, some, all that faces the eye.
    fn border_of(setting: &Setting) -> Vec<DVec2> {
        let (a, b) = (setting.target.min.as_dvec2(), setting.target.max.as_dvec2());
        let sides = |t: f64| {
            [
                DVec2::new(a.x + (b.x - a.x) * t, a.y),
                DVec2::new(b.x, a.y + (b.y - a.y) * t),
                DVec2::new(a.x + (b.x - a.x) * t, b.y),
                DVec2::new(a.x, a.y + (b.y - a.y) * t),
            ]
        };
        (0..=60).flat_map(|i| sides(f64::from(i) / 60.0)).collect()
    }

    #[test]
    fn regions_1_2_3_are_what_rays_say() {
        let setting = Setting::of("occluder_and_box").expect("a scene");
        let plan = Plan::new(frame([-8.4, 8.4], [-6.4, 5.6]), COLUMN_PT);
        let (all, border) = (one_occluder(&setting, &plan), border_of(&setting));
        let mut seen = [0; 3];
        for p in viewpoints(&plan, 2000) {
            let found: Vec<Occlusion> = all.iter().filter(|(_, c)| holds(c, p)).map(|r| r.0).collect();
            let [region] = found[..] else {
                assert!(
                    setting.blockers.planes(0, &setting.target, p.as_vec2()).is_empty(),
                    "{p}: {found:?}"
                );
                continue;
            };
            assert_eq!(region, setting.blockers.classify(0, &setting.target, p.as_vec2()), "{p}");
            let blocked = border.iter().filter(|to| blocked(&setting, p, **to)).count();
            let wanted = if blocked == border.len() {
                Occlusion::Full
            } else if blocked == 0 {
                Occlusion::None
            } else {
                Occlusion::Partial
            };
            // Rays are 1/60 of a side apart, so next to a line they may miss the sliver.
            let near = setting.borders().iter().any(|b| (b.normal.normalize().dot(p - b.at)).abs() < 0.15);
            assert!(
                near || region == wanted,
                "{p}: {region:?}, but of {} rays {blocked} are blocked",
                border.len()
            );
            seen[region as usize] += usize::from(!near);
        }
        assert!(seen.iter().all(|n| *n > 100), "{seen:?}");
    }

    #[test]
    fn neither_of_the_connected_hides_it_alone_but_rays_find_no_way() {
        let setting = Setting::of("connected_occluders").expect("a scene");
        let plan = Plan::new(frame([-8.4, 8.4], [-6.4, 5.8]), COLUMN_PT);
        let all = regions(&plan.wide(), &setting.borders(), |p| who_hides(&setting, p));
        let mut jointly = 0;
        for p in viewpoints(&plan, 2000) {
            if all.iter().any(|(who, c)| *who == Hiding::Jointly && holds(c, p)) {
                let relation = |id| setting.blockers.classify(id, &setting.target, p.as_vec2());
                assert!((0..2).all(|id| relation(id) == Occlusion::Partial), "{p}");
                assert!(border_of(&setting).iter().all(|to| blocked(&setting, p, *to)), "{p}");
                jointly += 1;
            }
        }
        assert!(jointly > 100, "{jointly}");
    }

    #[test]
    fn ignoring_the_silhouette_edge_would_hide_what_is_seen() {
        let setting = Setting::of("silhouette_edge").expect("a scene");
        let plan = Plan::new(frame([-9.4, 7.4], [-6.4, 5.8]), COLUMN_PT);
        let all = regions(&plan.wide(), &setting.borders(), |p| verdict(&setting, p));
        let mut counts = [0; 2];
        for p in viewpoints(&plan, 2000) {
            for (what, _) in all.iter().filter(|(_, c)| holds(c, p)) {
                let near =
                    setting.borders().iter().any(|b| (b.normal.normalize().dot(p - b.at)).abs() < 0.15);
                let free = border_of(&setting).iter().any(|to| !blocked(&setting, p, *to));
                assert!(near || free == (*what == Verdict::Wrong), "{p}: {what:?}");
                counts[*what as usize] += 1;
            }
        }
        assert!(counts.iter().all(|n| *n > 100), "{counts:?}");
        let seen = Vec2::new(setting.target.max.x, setting.target.min.y).as_dvec2();
        assert!(
            !blocked(&setting, setting.eye(0).as_dvec2(), seen),
            "the line in the figure is a line of sight"
        );
    }
}
