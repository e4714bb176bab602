# SPDX-License-Identifier: BSD-3-Clause
"""Fetches public recordings and unpacks them: existing ones are not fetched again, those with a wrong checksum are
refused, and no partial one is left."""
import hashlib
import json
import pathlib
import shutil
import sys
import tarfile
import tempfile
import urllib.request
import zipfile

CHUNK = 1 << 20


class Refused(Exception):
    """An archive that is not what it should be."""


def fetch(url, path):
    """The file's sha256. Prints its progress on stderr."""
    digest, got = hashlib.sha256(), 0
    with urllib.request.urlopen(url, timeout=60) as answer, open(path, "wb") as out:
        size = int(answer.headers.get("Content-Length") or 0)
        while True:
            chunk = answer.read(CHUNK)
            if not chunk:
                break
            out.write(chunk)
            digest.update(chunk)
            got += len(chunk)
            share = f" of {size / 1e6:.0f} MB" if size else " MB"
            print(f"\r  {got / 1e6:.0f}{share}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    if size and got != size:
        raise Refused(f"{url}: ended after {got} of {size} bytes")
    return digest.hexdigest()


def members(archive):
    """(name, is a file or a folder) of its members."""
    if isinstance(archive, zipfile.ZipFile):
        return [(info.filename, (info.external_attr >> 28) not in (0xA,)) for info in archive.infolist()]
    return [(info.name, info.isfile() or info.isdir()) for info in archive.getmembers()]


def unpack(path, folder):
    """Into a new folder. Names that lead out of it, links and devices are refused."""
    try:
        archive = zipfile.ZipFile(path) if zipfile.is_zipfile(path) else tarfile.open(path)
    except (tarfile.TarError, zipfile.BadZipFile) as error:
        raise Refused(f"{path.name}: is no archive: {error}") from error
    with archive:
        for name, is_plain in members(archive):
            parts = pathlib.PurePosixPath(name)
            if parts.is_absolute() or ".." in parts.parts or not is_plain:
                raise Refused(f"{path.name}: has '{name}', which is no file below it")
        archive.extractall(folder)


def sequence_in(folder, name):
    """The folder with rgb.txt that was unpacked: that name, or the only one."""
    found = sorted({path.parent for path in folder.rglob("rgb.txt")})
    named = [path for path in found if path.name == name]
    if len(named or found) != 1:
        raise Refused(f"{name}: {len(found)} folders with rgb.txt in the archive, expected one")
    return (named or found)[0]


class Downloads:
    def __init__(self, folder):
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        self.file = folder / "checksums.json"
        self.known = json.loads(self.file.read_text()) if self.file.is_file() else {}

    def check(self, entry, found):
        expected = entry.get("sha256") or self.known.get(entry["url"])
        if expected and expected != found:
            raise Refused(f"{entry['url']}: sha256 is {found}, expected {expected}")
        self.known[entry["url"]] = found
        self.file.write_text(json.dumps(self.known, indent=1, sort_keys=True) + "\n")

    def get(self, entry):
        """The folder of a sequence. Throws Refused, or OSError where there is no network."""
        target = self.folder / entry["name"]
        if target.is_dir():
            return target
        print(f"fetching {entry['url']}", file=sys.stderr, flush=True)
        with tempfile.TemporaryDirectory(dir=self.folder, prefix=".part_") as name:
            part = pathlib.Path(name)
            self.check(entry, fetch(entry["url"], part / "archive"))
            unpack(part / "archive", part / "unpacked")
            shutil.move(str(sequence_in(part / "unpacked", entry["name"])), str(target))
        return target


def download(archives, collection, folder):
    """(folders that are there now, sentences about those that are not)."""
    entries = json.loads(archives.read_text())
    if not isinstance(entries.get(collection), list):
        raise Refused(f"{archives}: has no list '{collection}'")
    downloads, there, missing = Downloads(folder), [], []
    for entry in entries[collection]:
        try:
            there.append(downloads.get(entry))
        except (Refused, OSError) as error:
            missing.append(f"{entry['name']}: {error}")
            print(f"  failed: {error}", file=sys.stderr, flush=True)
    return there, missing
