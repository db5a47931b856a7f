"""Mistakes on the command line: the command, the exit code, and the answer."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Command:
    """Words after ``vitruvius``, in a folder that has houses.jsonl (one house of 2 rooms) and runs/mine."""

    words: str
    says: tuple[str, ...]
    code: int = 2


MISTAKES = (
    # commands
    Command("trian", ("there is no command trian", "did you mean train?")),
    Command("frobnicate", ("there is no command frobnicate: there are generate, regenerate, check",)),
    Command("bench generatr", ("there is no study generatr", "did you mean generator?")),
    Command("--rooms 3 generate", ("--rooms comes after a command: vitruvius generate --rooms 3",)),
    Command("--seed", ("--seed comes after a command, as in vitruvius generate",)),
    Command("bench --rounds 3 generator", ("after a command: vitruvius bench generator --rounds 3",)),
    Command("version", ("there is no command version", "did you mean --version?")),
    # options
    Command("generate rooms=3", ("rooms=3: did you mean --rooms=3?",)),
    Command("generate -rooms 3", ("-rooms: did you mean --rooms?",)),
    Command("draw houses.jsonl format svg", ("format: did you mean --format?",)),
    Command("explain houses.jsonl --why", ("--why: give a value, as in --why TEXT: Part to explain: a",)),
    Command(
        "generate --rooms 3 --snap 0.1", ("--plan-unit and --snap need a plan: give the plan with --plan",)
    ),
    Command("explain --rooms 3 --plan-unit cm", ("--plan-unit and --snap need a plan",)),
    Command("generate --rooom 3", ("generate: there is no option --rooom", "did you mean --rooms?")),
    Command("generate --rooms 3 --tpye hall=1", ("no option --tpye", "did you mean --type?")),
    Command("generate --rooms 3 --zoo 2", ("no option --zoo", "see vitruvius generate --help")),
    Command("train --learning_rat 1", ("no option --learning-rat", "did you mean --learning-rate?")),
    Command("train --no-resum", ("no option --no-resum", "did you mean --no-resume?")),
    Command("bench generator --round 5", ("no option --round", "did you mean --rounds?")),
    Command("check", ("vitruvius check: give FILE: House file, or - for the standard input.",)),
    Command("check houses.jsonl b", ("unexpected argument b", "see vitruvius check --help")),
    Command("convert houses.jsonl", ("give --out PATH: New house file",)),
    Command("generate --rooms", ("--rooms: give a value, as in --rooms N",)),
    Command("generate --rooms --count 3", ("--rooms: give a value",)),
    Command("check houses.jsonl --json=yes", ("--json takes no value",)),
    Command("generate --rooms many", ("--rooms many: give a whole number, as in --rooms 3",)),
    Command("generate --rooms 2 --cell wide", ("--cell wide: give a number",)),
    Command("train --half-lives 1 x", ("--half-lives x: give a number",)),
    Command("completion tcsh", ("there is no shell tcsh: there are bash, zsh",)),
    # names
    Command("draw houses.jsonl --format pgn", ("there is no format pgn", "did you mean png?")),
    Command("convert houses.jsonl --out x --to gtlf", ("there is no format gtlf", "did you mean gltf?")),
    Command("evaluate --world papre", ("there is no world papre", "did you mean paper?")),
    Command("play --view sene", ("there is no view sene", "did you mean seen?")),
    Command("bench generator --part lodaing", ("there is no part lodaing", "did you mean loading?")),
    Command("train --config mine.toml", ("mine.toml: cannot be read: No such file",), 5),
    Command("train --config", ("--config: give a value, as in --config PATH",)),
    Command("info housse.jsonl", ("there is no such file", "did you mean houses.jsonl?"), 5),
    Command("info runs", ("), a run (config.json) or a grammar (.lp)", "it has mine"), 5),
    Command("train --preset map-completio", ("no preset map-completio", "did you mean map-completion?")),
    Command("train --preset=best", ("there is no preset best: there are pqn,",)),
    Command(
        "evaluate dqn",
        ("dqn: is a preset of train, not an agent", "train --preset dqn", "runs/dqn/agent.safetensors"),
        5,
    ),
    Command("evaluate mapcompletion", ("there is no agent mapcompletion", "did you mean map-completion?"), 5),
    Command("evaluate runs/mine", ("is a folder", "did you mean runs/mine/agent.safetensors?"), 5),
    Command("evaluate runs/mine/agent.safetensor", ("there is no such file", "vitruvius train"), 5),
    Command("generate --rooms 3 --grammar famly", ("there is no grammar famly", "did you mean family?"), 5),
    Command("lint clinc", ("no such directory", "there is no grammar clinc", "did you mean clinic?"), 5),
    Command("generate --rooms 3 --type bathrom=1", ("no room type bathrom", "did you mean bathroom?")),
    Command("generate --rooms 3 --piece wardrop=1", ("there is no piece wardrop", "did you mean wardrobe?")),
    Command("generate --rooms 3 --piece bedrom.bed=1", ("no room type bedrom", "did you mean bedroom?")),
    Command(
        "generate --rooms 3 --count-layouts --seconds 0.1 --type hal=1",
        ("no room type hal", "did you mean hall?"),
    ),
    Command("check housse.jsonl", ("there is no such file", "did you mean houses.jsonl?"), 5),
    Command("check flats.json", ("there is no such file", "this folder has houses.jsonl"), 5),
    Command("check none/flats.json", ("no such file", "vitruvius generate --rooms 4"), 5),
    Command("evaluate --targets scondary", ("there is no task scondary", "did you mean secondary?")),
    # values
    Command(
        "generate --rooms 3 --type bathroom", ("--type bathroom: give a count, as in --type bathroom=2 or",)
    ),
    Command("generate --rooms 0", ("rooms must be a whole number, 1 or more, not 0",)),
    Command("generate --rooms 4..2", ("--rooms 4..2: the smaller number comes first",)),
    Command("train test-v1", ("test-v1 is reserved for evaluation",)),
    Command("generate --rooms 300", ("rooms must be at most 128, not 300",)),
    Command("generate --rooms 3 --seconds inf", ("seconds must be above 0 and below a million",)),
    Command("train --steps 0", ("steps must be above 0, not 0",)),
    Command("train --sim nose=0.1", ("--sim nose=0.1", "there is no field nose", "did you mean noise?")),
    Command("train --sim noise=0.1 --sim noise=0.2", ("--sim noise=0.2", "give each field once")),
    Command("train --sim noise=much", ("--sim noise=much", "Expected `float`")),
    Command("train --sim ray_spacing=2", ("--sim ray_spacing=2", "it must divide 45")),
    Command("train --targets mian", ("there is no task mian", "did you mean main?")),
    Command("train --targets {'task':'reach'}", ("is not JSON",)),
    Command('train --targets {"task":"reach"}', ("cannot be used", "'room'")),
    Command("train --targets nowhere:Task", ("cannot be used", "nowhere")),
    Command("generate --rooms 3 --piece bed=two", ("--piece bed=two: give a count, as in --piece bed=2",)),
    Command("generate --rooms 3 --type hall=1 --type hall=2", ("hall is given twice: give each name once",)),
    Command(
        "explain houses.jsonl --why bed", ("there is no bed: did you mean R", ".bed? the house has main")
    ),
    Command("lint houses.jsonl", ("houses.jsonl: is a file, but a grammar is a folder of rule files",), 5),
    Command("draw houses.jsonl --grammar famly", ("no grammar famly", "did you mean family?"), 5),
    Command("check houses.jsonl --promises famly", ("no grammar famly", "did you mean family?"), 5),
    # files that are written
    Command("generate --rooms 2 --out x.txt", ("x.txt: .txt is not supported", ".jsonl")),
    Command("generate --rooms 2 --out x.csv", ("x.csv: .csv is not supported", ".jsonl")),
    Command("generate --rooms 2 --out x", ("x: no extension is not supported", ".jsonl")),
    Command("generate --rooms 2 --count 2 --out x.json", ("holds one house, not 2", "use .jsonl")),
    Command("generate --rooms 2 --out runs", ("runs: is a folder", "runs/name.jsonl")),
    Command("export pqn --out x.pt", ("x.pt: .pt is not supported", ".onnx")),
    Command("evaluate --out x.json", ("x.json: the output is a",)),
    Command("train --steps 1 --out x.safetensors", ("x.safetensors: the output is a",)),
    # fixed rooms
    Command(
        "generate --rooms 1 --keep houses.jsonl",
        ("the house has 2 rooms to keep, but rooms=1", "ask for rooms=2 or more", "--keep-rooms R0"),
    ),
    Command("generate --rooms 3 --keep houses.jsonl --keep-rooms R0 R5", ("no room R5", "there are R0, R1")),
    Command("generate --rooms 3 --keep houses.jsonl --keep-house 1", ("has houses 0 to 0",)),
    Command("generate --rooms 3 --keep-rooms R0", ("file: give it with --keep FILE",)),
    Command("generate --rooms 3 --keep houses.jsonl --cell 0.3", ("leave out cell or keep",)),
    Command("generate --rooms 3 --keep houses.jsonl --count-layouts", ("leave out --keep",)),
    Command("generate --rooms 3 --count-layouts --out houses.jsonl", ("leave out --out",)),
    # plans of the user's
    Command("generate", ("rooms: give a number, as in --rooms 6, or", "in --plan FILE")),
    Command("generate --count-layouts", ("as in --rooms 6",)),
    Command("generate --plan houses.jsonl --rooms 9", ("it has 3 rooms, but rooms=9: leave rooms out",)),
    Command("generate --plan houses.jsonl --cell 0.3", ("leave out cell or plan",)),
    Command("generate --plan houses.jsonl --keep houses.jsonl", ("leave out keep or plan",)),
    Command("generate --plan houses.jsonl --count-layouts", ("leave out --plan",)),
    Command("generate --plan houses.jsonl", ("family is a star", "--grammar home")),
    Command("generate --plan houses.jsonl --grammar home", ("plan: main: there is no room type main",)),
    Command("generate --plan flat.geojson", ("flat.geojson: there is no such file",), 5),
    Command("generate --plan runs/mine/agent.safetensors", ("agent.safetensors: holds no house",), 5),
    # studies
    Command("bench generator --rounds 0", ("--rounds 1 or more",)),
    Command("bench generator --part house --publish", ("leave out --part",)),
    Command("bench agents --only pqnn", ("there is no entry pqnn", "did you mean pqn?")),
    Command("bench peers --only jaxnav", ("there is no peer jaxnav", "did you mean JaxNav?")),
)
