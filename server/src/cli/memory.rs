//! `jointbench servo-memory`: reads the memory of a joint's servo.

use super::arguments::ServoMemory as Arguments;
use super::client::Client;
use super::exit::Done;
use super::print::json_out;
use super::run::choose_bench;
use crate::view::{MemoryVariable, ServoMemory};

const HEAD: &str = "address  name      bytes                      value                 meaning";
/// Longer byte sequences are truncated.
const MOST_BYTES: usize = 8;

pub fn memory(arguments: &Arguments) -> Done {
    let client = Client::new(&arguments.reach)?;
    let bench = choose_bench(&client, arguments.bench.as_deref())?;
    let only = arguments.address.map(|address| format!("?address={address}")).unwrap_or_default();
    let memory: ServoMemory = client.get(&format!("/bench/{bench}/servo-memory{only}"))?;
    if arguments.json {
        return json_out(&memory);
    }
    println!("{HEAD}");
    memory.variables.iter().for_each(|variable| println!("{}", line(variable)));
    Ok(())
}

fn line(variable: &MemoryVariable) -> String {
    let MemoryVariable { address, name, bytes, shown, meaning, .. } = variable;
    let digits: Vec<String> = bytes.iter().take(MOST_BYTES).map(|byte| format!("{byte:02X}")).collect();
    let more = if bytes.len() > MOST_BYTES { " …" } else { "" };
    let digits = digits.join(" ") + more;
    format!("0x{address:02X}     {name:8}  {digits:25}  {shown:20}  {meaning}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_holds_address_name_bytes_value_and_meaning() {
        let text = |text: &str| text.to_owned();
        let variable = MemoryVariable {
            address: 6,
            name: text("ninter"),
            bytes: vec![0x20],
            value: Some(32.0),
            shown: text("32 ticks"),
            unit: text("ticks"),
            meaning: text("Clock ticks between set-points"),
        };
        let columns: Vec<String> = line(&variable).split("  ").filter(|part| !part.is_empty()).map(text).collect();
        let columns: Vec<&str> = columns.iter().map(|part| part.trim()).collect();
        assert_eq!(columns, ["0x06", "ninter", "20", "32 ticks", "Clock ticks between set-points"]);
        let buffer = MemoryVariable { bytes: vec![0; 32], ..variable };
        assert!(line(&buffer).contains("00 00 …"), "{}", line(&buffer));
    }
}
