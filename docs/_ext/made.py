"""The directive in front of a table of results."""
from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective


class Made(SphinxDirective):
    """How a table was made; check_results.py describes its content."""

    required_arguments = 1
    final_argument_whitespace = True
    has_content = False
    option_spec = dict.fromkeys(("revision", "date", "machine", "reads", "data", "hash", "data_hash", "older"), directives.unchanged)

    def run(self):
        given = self.options
        text = f"Made by ``{self.arguments[0]}``; revision {given['revision']}, {given['date']}, {given['machine']}"
        text += f"; hash {given.get('hash', 'none')}" + (f", data {given['data_hash']}" if "data_hash" in given else "") + "."
        line = nodes.paragraph("", "", classes=["made"])
        for part, piece in enumerate(text.split("``")):
            line += nodes.literal(piece, piece) if part % 2 else nodes.Text(piece)
        if "older" in given:
            note = f" Not of this version: {given['older']}."
            line += nodes.emphasis(note, note)
        return [line]


def setup(app):
    app.add_directive("made", Made)
    return {"parallel_read_safe": True}
