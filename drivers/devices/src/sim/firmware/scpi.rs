//! SCPI program messages: headers with short and long forms, optional nodes, numeric suffixes, chains, parameters.

use std::collections::VecDeque;

/// Entries of the error queue; the last entry of a full queue reports the overflow.
const QUEUE_DEPTH: usize = 20;

/// Bit 0 of the standard event status register.
const OPERATION_COMPLETE: u8 = 1;

/// One node of a header pattern, `[:SOURce#]`: short form, long form, optional, takes a number.
#[derive(Debug)]
struct Node {
    short: String,
    long: String,
    optional: bool,
    numbered: bool,
}

/// A pattern such as `[:SOURce#]:CURRent[:LEVel][:IMMediate][:AMPLitude]`.
#[derive(Debug)]
pub struct Pattern(Vec<Node>);

impl Pattern {
    pub fn new(text: &str) -> Self {
        let nodes = text.split(':').map(|part| part.trim_matches(['[', ']'])).filter(|part| !part.is_empty());
        let optional = text.split(':').scan(text.starts_with('['), |next, part| {
            let this = std::mem::replace(next, part.ends_with('['));
            Some((part, this))
        });
        let optional: Vec<bool> =
            optional.filter(|(part, _)| !part.trim_matches(['[', ']']).is_empty()).map(|(_, this)| this).collect();
        let node = |(part, optional): (&str, bool)| {
            let name = part.trim_end_matches('#');
            let short: String = name.chars().filter(|c| !c.is_ascii_lowercase()).collect();
            Node { short, long: name.to_ascii_uppercase(), optional, numbered: part.ends_with('#') }
        };
        Self(nodes.zip(optional).map(node).collect())
    }

    /// The numeric suffixes in order, if the header matches this command.
    pub fn matches(&self, header: &[&str]) -> Option<Vec<u32>> {
        fn walk(nodes: &[Node], header: &[&str], numbers: &mut Vec<u32>) -> bool {
            let Some((node, later)) = nodes.split_first() else { return header.is_empty() };
            if let Some((mnemonic, rest)) = header.split_first()
                && let Some(number) = node.takes(mnemonic)
            {
                let length = numbers.len();
                numbers.extend(number);
                if walk(later, rest, numbers) {
                    return true;
                }
                numbers.truncate(length);
            }
            node.optional && walk(later, header, numbers)
        }
        let mut numbers = Vec::new();
        walk(&self.0, header, &mut numbers).then_some(numbers)
    }
}

impl Node {
    /// `Some(None)`: the mnemonic without a number.
    fn takes(&self, mnemonic: &str) -> Option<Option<u32>> {
        let upper = mnemonic.to_ascii_uppercase();
        if upper == self.short || upper == self.long {
            return Some(None);
        }
        let name = upper.trim_end_matches(|c: char| c.is_ascii_digit());
        let number = upper[name.len()..].parse().ok()?;
        (self.numbered && (name == self.short || name == self.long)).then_some(Some(number))
    }
}

/// One command of a program message.
#[derive(Debug, PartialEq, Eq)]
pub struct Unit {
    pub header: Vec<String>,
    pub query: bool,
    pub parameters: Vec<String>,
}

/// Splits a line at `;`. A header without a leading colon continues at the node of the header before it.
pub fn units(line: &str) -> Vec<Unit> {
    let mut path: Vec<String> = Vec::new();
    let mut units = Vec::new();
    for text in line.split(';').map(str::trim).filter(|text| !text.is_empty()) {
        let (header, parameters) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        let query = header.ends_with('?');
        let header = header.trim_end_matches('?');
        let mut nodes: Vec<String> = header.trim_start_matches(':').split(':').map(str::to_owned).collect();
        if !header.starts_with([':', '*']) && !path.is_empty() {
            nodes.splice(0..0, path.iter().cloned());
        }
        if !header.starts_with('*') {
            path = nodes[..nodes.len() - 1].to_vec();
        }
        let parameters = parameters.split(',').map(str::trim).filter(|p| !p.is_empty()).map(str::to_owned).collect();
        units.push(Unit { header: nodes, query, parameters });
    }
    units
}

/// SCPI-99 errors that this instrument reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Error {
    DataType,
    NotAllowed,
    Missing,
    UndefinedHeader,
    InvalidSuffix,
    Execution,
    OutOfRange,
    IllegalValue,
    QueueOverflow,
}

impl Error {
    pub fn entry(self) -> (i32, &'static str) {
        match self {
            Error::DataType => (-104, "Data type error"),
            Error::NotAllowed => (-108, "Parameter not allowed"),
            Error::Missing => (-109, "Missing parameter"),
            Error::UndefinedHeader => (-113, "Undefined header"),
            Error::InvalidSuffix => (-131, "Invalid suffix"),
            Error::Execution => (-200, "Execution error"),
            Error::OutOfRange => (-222, "Data out of range"),
            Error::IllegalValue => (-224, "Illegal parameter value"),
            Error::QueueOverflow => (-350, "Queue overflow"),
        }
    }

    /// Bit of the standard event status register.
    fn event_bit(self) -> u8 {
        match self.entry().0 {
            -199..=-100 => 1 << 5,
            -299..=-200 => 1 << 4,
            _ => 1 << 3,
        }
    }
}

/// Error queue and standard registers.
#[derive(Debug)]
pub struct Status {
    queue: VecDeque<Error>,
    pub events: u8,
    pub event_enable: u8,
    pub service_enable: u8,
}

impl Status {
    /// Bit 7: power came on.
    pub fn power_on() -> Self {
        Self { queue: VecDeque::new(), events: 1 << 7, event_enable: 0, service_enable: 0 }
    }

    pub fn push(&mut self, error: Error) {
        self.events |= error.event_bit();
        if self.queue.len() < QUEUE_DEPTH {
            self.queue.push_back(error);
        } else if let Some(last) = self.queue.back_mut() {
            *last = Error::QueueOverflow;
        }
    }

    pub fn pop(&mut self) -> String {
        let (code, text) = self.queue.pop_front().map_or((0, "No error"), Error::entry);
        format!("{code},\"{text}\"")
    }

    /// The commands of IEEE 488.2 that every instrument has.
    pub fn common(&mut self, command: &str, unit: &Unit) -> Result<Option<String>, Error> {
        let text = |text: String| Ok(Some(text));
        let mask = || unit.parameters.first().ok_or(Error::Missing)?.parse().map_err(|_| Error::DataType);
        match (command, unit.query) {
            ("*OPC", true) => return text("1".into()),
            ("*TST", true) => return text("0".into()),
            ("*ESR", true) => return text(std::mem::take(&mut self.events).to_string()),
            ("*ESE", true) => return text(self.event_enable.to_string()),
            ("*SRE", true) => return text(self.service_enable.to_string()),
            ("*STB", true) => return text(self.byte().to_string()),
            ("*ESE", false) => self.event_enable = mask()?,
            ("*SRE", false) => self.service_enable = mask()?,
            ("*CLS", false) => self.clear(),
            // Every earlier command is complete when this one is read.
            ("*OPC", false) => self.events |= OPERATION_COMPLETE,
            ("*WAI" | "*TRG", false) => {}
            _ => return Err(Error::UndefinedHeader),
        }
        Ok(None)
    }

    pub fn clear(&mut self) {
        self.queue.clear();
        self.events = 0;
    }

    pub fn byte(&self) -> u8 {
        let byte = u8::from(!self.queue.is_empty()) << 2 | u8::from(self.events & self.event_enable != 0) << 5;
        byte | u8::from(byte & self.service_enable != 0) << 6
    }
}

/// `0.6`, `.6`, `6E-1`, `600mA`, `MIN`, `MAX`.
pub fn number(text: &str, unit: &str, range: (f64, f64)) -> Result<f64, Error> {
    let upper = text.to_ascii_uppercase();
    let value = match upper.as_str() {
        "MIN" | "MINIMUM" => return Ok(range.0),
        "MAX" | "MAXIMUM" => return Ok(range.1),
        _ => {
            let value: &str = upper.trim_end_matches(|c: char| c.is_ascii_alphabetic());
            let suffix = upper[value.len()..].trim();
            let scale = match suffix.strip_suffix(unit).ok_or(()) {
                _ if suffix.is_empty() => 1.0,
                Ok("") => 1.0,
                Ok("M") => 1e-3,
                Ok("U") => 1e-6,
                _ if value.is_empty() => return Err(Error::DataType),
                _ => return Err(Error::InvalidSuffix),
            };
            value.trim().parse::<f64>().map_err(|_| Error::DataType)? * scale
        }
    };
    if (range.0..=range.1).contains(&value) { Ok(value) } else { Err(Error::OutOfRange) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_have_short_long_and_optional_nodes() {
        let pattern = Pattern::new("[:SOURce#]:CURRent[:LEVel][:IMMediate][:AMPLitude]");
        for header in ["CURR", "SOUR1:CURR", "source2:current", "SOURce:CURRent:LEVel:IMMediate:AMPLitude", "CURR:AMPL"]
        {
            let nodes: Vec<&str> = header.split(':').collect();
            assert!(pattern.matches(&nodes).is_some(), "{header}");
        }
        for header in ["CURRE", "SOUR1", "SOUR1:CURR:PROT", "CURR1", "VOLT"] {
            let nodes: Vec<&str> = header.split(':').collect();
            assert!(pattern.matches(&nodes).is_none(), "{header}");
        }
        assert_eq!(pattern.matches(&["SOUR2", "CURR"]), Some(vec![2]));
    }

    #[test]
    fn chains_restart_at_a_colon() {
        let line = ":INSTrument:NSELect 1; :SOURce:CURRent:LEVel:IMMediate:AMPLitude 0.6";
        let found = units(line);
        assert_eq!(found.len(), 2);
        assert_eq!(found[1].header[0], "SOURce");
        assert_eq!(found[1].parameters, ["0.6"]);
        assert_eq!(units(":SOUR1:VOLT 5;CURR 1")[1].header, ["SOUR1", "CURR"]);
        assert_eq!(units("*IDN?;:OUTP? CH1")[1].parameters, ["CH1"]);
    }

    #[test]
    fn a_finished_operation_sets_its_bit() {
        let mut status = Status::power_on();
        status.clear();
        let mut ask = |line: &str| {
            let unit = units(line).remove(0);
            status.common(&unit.header[0], &unit).unwrap()
        };
        assert_eq!(ask("*ESE 1"), None);
        assert_eq!(ask("*OPC"), None);
        assert_eq!(ask("*STB?").as_deref(), Some("32"), "the summary of enabled events");
        assert_eq!(ask("*ESR?").as_deref(), Some("1"));
        assert_eq!(ask("*ESR?").as_deref(), Some("0"), "reading clears it");
    }

    #[test]
    fn numbers_come_in_many_forms() {
        let amperes = |text| number(text, "A", (0.0, 1.05));
        for text in ["0.6", ".6", "6E-1", "600mA", "0.6A", "600 ma"] {
            assert!((amperes(text).unwrap() - 0.6).abs() < 1e-12, "{text}");
        }
        assert_eq!(amperes("MAX"), Ok(1.05));
        assert_eq!(amperes("1.06"), Err(Error::OutOfRange));
        assert_eq!(amperes("0.6V"), Err(Error::InvalidSuffix));
        assert_eq!(amperes("much"), Err(Error::DataType));
    }
}
