"""Reader of untrusted Parquet files that checks the footer and the page headers before it unpacks a page.

pyarrow ends the process if the statistics of a column are damaged, so the footer is read here.

A few kilobytes of Parquet may unpack to terabytes: pages are compressed, texts of a dictionary are repeated,
and texts share the beginning of the previous text (``DELTA_BYTE_ARRAY``). The footer may state other sizes
than the page headers, so the reader checks the headers, too: https://parquet.apache.org/docs/file-format/.
"""

from collections.abc import Iterator
from gzip import GzipFile
from pathlib import Path
from typing import Any, BinaryIO

from vitruvius.logic.opener import opened

MAX_FILE_BYTES, MAX_FOOTER_BYTES = 1 << 34, 1 << 24
"""Largest size of a file, and of its footer, which lists the row groups, in bytes."""

MAX_VALUES, MAX_VARINT_BITS = 1 << 23, 64
"""Largest number of values of a footer or a page header, and largest size of a number in it."""

MAX_GROUP_BYTES, MAX_GROUP_VALUES = 1 << 27, 1 << 23
"""Largest size of an unpacked row group: bytes, and values in all columns together."""

MAX_HEADER_BYTES = 1 << 16
"""Largest size of a page header, which may state a least and a greatest value, in bytes."""

ENCODINGS = {0, 2, 3, 8}
"""Encodings that repeat only texts of a dictionary: plain, dictionary (two numbers), run lengths."""

DATA, INDEX, DICTIONARY, DATA_2 = range(4)
"""Page types."""

FIELDS = 5, 7, 9, 11
"""Fields of Thrift's ``ColumnMetaData``: number of values, packed size, places of data and dictionary."""


def groups(path: Path, first: int, schema: Any) -> Iterator[list[dict[str, Any]]]:
    """Yield the rows of a file from number ``first`` on, one row group at a time.

    Raises ``OSError`` if the file cannot be read, and ``ValueError`` if it is no Parquet file of these
    columns or exceeds a bound.
    """
    import pyarrow as pa
    from pyarrow.parquet import ParquetFile

    with opened(path, MAX_FILE_BYTES, unpack=False) as source:
        stated = _row_groups(source)
        try:
            with ParquetFile(path) as file:
                if not file.schema_arrow.equals(schema):
                    raise ValueError("its columns differ from those of a set")
                with ParquetFile(path, metadata=file.metadata, read_dictionary=_texts(file)) as in_short:
                    for number in range(file.num_row_groups):
                        group = file.metadata.row_group(number)
                        if first < group.num_rows:
                            _require_group(source, stated[number], group.num_rows, file.schema)
                            _require_texts(in_short.read_row_group(number))
                            yield file.read_row_group(number).to_pylist()[max(first, 0) :]
                        first -= group.num_rows
        except pa.ArrowException as error:
            raise ValueError(str(error).partition("\n")[0]) from None


def _row_groups(file: BinaryIO | GzipFile) -> list[list[list[int]]]:
    """Return the numbers of each column of each row group that ``FIELDS`` names, from the footer.

    Raises ``ValueError`` if the footer is damaged, or larger than the file or than its bound.
    """
    size = file.seek(0, 2)
    file.seek(max(0, size - 8))
    length = int.from_bytes(file.read(8)[:4], "little")
    if not 12 <= 12 + length <= size:
        raise ValueError("it is not a Parquet file, or it is truncated")
    if length > MAX_FOOTER_BYTES:
        raise ValueError(f"its list of row groups holds more than {MAX_FOOTER_BYTES >> 20} MiB")
    file.seek(size - 8 - length)
    try:
        footer = Thrift(file.read(length)).struct()
        return [[_integers(column[3], *FIELDS) for column in group[1]] for group in footer[4]]
    except (AttributeError, KeyError, IndexError, TypeError, RecursionError):
        raise ValueError("its list of row groups is damaged") from None


def _texts(file: Any) -> list[str]:
    """Return the names of the text columns, which are first read as indices of a dictionary."""
    columns = [file.schema.column(number) for number in range(len(file.schema.names))]
    return [column.path for column in columns if column.physical_type == "BYTE_ARRAY"]


def _integers(fields: dict[int, Any], *numbers: int) -> list[int]:
    """Return fields by their numbers, 0 for an absent one. Raises ``TypeError`` unless all are integers."""
    found = [fields.get(number, 0) for number in numbers]
    if not all(type(each) is int for each in found):
        raise TypeError("a field is not an integer")
    return found


def _require_group(file: BinaryIO | GzipFile, stated: list[list[int]], rows: int, schema: Any) -> None:
    """Raise ``ValueError`` for a row group of so many rows whose pages exceed the bounds."""
    size = values = 0
    for number, (count_stated, *places) in enumerate(stated):
        own = 0
        for page, count in _pages(file, *places):
            size, own = size + page, own + count
            if size > MAX_GROUP_BYTES or values + own > MAX_GROUP_VALUES:
                most = f"{MAX_GROUP_BYTES >> 20} MiB or {MAX_GROUP_VALUES:,} values"
                raise ValueError(f"a row group holds more than {most}")
        if not rows <= count_stated <= own:
            raise ValueError(
                f"its pages of {schema.column(number).path} hold more or fewer values than stated"
            )
        values += own


def _pages(file: BinaryIO | GzipFile, size: int, data: int, dictionary: int) -> Iterator[tuple[int, int]]:
    """Yield the unpacked size in bytes and the number of values of each page of a column chunk."""
    place = dictionary if 0 < dictionary < data else data
    end = place + size
    while place < end:
        file.seek(place)
        head = Thrift(file.read(MAX_HEADER_BYTES))
        try:
            page = head.struct()
            kind, unpacked, packed = _integers(page, 1, 2, 3)
            about = page[{DATA: 5, DICTIONARY: 7, DATA_2: 8}[kind]]
            count, encoding = _integers(about, 1, 4 if kind == DATA_2 else 2)
        except (AttributeError, KeyError, IndexError, TypeError, RecursionError):
            raise ValueError(f"the page header at byte {place} is damaged") from None
        if encoding not in ENCODINGS:
            raise ValueError(f"a page has the unsupported encoding {encoding}")
        if unpacked < 0 or packed < 0 or count < 0:
            raise ValueError(f"the page header at byte {place} is damaged")
        yield unpacked, 0 if kind == DICTIONARY else count
        place += head.place + packed


def _require_texts(table: Any) -> None:
    """Raise ``ValueError`` if the texts of a table, read as dictionary indices, are too long together."""
    if sum(map(_length, table.columns)) > MAX_GROUP_BYTES:
        raise ValueError(f"a row group holds more than {MAX_GROUP_BYTES >> 20} MiB of texts")


def _length(array: Any) -> int:
    """Return the size of all texts of an array, bytes."""
    import pyarrow as pa
    from pyarrow import compute

    if isinstance(array, pa.ChunkedArray):
        return sum(map(_length, array.chunks))
    if isinstance(array, pa.DictionaryArray):
        lengths: Any = compute.call_function("binary_length", [array.dictionary])
        return compute.call_function("sum", [lengths.take(array.indices)]).as_py() or 0
    if isinstance(array, pa.StructArray):
        return sum(map(_length, array.flatten()))
    return _length(array.flatten()) if isinstance(array, pa.ListArray) else 0


class Thrift:
    """Decoder of the part of Thrift's compact protocol that footers and page headers use."""

    def __init__(self, content: bytes) -> None:
        """Begin at the first byte."""
        self.content, self.place, self.values = content, 0, 0

    def struct(self) -> dict[int, Any]:
        """Return the fields of a record by number. Raises ``IndexError`` if the record is truncated."""
        fields, number = dict[int, Any](), 0
        while head := self._byte():
            number = number + (head >> 4) if head >> 4 else self._whole()
            fields[number] = self._value(head & 15)
        return fields

    def _value(self, kind: int) -> Any:
        self.values += 1
        if self.values > MAX_VALUES:
            raise IndexError(f"more than {MAX_VALUES:,} values")
        match kind:
            case 1 | 2:
                return kind == 1
            case 3:
                return self._byte()
            case 4 | 5 | 6:
                return self._whole()
            case 7 | 8:
                return self._skipped(8 if kind == 7 else self._number())
            case 9:
                return self._list()
            case 12:
                return self.struct()
        raise TypeError("no footer or page header has such a field")

    def _list(self) -> list[Any]:
        head = self._byte()
        size, kind = head >> 4, head & 15
        values = range(self._number() if size == 15 else size)
        return [self._value(3 if kind in {1, 2} else kind) for _ in values]  # a truth value takes a byte

    def _byte(self) -> int:
        self.place += 1
        return self.content[self.place - 1]

    def _number(self) -> int:
        number = shift = 0
        while (byte := self._byte()) & 128:
            number |= (byte & 127) << shift
            shift += 7
            if shift > MAX_VARINT_BITS:
                raise IndexError("a number has too many bits")
        return number | byte << shift

    def _whole(self) -> int:
        number = self._number()
        return number >> 1 ^ -(number & 1)

    def _skipped(self, size: int) -> None:
        self.place += size
        if self.place > len(self.content):
            raise IndexError("a text ends after the end of the content")
