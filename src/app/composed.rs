//! What stands on the pages of a figure: which parts, how large, with which legend and caption.

use glam::Vec2;

use super::making::Making;
use super::plate::{Export, Form, Picture};
use super::state::State;
use super::twin::Twin;
use crate::drawing::words::{self, capitalized, count};
use crate::drawing::{Drawing, Role, Subject};
use crate::figure::page::{Entry, Swatch, legend};
use crate::figure::{self, GRID_GAP_PT, Look, Page, Panel, grid, grid_cell_pt, panels};
use crate::geometry::Either;
use crate::render::Format;

/// Parts that one file has at most.
const MOST_PARTS: usize = 5_000;
/// Room for a label, points.
const LABEL_PT: f32 = 17.0;
/// No part is narrower than this; labels of narrow ones are numbers.
const LEAST_PART_PT: f32 = 16.0;
const NARROW_PT: f32 = 60.0;
/// Pages as wide as this have pictures side by side.
const WIDE_PT: f32 = 340.0;

impl State {
    /// Begins a figure whose file carries a text.
    ///
    /// # Errors
    /// Why there is no such figure, in a line.
    pub fn begin(&mut self, export: &Export, format: Format, recipe: &str) -> Result<Making, String> {
        export.fits(format)?;
        if let Some(Either::Solid(stage)) = self.stage.as_ref().filter(|_| export.is_vector) {
            stage.refuse_vectors()?;
        }
        let last = self.len();
        let steps = match export.steps {
            Some(steps) if steps.to > last => {
                return Err(format!("the run has {0} steps: 0 to {0}", count(last)));
            }
            Some(steps) if steps.all().count() * export.shown().len() > MOST_PARTS => {
                let most = count(MOST_PARTS);
                return Err(format!(
                    "a figure has up to {most} pictures; take fewer steps, such as every 10th"
                ));
            }
            Some(steps) => steps.all().collect(),
            None => vec![self.step],
        };
        let of = |step: usize| export.shown().iter().map(move |picture| (step, *picture));
        let pages = match export.form {
            Form::Page => vec![steps.into_iter().flat_map(of).collect()],
            _ => steps.into_iter().map(|step| of(step).collect()).collect(),
        };
        let mut making = Making::new(export, format, recipe, pages);
        if export.shown().contains(&Picture::Twin) {
            let Some(Either::Solid(stage)) = &self.stage else {
                return Err("flatland is its own twin".into());
            };
            making.twin = Some(Twin::of(stage.posed(), &stage.view, &self.method, &self.settings)?);
        }
        if making.is_sequence() {
            let firsts: Vec<usize> = making.pages.iter().map(|page| page[0].0).collect();
            let below = firsts.iter().map(|step| self.at(*step, |s| s.blank(&making).below_pt()));
            making.least_below_pt = below.fold(0.0, f32::max);
        }
        if !making.is_single() {
            making.columns = self.columns_of(&making)?;
        }
        Ok(making)
    }

    /// Goes on by one part; the bytes of the file when it is done.
    ///
    /// # Errors
    /// Why it cannot be made, in a line.
    pub fn go_on(&mut self, making: &mut Making) -> Result<Option<Vec<u8>>, String> {
        match self.next_page(making)? {
            Some(drawing) => making.take(drawing),
            None => Ok(None),
        }
    }

    /// The first page of a figure.
    ///
    /// # Errors
    /// Why it cannot be made, in a line.
    pub fn drawn(&mut self, export: &Export) -> Result<Drawing, String> {
        let mut making = self.begin(export, Format::Svg, "")?;
        loop {
            if let Some(drawing) = self.next_page(&mut making)? {
                return Ok(drawing);
            }
        }
    }

    /// The next page, once all of its parts are there.
    fn next_page(&mut self, making: &mut Making) -> Result<Option<Drawing>, String> {
        let page = &making.pages[making.done];
        let (step, picture) = page[making.cells.len()];
        let cell = self.at(step, |s| s.part(making, picture)).ok_or(if making.export.is_vector {
            "surfaces pierce each other too often for vectors; leave them as pixels"
        } else {
            "there is nothing to make a figure of yet"
        })?;
        making.cells.push(cell);
        if making.cells.len() < page.len() {
            return Ok(None);
        }
        let drawing = self.at(page[0].0, |s| s.composed(making));
        making.done += 1;
        Ok(Some(drawing))
    }

    /// What `read` sees at another step.
    fn at<T>(&mut self, step: usize, read: impl FnOnce(&Self) -> T) -> T {
        let here = std::mem::replace(&mut self.step, step);
        let found = read(self);
        self.step = here;
        found
    }

    /// The page at this step without its picture, with the legend that any step may have.
    fn blank(&self, making: &Making) -> Page {
        let card = self.film().map(|film| film.reel.card());
        let entry = |(role, label)| Entry { role, label, swatch: Swatch::Area };
        let shown = making.export.shown();
        let has_states = shown.iter().any(|p| matches!(p, Picture::Observer | Picture::Eye));
        let is_shown = |role: Role| role != Role::Selected || self.selection != Subject::None;
        let states = self.legend().into_iter().filter(|(role, _)| is_shown(*role));
        Page {
            paper: making.export.paper,
            title: card.map_or(String::new(), |card| card.name.to_owned()),
            legend: if has_states { states.map(entry).collect() } else { Vec::new() },
            caption: self.caption(shown, making.steps().as_deref()).unwrap_or_default()
                + &self.of_twin(making),
            least_below_pt: making.least_below_pt,
        }
    }

    /// What the caption says of the twin at this step.
    fn of_twin(&self, making: &Making) -> String {
        let twin = making.twin.as_ref().filter(|_| making.steps().is_none());
        let said = twin.map(|twin| format!(" {}", twin.caption(twin.moment(self.events(), self.step))));
        said.unwrap_or_default()
    }

    /// A picture as large as the room, with its label, and its legend.
    fn pictured(
        &self,
        making: &Making,
        picture: Picture,
        room: Vec2,
        label: &str,
    ) -> Option<(Drawing, Vec<Entry>)> {
        let Some(twin) = making.twin.as_ref().filter(|_| picture == Picture::Twin) else {
            return self.content(&making.export, picture, room, label);
        };
        let look = Look { selected: Subject::None, current: Subject::None, ..self.look() };
        let picture = twin.picture(twin.moment(self.events(), self.step), &look);
        let figure::Picture::Flat(world, bounds) = &picture else { return None };
        let (marks, size) = (legend(world), bounds.size());
        let width = room.x.min((room.y - LABEL_PT) * size.x / size.y.max(1e-6)).max(LEAST_PART_PT);
        let panel = Panel { label: label.to_owned(), picture };
        Some((panels(width, 1, &[panel]), self.entries(marks)))
    }

    /// One picture at this step.
    fn part(&self, making: &Making, picture: Picture) -> Option<(Drawing, Vec<Entry>)> {
        let mut page = self.blank(making);
        if making.is_single() {
            let label = match picture {
                Picture::Observer | Picture::Eye => {
                    format!("step {} of {}", count(self.step), count(self.len()))
                }
                _ => String::new(),
            };
            let room = page.room_pt();
            if making.is_sequence() {
                return self.pictured(making, picture, room, &label);
            }
            page.legend.clear();
            let (content, entries) = self.pictured(making, picture, page.room_pt(), &label)?;
            page.legend.clone_from(&entries);
            // The legend takes room that only a slide, or a high picture, has not.
            let room = page.room_pt();
            let fits = content.size_pt.y <= room.y;
            return if fits {
                Some((content, entries))
            } else {
                self.pictured(making, picture, room, &label)
            };
        }
        let room = self.cell(making, making.columns);
        let is_narrow = room.x < NARROW_PT;
        let name = match picture {
            Picture::Observer => "Observer view".into(),
            Picture::Eye => "Eye view".into(),
            Picture::Code => "pseudocode".into(),
            Picture::Twin => "flatland twin".into(),
            Picture::Own(which) => capitalized(self.film()?.reel.pictures().get(which)?),
        };
        let step = if is_narrow { count(self.step) } else { format!("step {}", count(self.step)) };
        let label = match (making.steps(), making.export.shown().len()) {
            (None, _) => name,
            (Some(_), 1) => step,
            (Some(_), _) => format!("{step}: {name}"),
        };
        self.pictured(making, picture, room, &label)
    }

    /// The room of a part among others.
    fn cell(&self, making: &Making, columns: usize) -> Vec2 {
        let room = self.blank(making).room_pt();
        let rows = making.pages[0].len().div_ceil(columns) as f32;
        Vec2::new(grid_cell_pt(room.x, columns), (room.y - GRID_GAP_PT * (rows - 1.0)) / rows)
    }

    /// In how many columns the parts of a page stand: on a page as high as it must be the fewest with which
    /// they are as wide as their column, else those with which they are largest.
    fn columns_of(&mut self, making: &Making) -> Result<usize, String> {
        let count = making.pages[0].len();
        let (first, export) = (making.pages[0][0].0, &making.export);
        let room = self.at(first, |s| s.blank(making).room_pt());
        // Height for a width, of the highest of them.
        let width = grid_cell_pt(room.x, 2);
        let proportion = |s: &Self| {
            let measure = |picture: &Picture| s.pictured(making, *picture, Vec2::new(width, f32::MAX), "");
            let found = export.shown().iter().filter_map(measure);
            found.map(|(drawing, _)| drawing.size_pt.y / width).fold(0.05, f32::max)
        };
        let proportion = self.at(first, proportion);
        let used = |s: &mut Self, columns: usize| {
            let cell = s.at(first, |s| s.cell(making, columns));
            (cell.x.min((cell.y - LABEL_PT) / proportion), cell.x)
        };
        let least = if room.x < WIDE_PT { 1 } else { 2 };
        let mut best = (least, 0.0);
        for columns in least.min(count)..=count {
            let (got, most) = used(self, columns);
            if export.paper.height_pt().is_none() && got >= most - 0.5 && got > best.1 {
                best = (columns, got);
                break;
            }
            best = if got > best.1 { (columns, got) } else { best };
        }
        if best.1 < LEAST_PART_PT {
            let said = words::count(count);
            return Err(format!(
                "{said} pictures are too many for a page of this size; take fewer steps, such as every 10th, \
                 or a larger page"
            ));
        }
        Ok(best.0)
    }

    /// The page of the parts that are there, and its alternative text as its description.
    fn composed(&self, making: &mut Making) -> Drawing {
        let mut page = self.blank(making);
        let (mut drawings, mut entries) = (Vec::new(), Vec::<Entry>::new());
        for (drawing, legend) in making.cells.drain(..) {
            drawings.push(drawing);
            for entry in legend {
                match entries.iter_mut().find(|e| e.role == entry.role) {
                    // An area tells most, a dot least.
                    Some(known) if (entry.swatch as u8) < known.swatch as u8 => known.swatch = entry.swatch,
                    Some(_) => {}
                    None => entries.push(entry),
                }
            }
        }
        let words = self.states(false);
        let place = |role: Role| words.iter().position(|(r, _)| *r == role).unwrap_or(words.len());
        entries.sort_by_key(|entry| place(entry.role));
        if making.is_sequence() {
            for entry in &mut page.legend {
                if let Some(shown) = entries.iter().find(|e| e.role == entry.role) {
                    entry.swatch = shown.swatch;
                }
            }
        } else {
            page.legend = entries;
        }
        if making.steps().is_some() || making.twin.is_some() {
            // Counts are those of one step of one run.
            for entry in &mut page.legend {
                if let Some((_, word)) = words.iter().find(|(role, _)| *role == entry.role) {
                    entry.label.clone_from(word);
                }
            }
        }
        let mut content = match (drawings.len(), drawings.pop()) {
            (1, Some(drawing)) => drawing,
            (_, last) => {
                drawings.extend(last);
                grid(page.room_pt().x, making.columns, drawings)
            }
        };
        let legend: Vec<&str> = page.legend.iter().map(|e| e.label.as_str()).collect();
        let of = if legend.is_empty() { String::new() } else { format!(" Shown: {}.", legend.join("; ")) };
        content.description = page.caption.clone() + &of;
        page.compose(&content)
    }
}
