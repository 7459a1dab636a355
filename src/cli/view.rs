//! Which views: a file, a path of the scene, random ones, or a single one by options.

use glam::DVec3;

use super::{CliError, World, output, suggest};
use crate::app::view_text;
use crate::geometry::{Eye, MAX_SIDE_PX, Vector, View, ViewPath};
use crate::scene::{Scene, framing_view, motion_path, random_views, read_views};

/// Options that choose views.
#[derive(clap::Args)]
#[command(next_help_heading = "Views (one of); where objects move, view i of a path sees frame i")]
pub(super) struct ViewArgs {
    /// A view or path in a JSON file
    #[arg(long, value_name = "FILE", conflicts_with_all = ["path", "random_views", "eye"])]
    view: Option<String>,
    /// A path that the scene brought, such as `walk`; where things move and no path is as long, also `motion`
    #[arg(long, value_name = "NAME", conflicts_with_all = ["random_views", "eye"])]
    path: Option<String>,
    /// So many random views, the same for the same --seed
    #[arg(
        long,
        value_name = "N",
        conflicts_with = "eye",
        value_parser = clap::value_parser!(u32).range(1..=100_000)
    )]
    random_views: Option<u32>,
    /// Seed of random views
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// A single view: where the eye stands
    #[arg(
        long,
        value_name = "X,Y[,Z]",
        allow_hyphen_values = true,
        requires = "target",
        value_parser = numbers
    )]
    eye: Option<Numbers>,
    /// What it looks at
    #[arg(long, value_name = "X,Y[,Z]", allow_hyphen_values = true, requires = "eye", value_parser = numbers)]
    target: Option<Numbers>,
    /// Roughly up (space only) [default: 0,1,0]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "eye", value_parser = numbers)]
    up: Option<Numbers>,
    /// Whole angle of view: vertical in space, across the image in flatland [default: 60; in flatland 90]
    #[arg(long, value_name = "DEGREES", requires = "eye")]
    fov: Option<f64>,
    /// Depth of the near plane [default: 0.1]
    #[arg(long, requires = "eye")]
    near: Option<f64>,
    /// Depth of the far plane [default: 1000]
    #[arg(long, requires = "eye")]
    far: Option<f64>,
    /// Image size in pixels, for any views [default: that of the views, else 1024x1024]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<(u32, u32)>,
}

/// Numbers with commas between them.
#[derive(Clone, Debug)]
struct Numbers(Vec<f64>);

fn numbers(text: &str) -> Result<Numbers, String> {
    let one = |part: &str| part.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    text.split(',')
        .map(one)
        .collect::<Option<_>>()
        .map(Numbers)
        .ok_or_else(|| "expected numbers such as 1.5,0,-2".into())
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let (width, height) = text.split_once(['x', 'X', '×']).unwrap_or((text, "1"));
    let side = |t: &str| t.trim().parse().ok().filter(|v| (1..=MAX_SIDE_PX).contains(v));
    let both = side(width).zip(side(height));
    both.ok_or_else(|| format!("expected a width and a height from 1 to {MAX_SIDE_PX} such as 1024x1024"))
}

/// What views were asked for.
pub(super) enum Asked<S: World> {
    /// None.
    Nothing,
    /// Those of a file, or random ones.
    Path(ViewPath<S>),
    /// A path of the scene, by name.
    Named(String),
    /// A single one.
    Single(View<S>),
}

impl ViewArgs {
    /// What was asked for; the image size apart.
    pub fn asked<S: World>(&self, scene: &Scene<S>) -> Result<Asked<S>, CliError> {
        Ok(if let Some(name) = &self.path {
            self.views(scene)?;
            Asked::Named(name.clone())
        } else if self.eye.is_some() {
            Asked::Single(self.views(scene)?.views[0])
        } else if self.is_asked() {
            Asked::Path(self.views(scene)?)
        } else {
            Asked::Nothing
        })
    }

    /// The image size that was asked for; of flatland it has height 1.
    pub fn image(&self) -> Option<(u32, u32)> {
        self.size
    }

    /// Whether any views were asked for.
    pub fn is_asked(&self) -> bool {
        self.view.is_some() || self.path.is_some() || self.random_views.is_some() || self.eye.is_some()
    }

    /// The views that were asked for, at least one.
    pub fn views<S: World>(&self, scene: &Scene<S>) -> Result<ViewPath<S>, CliError> {
        let flat = S::Vector::AXES == 2;
        if flat && self.size.is_some_and(|(_, height)| height != 1) {
            return Err(CliError::words("--size", "a flatland image has height 1")
                .with_help("give the width alone, such as --size 1024"));
        }
        let mut path = self.chosen(scene)?;
        if let Some((width, height)) = self.size {
            path.views.iter_mut().for_each(|v| (v.width, v.height) = (width, height));
        }
        if !self.is_asked() {
            output::say(&format!("view: {}", view_text(&path.views[0], scene.origin())));
        }
        Ok(path)
    }

    /// The same, but where no views are asked for all of the scene's first path. Without a size the images
    /// are no larger than `most_px` a side.
    pub fn path<S: World>(&self, scene: &Scene<S>, most_px: u32) -> Result<ViewPath<S>, CliError> {
        let own = scene.paths().first().filter(|_| !self.is_asked());
        let mut path = own.map_or_else(|| self.views(scene), |own| Ok(own.clone()))?;
        for view in &mut path.views {
            if let Some((width, height)) = self.size {
                (view.width, view.height) = (width, if S::Vector::AXES == 2 { 1 } else { height });
            } else if view.width.max(view.height) > most_px {
                let longer = view.width.max(view.height);
                let scaled = |side: u32| (u64::from(side) * u64::from(most_px) / u64::from(longer)) as u32;
                (view.width, view.height) = (scaled(view.width).max(1), scaled(view.height).max(1));
            }
        }
        Ok(path)
    }

    fn chosen<S: World>(&self, scene: &Scene<S>) -> Result<ViewPath<S>, CliError> {
        if let Some(file) = &self.view {
            return Ok(read_views(file, scene.origin())?);
        }
        if let Some(name) = &self.path {
            let paths = paths(scene, self.first(scene));
            let at = paths.iter().position(|p| p.name == *name).ok_or_else(|| no_path(&paths, name))?;
            return Ok(paths[at].clone());
        }
        if let Some(count) = self.random_views {
            let views = random_views(scene, count as usize, self.seed);
            return Ok(ViewPath { name: "random".into(), views });
        }
        let (width, height) = self.size.unwrap_or((1024, 1024));
        if let Some(eye) = &self.eye {
            return Ok(ViewPath::single(self.single(scene, eye, width, height)?));
        }
        Ok(ViewPath::single(self.first(scene)))
    }

    /// The scene's first view, or one that frames it.
    fn first<S: World>(&self, scene: &Scene<S>) -> View<S> {
        let (width, height) = self.size.unwrap_or((1024, 1024));
        let own = scene.paths().first().map(|path| path.views[0]);
        own.unwrap_or_else(|| framing_view(&scene.bounds(), width, height))
    }

    fn single<S: World>(
        &self,
        scene: &Scene<S>,
        eye: &Numbers,
        width: u32,
        height: u32,
    ) -> Result<View<S>, CliError> {
        let flat = S::Vector::AXES == 2;
        let vector = |option: &str, given: &Numbers, origin: DVec3| {
            if given.0.len() != S::Vector::AXES {
                let (want, got) = (S::Vector::AXES, given.0.len());
                return Err(CliError::words(
                    option,
                    format!("needs {want} numbers in {}, not {got}", S::NAME),
                ));
            }
            Ok(S::Vector::from_fn(|a| (given.0[a] - origin[a]) as f32))
        };
        if flat && self.up.is_some() {
            return Err(CliError::words("--up", "there is no up in flatland"));
        }
        let upright = Numbers((0..S::Vector::AXES).map(|a| f64::from(u8::from(a == 1))).collect());
        // `requires` makes sure that there is a target; the eye itself would be refused below.
        let target = self.target.as_ref().unwrap_or(eye);
        let eye = Eye {
            position: vector("--eye", eye, scene.origin())?,
            target: vector("--target", target, scene.origin())?,
            up: vector("--up", self.up.as_ref().unwrap_or(&upright), DVec3::ZERO)?,
            fov: self.fov.unwrap_or(if flat { 90.0 } else { 60.0 }).to_radians() as f32,
            near: self.near.unwrap_or(0.1) as f32,
            far: self.far.unwrap_or(1000.0) as f32,
        };
        match eye.fault() {
            Some(why) => Err(CliError::words("--eye", why)),
            None => Ok(View { eye, width, height: if flat { 1 } else { height } }),
        }
    }
}

/// The scene's paths, and one through its motions that looks from `view`.
pub(super) fn paths<S: World>(scene: &Scene<S>, view: View<S>) -> Vec<ViewPath<S>> {
    let own = scene.paths();
    own.iter().cloned().chain(motion_path(scene, own, view)).collect()
}

fn no_path<S: World>(paths: &[ViewPath<S>], name: &str) -> CliError {
    let names: Vec<&str> = paths.iter().map(|p| p.name.as_str()).collect();
    let error = CliError::words("--path", format!("the scene brought no path `{name}`"));
    if names.is_empty() {
        error.with_help("it brought none; give --view FILE")
    } else {
        error.with_help(suggest::help(name, &names, "paths"))
    }
}
