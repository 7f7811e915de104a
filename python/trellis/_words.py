# SPDX-License-Identifier: MIT-0
"""Every word of the language as a function in Python; _words.pyi lists them, as `trellis reference python` prints it."""
from ._language import words

_words = words()
globals().update(_words)
__all__ = list(_words)
