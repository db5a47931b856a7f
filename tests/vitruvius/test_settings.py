"""Settings of a training run as TOML: printed settings train the same, and errors name their line."""

import json
import re
import tomllib
from dataclasses import replace
from pathlib import Path

import jsonschema
import pytest
import torch

from tests.sample_houses import random_house
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.runs import checkpoint
from vitruvius.cli import main, parse
from vitruvius.logic import save
from vitruvius.settings import SettingsError, read

ROOT = Path(__file__).parents[2]
WORDS = "--num-envs 8 --num-steps 16 --steps 1500 --learning-rate 0.003 --half-lives 2 8 --seed 7"


def printed(words: str, capsys: pytest.CaptureFixture[str]) -> str:
    """Return what --print-config prints."""
    with pytest.raises(SystemExit, match=r"^0$"):
        main(["train", *words.split(), "--print-config"])
    return capsys.readouterr().out


@pytest.mark.parametrize("preset", PRESETS)
def test_the_settings_of_a_preset_are_printed_whole_and_read_back(
    preset: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "f.toml"
    file.write_text(printed(f"--preset {preset}", capsys))
    assert read(file) == (preset, PRESETS[preset], {})
    found = tomllib.loads(file.read_text())
    assert found.keys() == {"preset", *vars(PRESETS[preset])}
    assert printed(f"--config {file}", capsys) == file.read_text()
    assert max(map(len, file.read_text().splitlines())) <= 100


def test_a_printed_file_trains_the_same_network_bit_for_bit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    houses, file = tmp_path / "houses.jsonl", tmp_path / "f.toml"
    save([random_house(seed) for seed in range(4)], houses)
    file.write_text(printed(f"{houses} --name mine {WORDS}", capsys))
    assert parse(["train", str(houses), *WORDS.split(), "--out", str(tmp_path / "one")]).run() == 0
    capsys.readouterr()
    assert parse(["train", "--config", str(file), "--out", str(tmp_path / "other"), "--json"]).run() == 0
    answer = json.loads(capsys.readouterr().out)
    jsonschema.validate(answer, json.loads((ROOT / "docs" / "answers.schema.json").read_text()))
    assert (answer["answer"]["steps"], answer["answer"]["agent"][-23:]) == (1536, "other/agent.safetensors")
    one, other = (checkpoint.load(tmp_path / name / "agent.safetensors") for name in ("one", "other"))
    assert (one.config, one.houses, other.name) == (other.config, other.houses, "mine")
    pairs = zip(one.network.state_dict().values(), other.network.state_dict().values(), strict=True)
    assert all(torch.equal(ours, theirs) for ours, theirs in pairs)


def test_the_command_line_wins_over_the_file_and_the_file_over_the_preset(tmp_path: Path) -> None:
    file = tmp_path / "f.toml"
    file.write_text(
        'preset = "pqn"\nname = "mine"\nhouses = "mine.jsonl"\nseed = 3\nmax_grad_norm = "none"\n'
        'sim = ["noise=0.05", "rays=20"]\ngamma = 1\n'
    )
    train = parse(["train", "--config", str(file)])
    expected = replace(PRESETS["pqn"], seed=3, max_grad_norm=None, sim=("noise=0.05", "rays=20"), gamma=1.0)
    assert (train.preset, train.name, str(train.houses)) == ("pqn", "mine", "mine.jsonl")
    assert train.learning == expected
    words = f"train other.jsonl --config={file} --seed 4 --sim noise=0.1 --max-grad-norm 2"
    train = parse(words.split())
    assert str(train.houses) == "other.jsonl"
    assert train.learning == replace(expected, seed=4, sim=("rays=20", "noise=0.1"), max_grad_norm=2.0)
    file.write_text('preset = "pqn"\nseed = 3\n')
    assert parse(["train", "--config", str(file), "--preset", "dqn"]).learning == replace(
        PRESETS["dqn"], seed=3
    )


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (
            "steps = 9\nlerning_rate = 1\n",
            ":2: preset pqn: there is no setting lerning_rate: did you mean learning_rate?",
        ),
        ('\n\nsteps = "ten"\n', ":3: steps: expected `int`, got `str`"),
        ("seed = true\n", ":1: seed: expected `int`, got `bool`"),
        ("steps = 9\nsteps = 0\n", ":2: no TOML: Cannot overwrite a value"),
        ("# all\nsteps = 0\n", ":2: steps must be above 0, not 0"),
        ("gamma = nan\n", ":1: gamma must lie between 0 and 1, not nan"),
        ('preset = "dqm"\n', ":1: there is no preset dqm: did you mean dqn?"),
        ('preset = "dqn"\nnum_steps = 4\n', ":2: preset dqn: there is no setting num_steps"),
        ('world = "papre"\n', ":1: there is no world papre: did you mean paper?"),
        ("houses = 3\n", ":1: houses: expected text, not 3"),
        ("half_lives = [1, 'x']\n", ":1: half_lives: expected `float`, got `str`"),
        ('steps = "none"\n', ":1: steps: expected `int`, got `str`"),
        ("[train]\nsteps = 9\n", ":1: [train]: settings stand at the top of the file, in no table"),
        ("steps = \n", ":1: no TOML: Invalid value"),
        (
            "num_envs = 1\nnum_steps = 1\nnum_minibatches = 9\n",
            ":3: num_minibatches must not exceed num_envs x num_steps, not 9",
        ),
        (b"\xff\xfe", ": no TOML: it is no text in UTF-8"),
        (b"#" * (1 << 21), ": cannot be read: it holds more than 256 KiB"),
        (".".join(["a"] * 50_000) + " = 1\n", ":1: more than 256 dots in a line"),
        ("steps = " + "[" * 100_000, ": no TOML: nested too deeply"),
        ("steps = " + "9" * 5_000, ": no TOML: Exceeds the limit"),
        ("steps = 0x" + "f" * 20_000, ": no TOML: an integer of more than 64 bits"),
        (f"{'a' * 100_000} = 1\n", f":1: preset pqn: there is no setting {'a' * 100}...: there are"),
    ],
)
def test_what_is_wrong_in_a_file_is_named_by_its_line(text: str | bytes, says: str, tmp_path: Path) -> None:
    file = tmp_path / "f.toml"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(SettingsError, match=re.escape(f"{file}{says}")):
        read(file)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=r"none\.toml: cannot be read: No such file"):
        read(tmp_path / "none.toml")
