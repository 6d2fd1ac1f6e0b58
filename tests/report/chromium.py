# SPDX-License-Identifier: GPL-3.0-or-later
"""A headless Chromium without a network, driven over its DevTools pipe; and a reader of its screenshots."""
import base64
import json
import os
import select
import shutil
import struct
import subprocess
import tempfile
import time
import zlib


class Chromium:
    """One browser with one page. `errors` collects what the page complained of, `requests` all it asked for."""

    def __init__(self):
        program = shutil.which("chromium")
        if program is None:
            raise SystemExit("chromium is missing: install packages-slow.txt")
        self.profile = tempfile.mkdtemp(prefix="millpose_chromium_")
        to_browser, self.out = os.pipe()
        self.inp, from_browser = os.pipe()

        def connect():  # the pipe's ends are file descriptors 3 and 4, by Chromium's rule
            reader, writer = os.dup(to_browser), os.dup(from_browser)
            os.dup2(reader, 3)
            os.dup2(writer, 4)

        self.process = subprocess.Popen(
            [program, "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
             "--remote-debugging-pipe", "--user-data-dir=" + self.profile, "--no-first-run", "--disable-extensions",
             "--disable-background-networking", "--host-resolver-rules=MAP * ~NOTFOUND", "--hide-scrollbars",
             "about:blank"],
            preexec_fn=connect, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.buffer = b""
        self.last = 0
        self.session = None
        self.errors, self.requests, self.contexts = [], [], {}
        target = [t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page"][0]
        self.session = self.call("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(domain + ".enable")
        self.call("Network.emulateNetworkConditions", offline=True, latency=0, downloadThroughput=-1,
                  uploadThroughput=-1)

    def close(self):
        self.process.terminate()
        self.process.wait(timeout=30)
        os.close(self.out)
        os.close(self.inp)
        shutil.rmtree(self.profile, ignore_errors=True)

    def call(self, method, **parameters):
        self.last += 1
        message = {"id": self.last, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.last:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]

    def receive(self):
        deadline = time.monotonic() + 120
        while b"\0" not in self.buffer:
            ready, _, _ = select.select([self.inp], [], [], max(0, deadline - time.monotonic()))
            piece = os.read(self.inp, 1 << 20) if ready else b""
            if not piece:
                raise RuntimeError("chromium does not answer")
            self.buffer += piece
        text, self.buffer = self.buffer.split(b"\0", 1)
        message = json.loads(text)
        self.note(message.get("method"), message.get("params", {}))
        return message

    def note(self, method, params):
        if method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "assert"):
            self.errors.append(" ".join(str(a.get("value", a.get("description"))) for a in params["args"]))
        elif method == "Log.entryAdded" and params["entry"]["level"] == "error":
            self.errors.append(params["entry"]["text"])
        elif method == "Runtime.executionContextCreated" and params["context"]["auxData"]["isDefault"]:
            self.contexts[params["context"]["auxData"]["frameId"]] = params["context"]["id"]
        elif method == "Network.requestWillBeSent":
            self.requests.append(params["request"]["url"])

    def evaluate(self, expression, **where):
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True, **where)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def frame(self):
        """Of the page's one iframe: its address, and what evaluate() needs to ask in it."""
        frame = self.call("Page.getFrameTree")["frameTree"]["childFrames"][0]["frame"]
        return frame["url"], {"contextId": self.contexts[frame["id"]]}

    def wait(self, expression, **where):
        deadline = time.monotonic() + 120
        while not self.evaluate(expression, **where):
            if time.monotonic() > deadline:
                raise RuntimeError("never true: " + expression)
            time.sleep(0.05)

    def settle(self):
        """Until what was scheduled is drawn, also what is off the screen."""
        self.frames()
        self.wait("!window.millpose || !millpose.isDrawn || millpose.isDrawn()")

    def frames(self):
        """Until what was scheduled on the screen is drawn."""
        self.evaluate("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(() => r(true))))")

    def media(self, theme="light", paper=False):
        self.call("Emulation.setEmulatedMedia", media="print" if paper else "",
                  features=[{"name": "prefers-color-scheme", "value": theme}])
        self.settle()

    def key(self, key, modifiers=0):
        self.call("Input.dispatchKeyEvent", type="keyDown", key=key, modifiers=modifiers)
        self.settle()

    def size(self, width, height):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def open(self, url):
        self.call("Page.navigate", url="about:blank")  # so that a changed fragment is a new page
        self.call("Page.navigate", url=url)
        self.wait("location.href !== 'about:blank' && document.readyState === 'complete' && "
                  "(!window.millpose || document.body.classList.contains('ready'))")
        self.settle()

    def click(self, x, y):
        """Returns when the page has had the click and drawn what came of it, however late its events come under load."""
        here = self.evaluate(f"""(() => {{ const e = document.elementFromPoint({x}, {y});
            window.hadClick = e && e.tagName === 'IFRAME';  // a frame within has its own events
            window.addEventListener('pointerup', () => {{ window.hadClick = true; }}, {{capture: true, once: true}});
            return Boolean(e); }})()""")
        if not here:
            raise RuntimeError(f"a click at {x}, {y} is outside of the window")
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)
        self.wait("window.hadClick !== false")  # undefined: the click led to another page
        self.settle()

    def click_on(self, selector):
        """The middle of an element, scrolled into view."""
        x, y = self.evaluate(f"""(() => {{ const e = document.querySelector({json.dumps(selector)});
            e.scrollIntoView({{block: "center"}}); const b = e.getBoundingClientRect();
            return [b.x + b.width / 2, b.y + b.height / 2]; }})()""")
        self.frames()  # input goes to what is where it was last drawn
        self.click(x, y)

    def screenshot(self, selector=None):
        """PNG bytes of the whole page or of one element."""
        clip = {}
        if selector:
            box = self.evaluate(f"""(() => {{ const b = document.querySelector({json.dumps(selector)})
                .getBoundingClientRect(); return [b.x + scrollX, b.y + scrollY, b.width, b.height]; }})()""")
            clip = {"clip": dict(zip(("x", "y", "width", "height"), box), scale=1)}
        data = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=True, **clip)["data"]
        return base64.b64decode(data)


def pixels(png):
    """(width, height, list of rows of (r, g, b)) of an 8-bit RGB or RGBA PNG."""
    at, data, header = 8, b"", None
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at:at + 8])
        body = png[at + 8:at + 8 + length]
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            data += body
        at += 12 + length
    width, height, depth, colour = header[:4]
    assert depth == 8 and colour in (2, 6), header
    step = 3 if colour == 2 else 4
    raw, stride = zlib.decompress(data), width * step
    rows, before = [], bytearray(stride)
    for y in range(height):
        filter_type = raw[y * (stride + 1)]
        line = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            a = line[i - step] if i >= step else 0
            b = before[i]
            c = before[i - step] if i >= step else 0
            if filter_type == 1:
                line[i] = line[i] + a & 255
            elif filter_type == 2:
                line[i] = line[i] + b & 255
            elif filter_type == 3:
                line[i] = line[i] + (a + b) // 2 & 255
            elif filter_type == 4:
                p = a + b - c
                near = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))
                line[i] = line[i] + near[2] & 255
        rows.append([tuple(line[x:x + 3]) for x in range(0, stride, step)])
        before = line
    return width, height, rows
