//! The real models: those of scenes2d/ and scenes3d/ always, others where `CULLSCOPE_SCENES` names a folder.

use std::path::{Path, PathBuf};

use cullscope::culling::Methods;
use cullscope::geometry::{Flat, PrimId, Solid};
use cullscope::method::Settings;
use cullscope::scene::{AnyScene, LoadOptions, Quiet, Scene, Surfaces, load};
use cullscope::truth::Truth;

fn home() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn solid(path: &Path) -> std::sync::Arc<Scene<Solid>> {
    match load(&path.to_string_lossy(), &LoadOptions::default(), &Quiet) {
        Ok(AnyScene::Solid(scene)) => scene,
        other => panic!("{}: {other:?}", path.display()),
    }
}

fn flat(path: &Path) -> std::sync::Arc<Scene<Flat>> {
    match load(&path.to_string_lossy(), &LoadOptions::default(), &Quiet) {
        Ok(AnyScene::Flat(scene)) => scene,
        other => panic!("{}: {other:?}", path.display()),
    }
}

/// Triangles, objects and views in space; what SOURCE.txt and the files' own lists say.
const SHIPPED: [(&str, usize, usize, usize); 14] = [
    ("box_outline", 16, 3, 48),
    ("corner_hole", 128, 4, 25),
    ("freedoom_e1m1", 3_693, 135, 119),
    ("freedoom_e1m2", 7_786, 316, 120),
    ("freedoom_e1m5", 27_828, 1_055, 120),
    ("freedoom_p2_map12", 44_232, 1_707, 118),
    ("joint_convex", 18, 3, 48),
    ("joint_disconnected", 18, 3, 48),
    ("joint_not_convex", 19, 3, 48),
    ("slit", 20, 2, 25),
    ("tangent_planes", 16, 3, 48),
    ("terrain_jacksboro_65k", 65_322, 132, 120),
    ("tree_aspen_5k", 4_896, 46, 120),
    ("tree_oak_52k", 52_325, 551, 120),
];

#[test]
fn shipped_models_load_whole() {
    for (name, triangles, objects, views) in SHIPPED {
        let scene = solid(&home().join("scenes3d").join(name).join(format!("{name}.obj")));
        assert_eq!(scene.prim_count(), triangles, "{name}");
        assert_eq!((scene.objects().len(), scene.paths()[0].views.len()), (objects, views), "{name}");
        assert!(scene.materials().iter().all(|m| m.name != "default"), "{name}: every face has a material");
        assert!(scene.report().notes.iter().all(|n| !n.contains("material")), "{name}: {:?}", scene.report());
    }
}

/// The protein of `scenes3d`: its SOURCE.txt counts 6,508 atoms in first positions, 93 in second ones, 636
/// waters, and no hydrogen; its views are 60 around and 60 on an approach.
#[test]
fn the_shipped_molecule_is_a_ball_an_atom() {
    let scene = solid(&home().join("scenes3d/pdb_3hsy/3hsy.pdb"));
    assert_eq!((scene.objects().len(), scene.live().len()), (6_508, 6_508 * 800));
    assert_eq!(scene.paths()[0].views.len(), 120);
    let waters = scene.objects().iter().filter(|o| o.group == "water").count();
    assert_eq!(waters, 636);
    let said = &scene.report().notes;
    assert!(said[0].ends_with("636 atoms of water, in the group `water`"), "{said:?}");
    assert!(said[1].contains("93 atoms in alternate positions left out"), "{said:?}");
    assert!(said[2].starts_with("6508 atoms: C ") && said[2].contains(", S "), "{said:?}");
    // The box of the coordinates, and a radius of at most 1.8 Å around it.
    let (low, high) = (scene.bounds().min, scene.bounds().max);
    assert!(low.x > -26.7 - 1.8 && low.x < -26.6 - 1.5 && high.z > 24.0 + 1.5 && high.z < 24.1 + 1.8);
}

/// Corners of all triangles, in order.
fn corners(scene: &Scene<Solid>) -> Vec<[f32; 3]> {
    let points = scene.live().iter().flat_map(|&p| scene.prim_points(p));
    points.map(|p| p.to_array()).collect()
}

/// What another reader, `tobj`, makes of the same files: the same triangles with the same winding.
#[test]
fn shipped_models_are_as_another_reader_reads_them() {
    for (name, triangles, ..) in SHIPPED {
        let path = home().join("scenes3d").join(name).join(format!("{name}.obj"));
        let scene = solid(&path);
        let options = tobj::LoadOptions { triangulate: true, ..tobj::LoadOptions::default() };
        let (models, _) = tobj::load_obj(&path, &options).expect("tobj reads it");
        let origin = scene.origin();
        let mut theirs: Vec<[f32; 3]> = Vec::new();
        for mesh in models.iter().map(|m| &m.mesh) {
            let point = |i: u32| std::array::from_fn(|a| mesh.positions[3 * i as usize + a] - origin[a]);
            theirs.extend(mesh.indices.iter().map(|&i| point(i).map(|v: f64| v as f32)));
        }
        assert_eq!(theirs.len(), 3 * triangles, "{name}");
        // Models are split by material there, so the order is compared triangle by triangle.
        let sorted = |corners: Vec<[f32; 3]>| {
            let mut all: Vec<_> = corners.chunks(3).map(|t| t.concat()).collect();
            all.sort_by(|a, b| {
                a.iter()
                    .zip(b)
                    .map(|(a, b)| a.total_cmp(b))
                    .find(|o| o.is_ne())
                    .unwrap_or_else(|| a.len().cmp(&b.len()))
            });
            all
        };
        assert!(sorted(corners(&scene)) == sorted(theirs), "{name}: other triangles");
    }
}

/// The scenes of Coorg and Teller's figures in space say what the figures say of the first view.
#[test]
fn scenes_of_figures_show_what_the_figures_show() {
    // How many triangles of the box are drawn: parts of it may lie behind one occluder.
    let some = 1..=12;
    for (name, drawn) in [
        ("joint_convex", 0..=0),
        ("joint_not_convex", some.clone()),
        ("joint_disconnected", some),
        ("tangent_planes", 0..=0),
    ] {
        let scene = solid(&home().join("scenes3d").join(name).join(format!("{name}.obj")));
        let views = &scene.paths()[0].views;
        let of_box = |prims: &[PrimId]| {
            prims.iter().filter(|p| scene.objects()[scene.object_of(**p).at()].name == "T").count()
        };
        let mut truth = Truth::new(&scene, Surfaces::default(), 1, [1.0; 3]);
        let method = <Solid as Methods>::method("large-occluders").expect("a method");
        let mut run =
            method.ready(&scene, &Settings::default(), &Quiet).expect("settings").expect("not cancelled");
        assert_eq!(of_box(&truth.look(&scene, &views[0])), 0, "{name}: the box is hidden");
        let of_box_drawn = of_box(&run.cull(&views[0]).prims);
        assert!(drawn.contains(&of_box_drawn), "{name}: {of_box_drawn} triangles of the box are drawn");
        // Farther on the box comes into sight.
        assert!(views.iter().any(|v| of_box(&truth.look(&scene, v)) > 0), "{name}");
    }
}

/// Holes have the pixels that their SOURCE.txt says, each of what stands behind it, and lie in blocks of
/// 16 × 16 as it says: at most 25 pixels of a block are ignored in the example of Zhang et al. (1997,
/// Section 5.4).
#[test]
fn holes_have_as_many_pixels_as_they_say() {
    for (name, behind, pixels, in_block) in [
        ("slit", "behind", 1024, 16),
        ("corner_hole", "behind_5x5", 25, 25),
        ("corner_hole", "behind_6x6", 36, 36),
        ("corner_hole", "behind_6x6_at_corner", 36, 9),
    ] {
        let scene = solid(&home().join("scenes3d").join(name).join(format!("{name}.obj")));
        let view = &scene.paths()[0].views[0];
        let mut truth = Truth::new(&scene, Surfaces::default(), 1, [1.0; 3]);
        truth.look(&scene, view);
        let image = truth.image();
        assert_eq!((image.width, image.height), (1024, 1024));
        let (mut count, mut blocks) = (0, vec![0; 64 * 64]);
        for (at, item) in image.item.iter().enumerate() {
            assert_ne!(*item, cullscope::raster::Target::NONE, "{name}: nothing at pixel {at}");
            if scene.objects()[scene.object_of(PrimId(*item)).at()].name == behind {
                count += 1;
                blocks[at / 1024 / 16 * 64 + at % 1024 / 16] += 1;
            }
        }
        assert_eq!(count, pixels, "{name}: {behind}");
        assert!(blocks.iter().all(|n| *n == 0 || *n == in_block), "{name}: {behind}");
    }
}

#[test]
fn shipped_levels_stand_in_flatland_too() {
    for (name, segments, objects, eyes, walk) in [
        ("freedoom_e1m1", 425, 107, 228, 792),
        ("freedoom_e1m2", 1_267, 278, 283, 724),
        ("freedoom_e1m5", 4_263, 803, 516, 2_281),
        ("freedoom_p2_map12", 5_108, 966, 577, 2_542),
    ] {
        let scene = flat(&home().join("scenes2d").join(name).join(format!("{name}.flat.json")));
        assert_eq!(scene.prim_count(), segments, "{name}");
        assert_eq!(
            (scene.objects().len(), scene.paths()[0].views.len(), scene.paths()[1].views.len()),
            (objects, eyes, walk),
            "{name}"
        );
    }
}

/// Triangles and objects of the models that are not shipped.
const OTHERS: [(&str, usize, usize); 14] = [
    ("citysim_town/citysim_town", 277_293, 439),
    ("delft/delft", 36_267, 570),
    ("classics/spot", 5_856, 1),
    ("classics/suzanne", 3_936, 1),
    ("classics/teapot", 6_320, 1),
    ("eztree_grove/eztree_grove", 170_348, 45),
    ("lq_e1m2/lq_e1m2", 14_850, 271),
    ("pandora/pandora", 60_694, 856),
    ("small_house/small_house", 145_231, 85),
    ("willow_garage/willow_garage", 13_839, 383),
    ("fm1_device/fm1_device", 103_504, 62),
    ("iss_modules/iss_modules", 24_546, 905),
    ("pdb_1d66/pdb_1d66", 136_880, 156),
    ("jacksboro/jacksboro", 275_772, 143),
];

#[test]
fn other_models_load_whole_where_they_are() {
    let Some(folder) = std::env::var_os("CULLSCOPE_SCENES").map(PathBuf::from) else {
        eprintln!("skipped: CULLSCOPE_SCENES names no folder with the models that are not shipped");
        return;
    };
    for (name, triangles, objects) in OTHERS {
        let path = folder.join(format!("{name}.obj"));
        if !path.is_file() {
            eprintln!("skipped: {} is not there", path.display());
            continue;
        }
        let scene = solid(&path);
        println!(
            "{name}: {} polygons, {} views, {:?}",
            scene.faces().len(),
            scene.paths()[0].views.len(),
            scene.report()
        );
        assert_eq!((scene.prim_count(), scene.objects().len()), (triangles, objects), "{name}");
        assert!(!scene.paths().is_empty(), "{name}");
    }
}
