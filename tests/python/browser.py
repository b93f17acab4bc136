"""A headless browser for tests: a page of a file is opened without network, clicked, and looked at.

Any Chromium (Debian: chromium-headless-shell or chromium), told what to do through a pipe, in its own protocol.
"""

import base64
import io
import json
import os
import select
import shutil
import subprocess
import time

import numpy as np

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome", "chrome")
# software alone draws, the same everywhere; no name of a host is known to it
FLAGS = (
    *("--headless", "--no-sandbox", "--hide-scrollbars", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    *("--disable-background-networking", "--disable-component-update", "--no-first-run", "--disable-dev-shm-usage"),
    *("--host-resolver-rules=MAP * ~NOTFOUND", "--remote-debugging-pipe"),
)


def found() -> str | None:
    """The first browser there is."""
    return next((path for path in map(shutil.which, NAMES) if path), None)


class Page:
    """A page in a window of its own; a context manager. `requests`: what it asked for, by address."""

    def __init__(self, path, folder, size=(900, 700)):
        to_read, self._to = os.pipe()
        self._from, to_write = os.pipe()

        def wire():
            # the browser reads 3 and writes 4; none may be overwritten before it is moved
            for end, source in zip((3, 4), [os.dup(to_read), os.dup(to_write)], strict=True):
                os.dup2(source, end)
                os.set_inheritable(end, True)

        window = f"--window-size={size[0]},{size[1]}"
        self._browser = subprocess.Popen(
            [found(), *FLAGS, window, f"--user-data-dir={folder}", "about:blank"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            close_fds=False,
            preexec_fn=wire,
        )
        os.close(to_read)
        os.close(to_write)
        self._size, self._text, self._count, self._session = size, b"", 0, None
        self.requests: list[str] = []
        self._loaded = False
        (target,) = (t for t in self.ask("Target.getTargets")["targetInfos"] if t["type"] == "page")
        attached = self.ask("Target.attachToTarget", targetId=target["targetId"], flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Network", "Runtime"):
            self.ask(f"{domain}.enable")
        self._loaded = False
        self.ask("Page.navigate", url=path.as_uri())
        while not self._loaded:
            self._read()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._session = None
        try:
            self.ask("Browser.close")
            self._browser.wait(10)
        except (OSError, RuntimeError, TimeoutError, subprocess.TimeoutExpired):
            self._browser.kill()
            self._browser.wait()
        os.close(self._to)
        os.close(self._from)

    def _read(self, patience=120.0):
        """The next message; what happens in the page is noted."""
        while b"\0" not in self._text:
            if not select.select([self._from], [], [], patience)[0]:
                raise TimeoutError("the browser says nothing")
            more = os.read(self._from, 1 << 20)
            if not more:
                raise RuntimeError("the browser is gone")
            self._text += more
        line, _, self._text = self._text.partition(b"\0")
        message = json.loads(line)
        if message.get("method") == "Network.requestWillBeSent":
            self.requests.append(message["params"]["request"]["url"])
        self._loaded = self._loaded or message.get("method") == "Page.loadEventFired"
        return message

    def ask(self, method, **parameters):
        """A command of the protocol, and its result."""
        self._count += 1
        command = {"id": self._count, "method": method, "params": parameters}
        if self._session is not None:
            command["sessionId"] = self._session
        os.write(self._to, json.dumps(command).encode() + b"\0")
        while True:
            message = self._read()
            if message.get("id") == self._count:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return message["result"]

    def evaluate(self, expression):
        """The value of JavaScript in the page."""
        result = self.ask("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(str(result["exceptionDetails"]))
        return result["result"].get("value")

    def wait_for(self, expression, patience=60.0):
        """Until JavaScript in the page is true."""
        end = time.monotonic() + patience
        while not self.evaluate(expression):
            if time.monotonic() > end:
                raise TimeoutError(f"the page never came to {expression}")
            time.sleep(0.05)

    def mouse(self, what, x, y):
        """Presses the left button at a point of the window, moves there, or lets it go."""
        self.ask("Input.dispatchMouseEvent", type=what, x=x, y=y, button="left", buttons=1, clickCount=1)

    def click(self, x, y):
        self.mouse("mousePressed", x, y)
        self.mouse("mouseReleased", x, y)

    def picture(self):
        """The window as it is now, (height, width, 3), 0 to 255."""
        import matplotlib.image

        # twice: what was drawn last is shown by the second
        for _ in range(2):
            data = self.ask("Page.captureScreenshot", format="png")["data"]
        return np.round(255 * matplotlib.image.imread(io.BytesIO(base64.b64decode(data)))[..., :3]).astype(int)
