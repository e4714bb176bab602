# SPDX-License-Identifier: BSD-3-Clause
"""The part `page` of scripts/bench: a map as a page of HTML, its size, and how soon Chromium without a display has
drawn it by software. Leaves pictures of the pages."""
import re
import statistics

import headless_browser
from bench_report import Failed, call
from bench_runs import PROGRAMS, Runs, note

SIZE_MB, OPEN_S = 15, 3
READY = "['open', 'failed'].includes(document.documentElement?.dataset.state)"
PHONE = {"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": True}


class Page(Runs):
    def page(self):
        if not headless_browser.find():
            print("page: skipped: there is no chromium (Debian package chromium)")
            return
        for seed in self.options.seeds:
            sequence, folder, _ = self.walk_run("loop_room", seed, "embedded")
            for kind, arguments in (("mesh", ()), ("surfels", ("--surfels",))):
                self.page_rows(f"loop_room {seed}, page of the {kind}", folder / "map.pfdb",
                               self.output / f"{sequence.name}_{kind}.html", arguments)

    def page_rows(self, name, map_file, file, arguments):
        note(f"making {name}")
        said = call(PROGRAMS / "posefusion_map", "view", map_file, "-o", file, "--title", name, *arguments)
        found = re.search(r"MB, (.*), of (\d+) surfels in ([\d.]+) s", said)
        if not found:
            raise Failed(f"no figures: {said}")
        self.row(f"{name}: {found[1]}, size", file.stat().st_size / 1e6, "MB", SIZE_MB, digits=1)
        self.row(f"{name}: time to make it", float(found[3]), "s", digits=2)
        times = [self.opened(file, shoot=i == 0) for i in range(self.options.repeats)]
        self.row(f"{name}: until all is drawn, median of {len(times)} browsers", statistics.median(times), "s", OPEN_S, digits=2)

    def opened(self, file, shoot):
        """Seconds until the page has drawn all, in a browser that has just been started."""
        try:
            with headless_browser.Browser() as browser:
                seconds = browser.open(file.as_uri(), READY)
                trouble = browser.value("document.getElementById('trouble').textContent")
                asked = [url for url in browser.requests() if not url.startswith(("file:", "data:"))]
                if trouble or asked or browser.errors():
                    raise Failed(f"{file.name}: {trouble} {asked} {browser.errors()}")
                if shoot:
                    self.shoot(browser, file)
                return seconds
        except headless_browser.BrowserError as error:
            raise Failed(f"{file.name}: {error}") from error

    @staticmethod
    def shoot(browser, file):
        """As it opens, turned by hand, and on a phone in the dark."""
        browser.screenshot(file.with_suffix(".png"))
        browser.drag((640, 400), (760, 300))
        browser.settle()
        browser.screenshot(file.with_name(f"{file.stem}_turned.png"))
        browser.call("Emulation.setDeviceMetricsOverride", **PHONE)
        browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
        browser.settle()
        browser.screenshot(file.with_name(f"{file.stem}_phone.png"))
