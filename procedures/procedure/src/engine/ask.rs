//! One request to one instrument: a reply that was missed or garbled is asked for once more, on a link made sure of.

use jointbench_instrument::Fault;
use jointbench_instrument::roles::Instrument;

/// What became of a request that did not go well.
pub(super) struct Trouble {
    pub fault: Fault,
    pub recovered: bool,
}

/// Asks; on a retryable fault recovers the link and asks once more. Trouble is told, recovered or not, and
/// that another instrument answers.
pub(super) fn ask<I: Instrument + ?Sized, T>(
    instrument: &mut I,
    mut request: impl FnMut(&mut I) -> Result<T, Fault>,
    mut tell: impl FnMut(Trouble),
) -> Result<T, Fault> {
    let fault = match request(instrument) {
        Ok(reply) => return Ok(reply),
        Err(fault) => fault,
    };
    let reply =
        if fault.is_retryable() { instrument.recover().and_then(|_| request(instrument)) } else { Err(fault.clone()) };
    tracing::warn!(instrument = instrument.name(), recovered = reply.is_ok(), "{fault}");
    let exchanged = reply.as_ref().err().filter(|found| found.is_wrong_instrument() && **found != fault).cloned();
    tell(Trouble { fault, recovered: reply.is_ok() });
    exchanged.into_iter().for_each(|fault| tell(Trouble { fault, recovered: false }));
    reply
}
