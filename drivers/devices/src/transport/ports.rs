//! The serial ports of this computer: connected devices, and why a port may not be opened. Opens none of them, because
//! opening can reset an instrument.

use super::Address;
use jointbench_instrument::FaultKind;
use serde::Serialize;
use serialport::{SerialPortType, available_ports};
#[cfg(unix)]
use std::path::PathBuf;

/// The description that a USB device gives of itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct UsbDevice {
    /// Number of the vendor, assigned by the USB Implementers Forum.
    pub vendor_id: u16,
    /// Number of the product, assigned by the vendor.
    pub product_id: u16,
    /// Serial number of the device.
    pub serial_number: Option<String>,
    /// Name of the maker.
    pub maker: Option<String>,
    /// Name of the product.
    pub product: Option<String>,
}

/// A port that exists, usable or not.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FoundPort {
    /// Address with which the port can be opened.
    pub address: Address,
    /// The address that stays the same in another socket: `usb://` and the serial number.
    pub lasting_address: Option<Address>,
    /// `None`: the port is not that of a USB device.
    pub usb: Option<UsbDevice>,
    /// The usual instrument with this vendor and product on such a bench.
    pub likely: Option<&'static str>,
    /// Why the port cannot be opened, and the remedy. `None`: no obstacle is known.
    pub closed: Option<String>,
}

/// Vendor, product (`None`: any), instrument.
const KNOWN: [(u16, Option<u16>, &str); 4] = [
    (0x10C4, Some(0x8056), "torque sensor (Lorenz)"),
    (0x1209, Some(0x0D32), "joint controller (ODrive)"),
    (0x1AB1, None, "current source (Rigol)"),
    (0x0403, None, "quadrature counter (QSB), or another instrument behind an FTDI converter"),
];

/// Every serial port of this computer, by name.
pub fn ports() -> Result<Vec<FoundPort>, FaultKind> {
    let mut found = available_ports().map_err(|error| FaultKind::NotOpened { what: error.to_string() })?;
    found.sort_by(|a, b| a.port_name.cmp(&b.port_name));
    let port = |info: serialport::SerialPortInfo| {
        let usb = match info.port_type {
            SerialPortType::UsbPort(usb) => Some(UsbDevice {
                vendor_id: usb.vid,
                product_id: usb.pid,
                serial_number: usb.serial_number,
                maker: usb.manufacturer,
                product: usb.product,
            }),
            _ => None,
        };
        let likely = usb.as_ref().and_then(|usb| {
            let is = |(vendor, product, _): &&(u16, Option<u16>, &str)| {
                *vendor == usb.vendor_id && product.is_none_or(|product| product == usb.product_id)
            };
            KNOWN.iter().find(is).map(|(.., what)| *what)
        });
        FoundPort {
            lasting_address: usb.as_ref().and_then(|usb| usb.serial_number.clone()).map(Address::Usb),
            closed: why_closed(&info.port_name),
            address: Address::Serial(info.port_name),
            usb,
            likely,
        }
    };
    Ok(found.into_iter().map(port).collect())
}

/// Present path of the device with this serial number.
pub(super) fn path_of(serial_number: &str) -> Result<String, FaultKind> {
    let not_opened = |what: String| FaultKind::NotOpened { what };
    let ports = available_ports().map_err(|error| not_opened(error.to_string()))?;
    let wanted = |info: &&serialport::SerialPortInfo| match &info.port_type {
        SerialPortType::UsbPort(usb) => usb.serial_number.as_deref() == Some(serial_number),
        _ => false,
    };
    match ports.iter().filter(wanted).collect::<Vec<_>>()[..] {
        [info] => Ok(info.port_name.clone()),
        [] => {
            Err(not_opened(format!("no USB device with the serial number {serial_number}; check that it is connected")))
        }
        [..] => Err(not_opened(format!("several USB ports with the serial number {serial_number}: name the port"))),
    }
}

/// Why the port at `path` cannot be opened, without opening it. `None`: no obstacle is known.
#[cfg(unix)]
pub fn why_closed(path: &str) -> Option<String> {
    use rustix::fs::{Access, access};
    use rustix::io::Errno;
    use std::os::unix::fs::MetadataExt;
    match access(path, Access::READ_OK | Access::WRITE_OK) {
        Ok(()) => {}
        Err(Errno::ACCESS) => {
            let group = std::fs::metadata(path).map(|port| format!(" (number {})", port.gid())).unwrap_or_default();
            return Some(format!(
                "permission denied; add the user to the group that owns the port{group}, and log in again"
            ));
        }
        Err(Errno::NOENT) => return Some("not found; check that it is connected".into()),
        Err(error) => return Some(error.to_string()),
    }
    user_of(path).map(|user| format!("in use by {user}; end that program first"))
}

#[cfg(not(unix))]
pub fn why_closed(_path: &str) -> Option<String> {
    None
}

/// A process that has the port open, if the system reports it (Linux: only for the user's own processes).
#[cfg(unix)]
fn user_of(path: &str) -> Option<String> {
    let path = std::fs::canonicalize(path).ok()?;
    let processes = std::fs::read_dir("/proc").ok()?.flatten().map(|process| process.path());
    let is_process = |path: &PathBuf| path.file_name().is_some_and(|name| name.as_encoded_bytes()[0].is_ascii_digit());
    let holder = processes.filter(is_process).find(|process| {
        let open = std::fs::read_dir(process.join("fd")).into_iter().flatten().flatten();
        open.into_iter().any(|file| std::fs::read_link(file.path()).is_ok_and(|target| target == path))
    })?;
    let name = std::fs::read_to_string(holder.join("comm")).unwrap_or_default();
    Some(format!("{} (process {})", name.trim(), holder.file_name()?.display()))
}
