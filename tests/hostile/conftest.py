"""Table of the hostile inputs by kind, at the end of their tests."""

from collections import Counter

import pytest

ANSWERS = ("refused", "limited", "accepted")


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print the answers to the inputs of each kind."""
    reports = [each for name in ("passed", "failed") for each in terminalreporter.stats.get(name, [])]
    rows = [value for each in reports for name, value in each.user_properties if name == "hostile"]
    if not rows:
        return
    counts = Counter((kind, answer) for kind, answer, _ in rows)
    effects = Counter({kind: 0 for kind, *_ in rows})
    for kind, _, number in rows:
        effects[kind] += number
    terminalreporter.write_sep("=", "hostile inputs")
    terminalreporter.write_line(
        "| kind | tried | refused | limited | accepted | effects |\n|---|---|---|---|---|---|"
    )
    for kind in sorted(effects):
        tried = sum(number for (each, _), number in counts.items() if each == kind)
        answers = " | ".join(str(counts[kind, answer]) for answer in ANSWERS)
        terminalreporter.write_line(f"| {kind} | {tried} | {answers} | {effects[kind]} |")
    totals = " | ".join(str(sum(counts[kind, answer] for kind in effects)) for answer in ANSWERS)
    terminalreporter.write_line(f"| all | {len(rows)} | {totals} | {sum(effects.values())} |")
