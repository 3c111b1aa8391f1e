"""Samples from the Parquet export, for the library of the user. Each library is an optional extra."""

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


def to_polars(parquet: bytes) -> pl.DataFrame:
    frame: pl.DataFrame = need("polars", "polars").read_parquet(BytesIO(parquet))
    return frame


def to_pandas(parquet: bytes) -> pd.DataFrame:
    need("pyarrow", "pandas")
    return need("pandas", "pandas").read_parquet(BytesIO(parquet), engine="pyarrow")


def to_arrow(parquet: bytes) -> pa.Table:
    return need("pyarrow.parquet", "arrow").read_table(BytesIO(parquet))


def to_numpy(parquet: bytes) -> dict[str, np.ndarray[Any, Any]]:
    need("numpy", "arrow")
    table = to_arrow(parquet)
    return {name: column.to_numpy() for name, column in zip(table.column_names, table.columns, strict=True)}
