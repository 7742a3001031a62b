//! OpenEXR with 32-bit floating point: one channel `Y`, which Blender and Godot show as gray, or `R`, `G`, `B`.

use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, LineOrder, SmallVec, WritableImage,
};

use super::{Layout, Out, Raster, Samples};

pub(super) fn encode(raster: &Raster, _: Layout, out: &mut Out) -> Result<(), String> {
    let Samples::F32(values) = &raster.samples else { return Err("OpenEXR is written in floating point".into()) };
    let names: &[&str] = match raster.channels {
        1 => &["Y"],
        3 => &["R", "G", "B"],
        other => return Err(format!("OpenEXR is not written with {other} channels")),
    };
    let channel = |(i, name): (usize, &&str)| {
        let samples: Vec<f32> = values.iter().skip(i).step_by(names.len()).copied().collect();
        AnyChannel::new(*name, FlatSamples::F32(samples))
    };
    let channels: SmallVec<_> = names.iter().enumerate().map(channel).collect();
    // Scan lines and ZIP are what every reader understands.
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let size = (raster.lattice.width, raster.lattice.height);
    Image::from_encoded_channels(size, encoding, AnyChannels::sort(channels))
        .write()
        .non_parallel()
        .to_buffered(out)
        .map_err(|e| e.to_string())
}
