"""Pieces of HTML."""
import html


def table(heads, lines):
    def cells(tag, line):
        return "".join(f"<{tag}{attributes(cell)}>{cell.html if isinstance(cell, Link) else html.escape(cell, False)}</{tag}>" for cell in line)
    return (f'<table><tr>{cells("th", heads)}</tr>' + "".join(f'<tr>{cells("td", line)}</tr>' for line in lines) + "</table>")


class Link:
    """A cell that leads to a section."""
    def __init__(self, section, text):
        self.html = f'<a href="#{section}">{html.escape(text, False)}</a>'


class Behind(str):
    """A cell that is marked: there somebody does better than we do."""


def attributes(cell):
    return ' class="behind"' if isinstance(cell, Behind) else ""


def boxed(kind, sentences):
    return f'<div class="{kind}">' + "".join(f"<p>{html.escape(text, False)}</p>" for text in sentences) + "</div>" if sentences else ""
