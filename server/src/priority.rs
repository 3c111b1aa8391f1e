//! Scheduling policies of the worker of a bench and of computations. Threads started later inherit the policy.

#[cfg(unix)]
use thread_priority::unix::{
    NormalThreadSchedulePolicy, RealtimeThreadSchedulePolicy, ThreadSchedulePolicy, set_thread_priority_and_policy,
    thread_native_id,
};

/// Gives this thread the real-time policy with the lowest real-time priority. Returns whether the system allows it.
#[cfg(unix)]
pub fn real_time() -> bool {
    set(ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::RoundRobin))
}

/// Lets this thread run only when no other thread needs the processor. Returns whether the system allows it.
#[cfg(unix)]
pub fn idle() -> bool {
    set(ThreadSchedulePolicy::Normal(NormalThreadSchedulePolicy::Idle))
}

#[cfg(unix)]
fn set(policy: ThreadSchedulePolicy) -> bool {
    set_thread_priority_and_policy(thread_native_id(), thread_priority::ThreadPriority::Min, policy).is_ok()
}

/// Other systems keep their policy.
#[cfg(not(unix))]
pub fn real_time() -> bool {
    false
}

/// Other systems keep their policy.
#[cfg(not(unix))]
pub fn idle() -> bool {
    false
}
