"""Tables for a terminal and for Markdown, and pictures."""

import io

import numpy as np
import pytest
from PIL import Image
from rich.console import Console

from tests.agent.evaluation.cases import result, scores
from vitruvius.agent.evaluation.plots import learning_curve, ratio_plot
from vitruvius.agent.evaluation.tables import Table, print_tables, score_table, tables
from vitruvius.agent.learning.learner import Progress

WIDEST = result(
    *[scores([98] * 4, [200] * 4, interventions=600)] * 3,
    oracle=[100, 99, 98, 101], rooms=[2, 3, 4, 6], shortest=[150] * 4,
    others={"random + avoidance": scores([10, 9, 99, 98], blocked=600)},
)  # fmt: skip


def shown(*tables: Table, width: int = 80, terminal: bool = True) -> str:
    """Return what a terminal of ``width`` columns shows, or what goes into a pipe."""
    console = Console(width=width, file=io.StringIO(), force_terminal=terminal, color_system=None)
    print_tables(tables, console)
    return console.file.getvalue()  # pyright: ignore[reportAttributeAccessIssue]


def test_the_tables_fit_a_terminal_of_80_columns():
    text = shown(*tables(WIDEST))
    assert "…" not in text
    assert max(map(len, text.splitlines())) <= 80
    assert "agent, 3 runs" in text


@pytest.mark.parametrize(("width", "terminal"), [(80, True), (40, True), (20, True), (80, False)])
def test_no_figure_is_cut_in_a_pipe_or_on_a_narrow_terminal(width, terminal):
    agents = {
        "map-completion-habit, of a long name": scores([198] * 4),
        "an-agent-with-one-word-only": scores([2] * 4),
    }
    wide = result(
        *[scores([198] * 4)] * 3,
        oracle=[100, 199, 98, 101],
        rooms=[2, 3, 4, 16],
        shortest=[150] * 4,
        others=agents,
    )
    text = shown(*tables(wide), width=width, terminal=terminal)
    assert "…" not in text
    for row in (row for table in tables(wide) for row in table.rows):
        assert all(word in text for cell in row[1:] for word in cell.split())
    if not terminal:
        assert all(cell in text for row in score_table(wide).rows for cell in row)


def test_a_row_has_targets_and_their_ratio_to_the_oracles_with_intervals():
    one = result(scores([5, 10]), oracle=(10, 20), mode="main")
    agent, oracle, _ = score_table(one).rows
    assert agent[:3] == ("agent", "7.5 [5.0, 10.0]", "0.50 [0.50, 0.50]")
    assert oracle[:3] == ("oracle", "15.0 [10.0, 20.0]", "1.00 [1.00, 1.00]")


@pytest.mark.parametrize(("mode", "human"), [("main", "27 of 56"), ("secondary", "10 of 21")])
def test_the_human_stands_last_and_is_said_to_be_of_another_house(mode, human):
    [*_, last] = score_table(result(scores([5, 10]), mode=mode)).rows
    assert last[:3] == ("human, another house", human, "0.48")


def test_in_the_papers_house_the_human_stands_beside_agents_as_one_who_saw_the_plan():
    [*_, last] = score_table(result(scores([5, 10]), mode="paper-main")).rows
    assert last[:3] == ("human, saw the plan", "27 of 56", "0.48")


def test_the_papers_agent_is_told_apart_by_its_weights():
    others = {"paper-original": scores([3, 3]), "paper": scores([1, 1])}
    names = [row[0] for row in score_table(result(scores([5, 10]), others=others)).rows]
    assert names[1:3] == ["paper, original", "paper, retrained"]


def test_without_a_human_every_row_has_a_cell_for_each_column():
    for table in tables(result(scores([5, 10]), mode="mixed")):
        assert {len(row) for row in table.rows} == {len(table.headings)}


def test_markdown_has_the_same_cells_as_the_terminal():
    table = score_table(WIDEST)
    markdown = table.markdown()
    assert markdown.startswith("**Targets in secondary rooms, 4 houses**\n\n| policy | targets |")
    for row in table.rows:
        assert f"| {' | '.join(row)} |" in markdown
        assert all(cell in shown(table) for cell in row)


def picture(content: bytes) -> np.ndarray:
    with Image.open(io.BytesIO(content)) as image:
        return np.array(image)


def test_the_ratio_plot_shows_target_modes_side_by_side():
    one = result(scores([5, 5]))
    single, triple = picture(ratio_plot([one])), picture(ratio_plot([one] * 3))
    assert triple.shape[1] > 2 * single.shape[1]


def test_the_learning_curve_shows_a_run_alone_or_beside_policies_that_were_measured():
    history = [Progress(steps, 1.0, steps / 3e6, steps / 1e5, *[0.1] * 5) for steps in (10**6, 3 * 10**6)]
    alone, beside = picture(learning_curve(history)), picture(learning_curve(history, WIDEST))
    assert alone.shape == beside.shape
    assert not np.array_equal(alone, beside)
