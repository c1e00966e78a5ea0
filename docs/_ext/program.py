"""Texts from the program itself, read while the pages are built: keys, commands, terms.

A page holds <!-- modebank: keys -->, commands, terms, headers or archive where they belong; nothing of it is written down twice.
Roles: {confval}`window.length` leads to a key, {term}`evidence` to a term, {command}`run` to a command.
"""
import functools
import json
import os
import pathlib
import re
import subprocess
from xml.etree import ElementTree

import archive_layout

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("MODEBANK_BUILD", ROOT / "build"))

SECTIONS = {
    "data": "Which files, channels and times a run is made of, and which runs train. The only section that every configuration needs.",
    "window": "The local model that is fitted in every window, its loss, prior and solver: [](../explanation/windows.md).",
    "mixture": "How the windows' parameters are clustered: [](../explanation/mixture.md).",
    "bank": "How a bank of modes is learned from the clusters and refined: [](../explanation/refinement.md).",
    "filter": "How a bank is stepped and scored: [](../explanation/filter.md).",
    "archive": "Where results go, and an existing bank to judge.",
    "job": "Threads and seed.",
    "study": "Varied keys, and runs of a parameter study: [](../howto/studies.md).",
    "track": "The live filter: [](../howto/live_filter.md).",
    "report": "Pages: [](../howto/read_archive.md).",
    "simulate": "Runs with known truth by {eq}`eq-model`; `configs/systems` has the built-in systems.",
}


def ask(*words):
    return subprocess.run([str(BUILD / "modebank"), *words], check=True, capture_output=True, text=True).stdout


@functools.cache
def described():
    """Commands, keys and terms, in the program's order."""
    return json.loads(ask("help", "--json"))


def terms():
    return json.loads((ROOT / "app/report/web/terms.json").read_text(encoding="utf-8"))


def plain(text):
    """Text of the program, escaped so that Markdown shows it unchanged."""
    return re.sub(r"([\\*_<>\[\]#$`{}])", r"\\\1", text)


def keys_page():
    lines, section = [], None
    for key in described()["keys"]:
        if key["key"].split(".")[0] != section:
            section = key["key"].split(".")[0]
            lines += [f"## {section}", "", SECTIONS.get(section, ""), ""]
        facts = f"allowed: {plain(key['allowed'])}" + (f"; unit: {plain(key['unit'])}" if key["unit"] else "")
        facts += f"; default: `{key['default']}`" if key["default"] else "; default: empty"
        facts += "; **basic**" if key["basic"] else ""
        facts += f"; changes the stage {key['stage']} and those that follow" if key["stage"] else ""
        text = plain(key["help"][:1].upper() + key["help"][1:])
        lines += [f"````{{confval}} {key['key']}", text + ".", "", f"*{facts}*", "", f"When to change it: {plain(key['when'])}.", "````", ""]
    return "\n".join(lines)


def commands_page():
    lines, heading = [], None
    for command in described()["commands"]:
        if command["group"] != heading:
            heading = command["group"]
            lines += [f"## {heading}", ""]
        name = command["name"]
        lines += [f"````{{command}} {name}", "```text", ask("help", name).rstrip(), "```", "````", ""]
    return "\n".join(lines)


def terms_page():
    """Other names become terms if they are words; names of table columns follow the meaning."""
    lines = ["```{glossary}", ":sorted:", ""]
    for entry in terms():
        words, columns = [entry["term"]], []
        for name in entry["also"]:
            if name.lower() not in [known.lower() for known in words]:
                (words if re.fullmatch(r"[A-Za-z +-]{2,}", name) and not name.startswith("in ") else columns).append(name)
        also = f" Columns: {', '.join(f'`{name}`' for name in columns)}." if columns else ""
        avoided = f" *Not used for it: {', '.join(entry['not'])}.*" if entry["not"] else ""
        lines += [*words, f"  {entry['means']}{also}{avoided}", ""]
    return "\n".join([*lines, "```", ""])


def headers():
    return sorted(path for include in ROOT.glob("*/include") for path in include.rglob("*.hpp"))


def declared(header):
    """(directive, name) of a header's declarations, from Doxygen's XML."""
    for file in sorted((BUILD / "api/xml").glob("*_8hpp.xml")):
        compound = ElementTree.parse(file).getroot().find("compounddef")
        if not compound.find("location").get("file").endswith(str(header)):
            continue
        for inner in compound.findall("innerclass"):
            if "<" not in inner.text and inner.get("prot") == "public" and not is_nested(inner.get("refid")):
                yield "doxygenclass" if inner.get("refid").startswith("class") else "doxygenstruct", inner.text
    for space in sorted((BUILD / "api/xml").glob("namespacemodebank*.xml")):
        for member in ElementTree.parse(space).getroot().iterfind(".//memberdef"):
            if not member.find("location").get("file").endswith(str(header)):
                continue
            name = member.findtext("qualifiedname")
            if member.get("kind") in ("enum", "typedef"):
                yield f"doxygen{member.get('kind')}", name
            elif member.get("kind") == "function":
                types = ", ".join("".join(parameter.find("type").itertext()) for parameter in member.findall("param"))
                yield "doxygenfunction", f"{name}({types})"


def is_nested(refid):
    """Whether a class is inside another one, whose description contains it."""
    outer = refid.rpartition("_1_1")[0]
    return any((BUILD / "api/xml" / f"{kind}{outer.removeprefix('class').removeprefix('struct')}.xml").is_file() for kind in ("class", "struct"))


def headers_page():
    lines = []
    for path in headers():
        name = path.relative_to(next(parent for parent in path.parents if parent.name == "include"))
        lines += [f"## {name}", "", f"`{path.relative_to(ROOT)}`", ""]
        for directive, thing in declared(path.relative_to(ROOT)):
            members = [":members:"] if directive in ("doxygenclass", "doxygenstruct") else []
            lines += [f"```{{{directive}}} {thing}", *members, "```", ""]
    return "\n".join(lines)


PAGES = {"archive": archive_layout.page, "headers": headers_page, "keys": keys_page, "commands": commands_page, "terms": terms_page}


def as_it_stands(app, what, name, thing, options, lines):
    """Escapes docstrings, which are plain text, for reStructuredText."""
    lines[:] = [re.sub(r"([*`|\\])", r"\\\1", line) for line in lines]


def fill_in(app, name, source):
    for what, page in PAGES.items():
        mark = f"<!-- modebank: {what} -->"
        if mark in source[0]:
            source[0] = source[0].replace(mark, page())


def name_of(env, signature, node):
    """A command is found by its first word."""
    from sphinx import addnodes
    node += addnodes.desc_name(signature, signature)
    return signature.split(" ")[0]


def setup(app):
    app.add_object_type("confval", "confval", objname="key", indextemplate="pair: %s; key")
    app.add_object_type("command", "command", objname="command", indextemplate="pair: %s; command", parse_node=name_of)
    app.connect("source-read", fill_in)
    app.connect("autodoc-process-docstring", as_it_stands)
    return {"parallel_read_safe": True}
