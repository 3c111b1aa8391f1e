"""The daemon."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, TypeVar
from urllib.parse import quote

from . import models
from ._connection import Connection, environment_token
from ._waiting import poll
from .bench import Bench
from .errors import NoDaemon
from .run import Run

DEFAULT_URL = "http://127.0.0.1:8080"
# The most that the daemon lists in one answer.
PAGE = 500

# An answer that the daemon computes in several requests.
Computed = TypeVar("Computed", models.Trends, models.ControlChart)


def connect(url: str | None = None, token: str | None = None) -> Lab:
    """Connects to a daemon, and checks its version.

    Without arguments: `JOINTBENCH_URL`, otherwise http://127.0.0.1:8080; `JOINTBENCH_TOKEN_FILE`, otherwise
    `JOINTBENCH_TOKEN`. `JOINTBENCH_CA_FILE` is the certificate (PEM) to trust at https://.
    """
    connection = Connection(url or os.environ.get("JOINTBENCH_URL") or DEFAULT_URL, token or environment_token())
    version = connection.get(models.Health, "/health").version
    if series(version) != series(models.API_VERSION):
        raise NoDaemon(
            f"the daemon at {connection.url} has version {version}, this package {models.API_VERSION}: "
            f"pip install jointbench=={version}"
        )
    return Lab(connection)


def series(version: str) -> list[str]:
    """The part of a version that changes with an incompatible API."""
    major, minor, *_ = version.split(".")
    return [major, minor] if major == "0" else [major]


class Lab:
    """A daemon with its benches, runs and units. Ends its connection as a context manager, or with `close`."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def __enter__(self) -> Lab:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Lab at {self._connection.url}>"

    def close(self) -> None:
        self._connection.close()

    def benches(self) -> list[Bench]:
        """All benches of the daemon."""
        return [Bench(self._connection, info) for info in self._connection.get(list[models.Bench], "/bench")]

    def bench(self, name: str) -> Bench:
        """The bench with this name."""
        return Bench(self._connection, self._connection.get(models.Bench, f"/bench/{quote(name, safe='')}"))

    def run(self, number: int) -> Run:
        """The run with this number."""
        return Run(self._connection, self._connection.get(models.Run, f"/runs/{number}"))

    def runs(self, search: str = "") -> Iterator[Run]:
        """Runs, newest first, for example of `unit:SN1 kind:friction -state:failed`."""
        seen: set[int] = set()
        page: models.RunList | None = None
        while page is None or len(page.runs) == PAGE:
            page = self._connection.get(models.RunList, "/runs", search=search, limit=PAGE, offset=len(seen))
            for info in page.runs:
                # A run that starts meanwhile shifts the pages.
                if info.id not in seen:
                    seen.add(info.id)
                    yield Run(self._connection, info)

    def units(self, search: str = "") -> list[models.UnitSummary]:
        """Units under test with their verdicts, newest runs first, at most 1000."""
        return self._connection.get(models.UnitList, "/units", search=search).units

    def yields(self, search: str = "") -> list[models.FirstPassYield]:
        """First-pass yield of each procedure, by part, revision and batch, for example of `part:JA-100`."""
        return self._connection.get(models.UnitList, "/units", search=search).yields

    def chart(self, procedure: str, quantity: str, search: str = "") -> models.ControlChart:
        """Individuals control chart of a quantity over units, with the capability for the limits of their runs."""
        return self._computed(
            models.ControlChart, "/units/chart", procedure=procedure, quantity=quantity, search=search
        )

    def trends(self, search: str = "") -> models.Trends:
        """Quantities of the newest 500 complete runs, oldest first, for example of `unit:SN1 kind:friction`."""
        return self._computed(models.Trends, "/trends", search=search)

    def _computed(self, kind: type[Computed], path: str, **query: str) -> Computed:
        """The answer when the results of all its runs are computed."""

        def complete() -> Computed | None:
            answer = self._connection.get(kind, path, **query)
            return None if answer.pending else answer

        return poll(complete, lambda: None, None, None, path)

    def import_run(
        self,
        file: str | os.PathLike[str],
        meta: Mapping[str, Any] | None = None,
        name: str | None = None,
        **choices: str | float | bool | Sequence[str],
    ) -> Run:
        """Imports a run table (text, Parquet, Arrow), and returns its run.

        `meta` are the constants that the table does not hold; without it, those of `FILE.meta.json` in the same folder.
        `choices` say how the table is read: `models.ImportForm` lists them, such as `time_from_rate=200` [Hz].
        """
        path = Path(file)
        sibling = path.parent / f"{path.name.split('.')[0]}.meta.json"
        if meta is None and sibling.is_file():
            meta = json.loads(sibling.read_text(encoding="utf-8"))
        form: dict[str, Any] = {**choices, **({} if meta is None else {"meta": json.dumps(meta)})}
        query = {} if name is None else {"name": name}
        return Run(self._connection, self._connection.upload(models.Run, "/runs/import", path, form, query))
