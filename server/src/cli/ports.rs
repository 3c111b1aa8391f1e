//! `jointbench ports`.

use super::exit::{Done, Exit};
use super::print::json_out;
use clap::Args;
use jointbench_devices::transport::{FoundPort, ports as found_ports};

#[derive(Debug, Args)]
pub struct Ports {
    /// One JSON array instead of a table
    #[arg(long)]
    pub json: bool,
}

pub fn ports(arguments: &Ports) -> Done {
    let found = found_ports().map_err(|fault| Exit::failed(format!("the ports cannot be listed: {fault}")))?;
    if arguments.json {
        json_out(&found)?;
    } else if found.is_empty() {
        println!("no serial port found: connect an instrument; network instruments are tcp://host:port in bench.toml");
    } else {
        found.iter().for_each(|port| println!("{}", line(port)));
    }
    Ok(())
}

/// One port: path, device, permission, and its permanent address.
fn line(port: &FoundPort) -> String {
    let mark = if port.closed.is_some() { "closed" } else { "ok    " };
    let usb = port.usb.as_ref().map(|usb| {
        let names = [usb.maker.as_deref(), usb.product.as_deref()].into_iter().flatten().collect::<Vec<_>>().join(" ");
        format!("{:04X}:{:04X} {names}", usb.vendor_id, usb.product_id)
    });
    let mut line = format!("{mark}  {:<16} {}", port.address.to_string(), usb.as_deref().unwrap_or("not a USB device"));
    if let Some(likely) = port.likely {
        line.push_str(&format!("\n        probably a {likely}"));
    }
    if let Some(lasting) = &port.lasting_address {
        line.push_str(&format!("\n        in bench.toml, independent of the USB socket: port = \"{lasting}\""));
    }
    if let Some(why) = &port.closed {
        line.push_str(&format!("\n        {why}"));
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_devices::Address;
    use jointbench_devices::transport::UsbDevice;

    #[test]
    fn a_port_without_permission_shows_reason_and_name() {
        let usb = UsbDevice {
            vendor_id: 0x10C4,
            product_id: 0x8056,
            serial_number: Some("L7".into()),
            maker: Some("Lorenz".into()),
            product: None,
        };
        let port = FoundPort {
            address: Address::from("/dev/ttyUSB1"),
            lasting_address: Some(Address::Usb("L7".into())),
            usb: Some(usb),
            likely: Some("torque sensor (Lorenz)"),
            closed: Some("in use by screen (process 7); end it first".into()),
        };
        let text = line(&port);
        for part in [
            "closed  /dev/ttyUSB1",
            "10C4:8056 Lorenz",
            "probably a torque sensor",
            "port = \"usb://L7\"",
            "end it first",
        ] {
            assert!(text.contains(part), "{part:?} in {text}");
        }
    }
}
