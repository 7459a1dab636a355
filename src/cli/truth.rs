//! `cullscope truth --gpu`: our item buffers beside those of a graphics device.

use super::view::ViewArgs;
use super::{CliError, scene};
use crate::geometry::Either;
use crate::scene::LoadOptions;

#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  cullscope truth --gpu generate:building --random-views 10\n\nAn experiment: \
                  WGPU_BACKEND chooses among drivers. Pixels differ where an edge passes a pixel's center \
                  closer than the grids that both snap it to, and where two triangles lie at one depth."
)]
pub(super) struct Args {
    /// A path to .obj, .gltf, .glb, .pdb or .xyz, or generate:NAME[?key=value&…]
    #[arg(value_name = "SCENE")]
    scene: String,
    /// Compare with the graphics adapter that there is
    #[arg(long, required = true)]
    gpu: bool,
    #[command(flatten)]
    view: ViewArgs,
}

pub(super) fn run(args: &Args) -> Result<(), CliError> {
    match scene::open(&args.scene, &LoadOptions::default())? {
        Either::Flat(_) => Err(CliError::words("--gpu", "a graphics device draws triangles, not segments")
            .with_help("give a scene in space")),
        Either::Solid(scene) => with_gpu::compare(args, &scene),
    }
}

#[cfg(not(feature = "gui"))]
mod with_gpu {
    use super::{Args, CliError};
    use crate::geometry::Solid;
    use crate::scene::Scene;

    pub(super) fn compare(args: &Args, scene: &Scene<Solid>) -> Result<(), CliError> {
        let _ = (args.gpu, &args.view, scene);
        Err(CliError::work("--gpu", "this build has no graphics")
            .with_help("build it with its default features"))
    }
}

#[cfg(feature = "gui")]
mod with_gpu {
    use super::{Args, CliError};
    use crate::cli::output;
    use crate::cli::progress::Bar;
    use crate::drawing::words::grouped;
    use crate::geometry::{PrimId, Solid};
    use crate::raster::render;
    use crate::render::gpu::{headless, items};
    use crate::scene::{Progress, Scene};
    use crate::truth::{Disagreement, disagreement};

    pub(super) fn compare(args: &Args, scene: &Scene<Solid>) -> Result<(), CliError> {
        let path = args.view.views(scene)?;
        let failed = |e: crate::render::gpu::GpuError| CliError::work("--gpu", e.to_string());
        let on = headless().map_err(failed)?;
        // What is see-through hides nothing, and a device has no order for it.
        let opaque = |prim: &PrimId| !scene.is_see_through(*prim);
        let prims: Vec<PrimId> = scene.live().iter().copied().filter(opaque).collect();
        let bar = Bar::new();
        let mut all = Disagreement::default();
        let mut text = String::from("view  pixels that differ      share  edges  ties  others\n");
        for (k, view) in path.views.iter().enumerate() {
            bar.report(k as f32 / path.views.len() as f32, "drawing");
            if bar.cancelled() {
                return Err(CliError::Interrupted);
            }
            let theirs = items(&on, scene, view, &prims).map_err(failed)?;
            let one = disagreement(scene, view, &render(scene, view, &prims).item, &theirs);
            text += &line(&format!("{k:>4}"), one);
            all.join(one);
        }
        drop(bar);
        text += &line(" all", all);
        text += &format!(
            "\n{} pixels of {} views on {}.\n",
            grouped(all.pixels as f64, 0),
            path.views.len(),
            on.adapter
        );
        text += "Edges: one passes the pixel's center within 1/64 pixel, closer than the grids that both \
                 snap it to.\nTies: both triangles lie at one depth there, as far as 32 bits go. Others: \
                 neither.\n";
        output::print(text.as_bytes())
    }

    fn line(name: &str, one: Disagreement) -> String {
        let share = 100.0 * one.total() as f64 / one.pixels.max(1) as f64;
        format!(
            "{name}  {:>18}  {share:>7.4} %  {:>5}  {:>4}  {:>6}\n",
            grouped(one.total() as f64, 0),
            one.edges,
            one.ties,
            one.others
        )
    }
}
