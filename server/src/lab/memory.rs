//! Memory of a joint's servo, read between runs.

use super::{Answer, Lab, LabError};
use crate::view::{MemoryVariable, ServoMemory};
use jointbench_devices::protocol::puma::Status;
use jointbench_devices::protocol::puma::memory::{self, Form, Variable};

impl Lab {
    /// All variables, or the data at one address. It sends no motion commands, and no run can start during the read.
    pub async fn servo_memory(&self, bench: &str, address: Option<u8>) -> Answer<ServoMemory> {
        let wanted = wanted(address)?;
        let ranges = wanted.iter().map(|variable| (variable.address, variable.bytes)).collect();
        let bench = self.handle(bench)?;
        self.wait_for_stored_ends(bench).await;
        let read = bench.read_memory(ranges).await?;
        let variables = wanted.iter().zip(read).map(|(variable, bytes)| shown(variable, bytes)).collect();
        Ok(ServoMemory { variables })
    }
}

fn wanted(address: Option<u8>) -> Answer<Vec<Variable>> {
    match address {
        None => Ok(memory::variables().copied().collect()),
        Some(address) if address > memory::LAST => Err(LabError::Invalid(format!(
            "address {address:#04X}: the memory ends at {:#04X}; give an address up to there",
            memory::LAST
        ))),
        Some(address) => Ok(vec![memory::at(address).copied().unwrap_or(Variable {
            address,
            bytes: 1,
            name: "(unused)",
            form: Form::Bits,
            unit: "",
            meaning: "No variable of table 2.7",
        })]),
    }
}

fn shown(variable: &Variable, bytes: Vec<u8>) -> MemoryVariable {
    let value = variable.value(&bytes);
    let digits = || bytes.iter().rev().map(|byte| format!("{byte:02X}")).collect::<String>();
    let shown = match (variable.form, value) {
        (_, Some(value)) if variable.address == 0 => {
            let status = Status(value as u16);
            let states: Vec<String> = status.states().into_iter().map(str::to_owned).chain(status.errors()).collect();
            format!("0x{} {}", digits(), states.join(", ")).trim_end().to_owned()
        }
        (Form::Bits, _) => format!("0x{}", digits()),
        (_, Some(value)) => format!("{} {}", (1e3 * value).round() / 1e3, variable.unit).trim_end().to_owned(),
        (_, None) => String::new(),
    };
    let Variable { address, name, unit, meaning, .. } = *variable;
    MemoryVariable {
        address,
        name: name.to_owned(),
        bytes,
        value,
        shown,
        unit: unit.to_owned(),
        meaning: meaning.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_shown_by_their_form() {
        let show = |address, bytes: &[u8]| shown(&wanted(Some(address)).unwrap()[0], bytes.to_vec()).shown;
        assert_eq!(show(0x01, &[0x0D, 0x00]), "0x000D position mode, arm power, in position");
        assert_eq!(show(0x06, &[0x20]), "32 ticks");
        assert_eq!(show(0x13, &[0x80, 0xFE, 0xFF]), "-1.5 counts");
        assert_eq!(show(0x1B, &[0x0D, 0x00]), "0x000D");
        assert_eq!(show(0x20, &[0; 32]), "");
        assert_eq!(show(0x40, &[0xAB]), "0xAB");
        assert!(matches!(wanted(Some(0x80)), Err(LabError::Invalid(why)) if why.contains("0x7F")));
    }
}
