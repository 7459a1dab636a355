//! A device without a window, and a target's pixels on the CPU.

use std::pin::pin;
use std::task::{Context, Poll, Waker};

use eframe::wgpu;

/// Why a picture could not be made on the device.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No driver.
    #[error(
        "no graphics adapter found ({reason}); 3D pictures need Vulkan or OpenGL, which the package \
         mesa-vulkan-drivers brings in software"
    )]
    NoAdapter {
        /// What the adapter search said.
        reason: String,
    },
    /// A driver that gives no device.
    #[error("the graphics adapter {adapter} gives no device: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// What it said.
        reason: String,
    },
    /// A size of zero or beyond reason.
    #[error("a picture of {width} × {height} pixels cannot be made; each side must be 1 to {most}")]
    Size {
        /// Width asked for.
        width: u32,
        /// Height asked for.
        height: u32,
        /// Largest side.
        most: u32,
    },
    /// Reading pixels back failed.
    #[error("the picture could not be read back from the graphics device: {reason}")]
    Read {
        /// What the device said.
        reason: String,
    },
}

/// A device without a window.
pub struct Headless {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Name, backend and driver, for people.
    pub adapter: String,
}

/// Opens a device without a window or display. `WGPU_BACKEND` chooses among drivers.
///
/// # Errors
/// [`GpuError::NoAdapter`] or [`GpuError::NoDevice`].
pub fn headless() -> Result<Headless, GpuError> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = wait(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    let adapter = adapter.map_err(|e| GpuError::NoAdapter { reason: e.to_string() })?;
    let info = adapter.get_info();
    let limits = adapter.limits();
    // No more than WebGL offers, apart from sizes, so that what works here works wherever the explorer does.
    let required_limits = wgpu::Limits {
        max_buffer_size: limits.max_buffer_size,
        ..wgpu::Limits::downlevel_webgl2_defaults().using_resolution(limits)
    };
    let request = adapter.request_device(&wgpu::DeviceDescriptor {
        label: Some("headless"),
        required_limits,
        ..Default::default()
    });
    let (device, queue) = wait(request)
        .map_err(|e| GpuError::NoDevice { adapter: info.name.clone(), reason: e.to_string() })?;
    Ok(Headless {
        device,
        queue,
        adapter: format!("{} ({:?}, {} {})", info.name, info.backend, info.driver, info.driver_info),
    })
}

/// Runs a future to its end. The ones used here are ready at once outside a browser.
fn wait<T>(future: impl Future<Output = T>) -> T {
    let mut future = pin!(future);
    let mut context = Context::from_waker(Waker::noop());
    loop {
        if let Poll::Ready(value) = future.as_mut().poll(&mut context) {
            return value;
        }
        std::hint::spin_loop();
    }
}

/// The pixels of a texture of premultiplied RGBA bytes, as they are, row 0 at the top.
pub(super) fn read(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
) -> Result<Vec<u8>, GpuError> {
    let (width, height) = (texture.width(), texture.height());
    let row = (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("pixels"),
        size: u64::from(row) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None },
        },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
    queue.submit([encoder.finish()]);
    let (done, mapped) = std::sync::mpsc::channel();
    let slice = buffer.slice(..);
    slice.map_async(wgpu::MapMode::Read, move |result| {
        // The receiver waits right below; if it is gone there is nobody to tell.
        let _ = done.send(result);
    });
    let failed = |reason: String| GpuError::Read { reason };
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| failed(e.to_string()))?;
    mapped.recv().map_err(|e| failed(e.to_string()))?.map_err(|e| failed(e.to_string()))?;
    let data = slice.get_mapped_range().map_err(|e| failed(e.to_string()))?;
    let mut pixels = Vec::with_capacity((width * height * 4) as usize);
    for line in data.chunks_exact(row as usize) {
        pixels.extend_from_slice(&line[..(width * 4) as usize]);
    }
    Ok(pixels)
}
