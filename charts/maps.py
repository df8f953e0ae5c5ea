"""Maps of stability, by `cradle stability`: NAME.csv begins with lines "# title", "# subtitle" and "# paragraph", NAME.svg is the
chart."""
import base64, html, os, subprocess, sys


def measure(program, folder):
    """Maps that are newer than the program stay."""
    place, done = os.path.join(folder, "maps"), os.path.join(folder, "maps_done")
    if os.path.exists(done) and os.path.getmtime(done) > os.path.getmtime(program):
        print(f"{place} is newer than the program: not mapped again", file=sys.stderr)
        return
    subprocess.run([program, "stability", "-o", place], check=True, stdout=subprocess.DEVNULL)
    with open(done, "w"):
        pass


def read(folder):
    """(title, paragraph, svg) of each map, as cradle lists them: by the time they were made."""
    place = os.path.join(folder, "maps")
    names = [name for name in os.listdir(place) if name.endswith(".csv")]
    found = []
    for name in sorted(names, key=lambda name: (os.path.getmtime(os.path.join(place, name)), name)):
        with open(os.path.join(place, name)) as file:
            title, _, paragraph = (file.readline()[2:].strip() for _ in range(3))
        with open(os.path.join(place, name[:-4] + ".svg"), "rb") as file:
            found.append((title, paragraph, file.read()))
    return found


def section(found):
    """HTML."""
    parts = ['<h2 id="maps">Where methods fail<small>cradle stability</small></h2><p>Each map is what small scenes do in the program '
             "itself, over two quantities; the borders that theory has are drawn over it.</p>"]
    for title, paragraph, svg in found:
        data = base64.b64encode(svg).decode()
        parts.append(f'<h3>{html.escape(title)}</h3><p>{html.escape(paragraph)}</p>'
                     f'<img class="map" alt="{html.escape(title)}" src="data:image/svg+xml;base64,{data}">')
    return "\n".join(parts)
