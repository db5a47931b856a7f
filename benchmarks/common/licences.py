"""Notice of the licences of all packages in ``requirements.lock``, from the installed packages.

Run ``./run python -m benchmarks.common.licences > THIRD_PARTY_LICENSES.md`` on Linux, where all packages are
installed.
"""

import re
from argparse import ArgumentParser
from collections.abc import Iterator
from importlib.metadata import Distribution, distribution
from pathlib import Path
from typing import Any

LOCK = Path(__file__).parents[2] / "requirements.lock"

USED = "vitruvius (pyproject.toml)"
"""Name in the lock for the reason of a package that is not only for development."""

SPDX = {
    "3-Clause BSD License": "BSD-3-Clause",
    "Apache 2.0": "Apache-2.0",
    "Apache Software License": "Apache-2.0",
    "BSD": "BSD-3-Clause",
    "BSD License": "BSD-3-Clause",
    "MIT License": "MIT",
    "Mozilla Public License 2.0 (MPL 2.0)": "MPL-2.0",
    "NVIDIA Proprietary Software": "LicenseRef-NVIDIA-Proprietary",
    "Python Software Foundation License": "PSF-2.0",
}
"""Texts that packages write instead of an SPDX name of their licence."""

UNSTATED = {
    "array-api-compat": "MIT",
    "cuda-toolkit": "LicenseRef-NVIDIA-Proprietary",
    "mlcroissant": "Apache-2.0",
}
"""Licences of packages that neither name a licence nor include its text, as their projects state them."""

ELSEWHERE = {"appnope": "BSD-2-Clause", "httpx2-jsfetch": "BSD-3-Clause"}
"""Licences of packages that are installed only on systems other than Linux, as their projects state them."""

ASKS_MORE = re.compile(r"GPL|MPL|EPL|CDDL|Proprietary")
"""Pattern in the names of licences that ask for more than a notice."""

HEADING = re.compile(
    r"(?:GNU (?:LESSER |AFFERO |LIBRARY )?GENERAL PUBLIC LICENSE|Mozilla Public License)\s+Version [\d.]*\d"
)
"""Pattern of the heading of such a licence, in a file of a package that has parts under it."""

EXCEPTION = "GCC Runtime Library Exception"
"""Exception under which a program may contain parts of its compiler without the compiler's licence."""

NOTICE = """# Licences of what Vitruvius uses

Vitruvius is under the MIT licence (`LICENSE`). `./run` or pip installs what follows.
Made from `requirements.lock` and the installed packages, which bring the texts, by
`./run python -m benchmarks.common.licences > THIRD_PARTY_LICENSES.md`.

## Licences that ask for more than a notice

Read them before you pass these on, for instance in an image with all of it.

- **DejaVu Sans**, the font of plans, in the wheel itself: the licence of Bitstream Vera, in
  `logic/drawing/fonts/LICENSE`. It may be copied and changed, but a changed font needs another name.
- **CLP(R) and CLP(Q) of SWI-Prolog**, `library(clpr)` and `library(clpq)`, which the solver processes load:
  the GNU General Public License, version 2 or later, with an exception: "if you link this library with other
  files, compiled with a Free Software compiler, to produce an executable, this library does not by itself
  cause the resulting executable to be covered by the GNU General Public License". So the headers of
  `clpr.pl` and `clpq.pl` say.
- **SWI-Prolog** itself is under BSD-2-Clause; libgmp, which it links, under the GNU LGPL, version 3 or later,
  or the GNU GPL, version 2 or later.
- **FFmpeg**, a program that imageio-ffmpeg brings and that `record` starts for an MP4: the GNU GPL, version 3
  or later, as its builds for Linux are.
- **clingo-wasm** 0.6.0 (Apache-2.0; clingo in it: MIT) and **swipl-wasm** 8.0.5 (BSD-2-Clause, with CLP(R)
  and CLP(Q) as above), which `vitruvius playground` fetches by npm, as
  `logic/browser/playground/package-lock.json` names them. A folder that it writes to be published holds them.
"""


def locked() -> dict[str, tuple[list[str], bool]]:
    """Return for each package of the lock its versions, one for each Python, and True if users need it."""
    entries = re.findall(r"^([\w.-]+)==(\S+)(.*?)(?=^\S|\Z)", LOCK.read_text(), re.MULTILINE | re.DOTALL)
    needed_by = {
        name: set(re.findall(r"^ +# +(?:via )?(\S.*)$", rest, re.MULTILINE)) for name, _, rest in entries
    }
    used = {USED}
    while more := {name for name, by in needed_by.items() if by & used} - used:
        used |= more
    return {name: ([v for other, v, _ in entries if other == name], name in used) for name in needed_by}


def licence(package: Distribution) -> str:
    """Return a package's licence, as the package states it, as an SPDX expression."""
    said: Any = package.metadata  # a mapping with repeated keys
    classes = [words.split(" :: ")[-1] for words in said.get_all("Classifier", []) if "License ::" in words]
    stated: list[str] = [
        said.get("License-Expression"),
        *classes,
        said.get("License", "").strip().split("\n")[0],
    ]
    for words in filter(None, stated):
        return SPDX.get(words, words)
    if any(text.startswith("MIT License") for _, text in _texts(package)):
        return "MIT"
    return UNSTATED[str(package.name)]


def parts(package: Distribution) -> list[str]:
    """Return the licences of parts of a package that ask for more than a notice, with their files."""
    found = set()
    for name, text in _texts(package):
        excepted = f" with the {EXCEPTION}" if EXCEPTION.lower() in text.lower() else ""
        found |= {f"{' '.join(words.split())}{excepted}, in `{name}`" for words in HEADING.findall(text)}
    return sorted(found)


def _texts(package: Distribution) -> Iterator[tuple[str, str]]:
    """Yield the names and the texts of a package's licence files."""
    for file in package.files or []:
        if re.fullmatch(
            r"(?i)(licen[sc]e|copying|notice|third)[^.]*(\.eigen|\.external|\.md|\.txt)?", file.name
        ):
            yield file.name, Path(str(file.locate())).read_text(errors="replace")


def notice() -> str:
    """Return the page, which depends only on the lock and the packages."""
    packages = {name: distribution(name) for name in locked() if name not in ELSEWHERE}
    licences = ELSEWHERE | {name: licence(package) for name, package in packages.items()}
    lines = [NOTICE.rstrip()]
    for more in sorted({words for words in licences.values() if ASKS_MORE.search(words)}):
        lines.append(f"- **{more}**: {', '.join(name for name in packages if licences[name] == more)}.")
    for name, package in packages.items():
        if not ASKS_MORE.search(licences[name]) and (found := parts(package)):
            lines.append(f"- Parts of **{name}**: {'; '.join(found)}.")
    for title, wanted in (("What users install", True), ("What development adds", False)):
        lines += ["", f"## {title}", "", "| package | version | licence |", "|---|---|---|"]
        for name, (versions, used) in locked().items():
            if used == wanted:
                lines.append(f"| {name} | {', '.join(versions)} | {licences[name]} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    ArgumentParser(description=__doc__).parse_args()
    print(notice(), end="")
