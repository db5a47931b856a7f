"""The folder of Taichi's compiled kernels, for all environment variables and permissions."""

import os
import tempfile
from pathlib import Path

import pytest

from vitruvius.sim.cache import VARIABLE, provide


@pytest.fixture
def own(tmp_path, monkeypatch):
    """Return the folder of this user among the temporary files, when no other folder is writable."""
    (tmp_path / "file").touch()
    monkeypatch.setenv(VARIABLE, str(tmp_path / "file" / "cache"))
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path / f"vitruvius-{os.getuid()}"


def test_a_named_folder_that_can_be_written_stays(own, monkeypatch):
    named = own.parent / "a" / "cache"
    monkeypatch.setenv(VARIABLE, str(named))
    assert provide() is True
    assert os.environ[VARIABLE] == str(named)
    assert not [*named.iterdir()]
    assert named.stat().st_mode & 0o777 == 0o700
    assert not own.exists()


def test_without_a_named_folder_it_is_in_the_home(own, monkeypatch):
    monkeypatch.delenv(VARIABLE)
    assert provide() is True
    assert VARIABLE not in os.environ
    assert (own.parent / "home" / ".cache").is_dir()


@pytest.mark.parametrize("named", ["", "relative", None])
def test_else_it_is_a_folder_of_this_user_among_the_temporary_files(own, monkeypatch, named):
    if named is not None:
        monkeypatch.setenv(VARIABLE, named)
    if not named:
        monkeypatch.delenv("HOME")
    assert provide() is True
    assert os.environ[VARIABLE] == str(own)
    assert own.is_dir()
    assert not Path("relative").exists()


def test_what_cannot_be_written_there_either_is_said(own):
    own.touch()
    assert provide() is False
    assert os.environ[VARIABLE] == str(own)


@pytest.mark.parametrize("keeps", [True, False])
def test_without_temporary_files_a_folder_that_can_be_written_serves(own, monkeypatch, keeps):
    def none() -> str:
        raise FileNotFoundError

    named = own.parent / "cache"
    if keeps:
        monkeypatch.setenv(VARIABLE, str(named))
    monkeypatch.setattr("vitruvius.sim.cache._writable", lambda folder: folder == named)
    monkeypatch.setattr(tempfile, "gettempdir", none)
    assert provide() is keeps
    assert tempfile.tempdir == os.environ[VARIABLE] == (str(named) if keeps else os.sep)
