//! Everything that the explorer can do. An [`Action`] is menu item, palette entry, shortcut,
//! tooltip and test name at once; a [`Command`] is an action or something with operands.

use std::collections::BTreeSet;

use super::any::AnyView;
use super::camera::ObserverCamera;
use super::findings::Laboratory;
use super::measured::Tables;
use super::objects::Listing;
use super::plate::Export;
use super::shown::{Detail, Dialog, Gesture, Layout, LookIn, Surface};
use crate::drawing::Subject;
use crate::geometry::{NodeId, ObjectId};
use crate::method::Verdict;
use crate::raster::DepthScale;

/// Where an action stands in the menus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Menu {
    /// Scenes, sessions, figures.
    File,
    /// Undo, selection, the Eye.
    Edit,
    /// Moving through the film.
    Step,
    /// What is shown and how.
    View,
    /// Help.
    Help,
}

impl Menu {
    /// From left to right.
    pub const ALL: [Menu; 5] = [Menu::File, Menu::Edit, Menu::Step, Menu::View, Menu::Help];
    /// Its title.
    pub fn title(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::Step => "Step",
            Self::View => "View",
            Self::Help => "Help",
        }
    }
}

/// What is known of an action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Info {
    /// The action.
    pub action: Action,
    /// Kebab-case name of the command line and of tests.
    pub name: &'static str,
    /// Title in menus and in the palette.
    pub title: &'static str,
    /// Keys, such as `Ctrl+F`; the first one is shown.
    pub keys: &'static [&'static str],
    /// Its menu.
    pub menu: Menu,
    /// What it does, in a sentence.
    pub help: &'static str,
}

macro_rules! actions {
    ($($menu:ident $action:ident $name:literal $title:literal [$($key:literal),*] $help:literal;)*) => {
        /// A command without operands.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Action {
            $(#[doc = $help] $action,)*
        }
        impl Action {
            /// Every action, in the order of menus.
            pub const ALL: &[Info] = &[$(Info {
                action: Action::$action,
                name: $name,
                title: $title,
                keys: &[$($key),*],
                menu: Menu::$menu,
                help: $help,
            },)*];
        }
    };
}

actions! {
    File Open "open" "Open scene…" ["Ctrl+O"] "Choose a scene to open, or type its path.";
    File Start "start" "Start screen" [] "Shows the examples.";
    File Failures "failures" "Scenes where methods fail…" [] "Small scenes, each with a way in which \
        methods fail.";
    File Reload "reload" "Reload scene" ["Ctrl+R"] "Reads the scene again.";
    File Save "save" "Save session" ["Ctrl+S"] "Saves what is open, so that it can be opened again.";
    File SaveAs "save-as" "Save session as…" ["Ctrl+Shift+S"] "Saves what is open under another name.";
    File Figure "figure" "Figure…" ["Ctrl+Shift+E"] "Sets up what figures show, of which size and in which \
        colors, and writes one.";
    File ExportSvg "export-svg" "Write figure as SVG" [] "Writes the figure that is set up as vectors.";
    File ExportPdf "export-pdf" "Write figure as PDF" [] "Writes the figure that is set up as a page.";
    File ExportPng "export-png" "Write figure as PNG" ["Ctrl+E"] "Writes the figure that is set up as \
        pixels.";
    File Cancel "cancel" "Cancel the work" ["Escape"] "Stops what is being waited for, or closes what is \
                                                       open.";
    File Quit "quit" "Quit" ["Ctrl+Q"] "Closes the explorer.";

    Edit Undo "undo" "Undo" ["Ctrl+Z"] "Takes back the last change of the Eye, the method or a parameter.";
    Edit Redo "redo" "Redo" ["Ctrl+Shift+Z", "Ctrl+Y"] "Does again what was taken back.";
    Edit SelectBack "selection-back" "Previous selection" ["Alt+Left"] "Selects what was selected before.";
    Edit SelectForward "selection-forward" "Next selection" ["Alt+Right"] "Selects what was selected after \
        that.";
    Edit SelectNone "select-none" "Select nothing" ["Ctrl+Shift+A"] "Clears the selection.";
    Edit SelectCurrent "select-current" "Select what the step is about" ["C"] "Selects the node or primitive \
        of the current step.";
    Edit SelectParent "select-parent" "Select the node above" ["P"] "Selects the node above the selected \
        one.";
    Edit SelectEye "select-eye" "Select the Eye" [] "Selects the Eye.";
    Edit Why "why" "Why is it so?" ["Y"] "Jumps to the step that decided the selected thing.";
    Edit CopyEye "copy-eye" "Copy the Eye as text" ["Ctrl+L"] "Copies the Eye in the words of the command \
        line.";
    Edit EyeHome "eye-home" "Put the Eye back on its path" [] "Takes back every change of the Eye.";
    Edit EyeHere "eye-here" "Put the Eye where the Observer is" [] "Culling sees from where you look.";
    Edit LockEye "lock-eye" "Lock the Eye" ["L"] "A locked Eye cannot be moved by accident.";
    Edit Flight "flight" "Record a flight" [] "Keeps every place of the Eye from now on; chosen again, they \
                                               become a path of their own and a view file.";
    Edit ResetSettings "reset-parameters" "Reset the parameters" [] "Gives every parameter its default.";

    Step PlayPause "play" "Play or pause" ["Space"] "Plays the film from here, or stops.";
    Step Forward "step" "Step forward" ["Right"] "To the next event.";
    Step Back "step-back" "Step back" ["Left"] "To the event before.";
    Step Over "step-over" "Step over" ["F10", "Shift+Right"] "Passes over all that happens below the next \
        node.";
    Step BackOver "step-back-over" "Step back over" ["Shift+F10", "Shift+Left"] "Passes back over the node \
        that was just left.";
    Step Into "step-into" "Step into" ["F11"] "To the very next event, lines of pseudocode included.";
    Step BackInto "step-back-into" "Step back into" ["Shift+F11"] "To the event before, lines of pseudocode \
        included.";
    Step Out "step-out" "Step out" ["Ctrl+F11", "Alt+Up"] "To the end of the node that is being looked at.";
    Step BackOut "step-back-out" "Step back out" ["Ctrl+Shift+F11"] "To before the node that is being looked \
        at.";
    Step NextVerdict "next-verdict" "Next verdict" ["Ctrl+Right"] "To the next decision.";
    Step PreviousVerdict "previous-verdict" "Previous verdict" ["Ctrl+Left"] "To the decision before.";
    Step NextSame "next-same" "Next of this kind" ["N"] "To the next event of the same kind.";
    Step PreviousSame "previous-same" "Previous of this kind" ["Shift+N"] "To the event of the same kind \
        before.";
    Step NextLayer "next-layer" "Next layer" ["Z"] "To the first step that draws something of a deeper layer \
        than before. A thing is of layer 3 if, where it is least covered, two others lie before it.";
    Step PreviousLayer "previous-layer" "Previous layer" ["Shift+Z"] "Back to where a layer began.";
    Step FirstWrong "first-wrong" "First wrong decision" [] "To the first step that left out something that \
        is visible.";
    Step NextOnSelected "next-on-selected" "Next about the selection" ["K"] "To the next event about the \
        selected thing.";
    Step PreviousOnSelected "previous-on-selected" "Previous about the selection" ["Shift+K"] "To the event \
        about the selected thing before.";
    Step Run "run" "Run to breakpoint" ["F5"] "To the next breakpoint.";
    Step RunBack "run-back" "Run back to breakpoint" ["Shift+F5"] "Back to the last breakpoint.";
    Step RunToCursor "run-to-cursor" "Run to cursor" ["Ctrl+F10"] "To the next event about the selected \
        thing.";
    Step BackToCursor "back-to-cursor" "Run back to cursor" ["Ctrl+Shift+F10"] "Back to the last event about \
        the selected thing.";
    Step Breakpoint "breakpoint" "Toggle breakpoint" ["F9"] "Stops whenever the selected thing, or this \
        line, comes up; again to remove it.";
    Step First "first" "First event" ["Home"] "To the beginning of the film.";
    Step Last "last" "Last event" ["End"] "To the end of the film.";
    Step GoTo "go-to" "Go to step…" ["Ctrl+G"] "To the step with this number.";
    Step PreviousFrame "previous-frame" "Previous view of the path" ["["] "The Eye goes one view back along \
        its path.";
    Step NextFrame "next-frame" "Next view of the path" ["]"] "The Eye goes one view on along its path.";
    Step PlayPath "play-path" "Play or pause the path" ["Shift+Space"] "The Eye goes along its path, and \
        what moves moves.";
    Step Slower "slower" "Play slower" ["Minus"] "Halves the speed.";
    Step Faster "faster" "Play faster" ["Plus"] "Doubles the speed.";
    Step Bookmark "bookmark" "Bookmark this step" ["Ctrl+B"] "Keeps this step to come back to; again to \
        remove it.";
    Step Bookmark1 "bookmark-1" "Go to bookmark 1" ["Ctrl+1"] "To the first bookmark.";
    Step Bookmark2 "bookmark-2" "Go to bookmark 2" ["Ctrl+2"] "To the second bookmark.";
    Step Bookmark3 "bookmark-3" "Go to bookmark 3" ["Ctrl+3"] "To the third bookmark.";
    Step Bookmark4 "bookmark-4" "Go to bookmark 4" ["Ctrl+4"] "To the fourth bookmark.";
    Step Bookmark5 "bookmark-5" "Go to bookmark 5" ["Ctrl+5"] "To the fifth bookmark.";
    Step Bookmark6 "bookmark-6" "Go to bookmark 6" ["Ctrl+6"] "To the sixth bookmark.";
    Step Bookmark7 "bookmark-7" "Go to bookmark 7" ["Ctrl+7"] "To the seventh bookmark.";
    Step Bookmark8 "bookmark-8" "Go to bookmark 8" ["Ctrl+8"] "To the eighth bookmark.";
    Step Bookmark9 "bookmark-9" "Go to bookmark 9" ["Ctrl+9"] "To the ninth bookmark.";
    Step Bookmark10 "bookmark-10" "Go to bookmark 10" ["Ctrl+0"] "To the tenth bookmark.";
    Step PresentNext "present-next" "Next slide" ["PageDown"] "To the next bookmark; without bookmarks, to \
        the next verdict.";
    Step PresentPrevious "present-previous" "Previous slide" ["PageUp"] "To the bookmark before; without \
        bookmarks, to the verdict before.";
    Step ToggleDetail "detail" "Steps: coarse or full" ["G"] "Coarse steps pass over lines of pseudocode.";

    View Find "find" "Find in events" ["Ctrl+F"] "Filters the event tree.";
    View FoldAll "fold-all" "Fold all nodes" [] "Folds every node of the event tree.";
    View UnfoldAll "unfold-all" "Unfold all nodes" [] "Unfolds every node of the event tree.";
    View FrameSelection "frame-selection" "Frame the selection" ["F"] "Brings the selected thing, or \
        everything, into the picture.";
    View Swap "swap" "Swap Eye view and Observer view" ["Tab"] "Look through the Eye, or from outside.";
    View ShowPrims "show-primitives" "Show primitives" [] "Shows or hides the scene.";
    View ShowNodes "show-nodes" "Show node boxes" ["B"] "Shows or hides the boxes of the index.";
    View ShowEye "show-eye" "Show the Eye" [] "Shows or hides the Eye and its frustum.";
    View ShowEvidence "show-evidence" "Show evidence" [] "Shows or hides what the current test used.";
    View HideObject "hide-object" "Hide the selected object" ["H"] "Shows the selected object no longer, or \
        again; it is culled as before.";
    View IsolateObject "isolate-object" "Show only the selected object" ["Shift+H"] "Shows no other object; \
        they are culled as before.";
    View ShowObjects "show-objects" "Show all objects" ["Alt+H"] "Shows every object again.";
    View SurfaceSolid "surface-solid" "Solid" [] "Draws surfaces.";
    View SurfaceWire "surface-wire" "Wireframe" [] "Draws edges.";
    View SurfaceClear "surface-translucent" "Translucent" [] "Draws surfaces that one sees through.";
    View CycleSurface "surface" "Next surface style" ["X"] "Solid, wireframe, translucent.";
    View LookInOff "look-in-off" "Look in: off" [] "Closed buildings stay closed.";
    View LookInCut "look-in-cut" "Look in: cut above the Eye" [] "Cuts away in the Observer's picture what \
        lies higher than the Eye, as a floor plan does.";
    View LookInFaces "look-in-faces" "Look in: without backs" [] "Leaves out faces that turn their back to \
        the Observer: opens rooms whose faces look inward.";
    View CycleLookIn "look-in" "Look in: next way" ["I"] "Closed, cut above the Eye, without backs.";
    View ThemeLight "theme-light" "Light theme" [] "Dark on light.";
    View ThemeDark "theme-dark" "Dark theme" [] "Light on dark.";
    View ThemePrint "theme-print" "Print theme" [] "Black on white, as figures are printed.";
    View LayoutDebug "layout-debug" "Layout: debug" ["Alt+1"] "All panels.";
    View LayoutLecture "layout-lecture" "Layout: lecture" ["Alt+2"] "Big type, few panels, the step in a \
        caption.";
    View LayoutFigure "layout-figure" "Layout: figure" ["Alt+3"] "The picture alone, as it is exported.";
    View LayoutPictures "layout-pictures" "Layout: pictures" ["Alt+4"] "The method's own pictures (a \
        pyramid, lists, a timeline) beside the scene.";
    View ResetLayout "reset-layout" "Reset layout" ["Alt+0"] "Puts every panel back.";
    View Tables "paper-table" "Paper tables…" [] "Measures the tables of the method's paper, beside the \
                                                  paper's own figures.";
    View Laboratory "laboratory" "Speed against error…" [] "Measures all methods on the Eye's path, and \
        advises on the simplest one that is right enough.";
    View ScaleUp "scale-up" "Larger" ["Ctrl+Plus", "Ctrl+Equals"] "Everything larger.";
    View ScaleDown "scale-down" "Smaller" ["Ctrl+Minus"] "Everything smaller.";
    View ScaleReset "scale-reset" "Normal size" [] "Everything in its normal size.";
    View FullScreen "full-screen" "Full screen" ["Ctrl+Shift+F"] "Fills the screen, or not.";

    Help Palette "palette" "Command palette…" ["Ctrl+K", "Ctrl+P"] "Finds a command by its name.";
    Help Keys "keys" "Keys" ["F1", "?"] "Lists every key.";
    Help Report "report" "Loading report" [] "What was noticed while the scene was loaded.";
    Help About "about" "About the method" [] "What the method does and where it comes from.";
}

impl Action {
    /// What is known of it.
    pub fn info(self) -> &'static Info {
        &Self::ALL[self as usize]
    }
    /// The action with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|i| i.name == name).map(|i| i.action)
    }
}

/// A command to the explorer.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Without operands.
    Do(Action),
    /// Opens a scene (or a session file).
    Open(String),
    /// Goes to a step.
    GoTo(usize),
    /// Selects a thing.
    Select(Subject),
    /// Chooses a method by its key.
    Method(String),
    /// Sets a parameter.
    Set(String, String, Gesture),
    /// Moves the Eye.
    Eye(AnyView, Gesture),
    /// Goes to a view of a path.
    Frame(usize, usize),
    /// Moves the Observer.
    Observe(ObserverCamera),
    /// Lists objects.
    List(Listing),
    /// Shows an object no longer, or again.
    FlipShown(ObjectId),
    /// Shows all objects but these.
    ShowWithout(BTreeSet<ObjectId>),
    /// Looks into a pixel of the Eye's image, by column and row; or into none.
    Pixel(Option<[u32; 2]>),
    /// Shows a picture of the method, by its word.
    Picture(String),
    /// Shades depths in it on this scale.
    Depths(DepthScale),
    /// Filters the event tree.
    Filter(String),
    /// Folds or unfolds the node entered by this event.
    Fold(u32),
    /// How fine steps are.
    Detail(Detail),
    /// Steps a second.
    Speed(f32),
    /// Opens a dialog, or closes it.
    Dialog(Dialog),
    /// Stops, or no longer stops, at a line of pseudocode.
    BreakLine(u8),
    /// Stops, or no longer stops, at a verdict.
    BreakVerdict(Verdict),
    /// Stops, or no longer stops, at a node.
    BreakNode(NodeId),
    /// Writes a note to a bookmark.
    Note(usize, String),
    /// Goes to a bookmark: its step, and where the person looked from.
    Bookmark(usize),
    /// Removes a bookmark.
    Unmark(usize),
    /// How surfaces are drawn.
    Surface(Surface),
    /// How the Observer looks into what is closed.
    LookIn(LookIn),
    /// A set of panels.
    Layout(Layout),
    /// Size of everything, 0.5 to 4.
    Scale(f32),
    /// Saves the session to a file.
    SaveTo(String),
    /// Sets up figures.
    Figures(Box<Export>),
    /// Writes a figure to a file, whose ending tells the format.
    WriteFigure(Box<Export>, String),
    /// Measures a paper's table, or writes it to a file.
    Tables(Tables),
    /// Measures methods against each other, or asks for advice.
    Laboratory(Laboratory),
    /// Removes a message.
    Dismiss(usize),
}

impl From<Action> for Command {
    fn from(action: Action) -> Self {
        Self::Do(action)
    }
}

/// How well `typed` fits `title`: letters in order, better when they are close together and begin words.
/// `None` if they do not occur in order. For the palette.
pub fn fuzzy(typed: &str, title: &str) -> Option<i32> {
    let title: Vec<char> = title.to_lowercase().chars().collect();
    let (mut at, mut score, mut last) = (0, 0, None);
    for c in typed.to_lowercase().chars().filter(|c| !c.is_whitespace()) {
        let found = at + title[at..].iter().position(|&t| t == c)?;
        let begins = found == 0 || !title[found - 1].is_alphanumeric();
        score += if begins { 8 } else { 1 }
            + if last == found.checked_sub(1) && last.is_some() { 6 } else { 0 }
            - (found - at) as i32 / 4;
        last = Some(found);
        at = found + 1;
    }
    Some(score - title.len() as i32 / 8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_action_has_a_name_of_its_own_and_no_key_is_taken_twice() {
        let (mut names, mut titles, mut keys) = (BTreeSet::new(), BTreeSet::new(), BTreeSet::new());
        for (i, info) in Action::ALL.iter().enumerate() {
            assert_eq!(info.action as usize, i);
            assert_eq!(Action::named(info.name), Some(info.action));
            assert!(names.insert(info.name) && titles.insert(info.title), "{info:?}");
            assert!(info.help.ends_with('.') && !info.title.is_empty());
            info.keys.iter().for_each(|k| assert!(keys.insert(*k), "{k} is taken twice"));
        }
    }

    #[test]
    fn the_palette_prefers_beginnings_of_words() {
        let best = |typed: &str| {
            let scored = Action::ALL
                .iter()
                .filter_map(|i| Some((fuzzy(typed, i.title)?, std::cmp::Reverse(i.action))));
            scored.max().map(|(_, a)| a.0)
        };
        assert_eq!(best("step ov"), Some(Action::Over));
        assert_eq!(best("dark"), Some(Action::ThemeDark));
        assert_eq!(best("gts"), Some(Action::GoTo));
        assert_eq!(fuzzy("zzz", "Step over"), None);
    }
}
