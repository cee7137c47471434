//! Finds and opens a device, and says which one was chosen and why.

use crate::backend::gpu::baker::Baker;
use crate::backend::gpu::driver_probe::Canary;
use crate::base::error::{Error, Result};
use std::fmt;
use std::str::FromStr;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The device that the user asks for.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum DeviceChoice {
    /// The best GPU, else software Vulkan, else the CPU path.
    #[default]
    Auto,
    /// The CPU path, in f64.
    Cpu,
    /// The adapter whose name contains this, whatever its case.
    Named(String),
}

impl FromStr for DeviceChoice {
    type Err = std::convert::Infallible;

    fn from_str(s: &str) -> Result<Self, Self::Err> {
        Ok(match s {
            "auto" => Self::Auto,
            "cpu" => Self::Cpu,
            name => Self::Named(name.into()),
        })
    }
}

/// An adapter, with its name, kind and driver.
#[derive(Debug, Clone)]
pub struct Adapter {
    /// The adapter's description by wgpu.
    pub info: wgpu::AdapterInfo,
    adapter: wgpu::Adapter,
}

/// A device that evaluates tables, opened by gonio or by the caller.
pub struct Device {
    pub(crate) baker: Baker,
    info: wgpu::AdapterInfo,
    owner: Owner,
    pub(crate) canary: OnceLock<Canary>,
}

/// The opener of a device, whose handlers get its errors.
enum Owner {
    /// gonio: its handlers keep the first error here.
    Gonio {
        #[cfg_attr(not(feature = "batch"), allow(dead_code))]
        adapter: Box<Adapter>,
        fault: Arc<Mutex<Option<String>>>,
    },
    /// A caller, whose handlers stay as they are: error scopes catch what gonio causes.
    Caller,
}

/// Lists all adapters that could bake, the best first; none in a build without any back end of wgpu.
pub fn adapters() -> Vec<Adapter> {
    if wgpu::Instance::enabled_backend_features().is_empty() {
        return Vec::new();
    }
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::PRIMARY,
        // No dispatch here is indirect: a device need not compile what would look after those.
        flags: wgpu::InstanceFlags::default() - wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    let mut adapters: Vec<_> =
        adapters.into_iter().map(|adapter| Adapter { info: adapter.get_info(), adapter }).collect();
    adapters.sort_by_key(Adapter::rank);
    adapters
}

impl Adapter {
    /// The rank of the adapter, 0 for the best.
    fn rank(&self) -> u8 {
        match self.info.device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Other => 3,
            wgpu::DeviceType::Cpu => 4,
        }
    }

    /// The kind of the device, for people: `GPU` or `software Vulkan`.
    pub fn kind(&self) -> &'static str {
        kind(&self.info)
    }

    /// The driver and its version.
    pub fn driver(&self) -> String {
        driver(&self.info)
    }

    /// Opens the device, with the limits of every WebGPU device and larger buffers where it has them.
    pub fn open(&self) -> Result<Device> {
        let offered = self.adapter.limits();
        let limits = wgpu::Limits {
            max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size,
            max_buffer_size: offered.max_buffer_size,
            ..wgpu::Limits::default()
        };
        // Stores of 64-bit words are faster on a software device, and on no GPU.
        let wide = match self.info.device_type {
            wgpu::DeviceType::Cpu => wgpu::Features::SHADER_INT64,
            _ => wgpu::Features::empty(),
        };
        // A user's shader may compute in f16, and read textures.
        let user = wgpu::Features::SHADER_F16 | wgpu::Features::FLOAT32_FILTERABLE;
        let wanted = wgpu::Features::SHADER_F64 | user | wide;
        let request = self.adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("gonio"),
            required_features: self.adapter.features() & wanted,
            required_limits: limits,
            ..Default::default()
        });
        let (device, queue) =
            pollster::block_on(request).map_err(|e| Error::Device(format!("{}: {e}", self.info.name)))?;
        let fault = Arc::new(Mutex::new(None));
        let first = fault.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            first.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error.to_string());
        }));
        let lost = fault.clone();
        device.set_device_lost_callback(move |reason, why| {
            let message = format!("the device is lost ({reason:?}) {why}");
            lost.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(message);
        });
        Ok(Device {
            baker: Baker::new(&device, &queue),
            info: self.info.clone(),
            owner: Owner::Gonio { adapter: Box::new(self.clone()), fault },
            canary: OnceLock::new(),
        })
    }
}

impl Device {
    /// Wraps an engine's device and queue, which can then do all that a device opened by gonio can: bake, evaluate points,
    /// check, light.
    ///
    /// The engine's error handlers stay as they are; an error that gonio causes comes back as [`Error::Device`].
    /// Tables in f64 need [`wgpu::Features::SHADER_F64`]; without it the CPU path does them.
    pub fn from_wgpu(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self {
            baker: Baker::new(device, queue),
            info: device.adapter_info(),
            owner: Owner::Caller,
            canary: OnceLock::new(),
        }
    }

    /// Calls `use_device`, and returns an error of the device that it caused as [`Error::Device`].
    pub(crate) fn guarded<T>(&self, use_device: impl FnOnce() -> Result<T>) -> Result<T> {
        if let Owner::Gonio { .. } = self.owner {
            let result = use_device()?;
            self.fault()?;
            return Ok(result);
        }
        self.baker.scoped(use_device)
    }

    /// The device that a choice means; `None` for the CPU path, with the reason in a line.
    ///
    /// # Errors
    /// When a named adapter is not there or cannot be opened.
    pub fn choose(choice: &DeviceChoice) -> Result<(Option<Self>, String)> {
        match choice {
            DeviceChoice::Cpu => Ok((None, "CPU path in f64, as asked".into())),
            DeviceChoice::Auto => {
                let mut failures = Vec::new();
                for adapter in adapters() {
                    match adapter.open() {
                        Ok(device) => {
                            let why = match adapter.kind() {
                                "GPU" => "the best GPU here",
                                _ => "no GPU here, software Vulkan is next",
                            };
                            let line = format!("{device}: {why}");
                            return Ok((Some(device), line));
                        }
                        Err(e) => failures.push(e.to_string()),
                    }
                }
                let why = if failures.is_empty() {
                    "no GPU and no Vulkan driver here".into()
                } else {
                    failures.join("; ")
                };
                Ok((None, format!("fell back to the CPU path in f64: {why}")))
            }
            DeviceChoice::Named(name) => {
                let adapters = adapters();
                let wanted = name.to_lowercase();
                // Every name holds "".
                let fits = |a: &&Adapter| !wanted.is_empty() && a.info.name.to_lowercase().contains(&wanted);
                let found = adapters.iter().find(fits);
                let adapter = found.ok_or_else(|| {
                    let names: Vec<_> = adapters.iter().map(|a| format!("\"{}\"", a.info.name)).collect();
                    Error::Device(if names.is_empty() {
                        format!("no adapter is named \"{name}\": there is none at all. {INSTALL} The device \"cpu\", which is the CPU path, needs none")
                    } else {
                        format!(
                            "no adapter is named \"{name}\"; there are {}, auto and cpu",
                            names.join(", ")
                        )
                    })
                })?;
                let device = adapter.open()?;
                let line = format!("{device}: its name holds \"{name}\"");
                Ok((Some(device), line))
            }
        }
    }

    /// A new device on the same adapter, after this one was lost.
    #[cfg(feature = "batch")]
    pub(crate) fn reopen(&self) -> Result<Self> {
        match &self.owner {
            Owner::Gonio { adapter, .. } => adapter.open(),
            Owner::Caller => Err(Error::Device(format!(
                "{}: the caller's device is lost; hand over a new one",
                self.name()
            ))),
        }
    }

    /// The description of its adapter by wgpu.
    pub fn info(&self) -> &wgpu::AdapterInfo {
        &self.info
    }

    /// The adapter's name.
    pub fn name(&self) -> &str {
        &self.info.name
    }

    /// `GPU` or `software Vulkan`.
    pub fn kind(&self) -> &'static str {
        kind(&self.info)
    }

    /// The driver and its version.
    pub fn driver(&self) -> String {
        driver(&self.info)
    }

    /// Whether its kernels can run in f64.
    pub fn has_f64(&self) -> bool {
        self.baker.device.features().contains(wgpu::Features::SHADER_F64)
    }

    /// The baker on this device.
    pub fn baker(&self) -> &Baker {
        &self.baker
    }

    /// The device and its queue.
    pub fn wgpu(&self) -> (&wgpu::Device, &wgpu::Queue) {
        (&self.baker.device, &self.baker.queue)
    }

    /// The first error that the device reported, if it did.
    pub(crate) fn fault(&self) -> Result<()> {
        let Owner::Gonio { fault, .. } = &self.owner else { return Ok(()) };
        match fault.lock().unwrap_or_else(PoisonError::into_inner).take() {
            Some(fault) => Err(Error::Device(format!("{}: {fault}", self.name()))),
            None => Ok(()),
        }
    }
}

impl Baker {
    /// Calls `use_device`, and returns an error of the device that it caused as [`Error::Device`]. The owner's error handlers
    /// stay as they are, and hear nothing of it.
    pub(crate) fn scoped<T>(&self, use_device: impl FnOnce() -> Result<T>) -> Result<T> {
        let filters =
            [wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Internal];
        let scopes = filters.map(|filter| self.device.push_error_scope(filter));
        let result = use_device();
        let mut fault = None;
        // The last one first, as they are nested.
        for scope in scopes.into_iter().rev() {
            fault = pollster::block_on(scope.pop()).or(fault);
        }
        match fault {
            Some(fault) => Err(Error::Device(format!("{}: {fault}", self.device.adapter_info().name))),
            None => result,
        }
    }
}

/// The remedy where there is no device: how to install a software one.
pub const INSTALL: &str = "Install a Vulkan driver; on Debian, software Vulkan is `apt-get install \
                           mesa-vulkan-drivers libvulkan1`.";

impl fmt::Display for Device {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}, {})", self.name(), self.kind(), self.driver())
    }
}

fn driver(info: &wgpu::AdapterInfo) -> String {
    format!("{} {}", info.driver, info.driver_info).trim().to_string()
}

fn kind(info: &wgpu::AdapterInfo) -> &'static str {
    if info.device_type == wgpu::DeviceType::Cpu { "software Vulkan" } else { "GPU" }
}
