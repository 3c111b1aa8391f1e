"""Samples as an Arrow stream, for the library of the user. Each library is an optional extra."""

from __future__ import annotations

import importlib
from io import BytesIO
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    import polars as pl
    import pyarrow as pa


def need(module: str, extra: str) -> Any:
    """A module of an optional extra."""
    try:
        return importlib.import_module(module)
    except ImportError as fault:
        raise ImportError(f"{module} is not installed: pip install 'jointbench[{extra}]'") from fault


def to_polars(stream: bytes) -> pl.DataFrame:
    frame: pl.DataFrame = need("polars", "polars").read_ipc_stream(BytesIO(stream))
    return frame


def to_pandas(stream: bytes) -> pd.DataFrame:
    need("pandas", "pandas")
    frame: pd.DataFrame = _table(stream, "pandas").to_pandas()
    return frame


def to_arrow(stream: bytes) -> pa.Table:
    return _table(stream, "arrow")


def to_numpy(stream: bytes) -> dict[str, np.ndarray[Any, Any]]:
    need("numpy", "arrow")
    table = to_arrow(stream)
    return {name: column.to_numpy() for name, column in zip(table.column_names, table.columns, strict=True)}


def _table(stream: bytes, extra: str) -> pa.Table:
    table: pa.Table = need("pyarrow.ipc", extra).open_stream(BytesIO(stream)).read_all()
    return table
