# SPDX-License-Identifier: BSD-3-Clause
"""Chromium without a display, drawn by software, controlled over a pair of pipes (DevTools protocol)."""
import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

NAMES = ("chromium", "chromium-browser", "google-chrome")
FLAGS = ("--headless=new", "--no-first-run", "--no-default-browser-check", "--disable-extensions",
         "--disable-background-networking", "--disable-component-update", "--disable-sync", "--mute-audio",
         "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--remote-debugging-pipe")


class BrowserError(Exception):
    pass


def find():
    """The program, or nothing where there is none."""
    return next(filter(None, map(shutil.which, NAMES)), None)


class Browser:
    """One page of a browser of its own; `size`: of its window, in pixels."""

    def __init__(self, size=(1280, 800)):
        program = find()
        if not program:
            raise BrowserError("there is no chromium (Debian package chromium)")
        self.folder = tempfile.mkdtemp(prefix="posefusion_browser_")
        commands, self.commands = os.pipe()
        self.answers, answers = os.pipe()
        # Root has no sandbox of its own; what is opened are our own pages.
        flags = FLAGS + (("--no-sandbox",) if os.geteuid() == 0 else ())
        # It reads commands from descriptor 3 and answers on 4, which the shell connects to the pipes.
        run = f'exec "$0" "$@" 3<&{commands} 4>&{answers}'
        self.process = subprocess.Popen(
            ["sh", "-c", run, program, *flags, f"--window-size={size[0]},{size[1]}", f"--user-data-dir={self.folder}"],
            pass_fds=(commands, answers), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(commands)
        os.close(answers)
        self.buffer, self.number, self.session, self.events = b"", 0, None, []
        try:
            target = self.call("Target.createTarget", url="about:blank")["targetId"]
            self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
            for domain in ("Page", "Runtime", "Network"):
                self.call(f"{domain}.enable")
        except BaseException:
            self.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        os.close(self.commands)
        os.close(self.answers)
        for _ in range(20):  # its helpers may still write
            shutil.rmtree(self.folder, ignore_errors=True)
            if not os.path.exists(self.folder):
                return
            time.sleep(0.1)

    def read(self, until):
        """The next message."""
        while b"\0" not in self.buffer:
            if not select.select([self.answers], [], [], max(0, until - time.monotonic()))[0]:
                raise BrowserError("the browser does not answer")
            part = os.read(self.answers, 1 << 20)
            if not part:
                raise BrowserError("the browser has ended")
            self.buffer += part
        message, _, self.buffer = self.buffer.partition(b"\0")
        return json.loads(message)

    def call(self, method, timeout_s=60, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.commands, json.dumps(message).encode() + b"\0")
        until = time.monotonic() + timeout_s
        while True:
            answer = self.read(until)
            if answer.get("id") != self.number:
                self.events.append(answer)
            elif "error" in answer:
                raise BrowserError(f"{method}: {answer['error']['message']}")
            else:
                return answer["result"]

    def value(self, expression):
        """Of an expression of JavaScript in the page."""
        found = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in found:
            raise BrowserError(f"{expression}: {found['exceptionDetails']['text']}")
        return found["result"].get("value")

    def open(self, address, ready, timeout_s=60):
        """Seconds from the call until the expression `ready` is true; none of the page before may match it."""
        self.events.clear()
        begin = time.monotonic()
        self.call("Page.navigate", url=address, timeout_s=timeout_s)
        while not self.value(ready):
            if time.monotonic() - begin > timeout_s:
                raise BrowserError(f"{address}: not ready after {timeout_s} s: {ready}")
            time.sleep(0.01)
        return time.monotonic() - begin

    def requests(self):
        """Addresses that the page has requested since it was opened."""
        return [e["params"]["request"]["url"] for e in self.events if e.get("method") == "Network.requestWillBeSent"]

    def errors(self):
        """Exceptions and errors of the page since it was opened."""
        kinds = {"Runtime.exceptionThrown", "Runtime.consoleAPICalled"}
        return [json.dumps(e["params"]) for e in self.events if e.get("method") in kinds]

    def drag(self, start, end, button="left", modifiers=0, steps=8):
        def mouse(kind, x, y, pressed):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, buttons=pressed, clickCount=1, modifiers=modifiers)
        pressed = {"left": 1, "right": 2, "middle": 4}[button]
        mouse("mousePressed", *start, pressed)
        for i in range(1, steps + 1):
            mouse("mouseMoved", *(a + (b - a) * i / steps for a, b in zip(start, end)), pressed)
        mouse("mouseReleased", *end, 0)

    def settle(self, seconds=0.5):
        """Lets the page do what it does some time after it was touched last, and draw it."""
        time.sleep(seconds)
        self.value("new Promise(resolve => requestAnimationFrame(() => requestAnimationFrame(resolve)))")

    def screenshot(self, path):
        shot = self.call("Page.captureScreenshot", format="png")
        path.write_bytes(base64.b64decode(shot["data"]))
