//! The adapter: opened without a window, and asked for what went wrong instead of letting it end the program.

use wgpu::{Adapter, Device, ErrorFilter, Extent3d, Queue, Texture, TextureFormat, TextureUsages};

use super::RenderError;
use crate::grid::{Field, Grid};

/// An open graphics adapter.
pub struct Gpu {
    pub(super) device: Device,
    pub(super) queue: Queue,
    name: String,
}

impl Gpu {
    /// Opens the strongest adapter there is; Mesa's software one counts.
    pub fn open() -> Result<Self, RenderError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options)).map_err(|_| RenderError::NoAdapter)?;
        Self::device(&adapter)
    }

    fn device(adapter: &Adapter) -> Result<Self, RenderError> {
        let info = adapter.get_info();
        let name = format!("{} ({})", info.name, info.backend);
        // All that the adapter can: large worlds need large textures.
        let wanted = wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() };
        let opened = pollster::block_on(adapter.request_device(&wanted));
        let (device, queue) =
            opened.map_err(|e| RenderError::NoDevice { adapter: name.clone(), cause: e.to_string() })?;
        Ok(Self { device, queue, name })
    }

    /// A device that somebody else opened, as a window does.
    pub fn wrap(device: Device, queue: Queue, name: String) -> Self {
        Self { device, queue, name }
    }

    /// The adapter and the interface it is reached by.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Refuses a grid that its textures cannot hold.
    pub(super) fn check_size(&self, grid: &Grid) -> Result<(), RenderError> {
        let most = self.device.limits().max_texture_dimension_2d;
        if grid.width.max(grid.height) <= most as usize {
            return Ok(());
        }
        let adapter = self.name.clone();
        Err(RenderError::TooLarge { width: grid.width, height: grid.height, adapter, most })
    }

    pub(super) fn failed(&self, cause: impl ToString) -> RenderError {
        RenderError::Failed { adapter: self.name.clone(), cause: cause.to_string() }
    }

    /// Does work on the device; what the driver complains of becomes an error.
    pub(super) fn checked<T>(&self, work: impl FnOnce() -> Result<T, RenderError>) -> Result<T, RenderError> {
        let scopes = [ErrorFilter::Internal, ErrorFilter::OutOfMemory, ErrorFilter::Validation]
            .map(|filter| self.device.push_error_scope(filter));
        let done = work();
        // The last opened is closed first; the first complaint is the one to tell.
        let complaints = scopes.into_iter().rev().filter_map(|scope| pollster::block_on(scope.pop()));
        match complaints.collect::<Vec<_>>().first() {
            Some(complaint) => Err(self.failed(complaint)),
            None => done,
        }
    }

    /// A texture of one number a cell.
    pub(super) fn texture(&self, grid: &Grid, label: &str, usage: wgpu::TextureUsages) -> Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: extent(grid),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: TextureFormat::R32Float,
            usage,
            view_formats: &[],
        })
    }

    /// Copies a field into a texture of its size.
    pub(super) fn upload(&self, field: &Field<f32>, texture: &Texture) {
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(field.grid.width as u32 * 4),
            rows_per_image: None,
        };
        let bytes = bytemuck::cast_slice(&field.data);
        self.queue.write_texture(texture.as_image_copy(), bytes, layout, extent(&field.grid));
    }

    /// Reads a texture of one number a cell back.
    pub(super) fn download(&self, texture: &Texture, grid: Grid) -> Result<Field<f32>, RenderError> {
        let bytes = self.read_pixels(texture)?;
        let data = bytes.chunks_exact(4).map(|v| f32::from_ne_bytes([v[0], v[1], v[2], v[3]])).collect();
        Ok(Field { grid, data })
    }
}

impl Gpu {
    /// A texture of a raster and its smaller copies, to be read by shaders.
    pub(super) fn raster<T: bytemuck::Pod>(
        &self,
        label: &str,
        format: TextureFormat,
        copies: &[([usize; 2], Vec<T>)],
    ) -> Texture {
        let [width, height] = copies.first().map_or([1, 1], |(size, _)| *size);
        let size = Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: 1 };
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size,
            mip_level_count: copies.len() as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
            view_formats: &[],
        });
        for (level, (size, data)) in copies.iter().enumerate() {
            self.write(&texture, (level as u32, 0), *size, data);
        }
        texture
    }

    /// Writes a mip level of a layer.
    pub(super) fn write<T: bytemuck::Pod>(
        &self,
        texture: &Texture,
        (level, layer): (u32, u32),
        [width, height]: [usize; 2],
        data: &[T],
    ) {
        let bytes = bytemuck::cast_slice(data);
        let into = wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: level,
            origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
            aspect: wgpu::TextureAspect::All,
        };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some((width * size_of::<T>()) as u32),
            rows_per_image: Some(height as u32),
        };
        let size = Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: 1 };
        self.queue.write_texture(into, bytes, layout, size);
    }

    /// What a pass draws into.
    pub(super) fn target(
        &self,
        label: &str,
        [width, height]: [u32; 2],
        format: TextureFormat,
        samples: u32,
    ) -> Texture {
        let more = match (samples, format.is_depth_stencil_format()) {
            (1, _) => TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC,
            (_, true) => TextureUsages::TEXTURE_BINDING,
            _ => TextureUsages::empty(),
        };
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: Extent3d { width: width.max(1), height: height.max(1), depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: TextureUsages::RENDER_ATTACHMENT | more,
            view_formats: &[],
        })
    }

    /// A buffer with something in it.
    pub(super) fn buffer<T: bytemuck::Pod>(&self, label: &str, data: &[T], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: (bytes.len() as u64).next_multiple_of(4).max(4),
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }

    /// Reads the bytes of a texture back, row by row.
    pub(super) fn read_pixels(&self, texture: &Texture) -> Result<Vec<u8>, RenderError> {
        let (width, height) = (texture.width() as usize, texture.height() as usize);
        let tight = width * texture.format().block_copy_size(None).unwrap_or(4) as usize;
        let padded = tight.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: (padded * height) as u64,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded as u32), rows_per_image: None };
        let into = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(texture.as_image_copy(), into, texture.size());
        self.queue.submit([encoder.finish()]);
        let (tell, hear) = std::sync::mpsc::channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |mapped| {
            let _ = tell.send(mapped);
        });
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| self.failed(e))?;
        hear.recv().map_err(|e| self.failed(e))?.map_err(|e| self.failed(e))?;
        let bytes = buffer.get_mapped_range(..).map_err(|e| self.failed(e))?;
        Ok(bytes.chunks_exact(padded).flat_map(|row| row[..tight].iter().copied()).collect())
    }
}

fn extent(grid: &Grid) -> Extent3d {
    Extent3d { width: grid.width as u32, height: grid.height as u32, depth_or_array_layers: 1 }
}
