"""A headless Chromium, driven through its debugging pipe (Chrome DevTools Protocol), without
further dependencies.

Used by pages_test.py. One Browser is one process with a profile of its own; one Page is one tab of
it.
"""
import base64
import fcntl
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--disable-dev-shm-usage", "--hide-scrollbars", "--remote-debugging-pipe"]
TIME_OUT_S = 120  # far more than a busy machine needs


def chromium():
    """Path of the program; None if it is not installed."""
    return shutil.which("chromium") or shutil.which("chromium-browser")


class Browser:
    def __init__(self):
        self.profile = tempfile.mkdtemp(prefix="chromium-")
        to_read, self.to_write = os.pipe()
        self.from_read, from_write = os.pipe()
        theirs = [fcntl.fcntl(fd, fcntl.F_DUPFD, 10) for fd in (to_read, from_write)]

        def only_3_and_4():
            os.dup2(theirs[0], 3)
            os.dup2(theirs[1], 4)

        self.process = subprocess.Popen(
            [chromium(), *FLAGS, "--user-data-dir=" + self.profile, "about:blank"], close_fds=False,
            preexec_fn=only_3_and_4, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for fd in (to_read, from_write, *theirs):
            os.close(fd)
        self.buffer = b""
        self.events = []
        self.last_id = 0

    def close(self):
        try:
            self.call("Browser.close")
            self.process.wait(30)
        except (OSError, RuntimeError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        os.close(self.to_write)
        os.close(self.from_read)
        shutil.rmtree(self.profile, ignore_errors=True)

    def call(self, method, params=None, session=None):
        """The result of a command; events in between are stored in `events`."""
        self.last_id += 1
        message = {"id": self.last_id, "method": method, "params": params or {}}
        if session:
            message["sessionId"] = session
        os.write(self.to_write, json.dumps(message).encode() + b"\0")
        wanted = self.last_id
        while True:
            answer = self.receive()
            if answer.get("id") != wanted:
                self.events.append(answer)
            elif "error" in answer:
                raise RuntimeError(f"{method}: {answer['error']['message']}")
            else:
                return answer["result"]

    def receive(self):
        end = time.monotonic() + TIME_OUT_S
        while b"\0" not in self.buffer:
            ready, _, _ = select.select([self.from_read], [], [], max(0, end - time.monotonic()))
            part = os.read(self.from_read, 1 << 20) if ready else b""
            if not part:
                raise RuntimeError("Chromium does not answer")
            self.buffer += part
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)


class Page:
    def __init__(self, browser, width_px=1200, height_px=900, dark=False):
        self.browser = browser
        self.target = browser.call("Target.createTarget", {"url": "about:blank"})["targetId"]
        self.session = browser.call("Target.attachToTarget",
                                    {"targetId": self.target, "flatten": True})["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(domain + ".enable")
        self.resize(width_px, height_px)
        self.set_dark(dark)

    def close(self):
        self.browser.call("Target.closeTarget", {"targetId": self.target})

    def bring_to_front(self):
        """Only the front tab draws."""
        self.call("Page.bringToFront")

    def call(self, method, params=None):
        return self.browser.call(method, params, self.session)

    def resize(self, width_px, height_px):
        self.call("Emulation.setDeviceMetricsOverride",
                  {"width": width_px, "height": height_px, "deviceScaleFactor": 1,
                   "mobile": width_px < 600})

    def set_dark(self, dark):
        self.call("Emulation.setEmulatedMedia",
                  {"features": [{"name": "prefers-color-scheme",
                                 "value": "dark" if dark else "light"}]})

    def open(self, path):
        self.call("Page.navigate", {"url": "file://" + os.path.abspath(path)})
        self.wait("document.documentElement?.dataset.ready === 'true'")

    def run(self, script):
        """Value of an expression, awaited when it is a promise."""
        result = self.call("Runtime.evaluate",
                           {"expression": script, "returnByValue": True, "awaitPromise": True})
        if "exceptionDetails" in result:
            details = result["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description", details["text"]))
        return result["result"].get("value")

    def wait(self, condition):
        end = time.monotonic() + TIME_OUT_S
        while not self.run(f"Boolean({condition})"):
            if time.monotonic() > end:
                raise RuntimeError(
                    f"never came true: {condition}; the page says: {self.complaints()}")
            time.sleep(0.05)

    def set_value(self, element_id, value):
        """Moves a slider or chooses an option, as a person does."""
        self.run(f"""(() => {{
          const element = document.getElementById({json.dumps(element_id)});
          element.value = {json.dumps(str(value))};
          for (const kind of ["input", "change"]) {{
            element.dispatchEvent(new Event(kind, {{bubbles: true}}));
          }}
        }})()""")

    def events_of(self, *methods):
        return [event for event in self.browser.events
                if event.get("sessionId") == self.session and event["method"] in methods]

    def complaints(self):
        """Errors and warnings of the console, uncaught exceptions."""
        found = [event["params"]["exceptionDetails"]
                 for event in self.events_of("Runtime.exceptionThrown")]
        found += [event["params"] for event in self.events_of("Runtime.consoleAPICalled")
                  if event["params"]["type"] in ("error", "warning", "assert")]
        found += [event["params"]["entry"] for event in self.events_of("Log.entryAdded")
                  if event["params"]["entry"]["level"] in ("error", "warning")]
        return found

    def screenshot(self, path, whole=True):
        height = self.run("document.documentElement.scrollHeight") if whole else None
        params = {"format": "png"}
        if whole:
            width = self.run("innerWidth")
            params["captureBeyondViewport"] = True
            params["clip"] = {"x": 0, "y": 0, "width": width, "height": height, "scale": 1}
        with open(path, "wb") as file:
            file.write(base64.b64decode(self.call("Page.captureScreenshot", params)["data"]))
