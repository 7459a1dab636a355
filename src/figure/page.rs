//! A page: title, picture, legend and caption, laid out at the size at which it is printed.
//!
//! Text is wrapped by its measured width, so nothing overlaps or sticks out (a property test holds it to
//! that). Lengths are in points of 1/72 inch unless a name says otherwise.

use glam::{Vec2, vec2};

use crate::drawing::{Anchor, Drawing, Font, Item, Layer, Mark, Role, Subject, metrics};

/// Points in a millimeter.
pub const PT_PER_MM: f32 = 72.0 / 25.4;

/// The size of a page.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Paper {
    /// One column of a journal: 84 mm, as high as it must be.
    #[default]
    Column,
    /// Two columns of a journal: 175 mm, as high as it must be.
    TwoColumns,
    /// A slide of 16:9, 254 mm wide, with larger text.
    Slide,
    /// Any other size; without a height it is as high as it must be.
    Custom {
        /// Its width.
        width_mm: f32,
        /// Its height.
        height_mm: Option<f32>,
    },
}

impl Paper {
    /// Width of the page; at least 20 mm.
    pub fn width_pt(self) -> f32 {
        let mm = match self {
            Paper::Column => 84.0,
            Paper::TwoColumns => 175.0,
            Paper::Slide => 254.0,
            Paper::Custom { width_mm, .. } if width_mm.is_finite() => {
                width_mm.clamp(*SIDES_MM.start(), *SIDES_MM.end())
            }
            Paper::Custom { .. } => 84.0,
        };
        mm * PT_PER_MM
    }

    /// Height of the page, if it is given; at least 20 mm.
    pub fn height_pt(self) -> Option<f32> {
        match self {
            Paper::Column | Paper::TwoColumns => None,
            Paper::Slide => Some(254.0 * 9.0 / 16.0 * PT_PER_MM),
            Paper::Custom { height_mm, .. } => height_mm
                .filter(|h| h.is_finite())
                .map(|h| h.clamp(*SIDES_MM.start(), *SIDES_MM.end()) * PT_PER_MM),
        }
    }

    /// Its word in files and on the command line: `column`, `page`, `slide`, or millimeters such as `120` and
    /// `120x90`.
    pub fn word(self) -> String {
        if let Some((word, _)) = WORDS.iter().find(|(_, paper)| *paper == self) {
            return (*word).to_owned();
        }
        match self {
            Paper::Custom { width_mm, height_mm: Some(height_mm) } => format!("{width_mm}x{height_mm}"),
            _ => format!("{}", self.width_pt() / PT_PER_MM),
        }
    }

    fn sizes(self) -> Sizes {
        match self {
            Paper::Slide => Sizes { margin: 20.0, gap: 10.0, title: 20.0, legend: 12.0, caption: 12.0 },
            _ => Sizes { margin: 3.0, gap: 6.0, title: 9.5, legend: 8.0, caption: 8.0 },
        }
    }
}

/// Sizes that have a word.
const WORDS: [(&str, Paper); 3] =
    [("column", Paper::Column), ("page", Paper::TwoColumns), ("slide", Paper::Slide)];

/// Sides of pages in millimeters.
const SIDES_MM: std::ops::RangeInclusive<f32> = 20.0..=5000.0;

impl std::str::FromStr for Paper {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        if let Some((_, paper)) = WORDS.iter().find(|(word, _)| *word == text) {
            return Ok(*paper);
        }
        let side = |t: &str| t.trim().parse::<f32>().ok().filter(|mm| SIDES_MM.contains(mm));
        let (width, height) = text.split_once(['x', 'X', '×']).map_or((text, None), |(w, h)| (w, Some(h)));
        match (side(width), height.map(side)) {
            (Some(width_mm), None) => Ok(Paper::Custom { width_mm, height_mm: None }),
            (Some(width_mm), Some(Some(mm))) => Ok(Paper::Custom { width_mm, height_mm: Some(mm) }),
            _ => Err("expected column, page, slide, or 20 to 5000 millimeters such as 120 or 120x90".into()),
        }
    }
}

/// Sizes of what stands on a page.
#[derive(Clone, Copy)]
struct Sizes {
    margin: f32,
    gap: f32,
    title: f32,
    legend: f32,
    caption: f32,
}

/// Distance of baselines in ems; our fonts ink 1.21 em, so that lines never touch.
const LEADING: f32 = 1.35;
/// On a page of given height the caption may take this part of it, and so may title and legend.
const TEXT_SHARE: f32 = 0.3;

/// What an entry of the legend shows beside its label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Swatch {
    /// A small area.
    Area,
    /// A piece of line.
    Line,
    /// A dot.
    Dot,
}

/// One entry of the legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its role.
    pub role: Role,
    /// Its words.
    pub label: String,
    /// Its picture.
    pub swatch: Swatch,
}

/// What stands around a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Page {
    /// The size.
    pub paper: Paper,
    /// Above the picture; may be empty.
    pub title: String,
    /// Below the picture, one entry after another.
    pub legend: Vec<Entry>,
    /// Below the legend: method, scene, parameters and step; may be empty.
    pub caption: String,
    /// Least height of what stands below the picture: pages of a sequence share one, so that nothing moves
    /// from one to the next.
    pub least_below_pt: f32,
}

impl Page {
    /// Width and height for the picture. On a page that is as high as it must be, the height is that of a
    /// sheet.
    pub fn room_pt(&self) -> Vec2 {
        let layout = self.layout();
        let width = self.paper.width_pt() - 2.0 * layout.sizes.margin;
        // 230 mm is the text height of a journal's page.
        let height = self.paper.height_pt().unwrap_or(230.0 * PT_PER_MM);
        vec2(width, (height - layout.above - layout.below).max(8.0))
    }

    /// Height of what stands below the picture, gaps and margin included.
    pub fn below_pt(&self) -> f32 {
        self.layout().below
    }

    /// The page with a picture on it. A picture larger than the room is made smaller: its points move
    /// together, its text and its lines keep their sizes.
    pub fn compose(&self, picture: &Drawing) -> Drawing {
        let (layout, room) = (self.layout(), self.room_pt());
        let size = picture.size_pt.max(Vec2::ONE);
        let scale = (room / size).min_element().min(1.0);
        let shown = size * scale;
        let height = self.paper.height_pt().unwrap_or(layout.above + shown.y + layout.below);
        let free = height - layout.above - layout.below - shown.y;
        let corner = vec2((self.paper.width_pt() - shown.x) / 2.0, layout.above + free.max(0.0) / 2.0);
        let mut page = Drawing {
            size_pt: vec2(self.paper.width_pt(), height),
            title: first(&[&self.title, &picture.title]),
            description: first(&[&picture.description, &self.caption]),
            items: Vec::with_capacity(picture.items.len() + 32),
        };
        for item in &picture.items {
            let mark = item.mark.mapped(|p| corner + p * scale);
            page.items.push(Item { mark, role: item.role, subject: item.subject, layer: item.layer });
        }
        layout.title_to(&mut page);
        layout.legend_to(&mut page, height - layout.below + layout.sizes.gap);
        layout.caption_to(&mut page, height);
        page
    }

    fn layout(&self) -> Layout<'_> {
        let sizes = self.paper.sizes();
        let width = self.paper.width_pt() - 2.0 * sizes.margin;
        let most = self.paper.height_pt().map_or(f32::INFINITY, |h| h * TEXT_SHARE);
        let title = fitted(&self.title, Font::Bold, sizes.title, width, most);
        let caption = fitted(&self.caption, Font::Regular, sizes.caption, width, most);
        let legend = legend_rows(&self.legend, sizes.legend, width, most);
        let line = |size: f32, n: usize| size * LEADING * n as f32;
        let gap = |n: usize| if n == 0 { 0.0 } else { sizes.gap };
        let above = sizes.margin + line(title.size, title.lines.len()) + gap(title.lines.len());
        let legend_height = line(legend.size, legend.rows);
        let caption_height = line(caption.size, caption.lines.len());
        let below =
            gap(legend.rows) + legend_height + gap(caption.lines.len()) + caption_height + sizes.margin;
        let below = below.max(self.least_below_pt);
        Layout { page: self, sizes, title, caption, legend, above, below }
    }
}

/// The first text that says something.
fn first(texts: &[&str]) -> String {
    texts.iter().find(|t| !t.is_empty()).map_or_else(String::new, |t| (*t).to_owned())
}

/// Lines of text and their size.
struct Block {
    lines: Vec<String>,
    size: f32,
}

/// A text in at most the given height: smaller first, and shortened where even that does not help.
fn fitted(text: &str, font: Font, size: f32, width: f32, most: f32) -> Block {
    for shrunk in [1.0, 0.85, 0.7, 0.6] {
        let size = size * shrunk;
        let lines = metrics::wrap(text.trim(), font, size, width);
        if lines.len() as f32 * size * LEADING <= most {
            return Block { lines, size };
        }
    }
    let size = size * 0.6;
    let mut lines = metrics::wrap(text.trim(), font, size, width);
    lines.truncate(((most / (size * LEADING)) as usize).max(1));
    if let Some(last) = lines.last_mut() {
        let room = width - metrics::width_pt("…", font, size);
        while metrics::width_pt(last, font, size) > room && last.pop().is_some() {}
        last.push('…');
    }
    Block { lines, size }
}

/// Width of a swatch and distances in the legend, in ems.
const SWATCH: f32 = 2.0;
const SWATCH_GAP: f32 = 0.5;
const ENTRY_GAP: f32 = 1.6;

/// Where the entries of a legend stand: row and left end.
struct Legend {
    places: Vec<(usize, f32)>,
    labels: Vec<String>,
    rows: usize,
    size: f32,
}

fn legend_rows(entries: &[Entry], size: f32, width: f32, most: f32) -> Legend {
    let mut legend = Legend { places: Vec::new(), labels: Vec::new(), rows: 0, size };
    for shrunk in [1.0, 0.85, 0.7, 0.6] {
        legend = legend_at(entries, size * shrunk, width);
        if legend.rows as f32 * legend.size * LEADING <= most {
            break;
        }
    }
    legend
}

/// The legend in as many columns as fit; where columns waste rows, one entry after another.
fn legend_at(entries: &[Entry], size: f32, width: f32) -> Legend {
    let (lead, gap) = ((SWATCH + SWATCH_GAP) * size, ENTRY_GAP * size);
    let labels: Vec<String> =
        entries.iter().map(|e| metrics::elide(&e.label, Font::Regular, size, width - lead)).collect();
    let wide: Vec<f32> = labels.iter().map(|l| lead + metrics::width_pt(l, Font::Regular, size)).collect();
    let (tidy, dense) = (in_columns(&wide, gap, width), in_flow(&wide, gap, width));
    let rows = |places: &[(usize, f32)]| places.last().map_or(0, |(row, _)| row + 1);
    let places = if rows(&tidy) <= rows(&dense) + 1 { tidy } else { dense };
    Legend { rows: rows(&places), places, labels, size }
}

/// Row and left end of each entry, in the most columns that fit.
fn in_columns(wide: &[f32], gap: f32, width: f32) -> Vec<(usize, f32)> {
    let columns_of = |n: usize| {
        (0..n).map(|c| wide.iter().skip(c).step_by(n).copied().fold(0.0, f32::max)).collect::<Vec<f32>>()
    };
    let fits = |columns: &Vec<f32>| columns.iter().sum::<f32>() + gap * (columns.len() - 1) as f32 <= width;
    let columns = (1..=wide.len()).rev().map(columns_of).find(fits).unwrap_or_else(|| columns_of(1));
    let left = |column: usize| columns[..column].iter().map(|w| w + gap).sum::<f32>();
    (0..wide.len()).map(|i| (i / columns.len(), left(i % columns.len()))).collect()
}

/// Row and left end of each entry, each where the one before ends.
fn in_flow(wide: &[f32], gap: f32, width: f32) -> Vec<(usize, f32)> {
    let (mut row, mut x) = (0, 0.0);
    wide.iter()
        .map(|w| {
            if x > 0.0 && x + w > width {
                (row, x) = (row + 1, 0.0);
            }
            let place = (row, x);
            x += w + gap;
            place
        })
        .collect()
}

struct Layout<'a> {
    page: &'a Page,
    sizes: Sizes,
    title: Block,
    caption: Block,
    legend: Legend,
    /// Height of what is above the picture, with its gap.
    above: f32,
    /// Height of what is below the picture, with its gap.
    below: f32,
}

impl Layout<'_> {
    fn lines_to(&self, block: &Block, font: Font, top: f32, to: &mut Drawing) {
        for (i, text) in block.lines.iter().enumerate() {
            let at = vec2(self.sizes.margin, top + block.size * (LEADING * i as f32 + 1.0));
            let mark =
                Mark::Text { at, text: text.clone(), size_pt: block.size, anchor: Anchor::Start, font };
            to.push(Layer::Caption, Role::Ink, Subject::None, mark);
        }
    }

    fn title_to(&self, to: &mut Drawing) {
        self.lines_to(&self.title, Font::Bold, self.sizes.margin, to);
    }

    fn caption_to(&self, to: &mut Drawing, height: f32) {
        let legend = self.legend.size * LEADING * self.legend.rows as f32;
        let gaps = self.sizes.gap * if self.legend.rows == 0 { 1.0 } else { 2.0 };
        let top = height - self.below + gaps + legend;
        self.lines_to(&self.caption, Font::Regular, top, to);
    }

    fn legend_to(&self, to: &mut Drawing, top: f32) {
        let size = self.legend.size;
        for ((entry, label), (row, x)) in
            self.page.legend.iter().zip(&self.legend.labels).zip(&self.legend.places)
        {
            let left = self.sizes.margin + x;
            let base = top + size * (LEADING * *row as f32 + 1.0);
            swatch(entry, vec2(left, base - 0.75 * size), vec2(left + SWATCH * size, base + 0.05 * size), to);
            to.text(
                Layer::Legend,
                Role::Ink,
                vec2(left + (SWATCH + SWATCH_GAP) * size, base),
                size,
                Anchor::Start,
                label.clone(),
            );
        }
    }
}

/// The picture of an entry, inside a rectangle.
fn swatch(entry: &Entry, min: Vec2, max: Vec2, to: &mut Drawing) {
    let middle = (min.y + max.y) / 2.0;
    let mark = match entry.swatch {
        Swatch::Area => Mark::Area(vec![min, vec2(max.x, min.y), max, vec2(min.x, max.y)]),
        Swatch::Line => Mark::Line { points: vec![vec2(min.x, middle), vec2(max.x, middle)], closed: false },
        Swatch::Dot => Mark::Dot { at: (min + max) / 2.0, radius_pt: (max.y - min.y) * 0.35 },
    };
    to.push(Layer::Legend, entry.role, Subject::None, mark);
}

/// Drawings below each other.
pub fn below(parts: Vec<Drawing>) -> Drawing {
    let mut all = Drawing::default();
    for part in parts {
        let by = vec2(0.0, all.size_pt.y);
        let moved = part.items.into_iter().map(|item| Item { mark: item.mark.mapped(|p| p + by), ..item });
        all.items.extend(moved);
        all.size_pt = vec2(all.size_pt.x.max(part.size_pt.x), by.y + part.size_pt.y);
    }
    all
}

/// The words of a role in a legend; nothing for what needs no explanation.
pub fn label(role: Role) -> Option<&'static str> {
    Some(match role {
        Role::Ink | Role::Faint | Role::Paper => return None,
        Role::Scene => "not yet looked at",
        Role::Undecided => "undecided",
        Role::Partial => "entered, part visible",
        Role::Visible => "visible: kept",
        Role::Hidden => "occluded: culled",
        Role::Outside => "outside: culled",
        Role::FacesAway => "faces away: culled",
        Role::Occluder => "occluder",
        Role::Approximated => "approximated, presumed hidden, over budget",
        Role::Wrong => "visible, yet culled",
        Role::Current => "current",
        Role::Selected => "selected",
        Role::Eye => "Eye and its frustum",
        Role::Evidence => "used by the test",
    })
}

/// A legend of the roles that occur in a picture, in the order of [`Role::ALL`].
pub fn legend<P>(picture: &Drawing<P>) -> Vec<Entry> {
    let entry = |role: Role| {
        let swatch = picture.items.iter().filter(|i| i.role == role).filter_map(|i| match i.mark {
            Mark::Area(_) | Mark::Swatch { .. } | Mark::Facet { .. } => Some(Swatch::Area),
            Mark::Line { .. } | Mark::Arrow(..) => Some(Swatch::Line),
            Mark::Dot { .. } => Some(Swatch::Dot),
            Mark::Text { .. } | Mark::Image { .. } => None,
        });
        // An area tells most, a dot least.
        let swatch = swatch.min_by_key(|s| *s as u8)?;
        Some(Entry { role, label: label(role)?.to_owned(), swatch })
    };
    Role::ALL.into_iter().filter_map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_pcg::Pcg32;
    use rand_pcg::rand_core::{Rng, SeedableRng};

    fn random_text(rng: &mut Pcg32, most: u32) -> String {
        let words = [
            "kD-tree",
            "of",
            "ρ ≥ 0.75",
            "a",
            "occlusion-maps",
            "frustum,",
            "Extraordinarily-long-word-that-never-ends",
            "12 345",
            "−3.5",
        ];
        let n = rng.next_u32() % (most + 1);
        (0..n).map(|_| words[rng.next_u32() as usize % words.len()]).collect::<Vec<_>>().join(" ")
    }

    fn random_page(rng: &mut Pcg32) -> Page {
        let custom = Paper::Custom {
            width_mm: 30.0 + (rng.next_u32() % 200) as f32,
            height_mm: rng.next_u32().is_multiple_of(2).then_some(60.0 + (rng.next_u32() % 200) as f32),
        };
        let paper = [Paper::Column, Paper::TwoColumns, Paper::Slide, custom][rng.next_u32() as usize % 4];
        let legend = Role::STATES[..rng.next_u32() as usize % 10].iter().enumerate();
        let swatches = [Swatch::Area, Swatch::Line, Swatch::Dot];
        let legend = legend
            .map(|(i, role)| Entry { role: *role, label: random_text(rng, 4), swatch: swatches[i % 3] })
            .collect();
        Page {
            paper,
            title: random_text(rng, 12),
            legend,
            caption: random_text(rng, 80),
            least_below_pt: 0.0,
        }
    }

    /// The rectangles of everything but the picture, and of the picture as a whole.
    fn rectangles(page: &Drawing) -> Vec<[Vec2; 2]> {
        let around = |points: &[Vec2]| {
            points.iter().fold([Vec2::INFINITY, Vec2::NEG_INFINITY], |[a, b], p| [a.min(*p), b.max(*p)])
        };
        let of = |i: &Item<Vec2>| match &i.mark {
            Mark::Text { at, text, size_pt, anchor, font } => {
                metrics::text_box(*at, text, *font, *size_pt, *anchor)
            }
            Mark::Area(points) | Mark::Line { points, .. } => around(points),
            Mark::Dot { at, radius_pt } => [*at - *radius_pt, *at + *radius_pt],
            _ => panic!("no such mark on this page"),
        };
        page.items.iter().map(of).collect()
    }

    #[test]
    fn nothing_on_a_page_overlaps_or_sticks_out() {
        let mut rng = Pcg32::seed_from_u64(11);
        for round in 0..400 {
            let page = random_page(&mut rng);
            let size = vec2(50.0 + (rng.next_u32() % 600) as f32, 20.0 + (rng.next_u32() % 600) as f32);
            let mut picture = Drawing { size_pt: size, ..Drawing::default() };
            picture.push(
                Layer::Ground,
                Role::Ink,
                Subject::None,
                Mark::Area(vec![Vec2::ZERO, vec2(size.x, 0.0), size, vec2(0.0, size.y)]),
            );
            let drawn = page.compose(&picture);
            let boxes = rectangles(&drawn);
            for (i, [a, b]) in boxes.iter().enumerate() {
                assert!(
                    a.cmpge(Vec2::splat(-0.01)).all() && b.cmple(drawn.size_pt + 0.01).all(),
                    "round {round}: {page:?} {:?}",
                    drawn.items[i]
                );
                for (j, [c, d]) in boxes.iter().enumerate().skip(i + 1) {
                    let apart =
                        b.x <= c.x + 0.01 || d.x <= a.x + 0.01 || b.y <= c.y + 0.01 || d.y <= a.y + 0.01;
                    assert!(apart, "round {round}: {page:?}\n{:?}\n{:?}", drawn.items[i], drawn.items[j]);
                }
            }
        }
    }

    #[test]
    fn papers_have_their_sizes() {
        let picture = Drawing {
            size_pt: vec2(100.0, 80.0),
            title: "T".into(),
            description: "D".into(),
            ..Drawing::default()
        };
        let page = Page { caption: "C".into(), ..Page::default() };
        let drawn = page.compose(&picture);
        assert!((drawn.size_pt.x - 238.11).abs() < 0.01 && drawn.size_pt.y > 80.0 && drawn.size_pt.y < 120.0);
        assert_eq!((drawn.title.as_str(), drawn.description.as_str()), ("T", "D"));
        let slide = Page { paper: Paper::Slide, ..page }.compose(&picture);
        assert!((slide.size_pt.x / slide.size_pt.y - 16.0 / 9.0).abs() < 1e-3);
        for odd in [f32::NAN, f32::INFINITY, -5.0, 0.0] {
            let paper = Paper::Custom { width_mm: odd, height_mm: Some(odd) };
            let size = Page { paper, title: "title".into(), ..Page::default() }.compose(&picture).size_pt;
            assert!(size.is_finite() && size.min_element() > 10.0, "{size}");
        }
    }

    #[test]
    fn the_legend_tells_what_is_there() {
        let mut picture = Drawing::default();
        picture.line(Layer::Scene, Role::Visible, Subject::None, [Vec2::ZERO, Vec2::ONE]);
        picture.push(Layer::Scene, Role::Hidden, Subject::None, Mark::Dot { at: Vec2::ONE, radius_pt: 1.0 });
        picture.push(
            Layer::Scene,
            Role::Hidden,
            Subject::None,
            Mark::Area(vec![Vec2::ZERO, Vec2::X, Vec2::Y]),
        );
        picture.text(Layer::Labels, Role::Wrong, Vec2::ONE, 8.0, Anchor::Start, "no mark of its own");
        picture.line(Layer::Labels, Role::Ink, Subject::None, [Vec2::ZERO, Vec2::ONE]);
        let legend: Vec<_> = legend(&picture).into_iter().map(|e| (e.role, e.swatch)).collect();
        assert_eq!(legend, [(Role::Visible, Swatch::Line), (Role::Hidden, Swatch::Area)]);
    }
}
