//! The house rules that a compiler does not know: which room may import which, where the large dependencies live, how
//! long a file may be, and that the drawn import graph is the real one.
//!
//! It reads the sources, not the compiled crate, so that code behind features counts as well.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

/// The rooms; a room imports only rooms before it.
const ROOMS: [&str; 28] = [
    "grid",
    "noise",
    "rmp",
    "sph",
    "flow",
    "world",
    "bake",
    "process",
    "crust",
    "terrain",
    "tectonics",
    "climate",
    "erosion",
    "volcano",
    "rivers",
    "edit",
    "scene",
    "recipe",
    "timeline",
    "measure",
    "relief",
    "render",
    "export",
    "job",
    "cli",
    "app",
    "lib",
    "main",
];
/// They meet only through the world.
const STAGE_ROOMS: [&str; 7] = ["terrain", "tectonics", "climate", "erosion", "volcano", "rivers", "edit"];
/// Dependencies that only some rooms may name.
const CONFINED: [(&str, &[&str]); 10] = [
    ("wgpu", &["render", "app"]),
    ("pollster", &["render", "app"]),
    ("egui", &["app"]),
    ("eframe", &["app"]),
    ("rapier2d", &["tectonics"]),
    ("zarrs", &["world"]),
    ("zstd", &["bake"]),
    ("spade", &["rmp"]),
    ("tiny_skia", &["rmp", "relief"]),
    ("clap", &["cli"]),
];
const MOST_LINES: usize = 600;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A source file: its room, how deep its module lies in the crate, its text.
struct Source {
    path: PathBuf,
    room: String,
    depth: usize,
    text: String,
}

fn sources() -> Vec<Source> {
    fn walk(folder: &Path, into: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                walk(&path, into);
            } else if path.extension().is_some_and(|end| end == "rs") {
                into.push(path);
            }
        }
    }
    let mut paths = Vec::new();
    walk(&root().join("src"), &mut paths);
    paths.sort();
    paths
        .into_iter()
        .map(|path| {
            let text = std::fs::read_to_string(&path).unwrap();
            let inside = path.strip_prefix(root().join("src")).unwrap().with_extension("");
            let parts: Vec<String> = inside.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
            let at_root = ["lib", "main"].contains(&parts[0].as_str());
            let own_level = parts.last().is_none_or(|last| last != "mod");
            let depth = if at_root { 0 } else { parts.len() - usize::from(!own_level) };
            Source { path, room: parts[0].clone(), depth, text }
        })
        .collect()
}

/// Words, `::`, and single marks of a Rust text, without comments, strings and lifetimes.
fn tokens(text: &str) -> Vec<String> {
    let s: Vec<char> = text.chars().collect();
    let at = |i: usize| s.get(i).copied().unwrap_or('\0');
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let (mut out, mut i) = (Vec::new(), 0);
    while i < s.len() {
        match s[i] {
            '/' if at(i + 1) == '/' => {
                while i < s.len() && s[i] != '\n' {
                    i += 1;
                }
            }
            '/' if at(i + 1) == '*' => {
                let mut level = 0;
                while i < s.len() {
                    match (s[i], at(i + 1)) {
                        ('/', '*') => (level, i) = (level + 1, i + 2),
                        ('*', '/') => (level, i) = (level - 1, i + 2),
                        _ => i += 1,
                    }
                    if level == 0 {
                        break;
                    }
                }
            }
            'r' if raw_string(&s, i).is_some() => i = raw_string(&s, i).unwrap_or(s.len()),
            '"' => {
                i += 1;
                while i < s.len() && s[i] != '"' {
                    i += if s[i] == '\\' { 2 } else { 1 };
                }
                i += 1;
            }
            // A character ends two or, escaped, more places on; a lifetime does not end.
            '\'' if at(i + 1) == '\\' => {
                i += 3;
                while i < s.len() && s[i] != '\'' {
                    i += 1;
                }
                i += 1;
            }
            '\'' if at(i + 2) == '\'' => i += 3,
            '\'' => i += 1,
            ':' if at(i + 1) == ':' => {
                out.push("::".to_owned());
                i += 2;
            }
            c if word(c) => {
                let start = i;
                while i < s.len() && word(s[i]) {
                    i += 1;
                }
                out.push(s[start..i].iter().collect());
                // A raw string may follow a byte prefix, b"..." and br"..." alike.
                if out.last().is_some_and(|w| w == "br") && raw_string(&s, i - 1).is_some() {
                    i = raw_string(&s, i - 1).unwrap_or(i);
                }
            }
            c => {
                if !c.is_whitespace() {
                    out.push(c.to_string());
                }
                i += 1;
            }
        }
    }
    out
}

/// Where the raw string that begins at an `r` ends.
fn raw_string(s: &[char], r: usize) -> Option<usize> {
    if r > 0 && (s[r - 1].is_alphanumeric() && s[r - 1] != 'b' || s[r - 1] == '_') {
        return None;
    }
    let hashes = s[r + 1..].iter().take_while(|&&c| c == '#').count();
    if s.get(r + 1 + hashes) != Some(&'"') {
        return None;
    }
    let body = r + 2 + hashes;
    let ends = |i: usize| s[i] == '"' && s[i + 1..].iter().take(hashes).filter(|&&c| c == '#').count() == hashes;
    (body..s.len()).find(|&i| ends(i)).map(|i| i + 1 + hashes)
}

/// First segments of every path of the text that starts at the crate's root, and every other crate it names.
#[derive(Default)]
struct Named {
    rooms: BTreeSet<String>,
    crates: BTreeSet<String>,
}

fn named(text: &str, depth: usize) -> Named {
    let t = tokens(text);
    let at = |i: usize| t.get(i).map_or("", String::as_str);
    let mut named = Named::default();
    // Inline modules lie one deeper than the file; each is left where its brace closes.
    let (mut braces, mut modules) = (0usize, Vec::new());
    for i in 0..t.len() {
        match at(i) {
            "{" => {
                braces += 1;
                if i >= 2 && at(i - 2) == "mod" {
                    modules.push(braces);
                }
            }
            "}" => {
                if modules.last() == Some(&braces) {
                    modules.pop();
                }
                braces = braces.saturating_sub(1);
            }
            "crate" | "upthrust" if at(i + 1) == "::" => heads(&t, i + 2, &mut named.rooms),
            "crate" if at(i + 1) == "as" => panic!("`use crate as ...` hides what is imported"),
            "super" if at(i.wrapping_sub(1)) != "::" => {
                let up = (0..).take_while(|k| at(i + 2 * k) == "super" && at(i + 2 * k + 1) == "::").count();
                if up > 0 && up >= depth + modules.len() {
                    heads(&t, i + 2 * up, &mut named.rooms);
                }
            }
            word if at(i.wrapping_sub(1)) != "::" && (at(i + 1) == "::" || at(i.wrapping_sub(1)) == "use") => {
                named.crates.insert(word.to_owned());
            }
            _ => {}
        }
    }
    named
}

/// The first segments of a path or of a group of paths.
fn heads(t: &[String], from: usize, into: &mut BTreeSet<String>) {
    if t[from] != "{" {
        into.insert(t[from].clone());
        return;
    }
    let (mut level, mut first) = (0, true);
    for token in &t[from..] {
        match token.as_str() {
            "{" => level += 1,
            "}" => level -= 1,
            "," => first = level == 1 || first,
            head if level == 1 && first => {
                into.insert(head.to_owned());
                first = false;
            }
            _ => {}
        }
        if level == 0 {
            return;
        }
    }
}

/// Which room imports which, the crate's own two files left out.
fn graph(sources: &[Source]) -> BTreeMap<usize, BTreeSet<usize>> {
    let rank = |room: &str| ROOMS.iter().position(|&known| known == room);
    let mut graph = BTreeMap::new();
    for source in sources.iter().filter(|source| source.depth > 0) {
        let own = rank(&source.room).unwrap_or_else(|| panic!("{}: no such room", source.path.display()));
        let edges: &mut BTreeSet<usize> = graph.entry(own).or_default();
        for room in named(&source.text, source.depth).rooms {
            let to = rank(&room).unwrap_or_else(|| panic!("{}: imports '{room}', no room", source.path.display()));
            if to != own {
                edges.insert(to);
            }
        }
    }
    graph
}

#[test]
fn imports_go_one_way() {
    let mut wrong = Vec::new();
    for source in sources() {
        let own = ROOMS.iter().position(|&room| room == source.room);
        for room in named(&source.text, source.depth).rooms {
            let to = ROOMS.iter().position(|&known| known == room);
            let stages = STAGE_ROOMS.contains(&room.as_str()) && STAGE_ROOMS.contains(&source.room.as_str());
            if own < to || to.is_none() || own.is_none() || stages && own != to {
                wrong.push(format!("{}: imports {room}", source.path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "a room imports only rooms before it, stages none of each other:\n{}", wrong.join("\n"));
}

#[test]
fn large_dependencies_stay_in_their_rooms() {
    let mut wrong = Vec::new();
    for source in sources() {
        let named = named(&source.text, source.depth).crates;
        for (name, homes) in CONFINED {
            if named.contains(name) && !homes.contains(&source.room.as_str()) {
                wrong.push(format!("{}: names {name}, which belongs to {homes:?}", source.path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn files_are_short_and_rooms_say_what_they_own() {
    let mut wrong = Vec::new();
    for source in sources() {
        let lines = source.text.lines().count();
        if lines > MOST_LINES {
            wrong.push(format!("{}: {lines} lines, at most {MOST_LINES}", source.path.display()));
        }
        if !source.text.starts_with("//! ") {
            wrong.push(format!("{}: does not open with //!", source.path.display()));
        }
        let name = source.path.file_stem().unwrap().to_str().unwrap();
        if ["util", "utils", "helper", "helpers", "common", "misc"].contains(&name) {
            wrong.push(format!("{}: says nothing of what is in it", source.path.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_crate_page_names_every_room() {
    let text = std::fs::read_to_string(root().join("src/lib.rs")).unwrap();
    let sources = sources();
    let rooms: BTreeSet<&str> = sources.iter().filter(|s| s.depth > 0).map(|s| s.room.as_str()).collect();
    for room in rooms {
        assert!(text.contains(&format!("pub mod {room};")), "src/lib.rs does not declare {room}");
        assert!(text.contains(&format!("[`{room}`]")) || text.contains(&format!("`{room}`")), "it is silent on {room}");
    }
    assert!(!text.contains("fn "), "src/lib.rs has no logic");
}

/// Every import in a table.
fn table(graph: &BTreeMap<usize, BTreeSet<usize>>) -> String {
    let mut lines = vec!["```text".to_owned()];
    for (&room, edges) in graph {
        let names: Vec<&str> = edges.iter().map(|&to| ROOMS[to]).collect();
        lines.push(format!("{:<10} {}", ROOMS[room], if names.is_empty() { "-".into() } else { names.join(" ") }));
    }
    lines.push("```".to_owned());
    lines.join("\n")
}

/// The same drawn, without the arrows that follow from others.
fn drawing(graph: &BTreeMap<usize, BTreeSet<usize>>) -> String {
    fn reaches(graph: &BTreeMap<usize, BTreeSet<usize>>, from: usize, to: usize) -> bool {
        graph.get(&from).is_some_and(|edges| edges.iter().any(|&next| next == to || reaches(graph, next, to)))
    }
    let mut lines = vec!["```mermaid".to_owned(), "graph BT".to_owned()];
    for (&room, edges) in graph {
        let needed = edges.iter().filter(|&&to| !edges.iter().any(|&by| by != to && reaches(graph, by, to)));
        lines.extend(needed.map(|&to| format!("    {} --> {}", ROOMS[room], ROOMS[to])));
    }
    lines.push("```".to_owned());
    lines.join("\n")
}

#[test]
fn the_drawn_import_graph_is_the_real_one() {
    let page = std::fs::read_to_string(root().join("docs/architecture.md")).unwrap_or_default();
    let graph = graph(&sources());
    let blocks = [drawing(&graph), table(&graph)];
    let current = blocks.iter().all(|block| page.contains(block.as_str()));
    assert!(current, "docs/architecture.md is not current; its blocks are now:\n\n{}\n", blocks.join("\n\n"));
}

#[test]
fn the_reader_of_sources_finds_what_it_should() {
    let text = r##"
        // use crate::comment;
        /* crate::block /* crate::nested */ crate::block */
        use crate::{grid::{Field, Grid}, noise, world as w};
        use super::process::Step;
        use tiny_skia::Mask;
        const S: &str = "crate::string \" crate::string";
        const R: &str = r#"crate::raw " crate::raw"#;
        fn f<'a>(c: char) -> bool { c == '"' && c == '\'' && crate::flow::ok::<'a>() }
        mod tests { use super::*; use super::super::rmp; use super::super::super::nothing; }
        fn g() { super::sibling(); eframe::egui::f(); std::fs::read(wgpu::X); }
    "##;
    let found = named(text, 1);
    let rooms: Vec<&str> = found.rooms.iter().map(String::as_str).collect();
    assert_eq!(rooms, ["flow", "grid", "noise", "nothing", "process", "rmp", "sibling", "world"]);
    let deeper = named(text, 2);
    assert!(!deeper.rooms.contains("process") && deeper.rooms.contains("nothing"));
    assert!(["tiny_skia", "wgpu", "eframe", "std"].iter().all(|name| found.crates.contains(*name)));
    assert!(!found.crates.contains("egui") && !found.crates.contains("crate"));
}
