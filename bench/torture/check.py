"""Checks that files with final names are complete, and compares the products of two runs."""
import json
import re
import sqlite3
import struct
import zlib

# Matches the names of unfinished files, and of files that only report the progress of a command.
UNFINISHED = re.compile(r"\.tmp|\.incomplete$|\.write-test-|\.lock$|/lock$|-journal$|-wal$|-shm$|"
                        r"(^|/)(stdout|stderr|log(-\d+)?\.txt)$")


def png(data):
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, kind = 8, b""
    while kind != b"IEND":
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 4:at + 8 + size]
        assert struct.unpack(">I", data[at + 8 + size:at + 12 + size])[0] == zlib.crc32(body)
        at += 12 + size
    assert at == len(data)


def glb(data):
    magic, version, size = struct.unpack("<4sII", data[:12])
    assert (magic, version, size) == (b"glTF", 2, len(data))
    length = struct.unpack("<I", data[12:16])[0]
    json.loads(data[20:20 + length])
    if size > 20 + length:
        rest = struct.unpack("<I", data[20 + length:24 + length])[0]
        assert 28 + length + rest == size


def safetensors(data):
    length = struct.unpack("<Q", data[:8])[0]
    header = json.loads(data[8:8 + length])
    ends = [entry["data_offsets"][1] for name, entry in header.items() if name != "__metadata__"]
    assert 8 + length + max(ends, default=0) == len(data)


def webp(data):
    assert data[:4] == b"RIFF" and data[8:12] == b"WEBP"
    assert struct.unpack("<I", data[4:8])[0] + 8 == len(data)


def html(data):
    assert data.rstrip().endswith(b"</html>")


def radiance(data):
    header, _, rest = data.partition(b"\n\n")
    assert header.startswith(b"#?") and len(rest) > 20


def openexr(data):
    assert data[:4] == b"\x76\x2f\x31\x01" and len(data) > 300


def json_lines(data):
    for line in data.split(b"\n")[:-1]:  # a last line without "\n" is still being written
        json.loads(line)


def jpeg(data):
    assert data[:2] == b"\xff\xd8" and data[-2:] == b"\xff\xd9"


def text(data):
    assert data


PARSERS = {".png": png, ".jpg": jpeg, ".glb": glb, ".safetensors": safetensors, ".webp": webp, ".html": html,
           ".json": json.loads, ".jsonl": json_lines, ".hdr": radiance, ".exr": openexr,
           ".csv": text, ".obj": text, ".txt": text}


def database(path):
    with sqlite3.connect(f"file:{path}?mode=ro", uri=True) as connection:
        assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)


def broken_files(folder):
    """Returns a message for each file in `folder` that has its final name but cannot be read."""
    found = []
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        if not path.is_file() or UNFINISHED.search(name):
            continue
        try:
            if path.suffix in (".sqlite", ".db"):
                database(path)
            elif path.suffix in PARSERS:
                PARSERS[path.suffix](path.read_bytes())
        except (AssertionError, ValueError, struct.error, sqlite3.Error, IndexError) as error:
            found.append(f"{name} is not whole ({type(error).__name__}, {path.stat().st_size} bytes)")
    return found


def without(value, names):
    """Returns a copy of a JSON value without the members named in `names`, at any depth."""
    if isinstance(value, dict):
        return {key: without(each, names) for key, each in value.items() if key not in names}
    return [without(each, names) for each in value] if isinstance(value, list) else value


def differences(first, second):
    """Returns the names of the products that differ or exist in one of the two dictionaries only."""
    return [name for name in sorted(first.keys() | second.keys())
            if first.get(name) != second.get(name)]
