"""Waiting for the daemon."""

import sys
import time
from collections.abc import Callable
from typing import TypeVar

from .errors import NoDaemon, Refused
from .models import Progress

POLL_S = 0.25
# Waiting time for a daemon that does not answer: it may be restarting.
RESTARTED_S = 15.0
# A lease is renewed so many times before it expires.
RENEWALS = 4

T = TypeVar("T")


def poll(
    request: Callable[[], T | None],
    renew: Callable[[], object],
    lease: float | None,
    timeout: float | None,
    subject: str,
) -> T:
    """Repeats the request until it returns a value, and renews the lease meanwhile."""
    began = answered = renewed = time.monotonic()
    while True:
        now = time.monotonic()
        try:
            if lease is not None and now - renewed > lease / RENEWALS:
                renewed = now
                try:
                    renew()
                except Refused:
                    pass  # It has ended: the request shows how.
            value = request()
            if value is not None:
                return value
            answered = now
        except NoDaemon:
            if now - answered > RESTARTED_S:
                raise
        if timeout is not None and now - began > timeout:
            raise TimeoutError(f"{subject} has not ended after {timeout} s; it continues")
        time.sleep(POLL_S)


def show(progress: Progress) -> None:
    """One line on standard error, which the next call overwrites."""
    at_most = "at most " if progress.at_most else ""
    step = min(progress.step + 1, progress.steps)
    line = f"  {at_most}{progress.remaining_s:.0f} s left  step {step}/{progress.steps}  {progress.label}"
    print(f"\r{line[:79]:79}", end="", file=sys.stderr, flush=True)
