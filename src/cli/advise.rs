//! `cullscope advise`: the simplest configuration that is right enough at the least time.

use std::path::PathBuf;
use std::sync::Arc;

use serde_json::{Value as Json, json};

use super::methods::json_text;
use super::progress::Bar;
use super::view::ViewArgs;
use super::{CliError, World, output, scene};
use crate::drawing::words::grouped;
use crate::figure::{charts, tradeoff_charts};
use crate::geometry::each;
use crate::measure::ExperimentError;
use crate::measure::advise::{Advice, Wish, advise};
use crate::render::{self, Format, Theme};
use crate::scene::{LoadOptions, Scene};

#[derive(clap::Args)]
#[command(after_help = "Examples:\n  cullscope advise generate:terrain --path flight\n  cullscope advise \
                  generate:building --path 'figure 8' --max-wrong-pixels 0.1 --out advice.json --chart \
                  advice.svg\n\nHalf of the views are kept back: what is advised was not chosen by them, \
                  and is checked on them.")]
pub(super) struct Args {
    /// A path to .obj, .gltf, .glb, .pdb, .xyz or a flatland .json, or generate:NAME[?key=value&…]
    #[arg(value_name = "SCENE")]
    scene: String,
    #[command(flatten)]
    view: ViewArgs,
    /// Wrong pixels at most, a share of all images' pixels; 0: it must be exact
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0, value_parser = percent)]
    max_wrong_pixels: f64,
    /// Write JSON to a file: advice, check, and all that was tried
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write a chart of all that was tried, and of what parameters gain: .svg, .pdf or .png
    #[arg(long, value_name = "FILE")]
    chart: Option<PathBuf>,
}

fn percent(text: &str) -> Result<f64, String> {
    let fits = |v: &f64| (0.0..=100.0).contains(v);
    text.parse().ok().filter(fits).ok_or_else(|| "expected a share from 0 to 100 such as 0.1".into())
}

pub(super) fn run(args: &Args) -> Result<(), CliError> {
    // Words first: nobody wants to hear of a slip after a minute.
    let format = args.chart.as_ref().map(|path| {
        let ending = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        ending.parse::<Format>().map_err(|e| CliError::words("--chart", e.to_string()))
    });
    let format = format.transpose()?;
    each!(scene::open(&args.scene, &LoadOptions::default())?, scene => of(args, &scene, format))
}

fn of<S: World>(args: &Args, scene: &Arc<Scene<S>>, format: Option<Format>) -> Result<(), CliError> {
    let path = args.view.views(scene)?;
    let wish = Wish { most_wrong_percent: args.max_wrong_pixels, seed: args.view.seed };
    let bar = Bar::new();
    let advice = advise(scene, &path.views, wish, &bar).map_err(|e| match e {
        ExperimentError::Cancelled => CliError::Interrupted,
        e => CliError::work("advise", e.to_string()),
    })?;
    drop(bar);
    if let Some(place) = &args.out {
        let text = json_text(&written(&advice, scene.source(), &path.name));
        output::write_file(place, |to| to.write_all(text.as_bytes()).map(|()| true))?;
    }
    if let (Some(place), Some(format)) = (&args.chart, format) {
        let bytes = drawn(args, &advice, format)?;
        output::write_file(place, |to| to.write_all(&bytes).map(|()| true))?;
    }
    output::print(said(&advice).as_bytes())
}

/// The advice as it is read.
fn said(advice: &Advice) -> String {
    let chosen = advice.configuration();
    let set = chosen.settings.0.iter().map(|(name, value)| format!(" --set {name}={value}"));
    let mut text = format!("Use --method {}{}\n", chosen.method, set.collect::<String>());
    let (unseen, frustum) = (&advice.unseen, &advice.frustum);
    let views = if unseen.frames == 1 {
        "the view".to_owned()
    } else {
        format!("{} views that it was not chosen by", unseen.frames)
    };
    text += &format!(
        "On {views}: {} ms a frame, {} % of the pixels wrong ({} % at worst).\n",
        grouped(unseen.time_ms, 3),
        grouped(unseen.wrong_percent, 4),
        grouped(unseen.worst_percent, 4),
    );
    text += &if advice.is_plain() {
        "Occlusion culling does not pay here: nothing that was tried is faster and right enough.\n".to_owned()
    } else {
        let gain = frustum.time_ms / unseen.time_ms.max(1e-9);
        format!(
            "Frustum culling alone takes {} ms there, {gain:.2} times as long.\n",
            grouped(frustum.time_ms, 3)
        )
    };
    for &k in &advice.refused {
        text += &format!(
            "Wrong or slower than frustum culling there: {}\n",
            advice.trials[k].configuration.label()
        );
    }
    if advice.left_out > 0 {
        let n = advice.left_out;
        text +=
            &format!("Not tried: {n} configurations, which promise nothing, while nothing may be wrong.\n");
    }
    let [flown, grid] = advice.cost.map(|n| grouped(n as f64, 0));
    let wish = advice.wish.most_wrong_percent;
    text += &format!(
        "\n{} configurations, {flown} frames; the full grid would have been {grid}. Wrong pixels at most: \
         {wish} %. Times are the mean frame from the view to the image, on one thread; those of few frames \
         are rough.\n\n",
        advice.trials.len(),
    );
    text + &advice.table().text()
}

fn written(advice: &Advice, scene: &str, path: &str) -> Json {
    let flown = |f: &crate::measure::advise::Flown| {
        json!({
            "frames": f.frames, "frame_ms": f.time_ms, "wrong_pixels_percent": f.wrong_percent,
            "worst_wrong_pixels_percent": f.worst_percent,
        })
    };
    let chosen = advice.configuration();
    json!({
        "cullscope": env!("CARGO_PKG_VERSION"),
        "scene": scene,
        "path": path,
        "max_wrong_pixels_percent": advice.wish.most_wrong_percent,
        "seed": advice.wish.seed,
        "method": chosen.method,
        "set": chosen.settings.0,
        "unseen": flown(&advice.unseen),
        "frustum_unseen": flown(&advice.frustum),
        "refused": advice.refused.iter().map(|k| advice.trials[*k].configuration.label()).collect::<Vec<_>>(),
        "frames_flown": advice.cost[0],
        "frames_of_the_grid": advice.cost[1],
        "tried": advice.table().json(),
    })
}

fn drawn(args: &Args, advice: &Advice, format: Format) -> Result<Vec<u8>, CliError> {
    let (tradeoff, gains) = advice.charts();
    let (above, legend) = tradeoff_charts(&[tradeoff]);
    let (below, _) = charts(gains.as_slice());
    let mut content = above;
    let down = content.size_pt.y + 14.0;
    if gains.is_some() {
        content.size_pt.y = down + below.size_pt.y;
        content.items.extend(below.items.into_iter().map(|mut item| {
            item.mark = item.mark.mapped(|p| p + glam::vec2(0.0, down));
            item
        }));
    }
    let caption = format!(
        "{}: {} is advised, of {} configurations that were tried. Times are mean frames from the view to \
         the image; of those that fell out early, of few frames. Error: wrong pixels of all images \
         together; what makes none stands at the left.",
        args.scene,
        advice.configuration().label(),
        advice.trials.len(),
    );
    let title = "Advice".to_owned();
    let page = crate::figure::Page {
        paper: crate::figure::Paper::TwoColumns,
        title,
        legend,
        caption,
        ..crate::figure::Page::default()
    };
    let recipe = format!("cullscope advise {} --max-wrong-pixels {}", args.scene, args.max_wrong_pixels);
    render::export(&page.compose(&content), format, Theme::Print, &recipe)
        .map_err(|e| CliError::work("--chart", e.to_string()))
}
