"""Published figures of flats and houses, the same figures of generated ones, and the page of both."""

from collections.abc import Iterable, Iterator, Sequence
from statistics import median, quantiles

from vitruvius.logic.house.house import House

PASSAGES = ("corridor", "hall")
"""Types of rooms that people pass through."""

DAY = ("living", "dining", "kitchen")


def beside_published(houses: Sequence[House], window: float) -> Iterator[list[str]]:
    """Yield rows: quantity, quartiles in these houses, published figure, and its source."""
    yield ["bedroom, m²", spread(areas(houses, "bedroom")), "least: 7.5 (single), 11.5 (double)", NDSS]
    yield [
        "bedroom, width in m",
        spread(widths(houses, "bedroom")),
        "least: 2.15 (single), 2.75 (double)",
        NDSS,
    ]
    yield ["bedroom, m²", spread(areas(houses, "bedroom")), "least: 8 (single), 12 (double)", LHDG]
    yield [
        "living, dining and kitchen together, m²",
        spread([whole(house, DAY) for house in houses]),
        "least: 23, 25, 27, 29 for 2, 3, 4, 5 persons",
        LHDG,
    ]
    for bedrooms, least in ((1, "39 to 50"), (2, "61 to 70"), (3, "74 to 95"), (4, "90 to 117")):
        if homes := [house for house in houses if len(areas([house], "bedroom")) == bedrooms]:
            what = f"home of {bedrooms} bedroom{'s' if bedrooms > 1 else ''}, m² (n = {len(homes)})"
            yield [what, spread([whole(house) for house in homes]), f"least: {least}, by persons", NDSS]
    shares = [100 * whole(house, PASSAGES) / whole(house) for house in houses]
    yield ["corridor and hall, % of the area", spread(shares, 0), "10 to 15", CIRCULATION]
    lit = [100 * window * each for each in glazed(houses)]
    yield [f"windows of {window} m height, % of their room's floor", spread(lit, 0), "least: 12.5", MBO]
    yield ["rooms a home", "4 to 12, as asked for", "mean: 5.7", DWELLINGS]
    yield ["rooms a home", "4 to 12, as asked for", "mean of a drawing: 13.8", CUBICASA]


def areas(houses: Iterable[House], type_: str) -> list[float]:
    """Return the areas of the rooms of a type, in square metres."""
    return [room.area for house in houses for room in house.rooms if room.type == type_]


def widths(houses: Iterable[House], type_: str) -> list[float]:
    """Return the shorter sides of the rooms of a type, in metres."""
    return [min(room.width, room.height) for house in houses for room in house.rooms if room.type == type_]


def whole(house: House, types: Sequence[str] = ()) -> float:
    """Return the area of all rooms, or of those of some types, in square metres."""
    return sum(room.area for room in house.rooms if not types or room.type in types)


def glazed(houses: Iterable[House]) -> Iterator[float]:
    """Yield the length of windows for each square metre of a room that has windows, in metres."""
    for house in houses:
        for room in house.rooms:
            if found := [each.length for each in house.windows if each.room == room.name]:
                yield sum(found) / room.area


def spread(values: Sequence[float], digits: int = 1) -> str:
    """Return the median and the quartiles."""
    low, _, high = quantiles(values, n=4, method="inclusive") if len(values) > 1 else [values[0]] * 3
    return f"{median(values):.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]"


NDSS, LHDG, MBO = "space standard, England", "London", "Musterbauordnung, Germany"
CIRCULATION, DWELLINGS, CUBICASA = "rule of thumb", "Swiss Dwellings", "CubiCasa5K"

PAGE = """# Homes and their cost

`{command}`. {machine}. {versions}. [Plans](plans.md) explains how homes are made.

![Twelve homes: the first of each size](homes.png)

## Time by number of rooms
The table has the CPU time of one core in milliseconds, the median of {houses} houses of each size. An
unfurnished plan has rooms, doors and windows; a furnished one is a house. A layout is refuted if its
lengths have no solution. A plan is made again if a room cannot be furnished at its size. The last column is
the number of different topologies (room types, walls and doors) as a fraction of the houses.

| rooms | unfurnished | p95 | furnished | p95 | refuted layouts a plan | plans a house | topologies |
|---|---|---|---|---|---|---|---|
{sizes}

## Clinics and buildings of flats
Furnished houses: CPU time of one core in milliseconds, and the number of houses with violations by `check`.
The last row of each grammar is the growth of the median, fitted to all sizes.

| grammar | rooms | median | p95 | with violations |
|---|---|---|---|---|
{larger}

## Areas and doors by room type
The table covers homes of all these sizes, equally many of each. The entrance counts as a door.

| type | a home | area in m²: median [quartiles] | from, to | doors a room |
|---|---|---|---|---|
{types}

## Comparison with published figures
| | here: median [quartiles] | published | where |
|---|---|---|---|
{published}

Standards state minimums, not usual values. Walls here have no thickness, so areas are net. Plans have no
window heights: {window} m is assumed. We found no verifiable surveys of the share of corridors and of doors
per room, and no verifiable areas of single published plans.

- space standard, England: *Technical housing standards: nationally described space standard*, 2015, table 1
  and paragraph 10; homes of one storey.
- London: *London Housing Design Guide*, interim edition, 2010, section 4.
- rule of thumb: horizontal circulation is 10 to 15 % of the plinth area ([What is circulation
  area](https://dreamhomeguide.in/what-is-circulation-area/)).
- Musterbauordnung, Germany, § 47 (2): a rough opening of an eighth of the room's net floor area.
- Swiss Dwellings 1.0.0 ([Zenodo 7070952](https://zenodo.org/records/7070952)): 242,257 rooms of 42,207
  flats.
- CubiCasa5K (Kalervo and others, 2019): 68,877 rooms, including outdoor areas, of 5,000 drawings.
"""
