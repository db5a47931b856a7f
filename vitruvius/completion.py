"""``vitruvius completion``: a script by which a shell completes commands, options and their values.

The script has all words in it, so that completing starts no Python. It knows the names of grammars, presets,
agents and banks that come with Vitruvius, and leaves files to the shell.
"""

import pkgutil
import shlex
import textwrap
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import tyro

from agent.algorithms.table import PRESETS
from agent.banks import BANKS, PAPER_HOUSE
from agent.learning.config import TARGET_MODES
from agent.runs.released import released
from logic.grammar import shipped
from vitruvius.options import Option, options_in, options_of

HOUSES = [*BANKS, PAPER_HOUSE]

NAMES = {
    "grammar": shipped,
    "agent": released,
    "agents": released,
    "race": released,
    "houses": lambda: HOUSES,
    "targets": lambda: list(TARGET_MODES),
    "thing": lambda: sorted({*HOUSES, *shipped(), *released(), *PRESETS}),
    "backend": lambda: ["continuous", "grid"],
}
"""By an option's name, the values that come with Vitruvius, besides files."""

OPEN = {"grammar", "agent", "agents", "race", "houses", "thing"}
"""Of these, the options that take a path as well."""

PROGRAMS = "vitruvius", "./run"
"""What is completed: the command, and the script of a checkout."""


@dataclass(frozen=True)
class Completion:
    """Print a script by which your shell completes commands, options, and names of grammars and agents.

    bash: add eval "$(vitruvius completion bash)" to ~/.bashrc.

    zsh: add eval "$(vitruvius completion zsh)" to ~/.zshrc, after compinit.

    fish: vitruvius completion fish > ~/.config/fish/completions/vitruvius.fish
    """

    shell: tyro.conf.Positional[Literal["bash", "zsh", "fish"]]
    """The shell that shall complete: bash, zsh or fish."""

    def run(self) -> int:
        """Print the script."""
        print({"bash": bash, "zsh": zsh, "fish": fish}[self.shell](), end="")
        return 0


@dataclass(frozen=True)
class Place:
    """A command, and what may follow it."""

    words: str
    """As in ``bench generator``."""
    sentence: str
    options: tuple[Option, ...]

    @property
    def flags(self) -> list[str]:
        """Its options, those that turn something off included."""
        found = list[str]()
        for option in self.options:
            if not option.positional:
                found.append(option.flag)
                if option.type is bool and option.default:
                    found.append(f"--no-{option.flag[2:]}")
        return [*found, "--help"]


def places() -> list[Place]:
    """All commands, and all studies."""
    from benchmarks import STUDIES
    from vitruvius.cli import COMMANDS

    found = list[Place]()
    for prefix, table in (("", COMMANDS), ("bench ", STUDIES)):
        for name, (where, sentence) in table.items():
            if table is STUDIES:
                options = options_in(where)
            else:
                options = [] if name == "bench" else _options(pkgutil.resolve_name(where))
            found.append(Place(prefix + name, sentence, tuple(options)))
    return found


def _options(kind: type) -> Iterable[Option]:
    """The options of a command; of ``train`` those of all presets."""
    if not hasattr(kind, "like"):
        return options_of(kind)
    found: dict[str, Option] = {}
    for preset in PRESETS:
        for option in options_of(kind.like(["--preset", preset])):  # pyright: ignore
            found.setdefault(option.name, option)
    return found.values()


def values(option: Option) -> list[str]:
    """The words that an option may take, as far as they are known."""
    return list(option.choices) or [*NAMES.get(option.name, list)()]


def takes_files(option: Option) -> bool:
    """Whether an option takes a path."""
    return option.type is Path or option.name in OPEN or (option.positional and not option.choices)


def bash() -> str:
    """The script for bash."""
    found = places()
    from benchmarks import STUDIES

    commands = " ".join(place.words for place in found if " " not in place.words)
    flags = "\n".join(
        f"    {shlex.quote(place.words)}) options={shlex.quote(' '.join(place.flags))} ;;" for place in found
    )
    taken = "\n".join(_bash_values(found))
    return f"""\
# Completion of vitruvius by bash: eval "$(vitruvius completion bash)"
_vitruvius() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} command=${{COMP_WORDS[1]}}
  local options='' words='' files=''
  COMPREPLY=()
  # bash cuts --option=value at its equals sign
  if [[ $current == '=' ]]; then
    current=''
  elif [[ $before == '=' ]]; then
    before=${{COMP_WORDS[COMP_CWORD-2]}}
  fi
  if ((COMP_CWORD == 1)); then
    COMPREPLY=($(compgen -W '{commands} --help --version' -- "$current"))
    return
  fi
  if [[ $command == help ]] && ((COMP_CWORD == 2)); then
    COMPREPLY=($(compgen -W '{commands}' -- "$current"))
    return
  fi
  if [[ $command == bench ]]; then
    if ((COMP_CWORD == 2)); then
      COMPREPLY=($(compgen -W '{" ".join(STUDIES)} --help' -- "$current"))
      return
    fi
    command="bench ${{COMP_WORDS[2]}}"
  fi
  case $command in
{flags}
  esac
  if [[ $current == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$current"))
    return
  fi
  [[ $before == --* ]] || before=''
  case "$command $before" in
{taken}
  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
  if [[ $files ]]; then
    local IFS=$'\\n'
    COMPREPLY+=($(compgen -f -- "$current"))
    compopt -o filenames 2>/dev/null
  fi
}}
complete -F _vitruvius {" ".join(PROGRAMS)}
"""


def _bash_values(found: Iterable[Place]) -> Iterator[str]:
    """Cases of a command and the option before the cursor, or none where arguments without names stand."""
    for place in found:
        for option in place.options:
            if option.positional or option.type is bool:
                continue
            words, files = " ".join(values(option)), "yes" if takes_files(option) else ""
            if not words and not files:
                continue
            pattern = shlex.quote(f"{place.words} {option.flag}")
            yield f"    {pattern}) words={shlex.quote(words)} files={files} ;;"
        positional = [option for option in place.options if option.positional]
        if positional:
            words = " ".join(dict.fromkeys(word for option in positional for word in values(option)))
            files = "yes" if any(map(takes_files, positional)) else ""
            # After a switch, too, such an argument may stand.
            switches = [option.flag for option in place.options if option.type is bool]
            patterns = "|".join(shlex.quote(f"{place.words} {flag}") for flag in ["", *switches])
            yield f"    {patterns}) words={shlex.quote(words)} files={files} ;;"


def zsh() -> str:
    """The script for zsh."""
    found, cases = places(), list[str]()
    for place in found:
        specs = " ".join(shlex.quote(spec) for spec in _zsh_specs(place))
        cases.append(f"    {shlex.quote(place.words)}) _arguments -S {specs} ;;")
    commands = _zsh_described(place for place in found if " " not in place.words)
    studies = _zsh_described(place for place in found if " " in place.words)
    body = "\n".join(cases)
    return f"""\
#compdef {" ".join(PROGRAMS)}
# Completion of vitruvius by zsh: eval "$(vitruvius completion zsh)", after compinit
_vitruvius_or_files() {{ compadd -- "$@"; _files }}
_vitruvius() {{
  local -a commands studies
  commands=({commands})
  studies=({studies})
  local command=$words[2]
  if ((CURRENT == 2)); then
    _describe command commands
    return
  fi
  if [[ $command == bench ]]; then
    if ((CURRENT == 3)); then
      _describe study studies
      return
    fi
    command="bench $words[3]"
    shift 1 words
    ((CURRENT--))
  fi
  shift 1 words
  ((CURRENT--))
  case $command in
{body}
    help) ((CURRENT == 2)) && _describe command commands ;;
  esac
}}
compdef _vitruvius {" ".join(PROGRAMS)}
"""


def _zsh_described(found: Iterable[Place]) -> str:
    words = (f"{place.words.rpartition(' ')[2]}:{place.sentence}" for place in found)
    return " ".join(map(shlex.quote, words))


def _zsh_specs(place: Place) -> Iterator[str]:
    """Of each option what ``_arguments`` takes."""
    for option in place.options:
        action = _zsh_action(option)
        if option.positional:
            yield f"{'*' if option.several else ''}:{option.name}:{action}"
            continue
        star = "*" if option.repeated else ""
        about = _zsh_text(_short(option.help))
        if option.type is bool:
            yield f"{option.flag}[{about}]"
            if option.default:
                yield f"--no-{option.flag[2:]}[{about}]"
        elif option.several:
            yield f"{option.flag}[{about}]:*-*:{option.name}:{action}"
        else:
            yield f"{star}{option.flag}=[{about}]:{option.name}:{action}"
    yield "--help[Show help]"


def _zsh_action(option: Option) -> str:
    words = " ".join(values(option))
    if words and takes_files(option):
        return f" _vitruvius_or_files {words}"
    return f"({words})" if words else "_files" if takes_files(option) else ""


def _zsh_text(text: str) -> str:
    """A sentence without what ``_arguments`` reads as its own."""
    return text.translate({ord(letter): f"\\{letter}" for letter in "[]:"})


def fish() -> str:
    """The script for fish."""
    lines = [
        "# Completion of vitruvius by fish: ~/.config/fish/completions/vitruvius.fish",
        'function __vitruvius_after; set -l w (commandline -poc); test "$w[2..]" = "$argv[1]"; end',
        "function __vitruvius_in; set -l w (commandline -poc)",
        '  string match -q -- "$argv[1] *" "$w[2..] "; end',
        "complete -c vitruvius -f",
        *_fish_lines(),
    ]
    return "\n".join(lines) + "\n"


def _fish_lines() -> Iterator[str]:
    start = "complete -c vitruvius -n"
    for place in places():
        above, _, name = place.words.rpartition(" ")
        after, here = (_fish(f"__vitruvius_{word}") for word in (f"after '{above}'", f"in '{place.words}'"))
        yield f"{start} {after} -a {name} -d {_fish(place.sentence)}"
        for option in place.options:
            words = " ".join(values(option))
            taken = f" -a {_fish(words)}" if words else ""
            about = _fish(_short(option.help))
            if option.positional:
                files = " -F" if takes_files(option) else ""
                yield f"{start} {here}{files}{taken}"
            elif option.type is bool:
                flags = [option.flag[2:], *([f"no-{option.flag[2:]}"] if option.default else [])]
                yield from (f"{start} {here} -l {flag} -d {about}" for flag in flags)
            else:
                files = "-r -F" if takes_files(option) else "-x"
                yield f"{start} {here} -l {option.flag[2:]} -d {about} {files}{taken}"


def _short(text: str) -> str:
    """What a list of completions has room for."""
    return textwrap.shorten(text.partition(". ")[0].rstrip("."), 70, placeholder="...")


def _fish(text: str) -> str:
    """Quoted for fish."""
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"
