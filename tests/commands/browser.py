"""A browser without a screen, led by the WebDriver protocol (W3C) through chromedriver."""
import base64, json, os, signal, socket, subprocess, time, urllib.request

PATIENCE = 60  # s
# Chromium's own software renderer; without a sandbox, which root has none of.
OPTIONS = ["--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
           "--disable-dev-shm-usage", "--window-size=600,480"]


class Browser:
    def __init__(self):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.driver = subprocess.Popen(["chromedriver", f"--port={self.port}"], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL, start_new_session=True)
        try:
            self.begin()
        except BaseException:
            self.end_driver()
            raise

    def begin(self):
        self.wait_until(self.answers)
        capabilities = {"browserName": "chrome", "goog:chromeOptions": {"args": OPTIONS}, "goog:loggingPrefs": {"browser": "ALL"}}
        self.session = "/session/" + self.call("POST", "/session", {"capabilities": {"alwaysMatch": capabilities}})["sessionId"]

    def answers(self):
        try:
            return self.call("GET", "/status")["ready"]
        except OSError:
            return False

    @staticmethod
    def wait_until(condition):
        end = time.monotonic() + PATIENCE
        while not (found := condition()):
            if time.monotonic() > end:
                raise TimeoutError("the browser did not come to it")
            time.sleep(0.05)
        return found

    def call(self, method, path, body=None):
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}{path}", method=method,
                                         data=None if body is None else json.dumps(body).encode())
        with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
            return json.load(answer)["value"]

    def open(self, path, fragment=""):
        """The page's data once it is ready, or has an error."""
        self.call("POST", self.session + "/url", {"url": "about:blank"})
        self.log()
        self.call("POST", self.session + "/url", {"url": f"file://{path}#{fragment}"})
        self.wait_until(lambda: {"ready", "error"} & self.data().keys())
        return self.data()

    def data(self):
        return self.run("return {...document.body.dataset}")

    def run(self, script, *arguments):
        return self.call("POST", self.session + "/execute/sync", {"script": script, "args": arguments})

    def log(self):
        """What the page told or failed at, since the last call."""
        return [entry["message"] for entry in self.call("POST", self.session + "/se/log", {"type": "browser"})]

    def click(self, x, y):
        """At a place of the window, in its pixels."""
        moves = [{"type": "pointerMove", "x": x, "y": y}, {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}]
        self.call("POST", self.session + "/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": moves}]})

    def press(self, key):
        strokes = [{"type": "keyDown", "value": key}, {"type": "keyUp", "value": key}]
        self.call("POST", self.session + "/actions", {"actions": [{"type": "key", "id": "keyboard", "actions": strokes}]})

    def screenshot(self):
        return base64.b64decode(self.call("GET", self.session + "/screenshot"))

    def close(self):
        try:
            self.call("DELETE", self.session)
        finally:
            self.end_driver()

    def end_driver(self):
        os.killpg(self.driver.pid, signal.SIGKILL)
        self.driver.wait()
