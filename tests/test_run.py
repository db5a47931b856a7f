"""Claims about ./run, which sets up everything, on machines made of stubs: nothing is really installed."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.programs import PATIENCE, finished

ROOT = Path(__file__).parents[1]
TOOLS = "bash cat chmod cksum cp dirname env flock grep id ln mkdir mv readlink rm sed sh sleep true xargs"
SWIPL = "exit 0"
APT = "echo 'E: no network' >&2; exit 100"
UV = """
case "$1 $2" in
"venv -q") mkdir -p "$3/bin" && ln -s "$(command -v env)" "$3/bin/python" ;;
"pip sync") echo all >>"$STUBS/log"; echo "+ torch"; sleep "${SLOW:-0}"; [ ! -e "$STUBS/broken" ] ;;
"pip install")
    case $* in *--constraints*)
        echo "${@: -1}" >>"$STUBS/log"; sleep "${SLOW:-0}"; [ ! -e "$STUBS/broken" ] || exit ;;
    esac
    while [ "$1" != --python ]; do shift; done
    printf '%s\\n' '#!/usr/bin/env bash' 'echo "vitruvius $* in $PWD"; exit 3' >"$2/bin/vitruvius"
    chmod +x "$2/bin/vitruvius" ;;
esac
"""
UV_INSTALLER = """echo 'mkdir -p "$UV_UNMANAGED_INSTALL" && cp "$STUBS/hidden" "$UV_UNMANAGED_INSTALL/uv"'"""
UV_SOURCES = {
    "curl": UV_INSTALLER,
    "wget": UV_INSTALLER,
    # python3 -m venv --clear FOLDER, then FOLDER/bin/python -m pip install uv
    "python3": """
case "$3" in
--clear) mkdir -p "$4/bin" && cp "$0" "$4/bin/python" ;;
install) cp "$STUBS/hidden" "${0%python}uv" ;;
esac
""",
}


class Machine:
    """Checkout with ./run in it, on a machine that has only basic tools and the given programs."""

    def __init__(self, folder: Path, **programs: str) -> None:
        self.stubs, self.checkout = folder / "bin", folder / "a checkout"
        self.stubs.mkdir()
        self.checkout.mkdir()
        for tool in TOOLS.split():
            if path := shutil.which(tool):
                (self.stubs / tool).symlink_to(path)
        for name, script in programs.items():
            (self.stubs / name).write_text(f"#!/usr/bin/env bash\n{script}\n")
            (self.stubs / name).chmod(0o755)
        shutil.copy(ROOT / "run", self.checkout)
        for name in ("pyproject.toml", "requirements.lock"):
            (self.checkout / name).write_text(name)

    def start(self, *args: str, **env: str) -> subprocess.Popen[str]:
        everything = os.environ | dict.fromkeys(("PATH", "HOME", "STUBS"), str(self.stubs)) | env
        command = [str(self.checkout / "run"), *args]
        pipe = subprocess.PIPE
        return subprocess.Popen(
            command,
            env=everything,
            cwd=self.stubs,
            stdin=subprocess.DEVNULL,
            stdout=pipe,
            stderr=pipe,
            text=True,
        )

    def run(self, *args: str) -> tuple[int, str, str]:
        process = self.start(*args)
        out, err = process.communicate(timeout=PATIENCE)
        return process.returncode, out, err

    def set_ups(self) -> list[str]:
        """Return the installed parts, one for each set-up: ``.``, ``.[agent]``, ``all``."""
        log = self.stubs / "log"
        return log.read_text().splitlines() if log.exists() else []


@pytest.fixture
def machine(tmp_path: Path) -> Machine:
    return Machine(tmp_path, swipl=SWIPL, uv=UV, **{"apt-get": APT})


def test_a_command_sets_up_once_and_keeps_its_arguments_folder_output_and_exit_code(machine: Machine) -> None:
    for _ in range(2):
        code, out, _ = machine.run("generate", "--out", "my houses.jsonl")
        assert (code, out) == (3, f"vitruvius generate --out my houses.jsonl in {machine.stubs}\n")
    assert len(machine.set_ups()) == 1


@pytest.mark.parametrize("relative", [False, True])
def test_a_link_to_it_runs_in_the_checkout_that_it_leads_to(
    machine: Machine, relative: bool, tmp_path: Path
) -> None:
    first, second = machine.stubs / "vitruvius", tmp_path / "elsewhere"
    first.symlink_to(Path("..") / machine.checkout.name / "run" if relative else machine.checkout / "run")
    second.symlink_to(Path(machine.stubs.name) / first.name if relative else first)
    made = finished(
        [second, "check"],
        env=os.environ | dict.fromkeys(("PATH", "HOME", "STUBS"), str(machine.stubs)),
        cwd=machine.stubs,
    )
    assert (made.returncode, made.stdout) == (3, f"vitruvius check in {machine.stubs}\n"), made.stderr
    assert (machine.checkout / ".venv").is_dir()


@pytest.mark.parametrize(
    ("words", "installed"),
    [
        ("generate", ["."]),
        ("watch", ["."]),
        ("train", [".[agent]"]),
        ("play", [".[play]"]),
        ("setup ifc", [".[ifc]"]),
        ("demo", [".", ".[agent]"]),
        ("python", ["all"]),
        ("setup", ["all"]),
    ],
)
def test_a_command_sets_up_what_it_needs_and_no_more(
    machine: Machine, words: str, installed: list[str]
) -> None:
    (machine.checkout / "pyproject.toml").write_text("ifc = [\n]\n")
    machine.run(*words.split())
    assert machine.set_ups() == installed


def test_what_was_set_up_for_another_command_stays_and_is_enough_for_a_smaller_one(machine: Machine) -> None:
    for words in ("train", "generate", "play", "train", "setup", "play", "record"):
        machine.run(words)
    assert machine.set_ups() == [".[agent]", ".[agent,play]", "all"]


def test_the_demo_draws_six_homes_before_the_rest_is_installed(machine: Machine) -> None:
    log = UV.replace("""'echo "vitruvius $* in $PWD"; exit 3'""", """'echo "$*" >>"$STUBS/log"'""")
    (machine.stubs / "uv").write_text(f"#!/usr/bin/env bash\n{log}")
    machine.run("demo")
    base, generate, draw, rest, demo = machine.set_ups()
    assert (base, rest, demo) == (".", ".[agent]", "demo")
    assert "--count 6" in generate
    assert draw.startswith("draw ")


def test_an_extra_that_is_none_is_refused_in_one_line(machine: Machine) -> None:
    code, out, err = machine.run("setup", "nothing")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert machine.set_ups() == []


def test_help_sets_nothing_up(machine: Machine) -> None:
    for args in [(), ("help",), ("--help",)]:
        code, out, _ = machine.run(*args)
        assert code == 0
        assert "./run demo" in out
    assert machine.set_ups() == []


def test_the_help_of_a_command_is_the_command_s_own(machine: Machine) -> None:
    assert machine.run("help", "check")[1] == f"vitruvius help check in {machine.stubs}\n"


def test_a_set_up_cut_short_is_begun_again(machine: Machine) -> None:
    (machine.stubs / "broken").touch()
    code, _, err = machine.run("train")
    assert code == 69
    assert "could not be installed" in err.splitlines()[-1]
    leftover = machine.checkout / ".venv" / "half a package"
    leftover.touch()
    (machine.stubs / "broken").unlink()
    assert machine.run("train")[0] == 3
    assert not leftover.exists()


@pytest.mark.parametrize("what", ["requirements.lock", "pyproject.toml", "run"])
def test_a_changed_file_is_noticed(machine: Machine, what: str) -> None:
    machine.run("train")
    with (machine.checkout / what).open("a") as file:
        file.write("# changed\n")
    machine.run("train")
    assert len(machine.set_ups()) == 2


def test_a_moved_checkout_is_set_up_anew(machine: Machine) -> None:
    machine.run("train")
    old = machine.checkout / ".venv" / "with the old path"
    old.touch()
    machine.checkout = machine.checkout.rename(machine.checkout.with_name("moved"))
    assert machine.run("train")[0] == 3
    assert len(machine.set_ups()) == 2
    assert not (machine.checkout / ".venv" / old.name).exists()


def test_a_prolog_that_vanished_is_noticed_and_named(machine: Machine) -> None:
    machine.run("train")
    (machine.stubs / "swipl").unlink()
    code, out, err = machine.run("train")
    assert (code, out) == (69, "")
    assert "SWI-Prolog 9.0 or later" in err.splitlines()[-1]


def test_an_old_prolog_is_not_taken_for_a_good_one(machine: Machine) -> None:
    (machine.stubs / "swipl").write_text("#!/usr/bin/env bash\nexit 1\n")
    assert machine.run("train")[0] == 69


@pytest.mark.parametrize(
    ("release", "candidate", "names"),
    [
        ("UBUNTU_CODENAME=jammy", "8.4.2+dfsg-2ubuntu1", "before 9.0.*add-apt-repository ppa"),
        ("UBUNTU_CODENAME=jammy", "9.3.8-1-g2fa0e6e-jammyppa2", ""),
        ("UBUNTU_CODENAME=noble", "9.0.4+dfsg-3.1ubuntu4", ""),
        ("VERSION_CODENAME=bullseye", "8.2.4+dfsg-1", "before 9.0.*: conda install"),
        ("VERSION_CODENAME=bookworm", "9.0.4+dfsg-2", ""),
    ],
)
def test_where_apt_has_an_old_prolog_its_archive_is_named_and_nothing_is_installed(
    tmp_path: Path, release: str, candidate: str, names: str
) -> None:
    policy = f"echo '  Candidate: {candidate}'"
    log = {"apt-get": 'echo >"$STUBS/installed"; exit 100', "apt-cache": policy}
    machine = Machine(tmp_path, swipl="exit 1", **log)
    (tmp_path / "os-release").write_text(f"NAME=Linux\n{release}\n")
    process = machine.start("train", OS_RELEASE=str(tmp_path / "os-release"))
    err = process.communicate(timeout=PATIENCE)[1]
    assert process.returncode == 69
    assert re.search(names or "could not be installed", err.splitlines()[-1])
    assert (machine.stubs / "installed").exists() == (not names)


def test_a_prolog_that_cannot_run_is_named_and_nothing_is_installed(tmp_path: Path) -> None:
    """Under a tiny stack (``ulimit -s``) Prolog ends by a signal."""
    install = {"apt-get": 'echo >"$STUBS/installed"'}
    machine = Machine(tmp_path, swipl="kill -SEGV $$", **install)
    code, _, err = machine.run("train")
    assert code == 69
    assert "as it started: check the limits" in err.splitlines()[-1]
    assert not (machine.stubs / "installed").exists()


def test_without_uv_and_python_the_message_says_what_to_install(tmp_path: Path) -> None:
    code, _, err = Machine(tmp_path, swipl=SWIPL, **{"apt-get": APT}).run("test")
    assert code == 69
    assert "python3-venv" in err.splitlines()[-1]


@pytest.mark.parametrize("program", ["python3", "curl", "wget"])
def test_uv_is_brought_by_what_is_there(tmp_path: Path, program: str) -> None:
    machine = Machine(tmp_path, swipl=SWIPL, hidden=UV, **{program: UV_SOURCES[program]})
    assert machine.run("train")[0] == 3
    assert (machine.checkout / ".local/uv/bin/uv").exists()


@pytest.mark.skipif(not shutil.which("flock"), reason="needs flock")
def test_two_at_once_set_up_once(machine: Machine) -> None:
    both = [machine.start("train", SLOW="0.5") for _ in range(2)]
    answers = [process.communicate(timeout=PATIENCE) for process in both]
    assert [process.returncode for process in both] == [3, 3]
    assert len(machine.set_ups()) == 1
    assert any("waiting for another ./run" in err for _, err in answers)


@pytest.mark.parametrize(
    ("args", "given"),
    [
        ((), "-q -n auto --maxprocesses 8 --dist worksteal"),
        (("-n", "0"), "-q -n auto --maxprocesses 8 --dist worksteal -n 0"),
        (("tests/sim", "-k", "rays"), "-q -n auto --maxprocesses 8 --dist worksteal tests/sim -k rays"),
        (("tests/test_run.py",), "-q tests/test_run.py"),
    ],
)
def test_tests_run_side_by_side_unless_files_are_named(
    machine: Machine, args: tuple[str, ...], given: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    machine.run("train")
    python = machine.checkout / ".venv/bin/python"
    python.unlink()
    python.write_text(
        '#!/usr/bin/env bash\necho "$* in $PWD, $OMP_NUM_THREADS ${PYTHONDONTWRITEBYTECODE-}"\n'
    )
    python.chmod(0o755)
    code, out, _ = machine.run("test", *args)
    assert (code, out) == (0, f"-m pytest {given} in {machine.checkout}, 1 \n")
