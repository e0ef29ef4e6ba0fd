"""Controls a headless Chromium through its debugging pipe, so that tests of web pages need no library for browsers."""

import atexit
import base64
import functools
import json
import os
import select
import shutil
import struct
import subprocess
import tempfile
import time
import zlib
from pathlib import Path

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


def find():
    """Returns the path of Chromium, or None. The environment variable TROUPE_CHROMIUM names one that is not on the path."""
    named = os.environ.get("TROUPE_CHROMIUM")
    return named or next(filter(None, map(shutil.which, NAMES)), None)


class Browser:
    """A running headless Chromium."""

    def __init__(self, program):
        self.folder = tempfile.TemporaryDirectory(prefix="troupe-chromium-", ignore_cleanup_errors=True)
        to_browser, self.out = os.pipe()
        self.into, from_browser = os.pipe()
        # Graphics are drawn in software, because the machine may have no display.
        command = [program, "--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--use-angle=swiftshader",
                   "--use-gl=angle", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--disable-dev-shm-usage",
                   "--no-first-run", "--disable-extensions", "--disable-background-networking", "--mute-audio",
                   "--hide-scrollbars", f"--user-data-dir={self.folder.name}", "about:blank"]

        def pipes():  # the browser reads from 3 and writes to 4
            os.dup2(to_browser, 60)
            os.dup2(from_browser, 61)
            os.dup2(60, 3)
            os.dup2(61, 4)

        self.log = open(Path(self.folder.name) / "stderr", "wb")
        self.process = subprocess.Popen(command, preexec_fn=pipes, pass_fds=(3, 4), stdout=self.log, stderr=self.log,
                                        env={**os.environ, "HOME": self.folder.name})
        os.close(to_browser)
        os.close(from_browser)
        self.buffer = b""
        self.number = 0
        self.pages = {}  # the open pages by session

    def close(self):
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        os.close(self.out)
        os.close(self.into)
        self.log.close()
        self.folder.cleanup()

    def receive(self, until):
        """Returns the next message of the browser. Raises TimeoutError if none arrives before the time `until`."""
        while b"\0" not in self.buffer:
            left = until - time.monotonic()
            if left <= 0 or not select.select([self.into], [], [], left)[0]:
                raise TimeoutError(f"the browser is silent; it had said: {self.said()}")
            data = os.read(self.into, 1 << 20)
            if not data:
                raise RuntimeError(f"the browser is gone; it had said: {self.said()}")
            self.buffer += data
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def said(self):
        return (Path(self.folder.name) / "stderr").read_text(errors="replace")[-2000:]

    def call(self, method, params, session=None, timeout=240):
        self.number += 1
        number = self.number
        message = {"id": number, "method": method, "params": params}
        if session:
            message["sessionId"] = session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        until = time.monotonic() + timeout
        while True:
            answer = self.receive(until)
            if answer.get("id") == number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            if page := self.pages.get(answer.get("sessionId")):
                page.note(answer)


@functools.lru_cache(maxsize=None)
def browser_of(program):
    """Returns the browser in which all pages of this process are opened: starting one takes a second."""
    browser = Browser(program)
    atexit.register(browser.close)
    return browser


class Page:
    """A page in the browser, which shares no cookies and no storage with other pages. Records its faults: console messages,
    exceptions, failed requests."""

    def __init__(self, program, size=(1280, 800), touch=False):
        self.browser = browser_of(program)
        self.problems = []
        self.allowed = ()  # beginnings of addresses that the page may request
        self.context = self.browser.call("Target.createBrowserContext", {})["browserContextId"]
        target = self.browser.call("Target.createTarget", {"url": "about:blank", "browserContextId": self.context, "newWindow": True,
                                                           "width": size[0], "height": size[1]})
        self.session = self.browser.call("Target.attachToTarget", {"targetId": target["targetId"], "flatten": True})["sessionId"]
        self.browser.pages[self.session] = self
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=1, mobile=touch)
        if touch:
            self.call("Emulation.setTouchEmulationEnabled", enabled=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        del self.browser.pages[self.session]
        self.browser.call("Target.disposeBrowserContext", {"browserContextId": self.context})

    def note(self, message):
        """Records a message of the browser if it reports a fault."""
        method, params = message.get("method"), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.problems.append(details.get("exception", {}).get("description") or details["text"])
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning", "assert"):
            self.problems.append(" ".join(str(arg.get("value", arg.get("description"))) for arg in params["args"]))
        elif method == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
            self.problems.append(params["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            url = params["request"]["url"]
            if not url.startswith(("file:", "data:", "blob:", "about:", *self.allowed)):
                self.problems.append(f"asked for {url}")

    def call(self, method, **params):
        return self.browser.call(method, params, self.session)

    def open(self, path):
        self.call("Page.navigate", url=Path(path).resolve().as_uri())

    def open_address(self, address):
        """Opens a page of a server on this machine. The page may send further requests to this server."""
        self.allowed = (address.split("#")[0],)
        self.call("Page.navigate", url=address)

    def run(self, script):
        """Returns the value of a JavaScript expression; waits for promises."""
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description") or details["text"])
        return answer["result"].get("value")

    def holds(self, condition):
        """Returns whether a JavaScript expression is true now. It is not while the page is loaded or replaced by another."""
        try:
            return self.run(f"document.readyState === 'complete' && ({condition})")
        except RuntimeError as error:
            if "Inspected target navigated or closed" not in str(error):
                raise
            return False

    def wait(self, condition, seconds=240):
        """Waits until a JavaScript expression is true, also across a change of the page."""
        until = time.monotonic() + seconds
        while not self.holds(condition):
            if time.monotonic() > until:
                raise TimeoutError(f"never true: {condition}; the page said: {self.problems}")
            time.sleep(0.02)

    def press(self, key, code=None, shift=False):
        text = key if len(key) == 1 else ""
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=code or key, text=text if kind == "keyDown" else "",
                      modifiers=8 if shift else 0)

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def click(self, x, y):
        self.mouse("mouseMoved", x, y)
        self.mouse("mousePressed", x, y, button="left", clickCount=1)
        self.mouse("mouseReleased", x, y, button="left", clickCount=1)

    def touch(self, *places):
        """Touches the screen at a place, or moves a finger from the first to the last of several places."""
        for i, (x, y) in enumerate(places):
            self.call("Input.dispatchTouchEvent", type="touchMove" if i else "touchStart", touchPoints=[{"x": x, "y": y}])
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def drag(self, start, end, button="left", steps=8, shift=False):
        keys = {"modifiers": 8 if shift else 0}
        self.mouse("mouseMoved", *start, **keys)
        self.mouse("mousePressed", *start, button=button, clickCount=1, **keys)
        for i in range(1, steps + 1):
            at = [a + (b - a) * i / steps for a, b in zip(start, end)]
            self.mouse("mouseMoved", *at, button=button, buttons=1 if button == "left" else 2, **keys)
        self.mouse("mouseReleased", *end, button=button, clickCount=1, **keys)

    def screenshot(self, box=None):
        """Returns a screenshot of the page, or of the box (x0, y0, x1, y1) of it, as the bytes of a PNG."""
        clip = {} if box is None else {"clip": {"x": box[0], "y": box[1], "width": box[2] - box[0],
                                                "height": box[3] - box[1], "scale": 1}}
        return base64.b64decode(self.call("Page.captureScreenshot", format="png", **clip)["data"])


class Picture:
    """A decoded PNG of the browser: 8 bits, RGB or RGBA, not interlaced."""

    def __init__(self, png):
        assert png.startswith(b"\x89PNG\r\n\x1a\n")
        at, data = 8, b""
        while at < len(png):
            size, kind = struct.unpack(">I4s", png[at:at + 8])
            body = png[at + 8:at + 8 + size]
            if kind == b"IHDR":
                self.width, self.height, depth, color, _, _, interlaced = struct.unpack(">IIBBBBB", body)
                assert depth == 8 and color in (2, 6) and not interlaced
                self.channels = 3 if color == 2 else 4
            elif kind == b"IDAT":
                data += body
            at += 12 + size
        self.rows = self.unfiltered(zlib.decompress(data))

    def unfiltered(self, data):
        """Reverses the filters of the rows (PNG specification, section 9.2)."""
        stride, step, rows = self.width * self.channels, self.channels, []
        above = bytearray(stride)
        for y in range(self.height):
            kind = data[y * (stride + 1)]
            row = bytearray(data[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
            if kind == 2:
                row = bytearray((a + b) & 255 for a, b in zip(row, above))
            elif kind:
                for i in range(stride):
                    left = row[i - step] if i >= step else 0
                    corner = above[i - step] if i >= step else 0
                    if kind == 1:
                        guess = left
                    elif kind == 3:
                        guess = (left + above[i]) // 2
                    else:
                        p = left + above[i] - corner
                        guess = min((left, above[i], corner), key=lambda value: abs(p - value))
                    row[i] = (row[i] + guess) & 255
            rows.append(row)
            above = row
        return rows

    def at(self, x, y):
        """Returns red, green and blue of a pixel, 0 to 255."""
        first = round(x) * self.channels
        return tuple(self.rows[round(y)][first:first + 3])

    def different(self, other):
        """Returns the number of pixels that differ visibly from those of another picture of the same size."""
        return sum(max(abs(a - b) for a, b in zip(self.at(x, y), other.at(x, y))) > 12
                   for y in range(self.height) for x in range(self.width))
