//! Shaders by name: an entry point a file under `shaders/`, code that several share under `shaders/lib/`. A line
//! `#import NAME` stands for a file of the library, which is taken in once.

use wgpu::ShaderModule;

use super::Gpu;

macro_rules! sources {
    ($folder:literal: $($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../shaders/", $folder, $name, ".wgsl")))),*]
    };
}

/// What is imported.
const LIBRARY: &[(&str, &str)] = sources!("lib/": "frame", "noise", "sky", "ground", "light", "splat", "haze", "lens", "bright");

/// What is run.
pub(super) const ENTRIES: &[(&str, &str)] = sources!("":
    "cover", "hillshade", "ground_vertex", "ground", "side_vertex", "side", "backdrop",
    "sea_vertex", "sea", "shrink", "spread", "tone",
);

/// The whole text of an entry.
pub(super) fn source(name: &str) -> String {
    // What is not there fails where it is compiled.
    let text = ENTRIES.iter().find(|(known, _)| *known == name).map_or("", |(_, text)| text);
    if let Ok(dir) = std::env::var("LIVE_SHADERS") { return live(&dir, name); } // DEV-ONLY
    let mut out = String::new();
    let mut taken = Vec::new();
    expand(text, &mut taken, &mut out);
    out
}

// DEV-ONLY
fn live(dir: &str, name: &str) -> String { // DEV-ONLY
    fn go(dir: &str, path: String, taken: &mut Vec<String>, out: &mut String) { // DEV-ONLY
        for line in std::fs::read_to_string(&path).unwrap().lines() { // DEV-ONLY
            if let Some(n) = line.strip_prefix("#import ") { if !taken.contains(&n.to_string()) { taken.push(n.into()); go(dir, format!("{dir}/lib/{n}.wgsl"), taken, out); } } else { out.push_str(line); out.push('\n'); } // DEV-ONLY
        } // DEV-ONLY
    } // DEV-ONLY
    let mut out = String::new(); go(dir, format!("{dir}/{name}.wgsl"), &mut vec![], &mut out); out // DEV-ONLY
} // DEV-ONLY
fn expand(text: &'static str, taken: &mut Vec<&'static str>, out: &mut String) {
    for line in text.lines() {
        let Some(name) = line.strip_prefix("#import ") else {
            out.push_str(line);
            out.push('\n');
            continue;
        };
        let Some(&(name, text)) = LIBRARY.iter().find(|(known, _)| *known == name.trim()) else { continue };
        if !taken.contains(&name) {
            taken.push(name);
            expand(text, taken, out);
        }
    }
}

impl Gpu {
    /// A compiled shader.
    pub(super) fn shader(&self, name: &str) -> ShaderModule {
        self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(source(name).into()),
        })
    }
}
