//! The command tree of the DP800 series (programming guide PGH03109-1110).

use super::scpi::Pattern;
use std::sync::LazyLock;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    SystemError,
    SystemVersion,
    SystemControl,
    SelectNumber,
    SelectName,
    Voltage,
    Current,
    Apply,
    Output,
    Mode,
    ProtectionValue(Quantity),
    ProtectionState(Quantity),
    ProtectionTripped(Quantity),
    ProtectionClear(Quantity),
    Measure(Option<Quantity>),
    MeasurePower,
    MeasureAll,
    Condition,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    Voltage,
    Current,
}

pub static COMMANDS: LazyLock<Vec<(Pattern, Command)>> = LazyLock::new(|| {
    use Quantity::{Current, Voltage};
    let table = [
        (":SYSTem:ERRor[:NEXT]", Command::SystemError),
        (":SYSTem:VERSion", Command::SystemVersion),
        (":SYSTem:REMote", Command::SystemControl),
        (":SYSTem:LOCal", Command::SystemControl),
        (":SYSTem:RWLock", Command::SystemControl),
        (":INSTrument:NSELect", Command::SelectNumber),
        (":INSTrument[:SELEct]", Command::SelectName),
        ("[:SOURce#]:VOLTage[:LEVel][:IMMediate][:AMPLitude]", Command::Voltage),
        ("[:SOURce#]:CURRent[:LEVel][:IMMediate][:AMPLitude]", Command::Current),
        ("[:SOURce#]:VOLTage:PROTection[:LEVel]", Command::ProtectionValue(Voltage)),
        ("[:SOURce#]:VOLTage:PROTection:STATe", Command::ProtectionState(Voltage)),
        ("[:SOURce#]:VOLTage:PROTection:TRIPped", Command::ProtectionTripped(Voltage)),
        ("[:SOURce#]:VOLTage:PROTection:CLEar", Command::ProtectionClear(Voltage)),
        ("[:SOURce#]:CURRent:PROTection[:LEVel]", Command::ProtectionValue(Current)),
        ("[:SOURce#]:CURRent:PROTection:STATe", Command::ProtectionState(Current)),
        ("[:SOURce#]:CURRent:PROTection:TRIPped", Command::ProtectionTripped(Current)),
        ("[:SOURce#]:CURRent:PROTection:CLEar", Command::ProtectionClear(Current)),
        (":APPLy", Command::Apply),
        (":OUTPut[:STATe]", Command::Output),
        (":OUTPut:CVCC", Command::Mode),
        (":OUTPut:MODE", Command::Mode),
        (":OUTPut:OVP:VALue", Command::ProtectionValue(Voltage)),
        (":OUTPut:OVP[:STATe]", Command::ProtectionState(Voltage)),
        (":OUTPut:OVP:QUES", Command::ProtectionTripped(Voltage)),
        (":OUTPut:OVP:CLEAR", Command::ProtectionClear(Voltage)),
        (":OUTPut:OCP:VALue", Command::ProtectionValue(Current)),
        (":OUTPut:OCP[:STATe]", Command::ProtectionState(Current)),
        (":OUTPut:OCP:QUES", Command::ProtectionTripped(Current)),
        (":OUTPut:OCP:CLEAR", Command::ProtectionClear(Current)),
        (":MEASure:ALL[:DC]", Command::MeasureAll),
        (":MEASure:CURRent[:DC]", Command::Measure(Some(Current))),
        (":MEASure:POWEr[:DC]", Command::MeasurePower),
        (":MEASure[:VOLTage][:DC]", Command::Measure(Some(Voltage))),
        (":STATus:QUEStionable:INSTrument:ISUMmary#:CONDition", Command::Condition),
    ];
    table.into_iter().map(|(pattern, command)| (Pattern::new(pattern), command)).collect()
});
