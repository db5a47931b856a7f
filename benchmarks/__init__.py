"""Studies of houses, of the simulator's speed, and of agents. ``vitruvius bench NAME`` runs one.

Each study is a dataclass whose fields are its options, with a method ``run``. A study is imported only when
it is asked for.
"""

STUDIES = {
    "generator": ("benchmarks.generator.run:Generator", "Solve time against rooms, on any grammar."),
    "sampling": ("benchmarks.generator.sampling:Sampling", "How evenly layouts and lengths are sampled."),
    "mutants": (
        "benchmarks.reliability.mutants:Mutants",
        "How many small mistakes in code and rules the tests notice.",
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
    "shards": ("benchmarks.generator.shards:Shards", "A set of houses under kills, beside one without."),
    "kills": ("benchmarks.reliability.kills:Kills", "Commands under kills: each file is whole or absent."),
    "verdicts": ("benchmarks.generator.verdicts:Verdicts", "Whether walls or furniture are refuted falsely."),
    "homes": ("benchmarks.generator.homes:Homes", "What homes cost and are like, beside published ones."),
    "realism": ("benchmarks.realism.run:Realism", "Whether two sets of plans are alike; weights that fit."),
    "brief": ("benchmarks.briefs.run:BriefStudy", "A frozen bank of briefs: answered, scored, timed."),
    "planted": (
        "benchmarks.briefs.planted:PlantedStudy",
        "What known plans keep at their limits: no false proof.",
    ),
    "watch": ("benchmarks.generator.watch:WatchStudy", "Seconds from the save of a rule file to its houses."),
    "simulator": ("benchmarks.simulator.run:Simulator", "What a step costs, beside the same step in C."),
    "gpu": ("benchmarks.simulator.gpu:GPU", "Simulator and learner on a GPU, beside the CPU."),
    "peers": ("benchmarks.simulator.peers.run:Peers", "Steps a second of other simulators."),
    "agents": ("benchmarks.agents.run:Agents", "Train every preset and its changes, and measure all."),
    "paper": ("benchmarks.paper.run:PaperStudy", "The paper's claims, one by one, and what comes out here."),
    "learner": ("benchmarks.agents.learner:LearnerStudy", "Where the time of a training step goes."),
    "throughput": ("benchmarks.agents.throughput:Throughput", "Training speed of one process and of two."),
    "ranks": ("benchmarks.agents.ranks:Ranks", "What training by 1, 2 and 4 ranks costs."),
    "transfer": ("benchmarks.agents.transfer:Transfer", "Agents in houses of other kinds."),
    "explorers": ("benchmarks.planner.explorers:Explorers", "The planner with other numbers, or a prior."),
    "exploration": ("benchmarks.exploration.run:Exploration", "How agents explore maps of buildings."),
    "tasks": ("benchmarks.planner.tasks:Tasks", "What knowing where targets lie is worth, task by task."),
    "learning": ("benchmarks.planner.learning:Learning", "What learning adds to the explorer, paired."),
    "views": ("benchmarks.planner.views:Views", "What parts of the network that searches are worth."),
    "bounds": ("benchmarks.planner.bounds:Bounds", "What a network that searches may learn to know."),
    "playing": ("benchmarks.planner.playing:Playing", "Steps a second of agents that play."),
    "odds": ("benchmarks.planner.odds:Odds", "Where an unseen target may be: the planner's table."),
}
"""Import path ``module:Class`` and subject of each study, by name."""

GROUPS = {"generator": "Houses", "simulator": "Simulator", "agents": "Agents", "explorers": "Planner"}
"""Titles of the groups of studies, by the first study of each."""

SECTIONS = (
    (("generator.json", "simulator.json"), "benchmarks.common.section:timings"),
    (("homes.json",), "benchmarks.generator.section:homes"),
)
"""Sections of a report for the files of studies: see ``agent.report.folder``."""
