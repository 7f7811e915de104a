# SPDX-License-Identifier: MIT-0
"""What the commands of the package share: `python3 -m trellis.figures` and `python3 -m trellis.export`."""
from __future__ import annotations

import argparse
import sys
from typing import NoReturn


class Parser(argparse.ArgumentParser):
    """A parser that fails in one line."""

    def error(self, message: str) -> NoReturn:
        fail(message, 2)


def fail(message: str, status: int) -> NoReturn:
    """Ends the process with a message in one line."""
    sys.stderr.write(" ".join(message.split()) + "\n")
    sys.exit(status)
