# SPDX-License-Identifier: BSD-3-Clause
"""The pages of scripts/docs: without a warning, without a dead link; the documents as Doxygen reads them."""
import html.parser
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
import docs_markdown  # noqa: E402


class Links(html.parser.HTMLParser):
    """What a page links to, and the names in it."""

    def __init__(self, page):
        super().__init__()
        self.targets, self.names = set(), set()
        self.feed(page.read_text())

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.names |= {values[key] for key in ("id", "name") if values.get(key)}
        self.targets |= {values[key] for key in ("href", "src") if values.get(key)}


def dead_links(folder):
    pages = {page.name: Links(page) for page in folder.glob("*.html")}
    for name, page in sorted(pages.items()):
        for target in sorted(page.targets):
            url = urllib.parse.urlparse(target)
            path, anchor = url.path or name, urllib.parse.unquote(url.fragment)
            if url.scheme or url.netloc:
                continue
            if not (folder / path).exists():
                yield f"{name}: {target}"
            elif anchor and path in pages and anchor not in pages[path].names:
                yield f"{name}: {target}"


class Docs(unittest.TestCase):
    @unittest.skipUnless(shutil.which("doxygen"), "skipped: no doxygen")
    def test_pages_are_made_without_a_warning_and_lead_nowhere_dead(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([str(ROOT / "scripts" / "docs"), "--output", folder], text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            self.assertEqual(done.returncode, 0, done.stdout)
            pages = pathlib.Path(folder)
            self.assertEqual(list(dead_links(pages)), [])
            self.assertIn("The core as a library", (pages / "index.html").read_text())
            self.assertIn("process", (pages / "classpf_1_1Slam.html").read_text())
            for document in (ROOT / "docs").glob("*.md"):
                title = document.read_text().splitlines()[0].lstrip("# ")
                self.assertTrue(any(title in page.read_text() for page in pages.glob("*.html")), title)

    def test_headings_and_links_get_names_that_are_different_in_all_documents(self):
        text = ("# Title\n## Speed, and memory\nsee [it](#speed-and-memory), [grid](b.md#a-grid), [b](b.md)\n"
                "```\n# no heading\n```\n    [no](#link)\n")
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "b.md").write_text("# B\n## A grid\n")
            self.assertEqual(
                docs_markdown.filtered(text, "a", pathlib.Path(folder)),
                "# Title\n## Speed, and memory {#a-speed-and-memory}\n"
                "see [it](#a-speed-and-memory), [grid](#b-a-grid), [b](b.md)\n"
                "```\n# no heading\n```\n    [no](#link)\n")

    def test_what_has_no_page_is_named_by_its_path(self):
        text = "[how](../training/README.md), [there](https://example.org/a), ![picture](images/a.png)\n"
        self.assertEqual(docs_markdown.filtered(text, "a", ROOT / "docs"),
                         "how (`training/README.md`), [there](https://example.org/a), ![picture](images/a.png)\n")


if __name__ == "__main__":
    unittest.main()
