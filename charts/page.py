"""The page: one file, with nothing outside of it."""
import html, json, math, os

from frontier import WORST_ERROR
from looks import in_reading_order, look_of
from markup import Behind, Link, boxed, table
from scenes import SCENES
from study_file import floor_of, order_of
from svg_chart import Plot, error_chart, marks_once, sample, side_chart
from verdict import ENGINES, OURS, figures, number, rivals_of, span, verdict

FOLDER = os.path.dirname(os.path.abspath(__file__))
COST_LABEL = "CPU time a simulated second, s"
MAIN = Plot("", COST_LABEL, "error at the end: max |x − x_ref| / (1 + |x_ref|)", lambda row: max(row.cost, 1e-9), lambda row: row.error)
SIDES = [Plot("Error against evaluations", "evaluations, whole run", "", lambda row: row.evaluations, lambda row: row.error),
         Plot("Energy drift, of kinetic energy", COST_LABEL, "", MAIN.x_of, lambda row: row.energy),
         Plot("Constraint drift, m", COST_LABEL, "", MAIN.x_of, lambda row: row.constraint),
         Plot("Deepest penetration, m", COST_LABEL, "", MAIN.x_of, lambda row: row.penetration)]


def text_of(name):
    with open(os.path.join(FOLDER, name)) as file:
        return file.read()


def legend(rows):
    methods, groups = {(row.engine, row.method) for row in rows}, {}
    for engine, method in in_reading_order(methods):
        look = look_of(engine, method)
        groups.setdefault(engine, []).append(f'<span data-m="{method}">{sample(look)}{html.escape(look.title, False)}</span>')
    columns = (f"<div><b>{ENGINES[engine]}</b>{''.join(names)}</div>" for engine, names in groups.items())
    return f'<div class="legend">{"".join(columns)}</div>'


def data_of(rows, floor):
    """For the page's script: what a method is called, what its setting is, and the rows."""
    def value(x):
        return x if math.isfinite(x) else None
    methods = {}
    for engine, method in in_reading_order({(row.engine, row.method) for row in rows}):
        look, own = look_of(engine, method), [row for row in rows if row.method == method]
        title = f"{ENGINES[engine]}: {look.title}"
        steps = method not in ("plan", "dop853", "simbody", "simbodyFehlberg")
        order = order_of(own, floor) if steps else None
        methods[method] = [title + (f" (order {order:.1f})" if order else ""), "time step, s" if steps else "accuracy"]
    lines = [[row.method, *(value(x) for x in row[3:10]), row.status] for row in rows]
    return json.dumps({"methods": methods, "rows": lines}, separators=(",", ":")).replace("</", "<\\/")


def section(name, rows, reference):
    scene, floor = SCENES[name], floor_of(reference)
    won, lost, others = verdict(rows, floor)
    evaluations = SIDES[0]._replace(y_of=lambda row: max(row.error, floor / 10))
    sides = [side_chart(rows, plot) for plot in [evaluations, *SIDES[1:]]]
    heads = ["", "least error", "its cost, ms/s", "Cradle’s for it, ms/s", "cost ×", "error ×"]
    return (f'<section class="scene" id="{name}"><h2>{scene.title}<small>{scene.label} · {name}.json</small></h2><p>{scene.text}</p>'
            f'<div class="beside"><div>{error_chart(rows, floor, MAIN)}</div><div>{boxed("won", won)}{boxed("lost", lost)}'
            f'{table(heads, figures(rows, floor))}{"".join(f"<p class=small>{html.escape(text, False)}</p>" for text in others)}'
            f'<p class="small">Reference: {html.escape(reference.made_by)}; {html.escape(reference.confirmation)}.</p></div></div>'
            f'{legend(rows)}<div class="sides">{"".join(sides)}</div><details><summary>All runs</summary><table></table></details>'
            f'<script type="application/json">{data_of(rows, floor)}</script></section>')


def overview(studies, references):
    """By what factors each engine costs more than we do, scene by scene."""
    engines, lines = [engine for engine in ENGINES if engine != "cradle"], []
    for name, rows in studies.items():
        cells = {}
        for rival in rivals_of(rows, floor_of(references[name])):
            behind = bool(rival.lost) or not any(row.method == OURS and row.status == "ok" for row in rows)
            cells[rival.engine] = (Behind if behind else str)(span(rival.costs) if rival.costs else f"above {number(WORST_ERROR)}")
        lines.append([Link(name, f"{SCENES[name].label} {SCENES[name].title}")] + [cells.get(engine, "not its scene") for engine in engines])
    return table(["CPU time for the same error, in parts of Cradle’s"] + [ENGINES[engine] for engine in engines], lines)


def all_losses(studies, references):
    found = [(SCENES[name].title, text) for name, rows in studies.items() for text in verdict(rows, floor_of(references[name]))[1]]
    if not found:
        return boxed("won", [f"In none of these scenes is an engine cheaper than Cradle at an error of {number(WORST_ERROR)} or less."])
    return boxed("lost", ["Where Cradle loses:"] + [f"{title}: {text}" for title, text in found])


def page(studies, references, piles, maps, machine):
    """studies: rows by scene. piles, maps: HTML that follows the scenes; machine: (what, which) pairs."""
    parts = ['<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>Cradle: speed against accuracy</title>',
             f'<style>{text_of("page.css")}</style></head><body>{marks_once()}<div id="tip"></div>',
             "<h1>Speed against accuracy</h1>", text_of("introduction.html"), overview(studies, references),
             all_losses(studies, references)]
    parts += [section(name, studies[name], references[name]) for name in SCENES if name in studies]
    parts += [piles, maps, '<h2 id="machine">Measured on</h2>', table(["", ""], machine),
              f'<script>{text_of("page.js")}</script></body></html>']
    return "\n".join(parts)
