//! What hides a thing, by name: the occluders that the evidence names, or else what had been drawn by then at
//! the pixels of the thing.
//!
//! For the latter what had been drawn is drawn again, and compared with the thing at each pixel center that
//! the thing covers. So it is said of pixels, and of nothing in between.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use super::stage::{HiddenBy, SceneFacts, Stage};
use crate::drawing::Subject;
use crate::drawing::words::{Room, count, short};
use crate::geometry::{PixelRect, PrimId};
use crate::method::{Hiders, surfaces_of};
use crate::raster::{Drawable, Options, Target};

/// Things that are named.
const NAMED: usize = 3;

/// A primitive's object if it has a name, else the primitive; with how it is called.
pub(super) fn called(scene: &dyn SceneFacts, prim: PrimId) -> (Subject, String) {
    let object = scene.object_of(prim);
    match scene.object_name(object) {
        "" => (Subject::Prim(prim), format!("{} {prim}", scene.prim_name())),
        name => (Subject::Object(object), name.to_owned()),
    }
}

impl<S: Drawable> Stage<S> {
    /// What hides `prims`, which are left out as hidden on the ground of the evidence that is event `at`.
    pub(super) fn hiders_of(&self, at: usize, prims: &[PrimId]) -> Option<HiddenBy> {
        let film = &self.recorded.as_ref()?.film;
        match film.hiders(at)? {
            Hiders::Occluders(named, all) => {
                let mut by: Vec<(Subject, String)> = Vec::new();
                for thing in named.iter().map(|&p| called(&**film.scene(), p)) {
                    if !by.contains(&thing) {
                        by.push(thing);
                    }
                }
                let is_part = named.len() < all || by.len() > NAMED;
                by.truncate(NAMED);
                Some(HiddenBy { text: String::new(), by, is_part })
            }
            Hiders::Drawn(drawn) => self.before(&drawn, prims),
        }
    }

    /// What of `drawn` lies before `prims`, pixel by pixel.
    fn before(&self, drawn: &[PrimId], prims: &[PrimId]) -> Option<HiddenBy> {
        let film = &self.recorded.as_ref()?.film;
        let (scene, view) = (&**film.scene(), film.view());
        let surfaces = surfaces_of(film.knobs());
        let mut options = Options { surfaces: surfaces.both_sides(), ..Options::default() };
        // Of each pixel the nearest depth of the thing.
        let mut own: BTreeMap<usize, f32> = BTreeMap::new();
        for &prim in prims {
            S::fragments(scene, view, prim, &options, &mut |at, depth| {
                if depth < 1.0 / view.eye.far {
                    return;
                }
                let nearest = own.entry(at).or_insert(depth);
                *nearest = nearest.max(depth);
            });
        }
        let is_one = prims.len() == 1;
        let Some(window) = window(own.keys().copied(), view.width) else {
            let text = if is_one { "It covers no pixel's center." } else { "They cover no pixel's center." };
            return Some(HiddenBy { text: text.into(), ..HiddenBy::default() });
        };
        options.window = Some(window);
        let mut image = Target::new(view);
        S::draw(&mut image, scene, view, drawn, &options);
        let mut owners: BTreeMap<(Subject, String), usize> = BTreeMap::new();
        let (mut bare, mut farthest) = (0, None::<(f32, PrimId)>);
        for (&at, &depth) in &own {
            if image.item[at] == Target::NONE || image.depth[at] < depth {
                bare += 1;
                continue;
            }
            let prim = PrimId(image.item[at]);
            *owners.entry(called(scene, prim)).or_default() += 1;
            if farthest.is_none_or(|(least, _)| image.depth[at] < least) {
                farthest = Some((image.depth[at], prim));
            }
        }
        let plural = if own.len() == 1 { "" } else { "s" };
        let pixels = format!("{} {} pixel{plural}", if is_one { "its" } else { "their" }, count(own.len()));
        Some(told(scene, &pixels, bare, owners, farthest))
    }
}

/// The least rectangle around some pixels.
fn window(pixels: impl Iterator<Item = usize>, width: u32) -> Option<PixelRect> {
    pixels.fold(None, |all: Option<PixelRect>, at| {
        let (x, y) = (at as u32 % width, at as u32 / width);
        let all = all.unwrap_or(PixelRect { x0: x, x1: x + 1, y0: y, y1: y + 1 });
        Some(PixelRect { x0: all.x0.min(x), x1: all.x1.max(x + 1), y0: all.y0.min(y), y1: all.y1.max(y + 1) })
    })
}

/// The same in words; `pixels` of the thing are called so. `farthest`: `1/w` of the farthest of what lies
/// before it, and whose that is.
fn told(
    scene: &dyn SceneFacts,
    pixels: &str,
    bare: usize,
    owners: BTreeMap<(Subject, String), usize>,
    farthest: Option<(f32, PrimId)>,
) -> HiddenBy {
    let Some((depth, prim)) = farthest else {
        let text = format!("At {pixels} nothing that had been drawn by then lay nearer.");
        return HiddenBy { text, ..HiddenBy::default() };
    };
    let mut owners: Vec<_> = owners.into_iter().map(|(thing, n)| (Reverse(n), thing)).collect();
    owners.sort();
    let names: Vec<String> =
        owners.iter().take(NAMED).map(|(Reverse(n), (_, name))| format!("{name} ({})", count(*n))).collect();
    let more = match owners.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {} more", count(more)),
    };
    let bare = if bare > 0 { format!("; at {} nothing did", count(bare)) } else { String::new() };
    let away = short(1.0 / depth, Room::Sentence);
    let text = format!(
        "Of what had been drawn by then, this lay nearer at {pixels}: {}{more}{bare}. The farthest of it is \
         {}, at depth {away}.",
        names.join(", "),
        named(scene, prim)
    );
    let is_part = owners.len() > NAMED;
    let by = owners.into_iter().take(NAMED).map(|(_, thing)| thing).collect();
    HiddenBy { text, by, is_part }
}

/// A primitive with its number and the name of its object, such as `triangle 12 of door`.
pub(super) fn named(scene: &dyn SceneFacts, prim: PrimId) -> String {
    let object = scene.object_name(scene.object_of(prim));
    let of = if object.is_empty() { String::new() } else { format!(" of {object}") };
    format!("{} {prim}{of}", scene.prim_name())
}

#[cfg(test)]
mod tests {
    use super::super::tests::opened_with as opened;
    use super::*;
    use crate::method::Verdict;

    /// Whatever depths prove hidden lies at each of its pixels behind something that had been drawn by then,
    /// and that is named.
    #[test]
    fn what_depths_hide_is_hidden_by_what_had_been_drawn() {
        let building = "generate:building?polygons=2000&seed=3";
        for (source, method, least) in [
            ("street", "hierarchical-z", 10),
            ("street", "occlusion-maps", 4),
            (building, "hierarchical-z", 100),
            (building, "occlusion-maps", 50),
        ] {
            let state = opened(source, method);
            let (stage, film) = (state.staged().expect("a stage"), state.film().expect("a film"));
            let mut named = 0;
            for prim in (0..2000).map(PrimId).filter(|p| stage.scene().has_prim(*p)) {
                let Some((at, Verdict::Hidden)) = film.stamps.prim_decision(prim) else { continue };
                let Some(ground) = film.reel.evidence_of(at - 1) else { continue };
                let HiddenBy { text, by, .. } = stage.hidden_by(ground, &[prim]).expect("known");
                if text == "It covers no pixel's center." {
                    continue;
                }
                let what = format!("{source}, {method}, {prim}: {text}");
                assert!(
                    text.starts_with("Of what had been drawn by then") && !text.contains("nothing"),
                    "{what}"
                );
                for (subject, name) in by {
                    assert!(text.contains(&name), "{what}");
                    let Subject::Prim(hider) = subject else { continue };
                    let drawn = film.stamps.prim_decision(hider).expect("decided");
                    let is_drawn = drawn.1 == Verdict::Visible && drawn.0 <= at;
                    assert!(is_drawn || method == "occlusion-maps", "{what}: {drawn:?}");
                    assert_ne!(hider, prim, "{what}");
                }
                named += 1;
            }
            assert!(named >= least, "{source}, {method}: {named}");
        }
    }

    /// An occluder of the evidence is named as the sentence names it.
    #[test]
    fn occluders_are_those_of_the_evidence() {
        let state = opened("scenes2d/rooms.json", "large-occluders");
        let (stage, film) = (state.staged().expect("a stage"), state.film().expect("a film"));
        let (mut alone, mut together) = (0, 0);
        for prim in (0..10_000).map(PrimId).filter(|p| stage.scene().has_prim(*p)) {
            let Some((at, Verdict::Hidden)) = film.stamps.prim_decision(prim) else { continue };
            let Some(ground) = film.reel.evidence_of(at - 1) else { continue };
            let Some(HiddenBy { by, text, .. }) = stage.hidden_by(ground, &[prim]) else { continue };
            assert!(text.is_empty() && !by.is_empty());
            match film.reel.fields(ground).1.iter().find(|f| f.name == "occluder_prim") {
                Some(field) => {
                    let crate::method::Value::Integer(occluder) = field.value else { panic!("a number") };
                    assert_eq!(by, [called(stage.scene(), PrimId(occluder as u32))]);
                    alone += 1;
                }
                None => together += 1,
            }
        }
        assert!(alone > 3, "{alone} alone, {together} together");
    }
}
