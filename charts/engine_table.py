"""The table of engines in docs/engines.md: what the same error costs, scene by scene, and where Cradle loses."""
import os

from frontier import WORST_ERROR
from scenes import SCENES
from study_file import floor_of, points_of
from verdict import ENGINES, OURS, number, rivals_of, span, verdict

ACCURACY = 1e-6  # asked; the default of scenes
BEGIN, END = "<!-- engines, by ./run charts -->\n", "<!-- /engines -->\n"  # around the table in the page


class MarkError(Exception):
    """The page does not say where its table is."""


def our_cell(rows, floor):
    """Error and cost (CPU ms a simulated second) of what cradle chooses."""
    runs = points_of([row for row in rows if row.method == OURS and row.setting == ACCURACY], floor)
    return f"{number(runs[0][1])}; {number(1e3 * runs[0][0])}" if runs else "fails"


def cell(rival):
    """Factors of cost, and the least error; bold where Cradle loses."""
    if not rival.edge:
        return "fails"
    least = number(rival.edge[-1][1])
    if not rival.costs:
        return f"not below {least}"
    return f"**{span(rival.costs)}**; {least}" if rival.lost else f"{span(rival.costs)}; {least}"


def line(*cells):
    return f"| {' | '.join(cells)} |\n"


def table(studies, references):
    """Markdown, with a sentence for each loss below."""
    engines = [engine for engine in ENGINES if engine != "cradle"]
    text = line("", "Cradle: error; ms", *(ENGINES[engine] for engine in engines)) + "|---" * (2 + len(engines)) + "|\n"
    losses = []
    for name, rows in studies.items():
        floor = floor_of(references[name])
        rivals = {rival.engine: rival for rival in rivals_of(rows, floor)}
        theirs = (cell(rivals[engine]) if engine in rivals else "-" for engine in engines)
        text += line(SCENES[name].title, our_cell(rows, floor), *theirs)
        losses += [f"- {SCENES[name].title}: {lost}\n" for lost in verdict(rows, floor)[1]]
    nowhere = f"In none of these scenes does an engine cost less than Cradle at an error of {number(WORST_ERROR)} or less.\n"
    return text + "\n" + ("Where Cradle loses:\n\n" + "".join(losses) if losses else nowhere)


def with_table(page, text):
    """The page with this table in place of its own. Throws MarkError."""
    before, begin, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise MarkError(f"docs/engines.md has no lines {BEGIN.strip()} and {END.strip()}")
    return before + BEGIN + text + END + after


def update(path, studies, references):
    with open(path) as file:
        text = with_table(file.read(), table(studies, references))
    with open(path + ".part", "w") as file:
        file.write(text)
    os.rename(path + ".part", path)
