//! Where tensors live: the processor, or a GPU where one is built in and at hand.

use crate::error::SettingError;
use burn_tensor::Device;

/// Names that settings may give in this build.
pub const NAMES: &[&str] = &[
    "cpu",
    #[cfg(feature = "cuda")]
    "cuda",
    #[cfg(feature = "wgpu")]
    "wgpu",
];

/// The device that a name stands for, without gradients.
pub fn named(name: &str) -> Result<Device, SettingError> {
    match name {
        "cpu" => Ok(Device::flex()),
        #[cfg(feature = "cuda")]
        "cuda" => at_hand(name, burn_tensor::DeviceType::Cuda, Device::cuda(0)),
        #[cfg(feature = "wgpu")]
        "wgpu" => {
            let best = Device::wgpu(burn_tensor::DeviceKind::DefaultDevice);
            at_hand(name, burn_tensor::DeviceType::Wgpu, best)
        }
        _ => {
            let allowed = format!("one of those built in: {}", NAMES.join(", "));
            Err(SettingError::value("device", name, allowed))
        }
    }
}

/// Asks first, because tensors on a device that is missing panic.
#[cfg(any(feature = "cuda", feature = "wgpu"))]
fn at_hand(
    name: &str,
    kind: burn_tensor::DeviceType,
    device: Device,
) -> Result<Device, SettingError> {
    if Device::enumerate(kind).into_vec().is_empty() {
        let allowed = "cpu, as no such device, or no driver for it, is on this machine";
        return Err(SettingError::value("device", name, allowed));
    }
    Ok(device)
}

/// What a device calls itself.
pub fn title(device: &Device) -> String {
    #[cfg(any(feature = "cuda", feature = "wgpu"))]
    if let Some(identity) = device.identity() {
        return identity.name;
    }
    let _ = device;
    "processor".into()
}
