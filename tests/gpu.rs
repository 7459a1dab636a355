//! Viewports drawn without a window: state by step, occlusion, ghosts, several viewports, tiles.
//!
//! Every test ends early with a plain message where there is no graphics adapter at all.
#![cfg(feature = "gui")]

use std::sync::Arc;

use cullscope::culling::Methods;
use cullscope::drawing::{Drawing, Layer, Mark, Role, Subject};
use cullscope::geometry::{Eye, Frustum, MaterialId, NodeId, ObjectId, PrimId, Solid, View};
use cullscope::method::{Film, Settings, Verdict};
use cullscope::raster::render;
use cullscope::render::Theme;
use cullscope::render::gpu::{
    ColorBy, GpuError, Headless, NodeBoxes, Palette, Shown, SpaceCamera, SpaceLayer, SpaceStyle, Surface,
    ViewportId, headless, items,
};
use cullscope::scene::{Face, Material, Object, Parts, Quiet, Report, Scene, random_views};
use cullscope::trace::Stamps;
use cullscope::truth::{Disagreement, disagreement};
use eframe::wgpu;
use glam::{DVec3, Vec3};

const SIZE: [u32; 2] = [320, 240];

fn device() -> Option<Headless> {
    match headless() {
        Ok(device) => Some(device),
        Err(GpuError::NoAdapter { reason }) => {
            println!("not tested: no graphics adapter ({reason})");
            None
        }
        Err(other) => panic!("{other}"),
    }
}

/// A scene of boxes (center, half size, color); each is an object.
fn boxes(list: &[(Vec3, Vec3, [f32; 3])]) -> Arc<Scene<Solid>> {
    let (mut points, mut prims, mut faces, mut objects, mut materials) =
        (vec![], vec![], vec![], vec![], vec![]);
    let (mut prim_object, mut prim_material) = (vec![], vec![]);
    let sign = |k: u32, axis: u32| if k >> axis & 1 == 1 { 1.0 } else { -1.0 };
    for (i, &(center, half, color)) in list.iter().enumerate() {
        let base = points.len() as u32;
        points.extend((0..8).map(|k| center + half * Vec3::new(sign(k, 0), sign(k, 1), sign(k, 2))));
        for quad in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]] {
            let q = quad.map(|k: u32| base + k);
            let first = prims.len() as u32;
            prims.extend([Some([q[0], q[1], q[2]]), Some([q[0], q[2], q[3]])]);
            faces.push(Face { corners: q.to_vec(), prims: vec![PrimId(first), PrimId(first + 1)] });
            prim_object.extend([ObjectId(i as u32); 2]);
            prim_material.extend([MaterialId(i as u32); 2]);
        }
        objects.push(Object { name: format!("box {i}"), group: String::new(), motion: None });
        materials.push(Material::new(format!("color {i}"), color));
    }
    let (name, source) = ("boxes".into(), "boxes".into());
    let (origin, paths, report) = (DVec3::ZERO, vec![], Report::default());
    let parts = Parts::<Solid> {
        name,
        source,
        points,
        prims,
        prim_object,
        prim_material,
        faces,
        objects,
        materials,
        origin,
        paths,
        report,
    };
    Arc::new(Scene::new(parts).expect("a well-formed scene"))
}

/// A grid of towers on a floor: some before the eye, some beside and behind it.
fn town() -> Arc<Scene<Solid>> {
    let mut list = vec![(Vec3::new(0.0, -0.1, 0.0), Vec3::new(14.0, 0.1, 14.0), [0.5, 0.5, 0.5])];
    for x in -3..=3 {
        for z in -3..=3 {
            let height = 0.6 + ((x * 5 + z * 3) as f32).sin().abs();
            list.push((
                Vec3::new(x as f32 * 4.0, height, z as f32 * 4.0),
                Vec3::new(0.9, height, 0.9),
                [0.7, 0.45, 0.3],
            ));
        }
    }
    boxes(&list)
}

fn eye() -> Eye<Solid> {
    Eye {
        position: Vec3::new(-2.0, 1.6, 12.0),
        target: Vec3::new(1.0, 1.2, 0.0),
        up: Vec3::Y,
        fov: 0.7,
        near: 0.5,
        far: 22.0,
    }
}

fn film(scene: &Arc<Scene<Solid>>, eye: Eye<Solid>) -> Arc<dyn Film<Solid>> {
    let method = Solid::method("frustum").expect("the method");
    let mut run =
        method.ready(scene, &Settings::default(), &Quiet).expect("settings").expect("not cancelled");
    run.record(&View { eye, width: SIZE[0], height: SIZE[1] }, 1_000_000).film
}

/// The Eye and its frustum, and the evidence of a step.
fn marks(film: &dyn Film<Solid>, step: usize) -> Drawing<Vec3> {
    let mut to = Drawing::default();
    let (view, at) = (film.view(), film.view().eye.position);
    let c = Frustum::corners(&view.projection(), view.eye.near, view.eye.far);
    to.outline(Layer::Frustum, Role::Eye, Subject::Eye, &c[..4]);
    to.outline(Layer::Frustum, Role::Eye, Subject::Eye, &c[4..]);
    (0..4).for_each(|i| to.line(Layer::Frustum, Role::Eye, Subject::Eye, [at, c[4 + i]]));
    to.push(Layer::Eye, Role::Eye, Subject::Eye, Mark::Arrow(at, at + view.eye.forward() * 3.0));
    to.push(Layer::Eye, Role::Eye, Subject::Eye, Mark::Dot { at, radius_pt: 4.0 });
    film.explain(step, &mut to);
    to
}

fn observer() -> SpaceCamera {
    SpaceCamera {
        position: Vec3::new(16.0, 20.0, 26.0),
        target: Vec3::new(0.0, 0.0, 1.0),
        up: Vec3::Y,
        fov: 0.8,
        near: 0.1,
        far: f32::INFINITY,
    }
}

fn palette() -> Palette {
    Palette::of(Theme::Light)
}
fn flat(role: Role) -> [u8; 3] {
    Theme::Light.flat(role)
}

/// Everything that a test draws with.
struct Stage {
    gpu: Headless,
    layer: SpaceLayer,
}

impl Stage {
    fn new(scene: &Arc<Scene<Solid>>) -> Option<Self> {
        let gpu = device()?;
        let mut layer = SpaceLayer::new(&gpu.device, wgpu::TextureFormat::Rgba8Unorm);
        layer.set_scene(&gpu.device, scene, scene.live().to_vec());
        Some(Self { gpu, layer })
    }
    fn show(&mut self, film: &Arc<dyn Film<Solid>>, wrong: &[PrimId]) -> Stamps {
        let stamps = Stamps::new(&**film);
        self.layer.set_film(&self.gpu.device, &self.gpu.queue, &stamps, film.hierarchy(), wrong);
        stamps
    }
    fn mark(&mut self, drawing: &Drawing<Vec3>) {
        self.layer.set_marks(&self.gpu.device, &self.gpu.queue, drawing);
    }
    fn picture(&self, camera: &SpaceCamera, style: &SpaceStyle) -> Vec<u8> {
        self.layer.snapshot(&self.gpu.device, &self.gpu.queue, SIZE, 1, camera, style).expect("a picture").2
    }
}

fn pixel(rgba: &[u8], x: u32, y: u32) -> [u8; 3] {
    let at = ((y * SIZE[0] + x) * 4) as usize;
    [rgba[at], rgba[at + 1], rgba[at + 2]]
}
/// Whether a color is another one in some shade: the same ratios of its channels.
fn is_shade_of(c: [u8; 3], flat: [u8; 3]) -> bool {
    let most = |c: [u8; 3]| f32::from(c.into_iter().max().unwrap_or(0));
    let shade = most(c) / most(flat);
    (0.5..=1.01).contains(&shade)
        && (0..3).all(|i| (f32::from(c[i]) - f32::from(flat[i]) * shade).abs() <= 3.0)
}
fn count(rgba: &[u8], flat: [u8; 3]) -> usize {
    rgba.chunks_exact(4).filter(|c| is_shade_of([c[0], c[1], c[2]], flat)).count()
}
/// Pixels that are not exactly the paper's color.
fn inked(rgba: &[u8]) -> usize {
    rgba.chunks_exact(4).filter(|c| c[..3] != palette().paper).count()
}
/// Only surfaces: no boxes, no lines.
fn plain(step: usize) -> SpaceStyle {
    SpaceStyle { nodes: NodeBoxes::None, ..SpaceStyle::observer(step, palette()) }
}

#[test]
fn the_state_follows_the_step_and_nothing_is_uploaded() {
    let scene = town();
    let Some(mut stage) = Stage::new(&scene) else { return };
    let film = film(&scene, eye());
    stage.show(&film, &[]);
    let last = film.events().len();
    // Without ghosts, whose gray dots could be taken for undecided surfaces.
    let at = |step| stage.picture(&observer(), &SpaceStyle { culled: Shown::Not, ..plain(step) });
    let (start, half, end) = (at(0), at(last / 2), at(last));
    assert!(count(&start, flat(Role::Scene)) > 10_000 && count(&start, flat(Role::Visible)) == 0);
    let (some, all) = (count(&half, flat(Role::Visible)), count(&end, flat(Role::Visible)));
    assert!(0 < some && some < all, "{some} {all}");
    assert_eq!(count(&end, flat(Role::Scene)), 0);
    // Scrubbing back gives the same picture, since only the step was changed.
    assert_eq!(at(0), start);
    assert_eq!(at(last / 2), half);
}

#[test]
fn the_step_of_a_decision_is_the_first_that_shows_it() {
    let scene = town();
    let Some(mut stage) = Stage::new(&scene) else { return };
    let film = film(&scene, eye());
    let stamps = stage.show(&film, &[]);
    let kept = scene
        .live()
        .iter()
        .find(|p| stamps.prims()[p.at()].verdict == Verdict::Visible)
        .copied()
        .expect("something is kept");
    let step = stamps.prim_decision(kept).map(|d| d.0).expect("it was decided");
    let blue = |step| {
        count(
            &stage.picture(&observer(), &SpaceStyle { undecided: Shown::Not, ..plain(step) }),
            flat(Role::Visible),
        )
    };
    assert!(blue(step) > blue(step - 1), "{} {}", blue(step - 1), blue(step));
}

#[test]
fn the_nearer_triangle_wins_in_either_order() {
    let (red, green) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let camera = SpaceCamera {
        position: Vec3::new(0.0, 0.0, 5.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        fov: 0.8,
        near: 0.1,
        far: 4000.0,
    };
    for order in [[0, 1], [1, 0]] {
        let both =
            [(Vec3::ZERO, Vec3::splat(0.5), red), (Vec3::new(0.0, 0.0, -40.0), Vec3::splat(10.0), green)];
        let Some(stage) = Stage::new(&boxes(&order.map(|i| both[i]))) else { return };
        let picture = stage.picture(&camera, &SpaceStyle { color_by: ColorBy::Material, ..plain(0) });
        assert!(is_shade_of(pixel(&picture, 160, 120), [255, 0, 0]), "{:?}", pixel(&picture, 160, 120));
        assert!(is_shade_of(pixel(&picture, 160, 70), [0, 255, 0]), "{:?}", pixel(&picture, 160, 70));
    }
    // A hundredth of a unit apart, a hundred units away, with a near plane of a tenth.
    let thin = |z: f32, color| (Vec3::new(0.0, 0.0, z), Vec3::new(20.0, 20.0, 0.0001), color);
    let Some(stage) = Stage::new(&boxes(&[thin(-100.0, red), thin(-100.01, green)])) else { return };
    let picture = stage.picture(&camera, &SpaceStyle { color_by: ColorBy::Material, ..plain(0) });
    assert!(count(&picture, [255, 0, 0]) > 4000 && count(&picture, [0, 255, 0]) == 0);
}

#[test]
fn the_eyes_view_leaves_out_what_was_culled() {
    let scene = town();
    let Some(mut stage) = Stage::new(&scene) else { return };
    let film = film(&scene, eye());
    let stamps = stage.show(&film, &[]);
    let last = film.events().len();
    assert!(stamps.counts(last).of(Verdict::Outside) > 50, "the test needs culled triangles");
    let kept = stage.picture(&observer(), &SpaceStyle::eye(last, palette()));
    let all = stage.picture(&observer(), &SpaceStyle { culled: Shown::Solid, ..plain(last) });
    let counts = [
        count(&all, flat(Role::Outside)),
        count(&kept, flat(Role::Outside)),
        count(&kept, flat(Role::Visible)),
    ];
    assert!(counts[0] > 2000 && counts[1] == 0 && counts[2] > 2000, "{counts:?}");
    // Through the Eye itself nothing is missing.
    let camera = SpaceCamera::from(eye());
    let through = |culled| {
        stage.picture(
            &camera,
            &SpaceStyle { color_by: ColorBy::Material, culled, ..SpaceStyle::eye(last, palette()) },
        )
    };
    assert_eq!(through(Shown::Not), through(Shown::Solid));
    // Before anything is decided it shows nothing, or everything if asked.
    let at_start =
        |undecided| stage.picture(&camera, &SpaceStyle { undecided, ..SpaceStyle::eye(0, palette()) });
    assert_eq!(inked(&at_start(Shown::Not)), 0);
    assert!(count(&at_start(Shown::Solid), flat(Role::Scene)) > 10_000);
}

#[test]
fn ghosts_hide_nothing() {
    // A culled box stands before a kept one: as a ghost it lets the kept one through, wherever it comes in
    // the scene.
    let near = (Vec3::new(0.0, 0.0, 8.0), Vec3::splat(0.5), [1.0; 3]);
    let far = (Vec3::new(0.0, 0.0, -8.0), Vec3::splat(1.5), [1.0; 3]);
    let eye = Eye { position: Vec3::ZERO, target: -Vec3::Z, up: Vec3::Y, fov: 0.6, near: 0.1, far: 50.0 };
    let camera = SpaceCamera {
        position: Vec3::new(0.0, 0.0, 14.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        fov: 0.6,
        near: 0.1,
        far: 100.0,
    };
    for order in [[near, far], [far, near]] {
        let scene = boxes(&order);
        let Some(mut stage) = Stage::new(&scene) else { return };
        let film = film(&scene, eye);
        stage.show(&film, &[]);
        let last = film.events().len();
        let solid = stage.picture(&camera, &SpaceStyle { culled: Shown::Solid, ..plain(last) });
        assert_eq!(count(&solid, flat(Role::Visible)), 0, "the test needs one box before the other");
        let faint = stage.picture(&camera, &SpaceStyle { ghost: 0.0, ..plain(last) });
        let alone = stage.picture(&camera, &SpaceStyle { culled: Shown::Not, ..plain(last) });
        assert_eq!(faint, alone, "a ghost without opacity leaves no trace");
        let ghost = stage.picture(&camera, &plain(last));
        let [r, g, b] = pixel(&ghost, 160, 120);
        assert!(b > g && g > r, "blue shines through: {:?}", [r, g, b]);
        assert_ne!(ghost, alone, "and the ghost is seen");
        // What was culled wrongly is solid and in its own color, from the step of its decision on.
        stage.show(
            &film,
            &scene.live().iter().copied().filter(|&p| scene.prim_bounds(p).max.z > 0.0).collect::<Vec<_>>(),
        );
        assert!(count(&stage.picture(&camera, &plain(last)), flat(Role::Wrong)) > 500);
        assert_eq!(count(&stage.picture(&camera, &plain(0)), flat(Role::Wrong)), 0);
    }
}

#[test]
fn two_viewports_in_one_frame_and_the_same_picture_twice() {
    let scene = town();
    let Some(mut stage) = Stage::new(&scene) else { return };
    let film = film(&scene, eye());
    stage.show(&film, &[]);
    stage.mark(&marks(&*film, 40));
    let (a, b) = (ViewportId(1), ViewportId(2));
    let (above, through) = (
        SpaceStyle::observer(40, palette()),
        SpaceStyle { undecided: Shown::Solid, ..SpaceStyle::eye(40, palette()) },
    );
    let camera = SpaceCamera::from(eye());
    let draw = |layer: &mut SpaceLayer, gpu: &Headless| {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let drawn = [
            layer.render(&gpu.device, &gpu.queue, &mut encoder, a, SIZE, &observer(), &above),
            layer.render(&gpu.device, &gpu.queue, &mut encoder, b, [200, 150], &camera, &through),
        ];
        gpu.queue.submit([encoder.finish()]);
        drawn
    };
    let read = |layer: &SpaceLayer, gpu: &Headless, id| {
        layer.read_rgba(&gpu.device, &gpu.queue, id).expect("pixels")
    };
    assert_eq!(draw(&mut stage.layer, &stage.gpu), [true, true]);
    let first = [a, b].map(|id| read(&stage.layer, &stage.gpu, id).expect("drawn"));
    assert_eq!((first[1].0, first[1].1), (200, 150));
    assert_eq!(first[0].2, stage.picture(&observer(), &above), "a window and a file show the same");
    let alone = stage
        .layer
        .snapshot(&stage.gpu.device, &stage.gpu.queue, [200, 150], 1, &camera, &through)
        .expect("a picture");
    assert_eq!(first[1], alone);
    // Nothing changed, so nothing is drawn; then the marks change.
    assert_eq!(draw(&mut stage.layer, &stage.gpu), [false, false]);
    stage.mark(&marks(&*film, 40));
    assert_eq!(draw(&mut stage.layer, &stage.gpu), [true, true]);
    assert_eq!(first, [a, b].map(|id| read(&stage.layer, &stage.gpu, id).expect("drawn")));
    stage.layer.release(b);
    assert_eq!(read(&stage.layer, &stage.gpu, b), None);
}

#[test]
fn a_viewport_is_copied_into_the_rect_of_a_pass() {
    let scene = town();
    for format in [wgpu::TextureFormat::Rgba8Unorm, wgpu::TextureFormat::Rgba8UnormSrgb] {
        let Some(gpu) = device() else { return };
        let mut layer = SpaceLayer::new(&gpu.device, format);
        layer.set_scene(&gpu.device, &scene, scene.live().to_vec());
        let extent = wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 };
        let window = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: extent,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let id = ViewportId(0);
        layer.render(&gpu.device, &gpu.queue, &mut encoder, id, SIZE, &observer(), &plain(0));
        let view = window.create_view(&Default::default());
        let attachment = wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: wgpu::StoreOp::Store,
            },
        };
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(attachment)],
            ..Default::default()
        });
        layer.blit(id, &mut pass.forget_lifetime());
        // 320 pixels of four bytes are a whole number of the rows that copies need.
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(SIZE[0] * SIZE[1] * 4),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(SIZE[0] * 4), rows_per_image: None };
        encoder.copy_texture_to_buffer(
            window.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
            extent,
        );
        gpu.queue.submit([encoder.finish()]);
        buffer.slice(..).map_async(wgpu::MapMode::Read, |r| r.expect("mapped"));
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("done");
        let shown = buffer.slice(..).get_mapped_range().expect("mapped").to_vec();
        let drawn = layer.read_rgba(&gpu.device, &gpu.queue, id).expect("pixels").expect("drawn").2;
        // The device's own sRGB encoding may round one step another way.
        let worst = shown.iter().zip(&drawn).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(worst <= Some(1), "{format:?}: {worst:?}");
    }
}

#[test]
fn node_boxes_and_marks_are_drawn_by_step() {
    let scene = town();
    let Some(mut stage) = Stage::new(&scene) else { return };
    let film = film(&scene, eye());
    stage.show(&film, &[]);
    let last = film.events().len();
    let lines = |step, nodes| SpaceStyle { nodes, surface: Surface::Hidden, ..plain(step) };
    let ink = |style: SpaceStyle| inked(&stage.picture(&observer(), &style));
    assert_eq!(ink(lines(0, NodeBoxes::Frontier)), 0, "no node is entered yet");
    let root = ink(lines(last, NodeBoxes::Levels(0, 0)));
    let all = ink(lines(last, NodeBoxes::Levels(0, 99)));
    let frontier = ink(lines(last, NodeBoxes::Frontier));
    assert!(0 < root && root < frontier && frontier < all, "{root} {frontier} {all}");
    assert_eq!(ink(lines(last, NodeBoxes::Levels(50, 99))), 0);
    // Layers of marks, and highlights.
    stage.mark(&marks(&*film, 0));
    let marked = stage.picture(&observer(), &lines(0, NodeBoxes::None));
    assert!(count(&marked, Theme::Light.style(Role::Eye).stroke) > 100);
    let without = SpaceStyle { without: vec![Layer::Frustum, Layer::Eye], ..lines(0, NodeBoxes::None) };
    assert_eq!(inked(&stage.picture(&observer(), &without)), 0);
    for subject in [Subject::Prim(PrimId(3)), Subject::Node(NodeId(0)), Subject::Object(ObjectId(0))] {
        let lit = SpaceStyle { highlights: vec![(subject, Role::Current)], ..without.clone() };
        assert!(inked(&stage.picture(&observer(), &lit)) > 20, "{subject:?}");
    }
}

#[test]
fn wires_follow_faces_and_sections_cut() {
    let scene = boxes(&[(Vec3::ZERO, Vec3::splat(1.0), [0.2, 0.4, 0.8])]);
    let Some(stage) = Stage::new(&scene) else { return };
    // Straight on, the front face is a square: its diagonal is inside the face and has no wire.
    let camera = SpaceCamera {
        position: Vec3::new(0.0, 0.0, 5.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        fov: 0.8,
        near: 0.1,
        far: 50.0,
    };
    let wires =
        stage.picture(&camera, &SpaceStyle { surface: Surface::Wireframe, only_fronts: true, ..plain(0) });
    assert!((100..2000).contains(&inked(&wires)), "{}", inked(&wires));
    assert_eq!(pixel(&wires, 160, 120), palette().paper);
    // Cutting the near half away opens the box: what is seen is its back, farther and so smaller.
    let solid = inked(&stage.picture(&camera, &plain(0)));
    let cut = inked(&stage.picture(&camera, &SpaceStyle { section: Some((-Vec3::Z, 0.0)), ..plain(0) }));
    let gone = inked(&stage.picture(&camera, &SpaceStyle { section: Some((-Vec3::Z, -3.0)), ..plain(0) }));
    assert!(gone == 0 && 0 < cut && cut < solid, "{gone} {cut} {solid}");
    // Without backs nothing is left of the opened half but the rim of its sides.
    let open = SpaceStyle { section: Some((-Vec3::Z, 0.0)), only_fronts: true, ..plain(0) };
    assert_eq!(inked(&stage.picture(&camera, &open)), 0);
}

#[test]
fn tiles_join_without_a_seam_and_sizes_are_checked() {
    let scene = town();
    let Some(mut stage) = Stage::new(&scene) else { return };
    let film = film(&scene, eye());
    stage.show(&film, &[]);
    stage.mark(&marks(&*film, 60));
    let Headless { device, queue, .. } = &stage.gpu;
    let style =
        SpaceStyle { surface: Surface::Both, transparent: true, ..SpaceStyle::observer(60, palette()) };
    // At 8 by 8 samples 300 pixels are two tiles wide; at 3 by 3 they are one.
    let size = [300, 150];
    let picture = |samples| {
        stage.layer.snapshot(device, queue, size, samples, &observer(), &style).expect("a picture").2
    };
    let (many, few) = (picture(8), picture(3));
    assert_eq!(many[..4], [0; 4], "the corner is transparent");
    let column = |x: usize| {
        (0..size[1] as usize)
            .filter(|y| (0..4).any(|c| many[(y * 300 + x) * 4 + c].abs_diff(few[(y * 300 + x) * 4 + c]) > 40))
            .count()
    };
    let worst = [254, 255, 256, 257].map(column);
    assert!(worst.iter().all(|&n| n < 15), "{worst:?}");
    for size in [[0, 10], [10, 30_000]] {
        assert!(matches!(
            stage.layer.snapshot(device, queue, size, 1, &observer(), &style),
            Err(GpuError::Size { .. })
        ));
    }
}

/// An item buffer of the device shows what ours shows but for pixels on edges, whose centers both snap.
#[test]
fn the_device_sees_what_we_see() {
    let Some(on) = device() else { return };
    let box_at = |k: usize| {
        let at = Vec3::new((k % 5) as f32 * 2.1 - 4.0, (k / 5 % 4) as f32 * 1.7 - 3.0, (k / 20) as f32 * 3.3);
        (at, Vec3::new(0.7, 0.9, 0.5) + 0.05 * (k % 7) as f32, [0.5; 3])
    };
    let scene = boxes(&(0..80).map(box_at).collect::<Vec<_>>());
    let mut compared = Disagreement::default();
    for view in random_views(&scene, 4, 3).into_iter().map(|v| View { width: 300, height: 200, ..v }) {
        let theirs = items(&on, &scene, &view, scene.live()).expect("an item buffer");
        let ours = render(&*scene, &view, scene.live()).item;
        assert!(ours.iter().filter(|i| **i != u32::MAX).count() > 1000, "the view shows something");
        compared.join(disagreement(&scene, &view, &ours, &theirs));
        // Without a triangle that shows the device sees others.
        let shown = ours.iter().copied().find(|i| *i != u32::MAX);
        let without: Vec<PrimId> = scene.live().iter().copied().filter(|p| Some(p.0) != shown).collect();
        assert_ne!(items(&on, &scene, &view, &without).expect("an item buffer"), theirs);
    }
    assert!(compared.pixels == 240_000 && compared.total() < 240 && compared.others == 0, "{compared:?}");
    assert!(
        items(&on, &scene, &random_views(&scene, 1, 1)[0], &[]).expect("none").iter().all(|i| *i == u32::MAX)
    );
}
