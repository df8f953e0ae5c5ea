"""Charts as SVG inside a page: logarithmic axes, a line and marks a method. Marks carry the number of their run (data-r), which
the page's script looks up to say its values."""
import html, math
from collections import namedtuple

from looks import MARKS, in_drawing_order, look_of

Size = namedtuple("Size", "width height left right top bottom")  # pixels; the last four are margins
LARGE = Size(700, 500, 74, 14, 14, 52)
SMALL = Size(300, 225, 56, 16, 26, 42)
STRIP = 30  # pixels, for runs that blew up
LEAST, MOST = 1e-17, 1e4  # of error axes: what is beyond stands on the edge

# x_of, y_of: of a row. title: above; of large charts none.
Plot = namedtuple("Plot", "title x_label y_label x_of y_of")


class LogAxis:
    """Decades around some values, between two pixels."""
    def __init__(self, values, start, end):
        values = [min(max(value, LEAST), 1e12) for value in values]
        self.low, self.high = math.floor(math.log10(min(values)) - 0.05), math.ceil(math.log10(max(values)) + 0.05)
        self.start, self.end = start, end

    def at(self, value):
        part = (math.log10(max(value, 1e-300)) - self.low) / (self.high - self.low)
        return self.start + min(max(part, 0), 1) * (self.end - self.start)

    def ticks(self, most):
        step = next(step for step in (1, 2, 3, 4, 5, 10, 20) if (self.high - self.low) / step <= most)
        return [exponent for exponent in range(self.low, self.high + 1) if exponent % step == 0]


def marks_once():
    """Definitions that all charts of a page use."""
    shapes = "".join(f'<path id="mark-{name}" d="{path}"/>' for name, path in MARKS.items())
    return f'<svg width="0" height="0" style="position:absolute"><defs>{shapes}</defs></svg>'


def axes(size, x, y, plot):
    right, bottom = size.width - size.right, size.height - size.bottom
    parts = []
    for exponent in x.ticks(9 if size is LARGE else 5):
        at = x.at(10.0 ** exponent)
        parts.append(f'<path class="grid" d="M{at:.1f},{size.top}V{bottom}"/><text class="tick" x="{at:.1f}" y="{bottom + 16}" '
                     f'text-anchor="middle">{power(exponent)}</text>')
    for exponent in y.ticks(10 if size is LARGE else 6):
        at = y.at(10.0 ** exponent)
        parts.append(f'<path class="grid" d="M{size.left},{at:.1f}H{right}"/><text class="tick" x="{size.left - 6}" y="{at + 4:.1f}" '
                     f'text-anchor="end">{power(exponent)}</text>')
    parts.append(f'<rect class="frame" x="{size.left}" y="{size.top}" width="{right - size.left}" height="{bottom - size.top}"/>')
    middle = (size.left + right) / 2
    parts.append(f'<text class="label" x="{middle}" y="{size.height - 8}" text-anchor="middle">{html.escape(plot.x_label)}</text>')
    if plot.title:
        parts.append(f'<text class="title" x="{size.left}" y="16">{html.escape(plot.title)}</text>')
    if plot.y_label:
        across = (size.top + bottom) / 2
        parts.append(f'<text class="label" transform="translate(16,{across}) rotate(-90)" text-anchor="middle">'
                     f'{html.escape(plot.y_label)}</text>')
    return "".join(parts)


def power(exponent):
    if -1 < exponent < 2:
        return str(10 ** exponent)
    return f'10<tspan dy="-5" font-size="75%">{str(exponent).replace("-", "−")}</tspan>'


def mark(look, x, y, run):
    fill = look.color if look.filled else "none"
    return (f'<use href="#mark-{look.mark}" transform="translate({x:.1f},{y:.1f}) scale({look.size})" fill="{fill}" '
            f'data-r="{run}"/>')


def curve(method, look, runs, x, y, plot):
    """runs: (number, row)."""
    places = [(x.at(plot.x_of(row)), y.at(plot.y_of(row)), number) for number, row in runs]
    line = " ".join(f"{px:.1f},{py:.1f}" for px, py, _ in places)
    dash = f' stroke-dasharray="{look.dash}"' if look.dash else ""
    return (f'<g class="curve" data-m="{method}" stroke="{look.color}"><polyline points="{line}" fill="none" '
            f'stroke-width="{look.width}"{dash}/>' + "".join(mark(look, *place) for place in places) + "</g>")


def uncertainty_band(size, y, floor):
    top, bottom = y.at(floor), size.height - size.bottom
    if top >= bottom - 1:
        return ""
    return (f'<rect class="band" x="{size.left}" y="{top:.1f}" width="{size.width - size.left - size.right}" '
            f'height="{bottom - top:.1f}"/><text class="note" x="{size.width - size.right - 6}" y="{bottom - 6}" '
            f'text-anchor="end">below what the reference knows</text>')


def blown_up(size, rows, x, plot):
    """Crosses in the strip at the top. What blew up has no cost, and stands where a run of that step would, from the cost of
    the method's coarsest run that went well."""
    parts, methods = [], in_drawing_order({(row.engine, row.method) for row in rows})
    for place, (engine, method) in enumerate(methods):
        runs = [(number, row) for number, row in enumerate(rows) if row.method == method]
        good = next((row for _, row in runs if row.status == "ok"), None)
        for number, row in runs:
            if row.status != "unstable" or good is None:
                continue
            at = x.at(plot.x_of(good) * good.setting / row.setting)
            height = size.top + 5 + (STRIP - 10) * (1 - (place + 0.5) / len(methods))
            parts.append(f'<g class="curve" data-m="{method}" stroke="{look_of(engine, method).color}" stroke-width="2">'
                         f'<use href="#mark-cross" transform="translate({at:.1f},{height:.1f})" data-r="{number}"/></g>')
    return "".join(parts)


def error_chart(rows, floor, plot):
    """The large chart of a scene: errors below a tenth of the floor stand on the edge (what made the reference has none at all)."""
    size = LARGE
    good = [(number, row) for number, row in enumerate(rows) if row.status == "ok" and math.isfinite(row.error)]
    if not good:
        return ""
    strip = STRIP if any(row.status == "unstable" for row in rows) else 0
    x = LogAxis([plot.x_of(row) for _, row in good], size.left, size.width - size.right)
    y = LogAxis([min(max(plot.y_of(row), floor / 10), MOST) for _, row in good] + [floor], size.height - size.bottom, size.top + strip)
    top = (f'<rect class="strip" x="{size.left}" y="{size.top}" width="{size.width - size.left - size.right}" height="{strip}"/>'
           f'<text class="note" x="{size.width - size.right - 6}" y="{size.top + 18}" text-anchor="end">blew up</text>') if strip else ""
    return (svg(size) + top + uncertainty_band(size, y, floor) + axes(size, x, y, plot) + curves(good, x, y, plot) +
            (blown_up(size, rows, x, plot) if strip else "") + "</svg>")


def side_chart(rows, plot):
    """A small chart; empty if the scene has nothing of it: all values are zero or unknown."""
    good = [(number, row) for number, row in enumerate(rows) if row.status == "ok" and math.isfinite(plot.y_of(row))]
    if not any(plot.y_of(row) > 0 for _, row in good):
        return ""
    x = LogAxis([plot.x_of(row) for _, row in good], SMALL.left, SMALL.width - SMALL.right)
    y = LogAxis([min(max(plot.y_of(row), LEAST), MOST) for _, row in good], SMALL.height - SMALL.bottom, SMALL.top)
    return svg(SMALL) + axes(SMALL, x, y, plot) + curves(good, x, y, plot) + "</svg>"


def svg(size):
    return f'<svg class="chart" width="{size.width}" height="{size.height}" viewBox="0 0 {size.width} {size.height}">'


def curves(good, x, y, plot):
    methods = in_drawing_order({(row.engine, row.method) for _, row in good})
    return "".join(curve(method, look_of(engine, method), [item for item in good if item[1].method == method], x, y, plot)
                   for engine, method in methods)


def sample(look):
    """A piece of a line, for legends."""
    dash = f' stroke-dasharray="{look.dash}"' if look.dash else ""
    return (f'<svg width="34" height="14"><g stroke="{look.color}"><path d="M1,7H33" stroke-width="{look.width}"{dash}/>'
            f'{mark(look, 17, 7, -1)}</g></svg>')
