# SPDX-License-Identifier: MIT-0
"""Functions of Python for the words of the language, made from its registry."""
from __future__ import annotations

import difflib
import inspect
import math
import types
import typing
from typing import Any, Callable, Dict, Tuple

from . import _trellis

_TYPES = {
    **{name: getattr(typing, name) for name in ("Any", "Dict", "List", "Literal", "Mapping", "Sequence", "Union")},
    **{name: getattr(_trellis, name) for name in ("Guide", "Problem", "Script", "Strategy", "Value")},
    "math": math,
}


def signature(text: str) -> inspect.Signature:
    """The signature that a text describes: "(scale: float = 0.5) -> Guide"."""
    names: Dict[str, Any] = {}
    source = compile(f"def word{text}: ...", "signature", "exec", dont_inherit=True)  # its annotations are types, no texts
    exec(source, dict(_TYPES), names)
    return inspect.signature(names["word"])


def function(word: Dict[str, Any]) -> Callable[..., Any]:
    """The function of a word. It takes what the word takes: options by name, and what has no name in its order."""
    name = word["name"]

    def called(*given: Any, **named: Any) -> Any:
        return _trellis.call(name, given, named)

    called.__name__ = name.rpartition(".")[2]
    called.__qualname__ = name
    called.__module__ = "trellis"
    called.__doc__ = _trellis.help_text(name)
    setattr(called, "__signature__", signature(word["signature"]))
    setattr(called, "_word", name)  # so that the word itself can be an argument
    return called


def made_by(word: str, given: Tuple[Any, ...]) -> Any:
    """What a word makes of its arguments, for pickle."""
    return _trellis.call(word, given, {})


def module(name: str, summary: str, functions: Dict[str, Callable[..., Any]]) -> types.ModuleType:
    """What has the words of a module of the language, as `scenes.trap`."""
    made = types.ModuleType(f"trellis.{name}", summary)

    def missing(asked: str) -> Any:
        near = difflib.get_close_matches(asked, functions, 1)
        raise AttributeError(
            f"{name} has no '{asked}'" + (f" (did you mean '{near[0]}'?)" if near else "") + f"; it has: {', '.join(functions)}"
        )

    vars(made).update(functions)
    vars(made)["__getattr__"] = missing
    return made


def words() -> Dict[str, Any]:
    """Every word by its name: functions, and modules that have functions."""
    found: Dict[str, Any] = {}
    modules: Dict[str, Dict[str, Callable[..., Any]]] = {}
    summaries: Dict[str, str] = {}
    for word in _trellis.words():
        if word["is_module"]:
            summaries[word["name"]] = word["summary"]
        elif word["module"]:
            made = function(word)
            modules.setdefault(word["module"], {})[made.__name__] = made
        else:
            found[word["name"]] = function(word)
    for name, functions in modules.items():
        found[name] = module(name, summaries.get(name, f"What makes a {name}."), functions)
    return found
