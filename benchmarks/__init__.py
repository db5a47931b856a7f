"""Studies of houses, of the simulator's speed, and of agents. ``vitruvius bench NAME`` runs one.

Each study is a dataclass whose fields are its options, with a method ``run``. A study is imported only when
it is asked for.
"""

STUDIES = {
    "generator": ("benchmarks.generator.run:Generator", "Solve time against rooms, on any grammar."),
    "sampling": ("benchmarks.generator.sampling:Sampling", "Uniformity of sampled layouts and lengths."),
    "mutants": (
        "benchmarks.reliability.mutants:Mutants",
        "Small mistakes in code and rules that the tests notice.",
    ),
    "fuzz": ("benchmarks.reliability.fuzz:Fuzz", "Files of others with random changes, by every reader."),
    "calls": (
        "benchmarks.reliability.environments:Calls",
        "Environments under random sequences of calls, made again.",
    ),
    "grammars": (
        "benchmarks.reliability.grammars:RandomGrammars",
        "Small random grammars: one of the four answers, twice.",
    ),
    "shards": (
        "benchmarks.generator.shards:Shards",
        "A set of houses under kills, compared with one without.",
    ),
    "kills": ("benchmarks.reliability.kills:Kills", "Commands under kills: each file is whole or absent."),
    "verdicts": ("benchmarks.generator.verdicts:Verdicts", "False refutations of walls or furniture."),
    "homes": ("benchmarks.generator.homes:Homes", "Time and sizes of homes, and published figures."),
    "realism": ("benchmarks.realism.run:Realism", "Similarity of two sets of plans; fitted weights."),
    "brief": ("benchmarks.briefs.run:BriefStudy", "A benchmark of briefs: answers, scores, times."),
    "planted": (
        "benchmarks.briefs.planted:PlantedStudy",
        "Briefs at the limits of known plans: no false proof.",
    ),
    "watch": ("benchmarks.generator.watch:WatchStudy", "Seconds from the save of a rule file to its houses."),
    "simulator": ("benchmarks.simulator.run:Simulator", "Time of a step, compared with the same step in C."),
    "speed": (
        "benchmarks.speed.run:Speed",
        "Steps per second of the simulator, planners, agents and training.",
    ),
    "peers": ("benchmarks.simulator.peers.run:Peers", "Steps per second of other simulators."),
    "agents": ("benchmarks.agents.run:Agents", "Training and scores of every preset and its changes."),
    "paper": ("benchmarks.paper.run:PaperStudy", "The paper's claims, one by one, and the results here."),
    "transfer": ("benchmarks.agents.transfer:Transfer", "Agents in houses of other kinds."),
    "explorers": ("benchmarks.planner.explorers:Explorers", "The planner with other numbers, or a prior."),
    "exploration": ("benchmarks.exploration.run:Exploration", "Exploration of maps of buildings."),
    "tasks": ("benchmarks.planner.tasks:Tasks", "Value of knowing where targets lie, task by task."),
    "learning": ("benchmarks.planner.learning:Learning", "Paired gain of learning over the explorer."),
    "views": ("benchmarks.planner.views:Views", "Ablations of the network that searches."),
    "bounds": ("benchmarks.planner.bounds:Bounds", "Upper bounds for a network that searches."),
    "odds": ("benchmarks.planner.odds:Odds", "Positions of unseen targets: the planner's table."),
}
"""Import path ``module:Class`` and subject of each study, by name."""

GROUPS = {"generator": "Houses", "simulator": "Simulator", "agents": "Agents", "explorers": "Planner"}
"""Titles of the groups of studies, by the first study of each."""

SECTIONS = (
    (("generator.json", "simulator.json"), "benchmarks.common.section:timings"),
    (("homes.json",), "benchmarks.generator.section:homes"),
)
"""Sections of a report for the files of studies: see ``agent.report.folder``."""
