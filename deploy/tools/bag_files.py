"""The files of a rosbag2 bag as raw messages: sqlite3 and MCAP, also split ones, also after a kill
of the logger. Standard library; compressed chunks of an MCAP need a zstd: Debian's
python3-zstandard, PyPI's zstandard, or Python's own from 3.14 on.
"""

import pathlib
import sqlite3
import struct
import zlib

MAGIC = b"\x89MCAP0\r\n"
FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, CHUNK_INDEX, STATISTICS, DATA_END = (
    2,
    3,
    4,
    5,
    6,
    8,
    11,
    15,
)
LOG_TIME_OF_ZERO = 1  # nodes/bag/mcap_format.hpp has the reason
MAX_CHUNK = 1 << 30


class FileError(Exception):
    """A sentence: the unusable part of the bag."""


def files_of(path):
    """The bag's files in the order in which they were written; `path` is its folder, or one of
    them.
    """
    path = pathlib.Path(path)
    if path.is_file():
        return [path]
    files = sorted(
        (file for ending in ("*.db3", "*.mcap") for file in path.glob(ending)),
        key=lambda f: (len(f.name), f.name),
    )
    if not files and any(path.glob("*.zstd")):
        raise FileError(
            f"{path}: bag-level compression is not supported. Convert it with `ros2 bag convert`."
        )
    if not files:
        raise FileError(
            f"{path}: no recording here. Choose the folder with metadata.yaml and a .db3 or "
            f".mcap file."
        )
    return files


def losses(path):
    """Sentences: data that metadata.yaml states and the files do not hold."""
    path, stated, name, inside = pathlib.Path(path), {}, None, False
    try:
        lines = (path / "metadata.yaml").read_text().splitlines()
    except (OSError, UnicodeDecodeError):
        return []
    for key, _, value in (line.partition(":") for line in lines):
        words = key.split() or [""]
        inside = (
            words == ["files"]
            or inside
            and key[:1] in (" ", "-")
            and not (len(key) - len(key.lstrip()) <= 2 and words[0] != "-")
        )
        if inside and words[-1] == "path":
            name = value.strip().strip("'\"")
        elif inside and words[-1] == "message_count" and name and value.strip().isdigit():
            stated[name] = int(value)
    there = {file.name: open_file(file).count() for file in files_of(path)}
    whole = sum(there.values()) >= sum(stated.values())
    return [
        (
            f"'{name}' is missing in the recording: {count} messages are lost."
            if name not in there
            else f"'{name}' holds {there[name]} of {count} recorded messages; the others are lost."
        )
        for name, count in stated.items()
        if (there[name] < count if name in there else count and not whole)
    ]


def open_file(file):
    """SqliteFile or McapFile. FileError for other files."""
    with open(file, "rb") as opened:
        mcap = opened.read(len(MAGIC)) == MAGIC
    return McapFile(file) if mcap or pathlib.Path(file).suffix == ".mcap" else SqliteFile(file)


class SqliteFile:
    """`topics`: {number: (name, type, definition)}; the definition is always empty."""

    def __init__(self, file):
        self.file = file
        try:
            with self.connect() as connection:
                self.topics = {
                    row: (name, kind, "")
                    for row, name, kind in connection.execute("SELECT id, name, type FROM topics")
                }
            connection.close()
        except sqlite3.Error as error:
            raise FileError(
                f"the recording cannot be read ({error}); check that it is complete and of this "
                f"version"
            ) from None

    def connect(self):
        path = str(self.file).replace("%", "%25").replace("?", "%3f").replace("#", "%23")
        return sqlite3.connect(f"file:{path}?mode=ro", uri=True)

    def count(self):
        try:
            connection = self.connect()
            try:
                return connection.execute("SELECT count(*) FROM messages").fetchone()[0]
            finally:
                connection.close()
        except sqlite3.Error:
            return 0

    def messages(self, requested, progress=lambda fraction: None):
        """(topic's number, time [ns], bytes) of these topics, in order of arrival. FileError
        after the intact part of a damaged file."""
        connection = self.connect()
        try:
            last = connection.execute("SELECT max(id) FROM messages").fetchone()[0] or 1
            cursor = connection.execute(
                "SELECT id, topic_id, timestamp, data FROM messages WHERE topic_id IN"
                f" ({','.join(map(str, requested))}) ORDER BY id"
            )
            for row, topic, time, data in cursor:
                yield topic, time, data
                if row % 4096 == 0:
                    progress(row / last)
        except sqlite3.Error as error:
            raise FileError(str(error)) from None
        finally:
            connection.close()


def decompressor():
    """A function of the bytes and their size uncompressed."""
    try:
        import zstandard

        return lambda data, size: zstandard.ZstdDecompressor().decompress(
            data, max_output_size=max(size, 1)
        )
    except ImportError:
        pass
    try:
        from compression import zstd

        return lambda data, _: zstd.decompress(data)
    except ImportError:
        raise FileError(
            "its MCAP chunks are compressed, and this Python has no zstd. Install "
            "python3-zstandard (deploy/setup does), or `pip install zstandard`."
        ) from None


def records(data):
    """(opcode, content) of records one behind the other, up to the last whole one."""
    at = 0
    while at + 9 <= len(data):
        code, size = struct.unpack_from("<BQ", data, at)
        if size > len(data) - at - 9:
            return
        yield code, data[at + 9 : at + 9 + size]
        at += 9 + size


class Texts:
    """Texts and numbers one behind the other."""

    def __init__(self, data, at=0):
        self.data, self.at = data, at

    def bytes(self):
        (size,) = struct.unpack_from("<I", self.data, self.at)
        self.at += 4 + size
        if self.at > len(self.data):
            raise struct.error("a string exceeds its record")
        return bytes(self.data[self.at - size : self.at])

    def text(self):
        return self.bytes().decode(errors="replace")


class McapFile:
    """`topics`: {channel: (name, type, definition)}; the definition is the type's .msg with its
    used types, if the file has it."""

    def __init__(self, file):
        self.file, self.topics, self.schemas, self.unpack, self.stated = (
            file,
            {},
            {},
            decompressor(),
            None,
        )
        self.size = pathlib.Path(file).stat().st_size
        try:
            with open(file, "rb") as opened:
                if opened.read(8) != MAGIC:
                    raise FileError(
                        "the recording cannot be read (no MCAP magic at the start); check that "
                        "it is complete"
                    )
                if not self.read_summary(opened):
                    self.topics, self.schemas = {}, {}
                    for code, content, _ in self.walk(opened):
                        self.describe(code, content)
        except struct.error as error:
            raise FileError(
                f"the recording cannot be read ({error}); check that it is complete"
            ) from None

    def describe(self, code, content):
        if code == SCHEMA:
            (number,) = struct.unpack_from("<H", content)
            texts = Texts(content, 2)
            kind, encoding, text = texts.text(), texts.text(), texts.text()
            self.schemas[number] = (kind, text if encoding == "ros2msg" else "")
        elif code == CHANNEL:
            number, schema = struct.unpack_from("<HH", content)
            self.topics.setdefault(
                number, (Texts(content, 4).text(), *self.schemas.get(schema, ("", "")))
            )

    def read_summary(self, opened):
        """Whether there is one."""
        opened.seek(max(0, self.size - 37))
        tail = opened.read(37)
        if len(tail) < 37 or tail[-8:] != MAGIC or tail[:9] != struct.pack("<BQ", FOOTER, 20):
            return False
        start, _, crc = struct.unpack_from("<QQI", tail, 9)
        if not 8 < start < self.size - 37:
            return False
        opened.seek(start)
        summary = opened.read(self.size - 37 - start)
        if crc and zlib.crc32(summary + tail[:25]) != crc:
            return False
        for code, content in records(summary):
            self.describe(code, content)
            if code == STATISTICS:
                (self.stated,) = struct.unpack_from("<Q", content)
        return bool(self.topics)

    def count(self):
        if self.stated is None:
            self.stated = 0
            try:
                with open(self.file, "rb") as opened:
                    for code, _, _ in self.walk(opened):
                        self.stated += code == MESSAGE
            except (FileError, struct.error):
                pass  # the whole chunks before it count
        return self.stated

    def walk(self, opened):
        """(opcode, content, place in the file) of schemas, channels and messages, of those in
        chunks too.
        """
        opened.seek(8)
        while len(head := opened.read(9)) == 9:
            code, size = struct.unpack("<BQ", head)
            at = opened.tell()
            if (
                code in (0, DATA_END, FOOTER) or size > self.size - at
            ):  # the last one may not be whole
                return
            if code == CHUNK:
                for inner, content in records(self.uncompressed(opened.read(size))):
                    yield inner, content, at
            elif code in (SCHEMA, CHANNEL, MESSAGE):
                yield code, opened.read(size), at
            else:
                opened.seek(size, 1)

    def uncompressed(self, chunk):
        size, crc = struct.unpack_from("<QI", chunk, 16)
        texts = Texts(chunk, 28)
        compression = texts.text()
        packed = memoryview(chunk)[texts.at + 8 :]
        if size > MAX_CHUNK or struct.unpack_from("<Q", chunk, texts.at)[0] != len(packed):
            raise FileError("incomplete chunk")
        if compression not in ("", "zstd"):
            raise FileError(
                f"the MCAP is compressed by {compression}, supported: zstd. Convert it with "
                f"`mcap compress --compression zstd`"
            )
        if compression:
            try:
                data = self.unpack(bytes(packed), size)
            except Exception as error:  # each zstd raises different errors
                raise FileError(f"chunk cannot be uncompressed: {error}") from None
        else:
            data = bytes(packed)
        if len(data) != size or (crc and zlib.crc32(data) != crc):
            raise FileError("chunk checksum mismatch")
        return memoryview(data)

    def messages(self, requested, progress=lambda fraction: None):
        """As SqliteFile.messages."""
        requested = set(requested)
        with open(self.file, "rb") as opened:
            last = 0
            for code, content, at in self.walk(opened):
                if at != last:
                    progress(at / max(self.size, 1))
                    last = at
                if code != MESSAGE or len(content) < 22:
                    continue
                channel, _, time, published = struct.unpack_from("<HIQQ", content)
                if channel in requested:
                    yield (
                        channel,
                        0 if (time, published) == (LOG_TIME_OF_ZERO, 0) else time,
                        bytes(content[22:]),
                    )
