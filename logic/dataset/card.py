"""Card of a set for the Hugging Face Hub and for people, and its description in Croissant 1.1."""

import hashlib
import json
from collections.abc import Iterator
from typing import Any

from vitruvius.logic.dataset.sets import CARD, CROISSANT, DATA, MANIFEST, Manifest, Set, encoded

REAL, WHOLE, TEXT = "sc:Float", "sc:Integer", "sc:Text"

COLUMNS = {
    "id": (TEXT, "The grammar, 12 digits for its rules and the request, seed and index."),
    "split": (TEXT, "train, validation or test, by the seed."),
    "seed": (WHOLE, "With index, grammar_hash and request all that the house is a function of."),
    "index": (WHOLE, "Of the house in the series of its seed."),
    "grammar": (TEXT, "The name of the rules, which are in the folder grammar."),
    "grammar_hash": (TEXT, "SHA-256 of the rules."),
    "request": (TEXT, "What was asked for, as JSON."),
    "rooms": (WHOLE, "Number of rooms, as a request counts them: a star's main room is none."),
    "types": (TEXT, "Of these rooms, in their order."),
    "area": (REAL, "Square metres of all rooms that are inside."),
    "verdict": (TEXT, "house, or limit: then there is no house, and why says which limit."),
    "why": (TEXT, "The limit that the house ended in."),
    "sha256": (TEXT, "Of the house's canonical JSON."),
}
"""Type and meaning of the flat columns."""

NESTED = {
    "topology": "How the rooms lie together.",
    "hub": "The room that the others lie around, if any.",
    "floor": "The rectangle around all rooms, metres.",
    "rooms": "Rectangles with name and type, metres; x grows east, y south.",
    "doors": "Segments between two rooms, or a room and outside, metres.",
    "windows": "Segments in outer walls of a room, metres.",
    "pieces": "Furniture: rectangles with type, room and orientation, metres.",
}
"""Parts of the column ``house``."""

ENCODING = {"parquet": "application/x-parquet", "jsonl": "application/jsonlines"}

CONTEXT: dict[str, Any] = {
    "@language": "en",
    "@vocab": "https://schema.org/",
    "sc": "https://schema.org/",
    "cr": "http://mlcommons.org/croissant/",
    "rai": "http://mlcommons.org/croissant/RAI/",
    "dct": "http://purl.org/dc/terms/",
    "conformsTo": "dct:conformsTo",
    "data": {"@id": "cr:data", "@type": "@json"},
    "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
    "examples": {"@id": "cr:examples", "@type": "@json"},
    **{
        name: f"cr:{name}"
        for name in (
            *("arrayShape", "citeAs", "column", "equivalentProperty", "extract", "field", "fileObject"),
            *("fileProperty", "fileSet", "format", "includes", "isArray", "isLiveDataset", "jsonPath", "key"),
            *("md5", "parentField", "path", "recordSet", "references", "regex", "repeated", "replace"),
            *("samplingRate", "separator", "source", "subField", "transform"),
        )
    },
}


def described(of: Set, manifest: Manifest) -> dict[str, bytes]:
    """Return the last files of a set, with the manifest."""
    content = encoded(manifest)
    croissant = json.dumps(_croissant(of, manifest, hashlib.sha256(content).hexdigest()), indent=1)
    card = "\n".join(_card(of, manifest)) + "\n"
    return {CARD: card.encode(), CROISSANT: croissant.encode() + b"\n", MANIFEST: content}


def _words(of: Set, manifest: Manifest) -> str:
    asked = json.dumps(of.request)
    made = " and ".join(f"{name} {version}" for name, version in of.versions.items())
    return (
        f"{manifest.houses:,} furnished houses by the rules of the grammar {of.grammar}, asked for by "
        f"{asked}, made by {made}. {manifest.limits:,} more ended in a limit and are rows that say so."
    )


def _name(of: Set) -> str:
    return f"{of.grammar}-{of.grammar_hash[:8]}-{of.seed}"


def _card(of: Set, manifest: Manifest) -> Iterator[str]:
    """Yield the lines of the card."""
    rows = dict.fromkeys(of.houses, 0)
    for shard in manifest.shards:
        rows[shard.split] += shard.rows
    yield from ("---", "configs:", "- config_name: default", "  data_files:")
    for split in of.houses:
        yield from (f"  - split: {split}", f"    path: {DATA}/{split}-*.{of.files}")
    yield from ("tags:", "- floor plans", "- synthetic", "---", f"# Houses of {of.grammar}", "")
    yield from (_words(of, manifest), "", "| split | seed | rows |", "|---|---|---|")
    yield from (f"| {split} | {of.seed_of(split)} | {number:,} |" for split, number in rows.items())
    yield from ("", "| column | type | holds |", "|---|---|---|")
    for name, (kind, meaning) in COLUMNS.items():
        yield f"| `{name}` | {'list of ' if name == 'types' else ''}{kind[3:].lower()} | {meaning} |"
    yield from (f"| `house.{name}` | nested | {meaning} |" for name, meaning in NESTED.items())
    yield from (
        "",
        f"Any row is made again from its columns and the rules in `grammar/{of.grammar}`: "
        "`vitruvius regenerate FOLDER --row 57`.",
        f"`{MANIFEST}` has the hash of each file. Rules made all houses: no person's home is among them.",
        "A licence and a date are for who publishes the set to state, here and in `croissant.json`.",
    )


def _croissant(of: Set, manifest: Manifest, digest: str) -> dict[str, Any]:
    """Return the description in Croissant."""
    files = {
        "@type": "cr:FileSet",
        "@id": "shards",
        "name": "shards",
        "description": f"Rows, by shard; {MANIFEST} has the hash of each.",
        "encodingFormat": ENCODING[of.files],
        "includes": f"{DATA}/*.{of.files}",
    }
    hashes = {
        "@type": "cr:FileObject",
        "@id": MANIFEST,
        "name": MANIFEST,
        "contentUrl": MANIFEST,
        "encodingFormat": "application/json",
        "sha256": digest,
    }
    return {
        "@context": CONTEXT,
        "@type": "sc:Dataset",
        "conformsTo": "http://mlcommons.org/croissant/1.1",
        "name": _name(of),
        "description": _words(of, manifest),
        "version": "1.0.0",
        "distribution": [files, hashes],
        "recordSet": [
            {
                "@type": "cr:RecordSet",
                "@id": "houses",
                "name": "houses",
                "key": {"@id": "houses/id"},
                "field": [_field(name, *each) for name, each in COLUMNS.items()],
            }
        ],
    }


def _field(name: str, kind: str, meaning: str) -> dict[str, Any]:
    listed = {"isArray": True, "arrayShape": "-1"} if name == "types" else {}
    return {
        "@type": "cr:Field",
        "@id": f"houses/{name}",
        "name": name,
        "description": meaning,
        "dataType": kind,
        **listed,
        "source": {"fileSet": {"@id": "shards"}, "extract": {"column": name}},
    }
