//! The screen's reader of drawings, without a window.
//!
//! `FIGURES_OUT=folder` writes what it paints there (this alone needs a GPU driver).

mod sample;

use cullscope::drawing::{Anchor, Drawing, Layer, Mark, Role, Subject};
use cullscope::render::{Theme, screen};
use eframe::egui::{self, Pos2, Rect};
use glam::{Vec2, vec2};
use sample::every_mark;

/// Paints a drawing in a context of 840 × 660 points; the number of triangles and the bounds of what is
/// inked.
fn painted(ctx: &egui::Context, drawing: &Drawing, scale: f32) -> (usize, Rect) {
    let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, egui::vec2(840.0, 660.0)));
    let input = egui::RawInput { screen_rect, ..egui::RawInput::default() };
    let mut output =
        ctx.run_ui(input, |ui| screen::paint(ui.painter(), drawing, Theme::Light, Pos2::ZERO, scale));
    output.textures_delta.clear();
    let meshes = ctx.tessellate(output.shapes, 1.0);
    let mut inked = Rect::NOTHING;
    let mut triangles = 0;
    for m in &meshes {
        if let egui::epaint::Primitive::Mesh(mesh) = &m.primitive {
            triangles += mesh.indices.len() / 3;
            inked |= mesh.calc_bounds();
        }
    }
    (triangles, inked)
}

#[test]
fn every_mark_is_painted_with_and_without_our_fonts() {
    let ctx = egui::Context::default();
    let (plain, _) = painted(&ctx, &every_mark(), 2.0);
    screen::install_fonts(&ctx);
    painted(&ctx, &every_mark(), 2.0);
    let (triangles, inked) = painted(&ctx, &every_mark(), 2.0);
    assert!(plain > 1000 && triangles > 1000, "{plain} {triangles}");
    assert!(inked.min.x < 130.0 && inked.max.x > 800.0 && inked.max.y > 560.0, "{inked:?}");
}

#[test]
fn what_is_out_of_sight_costs_nothing_and_what_is_huge_little() {
    let ctx = egui::Context::default();
    let mut d = Drawing { size_pt: vec2(400.0, 300.0), ..Drawing::default() };
    for role in Role::ALL {
        d.line(Layer::Scene, role, Subject::None, [vec2(-900.0, -50.0), vec2(900.0, -90.0)]);
        d.text(Layer::Scene, role, vec2(2000.0, 20.0), 9.0, Anchor::Start, "far");
    }
    assert_eq!(painted(&ctx, &d, 1.0).0, 0);
    let corners = [vec2(-9e6, -9e6), vec2(9e6, -9e6), vec2(9e6, 9e6), vec2(-9e6, 9e6)];
    for role in Role::ALL {
        d.push(Layer::Scene, role, Subject::None, Mark::Area(corners.to_vec()));
        d.line(Layer::Scene, role, Subject::None, [corners[0], corners[2]]);
        d.push(Layer::Scene, role, Subject::None, Mark::Dot { at: Vec2::NAN, radius_pt: 4.0 });
    }
    let (triangles, _) = painted(&ctx, &d, 1.0);
    assert!(triangles < 60_000, "{triangles}");
    for odd in [f32::NAN, f32::INFINITY, 0.0, -1.0] {
        painted(&ctx, &d, odd);
    }
}

#[test]
fn ten_thousand_marks_fit_into_a_frame() {
    let ctx = egui::Context::default();
    let mut d = Drawing { size_pt: vec2(840.0, 660.0), ..Drawing::default() };
    for i in 0..10_000u32 {
        let at = vec2((i % 100) as f32 * 8.0, (i / 100) as f32 * 6.5);
        let role = Role::STATES[i as usize % 8];
        let points = [at, at + vec2(7.0, 0.0), at + vec2(6.0, 5.0)];
        d.push(
            Layer::Scene,
            role,
            Subject::None,
            if i % 2 == 0 {
                Mark::Area(points.to_vec())
            } else {
                Mark::Line { points: points.to_vec(), closed: false }
            },
        );
    }
    painted(&ctx, &d, 1.0);
    let begun = std::time::Instant::now();
    let (triangles, _) = painted(&ctx, &d, 1.0);
    println!("10,000 marks: {triangles} triangles in {:.1} ms", begun.elapsed().as_secs_f64() * 1e3);
    // The clock of a busy machine proves little; the work does not lie.
    assert!(triangles < 700_000, "{triangles}");
}

#[test]
fn pictures_become_textures_once() {
    let ctx = egui::Context::default();
    let d = every_mark();
    let textures = |ctx: &egui::Context| ctx.tex_manager().read().num_allocated();
    painted(&ctx, &d, 1.0);
    let first = textures(&ctx);
    painted(&ctx, &d, 1.5);
    assert_eq!(textures(&ctx), first, "the same picture is uploaded once");
    let mut other = every_mark();
    other.items.retain(|i| !matches!(i.mark, Mark::Image { .. }));
    for _ in 0..4 {
        painted(&ctx, &other, 1.0);
    }
    painted(&ctx, &every_mark(), 1.0);
    assert_eq!(textures(&ctx), first, "a picture that is gone gives its texture back");
}

#[test]
fn the_screen_looks_like_the_files() {
    let Some(folder) = std::env::var_os("FIGURES_OUT") else { return };
    for theme in Theme::ALL {
        let d = every_mark();
        let mut harness =
            egui_kittest::Harness::builder().with_size(egui::vec2(840.0, 660.0)).wgpu().build_ui(move |ui| {
                screen::install_fonts(ui.ctx());
                screen::paint_paper(ui.painter(), d.size_pt, theme, Pos2::ZERO, 2.0);
                screen::paint(ui.painter(), &d, theme, Pos2::ZERO, 2.0);
            });
        harness.remove_cursor();
        harness.run();
        let picture = harness.render().expect("a picture");
        picture
            .save(std::path::Path::new(&folder).join(format!("screen-{}.png", theme.name())))
            .expect("the picture can be written");
    }
}
