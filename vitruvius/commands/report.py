"""Options and work of ``vitruvius report``. Cheap to import."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Report:
    """Write a run as one HTML file: plans, learning curves, figures with intervals, and episodes to play.

    The file needs no network and no other file. demo, train, evaluate --out and bench write one, too.
    """

    folder: tyro.conf.Positional[Annotated[Path, tyro.conf.arg(metavar="RUN")]]
    """Folder of a run, which demo, train, evaluate --out or bench wrote; or a folder of house files, or of
    traces (vitruvius record --out RUN/NAME.trace.json)."""

    out: Path | None = None
    """File to write; by default report.html in the folder."""

    replace: bool = False
    """Overwrite a file that is not a report; the folder's own report is always written again."""

    def run(self) -> int:
        """Write the file."""
        from vitruvius.agent.report.folder import NAME, require_report, write_report
        from vitruvius.logic.files.replacing import unless_other
        from vitruvius.logic.files.writing import require_file
        from vitruvius.studies import study_sections

        if self.out:
            require_file(self.out, [".html"])
            with unless_other(self.out, self.replace) as file:
                write_report(self.folder, file, study_sections())
        else:
            require_report(self.folder, self.replace)
            write_report(self.folder, None, study_sections())
        print(self.out or self.folder / NAME)
        return 0
