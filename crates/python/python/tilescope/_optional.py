"""Packages that are used where they are installed."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def module(name: str, extra: str) -> Any:
    """Returns an optional module, or raises ``ImportError`` that says how to install it."""
    try:
        return import_module(name)
    except ImportError as error:
        raise ImportError(f"this needs {name}: pip install 'tilescope[{extra}]'") from error
