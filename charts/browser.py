"""Opens a page in headless Chromium: no error in the console, values on hovering over every chart; and takes its picture."""
import os, re, subprocess, tempfile

WIDTH = 1280
LONGEST = 120  # s
# Points at the first mark of each chart, as a mouse would, and writes down what the page says.
PROBE = """<script>
addEventListener("load", () => {
  const said = [...document.querySelectorAll("svg.chart")].map(svg => {
    const mark = svg.querySelector("use[data-r]"), place = mark.transform.baseVal.getItem(0).matrix, box = svg.getBoundingClientRect();
    svg.dispatchEvent(new PointerEvent("pointermove", {clientX: box.left + place.e, clientY: box.top + place.f}));
    const tip = document.getElementById("tip");
    const text = tip.style.display === "block" ? tip.textContent : "";
    svg.dispatchEvent(new PointerEvent("pointerleave"));
    return text;
  });
  const silent = said.filter(text => !/: .*\\d/.test(text)).length;
  document.documentElement.dataset.probed = said.length + " " + silent + " " + document.documentElement.scrollHeight;
});
</script>"""


class PageError(Exception):
    """The page does not work in a browser."""


def chromium(page, *arguments):
    with tempfile.TemporaryDirectory() as profile:
        command = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--enable-logging=stderr",
                   f"--user-data-dir={profile}", *arguments, "file://" + os.path.abspath(page)]
        result = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST)
    said = [line for line in result.stderr.splitlines() if re.search(r"\bCONSOLE\b", line)]
    if said:
        raise PageError("the console of the browser is not empty:\n" + "\n".join(said))
    if result.returncode != 0:
        raise PageError(f"chromium ended with {result.returncode}:\n{result.stderr[-2000:]}")
    return result.stdout


def check(page):
    """The height of the page in pixels. Throws PageError."""
    with tempfile.TemporaryDirectory() as folder, open(page) as file:
        probed = os.path.join(folder, "probed.html")
        with open(probed, "w") as copy:
            copy.write(file.read().replace("</body>", PROBE + "</body>"))
        found = re.search(r'data-probed="(\d+) (\d+) (\d+)"', chromium(probed, f"--window-size={WIDTH},1000", "--dump-dom"))
    if not found:
        raise PageError("the page's script did not run to its end")
    charts, silent, height = (int(number) for number in found.groups())
    if charts == 0 or silent > 0:
        raise PageError(f"{silent} of {charts} charts say no values under the pointer")
    return height


def take_picture(page, height, path):
    """Throws PageError."""
    chromium(page, f"--window-size={WIDTH},{height}", f"--screenshot={os.path.abspath(path)}")
    if not os.path.exists(path):
        raise PageError("chromium took no picture")
