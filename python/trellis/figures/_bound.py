# SPDX-License-Identifier: MIT-0
"""The figures of one document, as methods."""
from __future__ import annotations

import os
import pathlib
from typing import Any, Dict, List, Optional, Union

from ._costs import costs, levels, ratios, success
from ._document import Document, Results, read
from ._measure import correlation, scales, waterfall
from ._paths import length, profile
from ._save import save
from ._tables import tables
from ._teams import schedule
from ._worlds import levels_of_world, strip, world


class Figures:
    """The figures of a result: `result.figures.costs()` is `trellis.figures.costs(result)`, with the same arguments.

    results: what `read` returned.

    Raises `Error` as `read` does.
    """

    results: Results

    def __init__(self, document: Document) -> None:
        self.results = read(document)

    def costs(self, **options: Any) -> Any:
        """What does each strategy cost? See `trellis.figures.costs`."""
        return costs(self.results, **options)

    def success(self, **options: Any) -> Any:
        """How likely is a path by a number of checks? See `trellis.figures.success`."""
        return success(self.results, **options)

    def length(self, **options: Any) -> Any:
        """How fast do paths get shorter? See `trellis.figures.length`."""
        return length(self.results, **options)

    def ratios(self, **options: Any) -> Any:
        """Does guidance pay? See `trellis.figures.ratios`."""
        return ratios(self.results, **options)

    def levels(self, **options: Any) -> Any:
        """Which guide earns its place? See `trellis.figures.levels`."""
        return levels(self.results, **options)

    def waterfall(self, **options: Any) -> Any:
        """What does each level add? See `trellis.figures.waterfall`."""
        return waterfall(self.results, **options)

    def correlation(self, **options: Any) -> Any:
        """Which nats predict the checks? See `trellis.figures.correlation`."""
        return correlation(self.results, **options)

    def scales(self, **options: Any) -> Any:
        """How do the costs depend on an option? See `trellis.figures.scales`."""
        return scales(self.results, **options)

    def profile(self, **options: Any) -> Any:
        """Where along the path do the samples lie? See `trellis.figures.profile`."""
        return profile(self.results, **options)

    def world(self, **options: Any) -> Any:
        """Where did each strategy search, and what path did it find? See `trellis.figures.world`."""
        return world(self.results, **options)

    def levels_of_world(self, **options: Any) -> Any:
        """What did each level search, and what did it hand up? See `trellis.figures.levels_of_world`."""
        return levels_of_world(self.results, **options)

    def strip(self, **options: Any) -> Any:
        """How does the robot move? See `trellis.figures.strip`."""
        return strip(self.results, **options)

    def schedule(self, **options: Any) -> Any:
        """Which robot of a team waits, and how close do they come? See `trellis.figures.schedule`."""
        return schedule(self.results, **options)

    def tables(self, format: Optional[str] = None) -> Dict[str, Any]:
        """The numbers. See `trellis.figures.tables`."""
        return tables(self.results, format)

    def save(self, folder: Union[str, "os.PathLike[str]"], **options: Any) -> List[pathlib.Path]:
        """Writes all figures and tables. See `trellis.figures.save`."""
        return save(self.results, folder, **options)
