# SPDX-License-Identifier: MIT-0
"""Reads the tables of documents of results, which have an array for each column (docs/formats.md)."""
from __future__ import annotations

from typing import Any, Dict, List, Mapping


def column(table: Mapping[str, Any], name: str) -> List[Any]:
    """The values of a column, one for each row. A single value stands for equal ones of all rows, and numbers of texts
    for the texts; None for a column that the table does not have."""
    values, rows = table.get(name), int(table["rows"])
    if isinstance(values, Mapping):
        texts = values["texts"]
        if "pairs" in values:
            return [None if row is None else [[texts[row[i]], row[i + 1]] for i in range(0, len(row), 2)]
                    for row in values["pairs"]]
        return [_text(texts, row) for row in values["at"]]
    return values if isinstance(values, list) else [values] * rows


def _text(texts: List[str], row: Any) -> Any:
    if isinstance(row, list):
        return [texts[i] for i in row]
    return texts[row] if isinstance(row, int) else row


def rows(table: Mapping[str, Any]) -> List[Dict[str, Any]]:
    """The rows of a table, each with the names of the columns; values that are missing are None."""
    names = [name for name in table if name != "rows"]
    if not names:
        return [{} for _ in range(int(table["rows"]))]
    return [dict(zip(names, row)) for row in zip(*(column(table, name) for name in names))]
