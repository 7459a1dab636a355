//! The gallery of the papers' figures, as the real program writes it.

use std::fs;
use std::path::{Path, PathBuf};

use cullscope::papers::owns;

use super::{done, folder, refused, shipped};

/// A folder with the scenes of the gallery, as in the repository.
fn repository(test: &str) -> PathBuf {
    let here = folder(test);
    for scene in owns().map(|own| own.scene).filter(|scene| !scene.starts_with("generate:")) {
        let to = here.join(scene);
        fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
        fs::copy(shipped(scene), to).expect("a scene of the repository");
    }
    here
}

/// The files of a folder, by name.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).expect("a folder").map(|e| e.expect("an entry").path());
    let name = |path: &Path| path.file_name().expect("a name").to_string_lossy().into_owned();
    let mut all: Vec<_> = entries.map(|path| (name(&path), fs::read(&path).expect("a file"))).collect();
    all.sort();
    all
}

/// The whole folder of the repository is what the command writes; `UPDATE_FIGURES=1` writes it anew.
#[test]
fn the_gallery_is_written_as_it_is_in_the_repository() {
    let here = repository("gallery");
    let said = done(&here, &["figure", "--gallery", "screenshots/figures"]);
    assert!(said.lines().last().is_some_and(|line| line.ends_with("README.md")), "{said}");
    let (out, golden) = (here.join("screenshots/figures"), PathBuf::from(shipped("screenshots/figures")));
    let (made, committed) = (files(&out), files(&golden));
    assert_eq!(said.lines().count(), made.len(), "each file is told once");
    if std::env::var_os("UPDATE_FIGURES").is_some() {
        made.iter().for_each(|(name, bytes)| fs::write(golden.join(name), bytes).expect("written"));
        return;
    }
    let names = |all: &[(String, Vec<u8>)]| all.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&made), names(&committed));
    for ((name, a), (_, b)) in made.iter().zip(&committed) {
        assert!(a == b, "{name} differs from its file; if that is meant, UPDATE_FIGURES=1 writes it anew");
    }
}

/// The commands that the page names are those of figures.
#[test]
fn a_command_of_the_page_makes_its_figure() {
    let here = repository("gallery-commands");
    let flat = owns().filter(|own| own.scene.starts_with("scenes2d/"));
    for own in flat {
        let words = own.words();
        let said = done(&here, &[&words[1..], &["--out", "screenshots/figures"]].concat());
        let made = fs::read(here.join(said.trim())).expect("one figure");
        let golden = fs::read(shipped(&format!("screenshots/figures/{}.svg", own.name))).expect("a figure");
        assert!(made == golden, "{}", own.name);
    }
}

#[test]
fn a_gallery_without_its_scenes_or_with_other_words_is_refused_before_the_work() {
    let here = folder("gallery-refused");
    let said = refused(&here, &["figure", "--gallery", "out"], 1);
    assert!(said.contains("scenes2d/") && said.contains("help: "), "{said}");
    for more in [&["--all"][..], &["--list"], &["zhang-figure-1"], &["--check", "."], &["--format", "pdf"]] {
        refused(&here, &[&["figure", "--gallery", "out"], more].concat(), 2);
    }
    let scene = ["figure", "--gallery", "out", "--scene", "walls.json", "--method", "frustum"];
    refused(&here, &scene, 2);
    refused(&here, &["figure", "--gallery", "out", "--eye", "0,0", "--target", "0,1"], 2);
    assert!(!here.join("out").exists());
}
