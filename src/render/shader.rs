//! Shaders by name: an entry point a file under `shaders/`, code that several share under `shaders/lib/`. A line
//! `#import NAME` stands for a file of the library, which is taken in once.

use wgpu::ShaderModule;

use super::Gpu;

macro_rules! sources {
    ($folder:literal: $($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../shaders/", $folder, $name, ".wgsl")))),*]
    };
}

/// Files of the library.
const LIBRARY: &[(&str, &str)] = sources!("lib/":
    "frame", "noise", "sky", "ground", "light", "splat", "haze", "lens", "bright", "waves", "mirror", "water", "river", "fire",
    "noise3",
);

/// Entry points.
pub(super) const ENTRIES: &[(&str, &str)] = sources!("":
    "cover", "hillshade", "ground_vertex", "ground", "side_vertex", "side", "backdrop",
    "sea_vertex", "sea", "sea_side_vertex", "sea_side", "lake_vertex", "lake", "shrink", "spread", "tone",
    "lump_vertex", "lump", "lump_smooth", "lava", "ball", "smoke_vertex", "smoke",
    "distance", "distance_many", "shafts", "soften",
);

/// The whole text of an entry.
pub(super) fn source(name: &str) -> String {
    // What is not there fails where it is compiled.
    let text = ENTRIES.iter().find(|(known, _)| *known == name).map_or("", |(_, text)| text);
    expanded(text)
}

/// A text with its imports.
pub(super) fn expanded(text: &'static str) -> String {
    let mut out = String::new();
    expand(text, &mut Vec::new(), &mut out);
    out
}

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
        self.compile(name, source(name))
    }

    /// A compiled shader of this text.
    pub(super) fn compile(&self, name: &str, text: String) -> ShaderModule {
        self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::frame::Frame;
    use naga::{TypeInner, front::wgsl, valid};
    use std::mem::offset_of;

    fn module(text: &str) -> naga::Module {
        wgsl::parse_str(text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)))
    }

    /// Without any adapter: every shader is right, and has one entry point, called `main`.
    #[test]
    fn every_shader_is_valid() {
        for (name, _) in ENTRIES {
            let module = module(&source(name));
            let mut validator = valid::Validator::new(valid::ValidationFlags::all(), valid::Capabilities::default());
            validator.validate(&module).unwrap_or_else(|e| panic!("{name}: {e:?}"));
            let entries: Vec<_> = module.entry_points.iter().map(|entry| entry.name.as_str()).collect();
            assert_eq!(entries, ["main"], "{name}");
        }
    }

    /// Every file under `shaders/` is known, so that none is forgotten here.
    #[test]
    fn every_file_is_listed() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
        for (folder, list) in [(folder.join("lib"), LIBRARY), (folder, ENTRIES)] {
            for file in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
                if file.extension().is_some_and(|end| end == "wgsl") {
                    let name = file.file_stem().unwrap().to_str().unwrap();
                    assert!(list.iter().any(|(known, _)| *known == name), "{name} is not listed");
                }
            }
        }
    }

    #[test]
    fn the_frame_lies_in_memory_as_the_shader_reads_it() {
        let text = source("backdrop");
        let module = module(&text);
        let (_, frame) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some("Frame")).unwrap();
        let TypeInner::Struct { members, span } = &frame.inner else { panic!("no struct") };
        assert_eq!(*span as usize, size_of::<Frame>());
        macro_rules! same {
            ($($field:ident),* $(,)?) => {{
                let ours = [$((stringify!($field), offset_of!(Frame, $field))),*];
                let theirs: Vec<_> = members.iter().map(|m| (m.name.as_deref().unwrap(), m.offset as usize)).collect();
                assert_eq!(theirs, ours);
            }};
        }
        same!(
            view_projection,
            from_picture,
            eye,
            toward,
            light,
            sun,
            moon,
            ambient,
            map,
            haze,
            air,
            picture,
            cover,
            cover2,
            bands,
            water,
            dark,
            shallow,
            bloom,
            rays,
            inland,
            lava,
            heat
        );
    }
}
