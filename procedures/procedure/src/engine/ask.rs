//! One request to one instrument: after a missing or corrupted reply the link is recovered and the request repeated
//! once.

use jointbench_instrument::Fault;
use jointbench_instrument::roles::Instrument;

/// A failed or repeated request.
pub(super) struct RequestFault {
    pub fault: Fault,
    pub recovered: bool,
}

/// Sends a request. After a retryable fault it recovers the link and repeats the request once. Every fault is
/// reported, recovered or not, and so is another instrument that answers.
pub(super) fn ask<I: Instrument + ?Sized, T>(
    instrument: &mut I,
    mut request: impl FnMut(&mut I) -> Result<T, Fault>,
    mut log: impl FnMut(RequestFault),
) -> Result<T, Fault> {
    let fault = match request(instrument) {
        Ok(reply) => return Ok(reply),
        Err(fault) => fault,
    };
    let reply =
        if fault.is_retryable() { instrument.recover().and_then(|_| request(instrument)) } else { Err(fault.clone()) };
    tracing::warn!(instrument = instrument.name(), recovered = reply.is_ok(), "{fault}");
    let exchanged = reply.as_ref().err().filter(|found| found.is_wrong_instrument() && **found != fault).cloned();
    log(RequestFault { fault, recovered: reply.is_ok() });
    exchanged.into_iter().for_each(|fault| log(RequestFault { fault, recovered: false }));
    reply
}
