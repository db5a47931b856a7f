"""Tables of an evaluation: one renderer for terminals and for Markdown."""

from collections.abc import Iterable
from dataclasses import dataclass

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table as RichTable
from rich.text import Text

from vitruvius.agent.evaluation.result import HUMAN_RATIO, SUCCESS_STEPS, Result
from vitruvius.logic.spelling import numbered, printable
from vitruvius.sim.tasks.tasks import PAPER_TASKS

ROOMS = {"main": "the main room", "secondary": "secondary rooms", "mixed": "all rooms"}
WHERE = ROOMS | {"all": "all rooms"} | {f"paper-{mode}": f"{where}, paper's" for mode, where in ROOMS.items()}
"""Location of the targets, by target mode, in words: the paper's targets lie at fixed places of its own
house."""

LABELS = {"paper-original": "paper, original", "paper": "paper, retrained"}
"""Labels of policies in tables, by name."""


def human_name(mode: str) -> str:
    """Return the label of the paper's human, who played in the paper's house and saw the whole plan."""
    return "human, saw the plan" if mode in PAPER_TASKS else "human, another house"


SCORE_NOTE = (
    "All policies have the same starts and targets. Targets: number collected in an episode. Ratio: targets "
    "relative to the oracle in the same house; the oracle knows the house and the target and takes the "
    "shortest path. Both are interquartile means, with 95 % intervals over training runs and houses. "
    f"Success: share of episodes that reach their first target within {SUCCESS_STEPS} steps, or at all if "
    "it ends the episode. SPL: success weighted by the length of the shortest path over the path taken. "
    "Steps to find: steps to the first target, or those of a whole episode. Last column: share of houses "
    "with more targets than the paper's human, who saw the whole map of the paper's own house; the human's "
    "row states if that is another house. Random + avoidance is the paper's random walk; the explorer is "
    "the planner without a network."
)
"""Note on the columns and rows of ``score_table``."""

NOTE = (
    f"{SCORE_NOTE} Paper, original: the weights that the paper's authors released. Paper, retrained: their "
    "agent, trained again here. Both use the original's avoidance, and 2.5 % of random actions. The "
    "searcher knows the house, but not the target's place. Seen: share of the target places that the policy "
    "has looked at by that step. Rooms: share of the secondary rooms that it has entered. Blocked moves, "
    "and actions changed by the action mask: per 1000 steps."
)
"""Note on the columns and rows of all tables."""


DRIVING_NOTE = (
    "All policies meet the same starts and targets, and drive. Targets: picked up in an episode. Ratio: to "
    "the true path in the same house. Both are interquartile means, with 95 % intervals over training runs "
    f"and houses. Success: the share of episodes with a first target within {SUCCESS_STEPS} steps, or at "
    "all, where it ends the episode. SPL: that times the true path's time to the first target over the time "
    "taken. The true path's body knows the house and the target, the explorer its pose; the "
    "pursuit goes to a target that its rays show, else where they go furthest; a random drive is of speeds "
    "by chance. Seen: the share of the places where targets may lie that it had looked at by that step. "
    "Rooms: the share of the secondary rooms that it was in. Blocked moves: per 1000 steps."
)
"""Note on the columns and rows if bodies drive."""


MAX_COLUMNS = 10_000
"""Largest width of a table in a pipe, in characters."""


@dataclass(frozen=True)
class Table:
    """Table in words."""

    title: str
    headings: tuple[str, ...]
    rows: list[tuple[str, ...]]

    def terminal(self, folded: bool = False) -> RichTable:
        """Return the table for a terminal.

        If ``folded``, each interval is below its figure, and a long name takes two lines.
        """
        table = RichTable(
            title=Text(f"\n{self.title}"),
            title_justify="left",
            title_style="bold",
            box=SIMPLE_HEAD,
            show_edge=False,
            pad_edge=False,
            padding=(0, 1, 0, 0),
        )
        for place, heading in enumerate(self.headings):
            justify = "right" if place else "left"
            no_wrap = bool(place) or not folded
            table.add_column(Text(heading), justify=justify, no_wrap=no_wrap, overflow="fold")
        for name, *cells in self.rows:
            figures = [cell.replace(" [", "\n[") if folded else cell for cell in cells]
            table.add_row(*map(Text, (name, *figures)))  # as Text: rich would read [red] as a colour
        return table

    def markdown(self) -> str:
        """Return the table in Markdown, under its title."""
        rows = [[*map(_in_cell, row)] for row in (self.headings, *self.rows)]
        lines = (rows[0], ["---"] * len(self.headings), *rows[1:])
        title = _in_cell(self.title)
        return f"**{title}**\n\n" + "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _in_cell(text: str) -> str:
    """Return text escaped as a cell of a Markdown table: a name can neither end the cell nor become HTML."""
    return printable(text).replace("<", "&lt;").replace("|", "\\|")


def print_tables(tables: Iterable[Table], console: Console) -> None:
    """Print tables without truncated figures: in full width, or folded on a narrower terminal."""
    for table in tables:
        unbounded = Console(width=MAX_COLUMNS)
        whole, folded = table.terminal(), table.terminal(folded=True)
        narrow = console.is_terminal and unbounded.measure(whole).maximum > console.width
        shown = folded if narrow else whole
        least = unbounded.measure(shown).minimum if narrow else unbounded.measure(shown).maximum
        console.width, before = max(console.width, least), console.width
        console.print(shown)
        console.width = before


def tables(result: Result) -> list[Table]:
    """Return the three tables of a target mode."""
    return [score_table(result), behaviour_table(result), rooms_table(result)]


def score_table(result: Result) -> Table:
    """Return the table of each policy's scores."""
    if result.ends_on_pick_up:
        return find_table(result)
    human = result.human
    rows = []
    for name, label in _labels(result).items():
        figures = result.figures(name)
        means = [figures[key].value for key in ("success", "spl", *(["human"] if human else []))]
        rows.append((
            label, figures["targets"].text(1), figures["ratio"].text(2), *(f"{mean:.2f}" for mean in means)
        ))  # fmt: skip
    headings = ("policy", "targets", "ratio", "success", "SPL")
    if human:
        rows.append(
            (human_name(result.mode), f"{human.targets} of {human.oracle}", f"{HUMAN_RATIO}", "", "", "")
        )
        headings += (f"> {human.targets}",)
    return Table(f"{capital(result.task)}, {_count(result)}", headings, rows)


def find_table(result: Result) -> Table:
    """Return the table of each policy's scores if the first target ends the episode."""
    rows = []
    for name, label in _labels(result).items():
        figures = result.figures(name)
        rows.append((
            label, figures["success"].text(2), figures["spl"].text(2), f"{figures['first_find'].value:.0f}"
        ))  # fmt: skip
    title = f"{capital(result.task)}, {_count(result)}"
    return Table(title, ("policy", "success", "SPL", "steps to find"), rows)


def _count(result: Result) -> str:
    """Return the number of houses in words, with the episodes in each if there are several."""
    houses = len(result.rooms) // result.episodes
    count = numbered(houses, "house")
    return count + (f", {result.episodes} episodes each" if result.episodes > 1 else "")


def behaviour_table(result: Result) -> Table:
    """Return the table of what each policy sees and where it goes."""
    rows = []
    for name, label in _labels(result).items():
        figures = result.figures(name)
        shares = (f"{figures[key].value:.2f}" for key in ("coverage_500", "coverage_1500", "rooms"))
        counts = (f"{figures[key].value:.1f}" for key in ("blocked", "interventions"))
        rows.append((label, *shares, *counts))
    headings = ("policy", "seen by 500", "by 1500", "rooms", "blocked", "overruled")
    return Table(f"Behaviour, {result.task}", headings, rows)


def rooms_table(result: Result) -> Table:
    """Return the table of the ratio by number of secondary rooms."""
    by_rooms = {
        label: result.by_rooms(name) for name, label in _labels(result).items() if name != result.yardstick
    }
    headings = ("policy", *map(str, sorted(set(result.rooms.tolist()))))
    rows = [(label, *(f"{each.value:.2f}" for each in row.values())) for label, row in by_rooms.items()]
    return Table(f"Ratio by number of secondary rooms, {result.task}", headings, rows)


def capital(words: str) -> str:
    """Return words with a capital first letter."""
    return words[:1].upper() + words[1:]


def _labels(result: Result) -> dict[str, str]:
    """Return each policy's label, with the number of its training runs if there are several."""
    return {
        name: LABELS.get(name, name) + (f", {len(runs)} runs" if len(runs) > 1 else "")
        for name, runs in result.policies.items()
    }
