//! `cullscope bench occlusion`: occluders rasterized and boxes asked for, on an input that other programs
//! read too.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec3;

use super::error::reason;
use super::{CliError, methods, output, scene};
use crate::culling::Methods;
use crate::culling::hierarchical_z_parts::{self, Obscurer};
use crate::culling::occlusion_maps_parts::{self, Mapper};
use crate::geometry::{Aabb, Eye, Footprint, Solid, View, project_box};
use crate::measure::{timed, timing};
use crate::method::Settings;
use crate::raster::{Answer, Boxes, Clusters, Drawable, Isa, Options, Target, Tiles};
use crate::scene::{AnyScene, LoadOptions, Quiet, Scene, Surfaces};

#[derive(clap::Subcommand)]
pub(super) enum Command {
    /// Time what a method needs to draw occluders and to answer for boxes
    Occlusion(Args),
}

#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  cullscope bench occlusion --mesh city.obj --boxes boxes.txt --cams cams.txt \
                  --size 1024x1024 --repeat 9\n\nBoxes: a line each, minx miny minz maxx maxy maxz. Cameras: \
                  a line each, 20 numbers: the row-major M of clip = M (x, y, z, 1)\n(w = view depth), the \
                  near plane's w, the eye. Front faces are counter-clockwise; back faces are culled."
)]
pub(super) struct Args {
    /// Occluders, an OBJ file
    #[arg(long, value_name = "FILE.obj")]
    mesh: String,
    /// Boxes to ask for
    #[arg(long, value_name = "FILE.txt")]
    boxes: PathBuf,
    /// Cameras
    #[arg(long, value_name = "FILE.txt")]
    cams: PathBuf,
    /// Image size in pixels
    #[arg(long, value_name = "WxH", value_parser = super::paper::size)]
    size: [u32; 2],
    /// The method, or `tiles`: the depth structure by itself, clusters of occluders drawn front to back
    #[arg(long, value_name = "METHOD", default_value = hierarchical_z_parts::METHOD,
        value_parser = [hierarchical_z_parts::METHOD, occlusion_maps_parts::METHOD, TILES])]
    method: String,
    /// A parameter of the method; may be given several times [default: backface-culling=true, and
    /// coherence=false or adapt=false]
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Times every camera is drawn; the median counts
    #[arg(
        long,
        value_name = "N",
        default_value_t = 5,
        value_parser = clap::value_parser!(u32).range(1..=1000)
    )]
    repeat: u32,
    /// Write a byte a box and camera: 0 visible, 1 occluded, 3 outside
    #[arg(long, value_name = "FILE")]
    dump_vis: Option<PathBuf>,
}

/// Stands for the depth structure where a method is named.
const TILES: &str = "tiles";

/// How many times finer the image is on whose samples `false` is counted.
const FINER: u32 = 2;

pub(super) fn run(command: &Command) -> Result<(), CliError> {
    let Command::Occlusion(args) = command;
    let settings = settings(args)?;
    // Words that are off are told before files are read.
    if args.method == TILES && !args.set.is_empty() {
        return Err(CliError::words("--set", "tiles have no parameters: leave it out"));
    }
    <Solid as Methods>::method(&args.method).map(|m| m.knobs(&settings)).transpose()?;
    let AnyScene::Solid(mesh) = scene::open(&args.mesh, &LoadOptions::default())? else {
        return Err(CliError::work(&args.mesh, "a flatland scene; occluders must be triangles in space"));
    };
    let origin = mesh.origin();
    let place = |p: &[f64]| (glam::dvec3(p[0], p[1], p[2]) - origin).as_vec3();
    let boxes = lines(&args.boxes, 6)?
        .into_iter()
        .map(|b| Aabb { min: place(&b[..3]), max: place(&b[3..]) })
        .collect::<Vec<Aabb<Vec3>>>();
    let cams = lines(&args.cams, 20)?;
    let all = boxes.iter().fold(mesh.bounds(), |sum, b| sum.union(*b));
    let views = cams.iter().enumerate().map(|(i, c)| {
        view(c, place(&c[17..]), &all, args.size)
            .map_err(|why| CliError::work(format!("{} line {}", args.cams.display(), i + 1), why))
    });
    let views = views.collect::<Result<Vec<_>, _>>()?;
    let mut occluders = Occluders::new(&args.method, &mesh, &settings, &boxes)?;
    let measured = measure(&mut occluders, &mesh, &views, &boxes, args.repeat as usize);
    if let Some(path) = &args.dump_vis {
        output::write_file(path, |to| to.write_all(&measured.answers).map(|()| true))?;
    }
    output::print((measured.line(mesh.live().len()) + "\n").as_bytes())
}

/// Parameters of the method: those given, and otherwise such that no frame goes by the last, since cameras
/// may stand anywhere.
fn settings(args: &Args) -> Result<Settings, CliError> {
    let first: &[(&str, &str)] = match args.method.as_str() {
        hierarchical_z_parts::METHOD => &[("coherence", "false"), ("backface-culling", "true")],
        occlusion_maps_parts::METHOD => &[("adapt", "false"), ("backface-culling", "true")],
        _ => &[],
    };
    let mut settings = Settings(first.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect());
    settings.0.extend(methods::settings(&args.set)?.0);
    Ok(settings)
}

/// Lines of `count` numbers each; empty ones and those that begin with `#` are left out.
fn lines(path: &Path, count: usize) -> Result<Vec<Vec<f64>>, CliError> {
    let name = path.display().to_string();
    let text = fs::read_to_string(path).map_err(|e| CliError::work(name.as_str(), reason(&e)))?;
    let mut all = Vec::new();
    for (i, line) in text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty() && !l.starts_with('#')) {
        let numbers: Option<Vec<f64>> =
            line.split_whitespace().map(|w| w.parse().ok().filter(|v: &f64| v.is_finite())).collect();
        match numbers.filter(|n| n.len() == count) {
            Some(numbers) => all.push(numbers),
            None => {
                return Err(CliError::work(
                    format!("{name} line {}", i + 1),
                    format!("expected {count} finite numbers"),
                ));
            }
        }
    }
    if all.is_empty() { Err(CliError::work(name, "holds no line of numbers")) } else { Ok(all) }
}

/// The view that a matrix describes, rows of a perspective with square pixels, as far as there is something.
fn view(c: &[f64], eye: Vec3, all: &Aabb<Vec3>, [width, height]: [u32; 2]) -> Result<View<Solid>, String> {
    let row = |i: usize| glam::dvec3(c[4 * i], c[4 * i + 1], c[4 * i + 2]);
    let (x, y, w) = (row(0), row(1), row(3));
    if (w.length() - 1.0).abs() > 1e-3
        || x.dot(w).abs() > 1e-3 * x.length()
        || y.dot(w).abs() > 1e-3 * y.length()
    {
        return Err("the matrix is not that of a perspective whose w is the view depth".into());
    }
    let aspect = f64::from(width) / f64::from(height);
    if (y.length() / x.length() / aspect - 1.0).abs() > 0.01 {
        return Err(format!(
            "pixels are not square at {width}x{height}: the matrix is for an aspect of {:.4}",
            y.length() / x.length()
        ));
    }
    let far = all.corners().map(|p| p.distance(eye)).fold(0.0, f32::max) * 1.01 + 1.0;
    let fov = (2.0 * (1.0 / y.length()).atan()) as f32;
    let eye = Eye {
        position: eye,
        target: eye + w.as_vec3(),
        up: y.normalize().as_vec3(),
        fov,
        near: c[16] as f32,
        far,
    };
    eye.fault().map_or(Ok(View { eye, width, height }), |why| Err(why.to_owned()))
}

/// What draws occluders and answers.
enum Occluders {
    /// The method's octree, and the boxes to ask for.
    Cubes(Box<Obscurer<Solid>>, Boxes),
    /// The method with its own choice of occluders, and the boxes to ask for.
    Maps(Box<Mapper<Solid>>, Vec<Aabb<Vec3>>),
    /// The depth structure by itself.
    Tiles(Box<InTiles>),
}

/// Clusters of occluders, the tiles that they are drawn into, and the boxes to ask for.
struct InTiles {
    clusters: Clusters,
    tiles: Tiles,
    boxes: Boxes,
    answers: Vec<Answer>,
}

/// Back faces are culled.
const ONE_SIDED: Surfaces = Surfaces { one_sided: true, solid: false };

impl Occluders {
    fn new(
        method: &str,
        mesh: &Arc<Scene<Solid>>,
        settings: &Settings,
        boxes: &[Aabb<Vec3>],
    ) -> Result<Self, CliError> {
        Ok(match method {
            TILES => Self::in_tiles(mesh, boxes),
            occlusion_maps_parts::METHOD => {
                let mapper = Mapper::new(mesh, settings, &Quiet)?;
                Self::Maps(Box::new(mapper.ok_or(CliError::Interrupted)?), boxes.to_vec())
            }
            _ => {
                let cubes = Obscurer::new(mesh, settings, &Quiet)?;
                let boxes = Boxes::new(boxes.iter().copied());
                Self::Cubes(Box::new(cubes.ok_or(CliError::Interrupted)?), boxes)
            }
        })
    }
    fn in_tiles(mesh: &Scene<Solid>, boxes: &[Aabb<Vec3>]) -> Self {
        Self::Tiles(Box::new(InTiles {
            clusters: Clusters::new(mesh, ONE_SIDED, [mesh.live()]),
            tiles: Tiles::default(),
            boxes: Boxes::new(boxes.iter().copied()),
            answers: Vec::new(),
        }))
    }
    fn render(&mut self, view: &View<Solid>) {
        match self {
            Self::Cubes(cubes, _) => _ = cubes.render(view),
            Self::Maps(maps, _) => maps.make_maps(view),
            Self::Tiles(all) => {
                all.tiles.clear(view, true);
                all.tiles.draw(&all.clusters, ONE_SIDED.one_sided, Isa::best());
            }
        }
    }
    /// Asks for all boxes; `None`: out of view.
    fn hides(&mut self, view: &View<Solid>) -> Vec<Option<bool>> {
        match self {
            Self::Maps(maps, boxes) => maps.hides_all(view, boxes),
            Self::Cubes(cubes, boxes) => cubes.hides_all(boxes),
            Self::Tiles(all) => {
                all.tiles.hides_all(&all.boxes, true, Isa::best(), &mut all.answers);
                let hidden =
                    |&answer: &Answer| (answer != Answer::Outside).then_some(answer == Answer::Hidden);
                all.answers.iter().map(hidden).collect()
            }
        }
    }
}

/// What came out.
struct Measured {
    render_ms: f64,
    query_ns: f64,
    answers: Vec<u8>,
    false_count: usize,
}

fn measure(
    occluders: &mut Occluders,
    mesh: &Arc<Scene<Solid>>,
    views: &[View<Solid>],
    boxes: &[Aabb<Vec3>],
    repeat: usize,
) -> Measured {
    let mut measured = Measured { render_ms: 0.0, query_ns: 0.0, answers: Vec::new(), false_count: 0 };
    let n = views.len() as f64;
    for view in views {
        let (mut render, mut query) = (Vec::new(), Vec::new());
        let mut answers = Vec::new();
        for _ in 0..repeat {
            render.push(timed(|| occluders.render(view)).1);
            let (all, ms) = timed(|| occluders.hides(view));
            query.push(ms);
            answers = all;
        }
        measured.render_ms += timing::median(render) / n;
        measured.query_ns += timing::median(query) * 1e6 / boxes.len() as f64 / n;
        measured.false_count += wrongly_hidden(mesh, view, boxes, &answers);
        measured.answers.extend(answers.iter().map(|a| a.map_or(3, u8::from)));
    }
    measured
}

/// How many of the boxes called hidden show at a sample of a finer image: where a ray through a pixel's
/// center enters the box before it meets what is drawn there.
fn wrongly_hidden(
    mesh: &Scene<Solid>,
    view: &View<Solid>,
    boxes: &[Aabb<Vec3>],
    answers: &[Option<bool>],
) -> usize {
    let fine = View { width: view.width * FINER, height: view.height * FINER, ..*view };
    let mut image = Target::default();
    Solid::redraw(
        &mut image,
        mesh,
        &fine,
        mesh.live(),
        &Options { surfaces: ONE_SIDED, threads: 0, ..Options::default() },
    );
    let hidden = boxes.iter().zip(answers).filter(|(_, a)| **a == Some(true)).map(|(b, _)| b);
    hidden.filter(|b| shows(&fine, b, &image)).count()
}

fn shows(view: &View<Solid>, bounds: &Aabb<Vec3>, image: &Target) -> bool {
    let projection = view.projection();
    let Footprint::Seen(seen) =
        project_box(&projection, bounds, view.eye.near, view.eye.far, view.width, view.height)
    else {
        return true;
    };
    let [x, y, forward] = [0, 1, 2].map(|i| projection.rows[i].as_dvec3());
    let (low, high) = ((bounds.min - projection.eye).as_dvec3(), (bounds.max - projection.eye).as_dvec3());
    let at = |column: u32, row: u32| {
        let across = (f64::from(column) + 0.5) / f64::from(view.width) * 2.0 - 1.0;
        let down = 1.0 - (f64::from(row) + 0.5) / f64::from(view.height) * 2.0;
        // At view depth 1; the rows are orthogonal, dividing by the squared length undoes their scale.
        let ray = forward + x * (across / x.length_squared()) + y * (down / y.length_squared());
        let (a, b) = (low / ray, high / ray);
        let (enters, leaves) = (a.min(b).max_element(), a.max(b).min_element());
        enters <= leaves && 1.0 / enters > f64::from(image.depth[(row * view.width + column) as usize])
    };
    (seen.pixels.y0..seen.pixels.y1).any(|row| (seen.pixels.x0..seen.pixels.x1).any(|column| at(column, row)))
}

impl Measured {
    fn line(&self, triangles: usize) -> String {
        let count = |v: u8| self.answers.iter().filter(|a| **a == v).count();
        let in_view = (count(0) + count(1)).max(1);
        let hash = self
            .answers
            .iter()
            .fold(0xcbf2_9ce4_8422_2325u64, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3));
        format!(
            "RESULT render_ms={:.4} ns_per_tri_in={:.3} ns_per_query={:.2} pct_occluded_of_infrustum={:.3} \
             false={} hash={hash:016x}",
            self.render_ms,
            self.render_ms * 1e6 / triangles.max(1) as f64,
            self.query_ns,
            100.0 * count(1) as f64 / in_view as f64,
            self.false_count
        )
    }
}
