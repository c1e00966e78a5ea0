"""The directive in front of a table of results: the command that made it, its revision, date and machine."""
from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective

FIELDS = ("revision", "date", "machine")


class Made(SphinxDirective):
    required_arguments = 1
    final_argument_whitespace = True
    has_content = False
    option_spec = dict.fromkeys(FIELDS, directives.unchanged_required)

    def run(self):
        if missing := [name for name in FIELDS if name not in self.options]:
            raise self.error(f"a table without {', '.join(missing)}")
        revision, date, machine = (self.options[name] for name in FIELDS)
        line = nodes.paragraph("", "", classes=["made"])
        line += [nodes.Text("Made by "), nodes.literal("", self.arguments[0])]
        line += nodes.Text(f"; revision {revision}, {date}, {machine}.")
        return [line]


def setup(app):
    app.add_directive("made", Made)
    return {"parallel_read_safe": True}
