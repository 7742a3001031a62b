//! Opens the real window on a real world and looks at it. Needs a screen: `tests/run` lends it a virtual one; without any
//! it says so and passes.

#![cfg(feature = "app")]

use std::{path::Path, process::Command};

fn upthrust(arguments: &[&str], folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_upthrust"));
    command.args(arguments).current_dir(folder);
    command
}

#[test]
fn the_window_shows_the_map_and_its_layers() {
    let screen = ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some());
    if !screen {
        assert!(std::env::var_os("UPTHRUST_TESTS_NEED_GPU").is_none(), "there is no screen");
        eprintln!("skipped: there is no screen");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let grow = ["grow", "warped-terraces", "--size", "64", "--quiet", "--out", "world"];
    assert!(upthrust(&grow, folder.path()).status().unwrap().success());
    let shown = upthrust(&["app", "world", "--screenshot", "window.png"], folder.path()).output().unwrap();
    assert!(shown.status.success(), "{}", String::from_utf8_lossy(&shown.stderr));

    let window = image::open(folder.path().join("window.png")).unwrap().into_rgb8();
    assert!(window.width() >= 800 && window.height() >= 500, "{:?}", window.dimensions());
    // The map is a square in the middle of all but the side panel: hundreds of colours where the frame has a handful.
    let colours = |from: u32, to: u32| {
        let middle = window.height() / 4..window.height() * 3 / 4;
        let of = middle.flat_map(|y| (from..to).map(move |x| (x, y))).map(|(x, y)| window.get_pixel(x, y).0);
        of.collect::<std::collections::BTreeSet<_>>().len()
    };
    let (map, rim) = (colours(window.width() * 2 / 5 - 100, window.width() * 2 / 5 + 100), colours(0, 40));
    assert!(map > 1000 && rim < 10, "{map} colours on the map, {rim} at the rim");
    assert!(colours(window.width() - 240, window.width()) > 20, "the side panel is empty");
}

#[test]
fn without_a_screen_it_says_so_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let mut app = upthrust(&["app"], folder.path());
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        app.env_remove(name);
    }
    // Elsewhere a window would open and stay.
    if cfg!(target_os = "linux") {
        let said = app.output().unwrap();
        let line = String::from_utf8(said.stderr).unwrap();
        assert!(line.starts_with("error: no window can be opened: ") && line.lines().count() == 1, "{line}");
        assert!(!line.contains(".rs"), "{line}");
        assert_eq!(said.status.code(), Some(1));
    }
    let said = upthrust(&["app", "nowhere"], folder.path()).output().unwrap();
    assert_eq!(said.status.code(), Some(2));
}
