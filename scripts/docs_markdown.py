#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The filter of docs/Doxyfile: one document of docs/ to stdout as Doxygen has to read it.

Links within documents go by the names that GitHub makes of headings, which Doxygen knows since 1.9.8 only:
each heading gets that name, with the document's before it, and links get it too. What is not a document of
docs/ has no page: of a link to it the path is left.
"""
import pathlib
import re
import sys

HEADING = re.compile(r"^(#+) +(.*?)\s*$")
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)#:]*)(?:#([^)]*))?\)")


def anchor(heading):
    """GitHub's name of a heading: "Speed, and memory" is speed-and-memory."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def label(document, name):
    return f"{document}-{name}"


def link(found, document, folder):
    """One link of `document` (its name without .md), whose neighbours lie in `folder`."""
    text, path, name = found.groups()
    if path and not (path.endswith(".md") and "/" not in path and (folder / path).exists()):
        return f"{text} (`{pathlib.PurePosixPath(path).as_posix().lstrip('./')}`)"
    if not name:
        return found.group(0)
    return f"[{text}](#{label(path[:-3] or document, name)})"


def filtered(text, document, folder):
    lines, fenced = [], False
    for line in text.splitlines():
        fenced ^= line.startswith("```")
        if fenced or line.startswith("    "):
            lines.append(line)
            continue
        heading = HEADING.match(line)
        # The first one is the title: of the page, which has a name already.
        if heading and len(heading.group(1)) > 1:
            line += f" {{#{label(document, anchor(heading.group(2)))}}}"
        lines.append(LINK.sub(lambda found: link(found, document, folder), line))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    file = pathlib.Path(sys.argv[1])
    sys.stdout.write(filtered(file.read_text(encoding="utf-8"), file.stem, file.parent))
