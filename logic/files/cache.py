"""The folder of files that Vitruvius can make or fetch again."""

import os
import sys
from pathlib import Path


def cache() -> Path:
    """Return this user's folder for such files. Raises ``RuntimeError`` if the user has no home."""
    home = Path.home()
    if os.name == "nt":
        default = home / "AppData" / "Local"
    else:
        default = home / ("Library/Caches" if sys.platform == "darwin" else ".cache")
    return Path(os.environ.get("XDG_CACHE_HOME") or default) / "vitruvius"
