"""Sections of a report for the files of studies: see ``agent.report.folder``."""

SECTIONS = (
    (("generator.json", "simulator.json"), "benchmarks.common.section:timings"),
    (("homes.json",), "benchmarks.generator.section:homes"),
)
