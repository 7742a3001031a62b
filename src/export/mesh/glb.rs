//! Binary glTF 2.0: each level of detail is a mesh `terrain_LOD0`, `terrain_LOD1` ... with positions, normals and colours.
//!
//! Every level has a scene of its own, the finest one being the scene that is shown, so that levels do not lie over each
//! other in viewers that know nothing of them.

use std::io::{self, Write};

use serde_json::{Value as Json, json};

use super::{COARSEST, Lattice, MeshOptions, ground, put, to_scale};
use crate::{export::ExportError, relief, world::World};

/// Bytes of a position, a normal, a colour (four 16-bit shares), an index.
const BYTES: [usize; 4] = [12, 12, 8, 4];
// Codes of the specification (Khronos glTF 2.0, chapters 3.6 and 5.1).
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Writes the ground as a `.glb`.
pub fn write_glb(world: &World, options: &MeshOptions, out: &mut impl Write) -> Result<(), ExportError> {
    let ground = ground(world)?;
    let levels = levels(&ground, options);
    let mut text = describe(&levels).to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let binary: usize = levels.iter().map(|level| sizes(level).iter().sum::<usize>()).sum();
    // Header, then two chunks with a length and a kind each.
    let whole = 12 + 8 + text.len() + 8 + binary;
    for word in [u32::from_le_bytes(*b"glTF"), 2, whole as u32, text.len() as u32] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    out.write_all(&(binary as u32).to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    let colour = relief::tints(world);
    let metres = options.metres_per_unit / options.exaggeration.unwrap_or(1.0);
    for level in &levels {
        write_level(level, |height| colour((height as f64 * metres) as f32), out)?;
    }
    Ok(())
}

/// The finest lattice first.
fn levels(ground: &crate::grid::Field<f32>, options: &MeshOptions) -> Vec<Lattice> {
    let finest = to_scale(ground, options, options.size);
    let steps = finest.width.max(finest.height) - 1;
    let mut levels = vec![finest];
    for level in 1..options.levels {
        let size = (steps >> level) + 1;
        if size < COARSEST {
            break;
        }
        levels.push(to_scale(ground, options, size));
    }
    levels
}

/// Bytes of a level's positions, normals, colours and indices.
fn sizes(level: &Lattice) -> [usize; 4] {
    let points = level.points();
    [points * BYTES[0], points * BYTES[1], points * BYTES[2], level.triangles() * 3 * BYTES[3]]
}

fn describe(levels: &[Lattice]) -> Json {
    let (mut views, mut accessors, mut meshes, mut nodes, mut scenes) = (vec![], vec![], vec![], vec![], vec![]);
    let mut offset = 0;
    for (number, level) in levels.iter().enumerate() {
        let name = format!("terrain_LOD{number}");
        let first = accessors.len();
        for (which, bytes) in sizes(level).into_iter().enumerate() {
            let target = if which == 3 { ELEMENT_ARRAY_BUFFER } else { ARRAY_BUFFER };
            views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes, "target": target }));
            offset += bytes;
            let mut accessor = match which {
                0 | 1 => json!({ "componentType": FLOAT, "type": "VEC3" }),
                2 => json!({ "componentType": UNSIGNED_SHORT, "normalized": true, "type": "VEC4" }),
                _ => json!({ "componentType": UNSIGNED_INT, "type": "SCALAR" }),
            };
            accessor["bufferView"] = json!(first + which);
            accessor["count"] = json!(if which == 3 { level.triangles() * 3 } else { level.points() });
            if which == 0 {
                let [low, high] = bounds(level);
                accessor["min"] = json!(low);
                accessor["max"] = json!(high);
            }
            accessors.push(accessor);
        }
        let attributes = json!({ "POSITION": first, "NORMAL": first + 1, "COLOR_0": first + 2 });
        let primitive = json!({ "attributes": attributes, "indices": first + 3, "material": 0 });
        meshes.push(json!({ "name": name, "primitives": [primitive] }));
        nodes.push(json!({ "name": name, "mesh": number }));
        scenes.push(json!({ "name": name, "nodes": [number] }));
    }
    let rough = json!({ "metallicFactor": 0.0, "roughnessFactor": 1.0 });
    json!({
        "asset": { "version": "2.0", "generator": concat!("Upthrust ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": scenes,
        "nodes": nodes,
        "meshes": meshes,
        "materials": [{ "name": "terrain", "pbrMetallicRoughness": rough }],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": offset }],
    })
}

/// Least and greatest position.
fn bounds(level: &Lattice) -> [[f32; 3]; 2] {
    let mut low = level.point(0, 0);
    let mut high = level.point(level.width - 1, level.height - 1);
    for &h in &level.heights {
        low[1] = low[1].min(h);
        high[1] = high[1].max(h);
    }
    [low, high]
}

fn write_level(level: &Lattice, colour: impl Fn(f32) -> [f32; 3], out: &mut impl Write) -> io::Result<()> {
    for y in 0..level.height {
        for x in 0..level.width {
            put(out, &level.point(x, y))?;
        }
    }
    for y in 0..level.height {
        for x in 0..level.width {
            put(out, &level.normal(x, y))?;
        }
    }
    for &height in &level.heights {
        let [r, g, b] = colour(height).map(|v| (v.clamp(0.0, 1.0) * 65535.0 + 0.5) as u16);
        for share in [r, g, b, u16::MAX] {
            out.write_all(&share.to_le_bytes())?;
        }
    }
    level.each_triangle(|corners| corners.iter().try_for_each(|&i| out.write_all(&(i as u32).to_le_bytes())))
}
