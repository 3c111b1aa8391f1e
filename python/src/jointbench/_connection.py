"""Requests to the daemon, with answers as checked types."""

import os
import ssl
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

import httpx
import pydantic

from . import models
from .errors import JointbenchError, NoDaemon, Refused

CONNECT_S = 10.0

T = TypeVar("T")


class Connection:
    """One daemon, as REST requests below `/api/v1`."""

    def __init__(self, url: str, token: str | None) -> None:
        self.url = (url if "://" in url else f"http://{url}").rstrip("/")
        authority = environment_text("JOINTBENCH_CA_FILE")
        self._http = httpx.Client(
            base_url=f"{self.url}/api/v1",
            headers={"authorization": f"Bearer {token}"} if token else {},
            verify=ssl.create_default_context(cadata=authority) if authority else True,
            # A fit takes as long as it takes; the daemon limits its time.
            timeout=httpx.Timeout(None, connect=CONNECT_S),
            # A bench is in the network of the laboratory: no proxy of the environment, no .netrc.
            trust_env=False,
        )

    def close(self) -> None:
        self._http.close()

    def get(self, kind: type[T], path: str, **query: str | int) -> T:
        return self._parsed(kind, self.request("GET", path, params=query))

    def post(self, kind: type[T], path: str, body: pydantic.BaseModel | None = None, **headers: str) -> T:
        content = body.model_dump_json(exclude_none=True) if body else None
        media_type = {"content-type": "application/json"} if body else {}
        return self._parsed(kind, self.request("POST", path, content=content, headers={**media_type, **headers}))

    def upload(self, kind: type[T], path: str, file: Path, form: Mapping[str, Any], query: Mapping[str, str]) -> T:
        with file.open("rb") as content:
            return self._parsed(kind, self.request("POST", path, files={"file": content}, data=form, params=query))

    def request(self, method: str, path: str, **parts: Any) -> httpx.Response:
        try:
            response = self._http.request(method, path, **parts)
        except httpx.HTTPError as fault:
            raise NoDaemon(
                f"no daemon answers at {self.url} ({fault}): start it with `jointbench serve`, "
                "or give its address (connect(url), JOINTBENCH_URL) and its certificate (JOINTBENCH_CA_FILE)"
            ) from fault
        if response.is_success:
            return response
        try:
            problem = models.Problem.model_validate_json(response.content)
        except pydantic.ValidationError:
            raise NoDaemon(
                f"{self.url} answered {response.status_code}: check that a jointbench daemon runs at this address"
            ) from None
        if response.status_code == httpx.codes.UNAUTHORIZED:
            raise Refused(
                problem,
                f"the daemon at {self.url} requires a valid token: connect(token=…), "
                "JOINTBENCH_TOKEN or JOINTBENCH_TOKEN_FILE",
            )
        raise Refused(problem)

    def _parsed(self, kind: type[T], response: httpx.Response) -> T:
        try:
            return pydantic.TypeAdapter(kind).validate_json(response.content)
        except pydantic.ValidationError as fault:
            raise JointbenchError(f"{self.url} uses another version of the API: {fault}") from fault


def environment_token() -> str | None:
    """The token of the environment, as the command line takes it: the file has priority."""
    text = environment_text("JOINTBENCH_TOKEN_FILE")
    return os.environ.get("JOINTBENCH_TOKEN") if text is None else text.strip()


def environment_text(variable: str) -> str | None:
    """Text of the file that a variable names."""
    file = os.environ.get(variable)
    if not file:
        return None
    try:
        return Path(file).expanduser().read_text(encoding="utf-8")
    except OSError as fault:
        raise JointbenchError(f"{variable}: {file} cannot be read ({fault.strerror}): name another file") from fault
