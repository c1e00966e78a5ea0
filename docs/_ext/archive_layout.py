"""The archive's layout as a page: members and shapes from the functions in io/archive/layout*.hpp, texts from their comments.

Above an exchange function a comment `/// - NAME: text` describes a member or a column, `/// /PATH: text` its group; other lines are
for programmers alone.
"""
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
HEADERS = ["layout_data.hpp", "bank/layout_bank.hpp", "bank/layout_drifting.hpp", "layout_evaluation.hpp", "layout.hpp"]
ATTRIBUTES = {"attribute", "attribute_unless", "constant_attribute", "attribute_texts", "optional_attribute_texts"}
ARRAYS = {"field", "optional_field", "derived_field", "optional_derived_field", "through_rows", "text", "texts"}
TABLES = {"table", "optional_table", "table_rows"}
COLUMN = re.compile(r"(?:\w+_)?column\(")
CALL = re.compile(r"(?:\b\w+\.)?\b(\w+)\(")
LAMBDA = re.compile(r"const auto (\w+) = \[[^\]]*\]\(([^)]*)\) \{")


def closing(text, start):
    """Position after the bracket that closes the one at `start`; strings are skipped."""
    pairs, depth, place = {"(": ")", "[": "]", "{": "}"}, [], start
    while place < len(text):
        if text[place] == '"':
            place = text.index('"', place + 1)
        elif text[place] in pairs:
            depth.append(pairs[text[place]])
        elif depth and text[place] == depth[-1]:
            depth.pop()
            if not depth:
                return place + 1
        place += 1
    raise ValueError(f"no bracket closes {text[start:start + 60]!r}")


def split(arguments):
    """Splits at the commas outside of brackets and strings."""
    parts, begin, place = [], 0, 0
    while place < len(arguments):
        if arguments[place] in "([{":
            place = closing(arguments, place)
            continue
        if arguments[place] == '"':
            place = arguments.index('"', place + 1)
        elif arguments[place] == ",":
            parts.append(arguments[begin:place].strip())
            begin = place + 1
        place += 1
    return [*parts, arguments[begin:].strip()]


class Function:
    def __init__(self, comment, parameters, body):
        self.parameters = [re.split(r"[ &]+", parameter)[-1] for parameter in split(parameters)]
        self.body = body
        self.texts, self.groups, last = {}, {}, None
        for line in comment.splitlines():
            line = line.removeprefix("///").removeprefix(" ")
            if described := re.match(r"(- )?(/?[\w/]*): (.*)", line) if line.startswith(("- ", "/")) else None:
                last = (self.texts if described[1] else self.groups, described[2])
                last[0][last[1]] = described[3]
            elif last and line.startswith("  "):
                last[0][last[1]] += " " + line.strip()
            else:
                last = None


class Layout:
    """Members by path: (name, letters, kind, optional, text, columns), in the order they are exchanged in."""

    def __init__(self):
        self.functions, self.groups, self.members, self.used = {}, {}, {}, set()
        for header in HEADERS:
            text = (ROOT / "io/archive" / header).read_text(encoding="utf-8")
            for found in re.finditer(r"((?:^///.*\n)*)^template <[^>]*>\nvoid (exchange_\w+)\(([^)]*)\) (?=\{)", text, flags=re.M):
                body = re.sub(r"//.*", "", text[found.end():closing(text, found.end())])
                function = Function(found[1], found[3], body)
                self.functions[found[2], len(function.parameters)] = function
                self.groups |= function.groups
        self.walk(self.functions["exchange_archive", 2], self.functions["exchange_archive", 2].body, "", {}, {})

    def value(self, expression, names):
        """A text from literals and parameters joined by +; another expression becomes its last word in capitals."""
        parts = [part.strip() for part in expression.split("+")]
        if all(part.startswith('"') or part in names for part in parts):
            return "".join(part.strip('"') if part.startswith('"') else names[part] for part in parts)
        return re.split(r"\W", expression)[-1].upper()

    def add(self, path, name, *what):
        members = self.members.setdefault(path or "/", {})
        members.setdefault(name, what)

    def text(self, function, name):
        self.used.add((id(function), name))
        return function.texts.get(name, "")

    def walk(self, function, body, path, names, local):
        local = dict(local)
        while found := LAMBDA.search(body):
            end = closing(body, found.end() - 1)
            local[found[1]] = ([re.split(r"[ &]+", p)[-1] for p in split(found[2])], body[found.end() - 1:end])
            body = body[:found.start()] + body[end:]
        place = 0
        while found := CALL.search(body, place):
            end, name = closing(body, found.end() - 1), found[1]
            arguments = split(body[found.end():end - 1])
            place = end
            if name in ATTRIBUTES:
                key = self.value(arguments[1 if name == "attribute_unless" else 0], names)
                self.add(path, key, "", "attribute", name.startswith("optional") or name == "attribute_unless", self.text(function, key), [])
            elif name in ARRAYS:
                key = self.value(arguments[0], names)
                letters = re.findall(r'"(\w+)"', arguments[2]) if name != "text" else []
                kind = "text" if name in ("text", "texts") else "array"
                self.add(path, key, ",".join(letters), kind, name.startswith("optional"), self.text(function, key), [])
            elif name in TABLES:
                key = self.value(arguments[0], names)
                self.add(path, key, "", "table", name.startswith("optional"), self.text(function, key), self.columns(function, arguments, names))
            elif name in ("group", "optional_group", "exchange_part"):
                key = self.value(arguments[1 if name == "exchange_part" else 0], names)
                inner = local[arguments[-1]][1] if arguments[-1] in local else arguments[-1]
                self.members.setdefault(f"{path}/{key}", {})
                self.walk(function, inner, f"{path}/{key}", names, local)
            elif name in local:
                self.walk(function, local[name][1], path, self.bound(local[name][0], arguments, names), local)
            elif (name, len(arguments)) in self.functions:
                called = self.functions[name, len(arguments)]
                self.walk(called, called.body, path, self.bound(called.parameters, arguments, names), {})
            else:
                place = found.end()

    def bound(self, parameters, arguments, names):
        return {parameter: self.value(argument, names) for parameter, argument in zip(parameters, arguments) if argument.startswith('"')}

    def columns(self, function, arguments, names):
        columns = []
        for argument in arguments:
            if found := COLUMN.match(argument):
                parts = split(argument[found.end():closing(argument, found.end() - 1) - 1])
                name = self.value(parts[0], names)
                unit = parts[2].strip('"') if len(parts) > 2 and parts[2].startswith('"') else ""
                columns.append((name, unit, self.text(function, name)))
        return columns

    def unused(self):
        """Texts of members that do not exist."""
        return sorted(name for function in self.functions.values() for name in function.texts if (id(function), name) not in self.used)


def line_of(name, letters, kind, optional, text, columns):
    label = f"{name} ({letters})" if letters else name
    if kind == "table":
        listed = [f"`{column}`" + (f" [{unit}]" if unit else "") + (f": {said}" if said else "") for column, unit, said in columns]
        text = f"{text}. " if text else ""
        text += "Columns: " + "; ".join(listed)
    label, text = f"[{label}]" if optional else label, text.replace("|", r"\|")
    return f"| `{label}` | {kind} | {text} |"


def page():
    layout, lines, seen = Layout(), [], {}
    for path, members in layout.members.items():
        rows = [line_of(name, what[0], what[1], what[2], what[3], what[4]) for name, what in members.items()]
        intro = layout.groups.get(path, "")
        same = next((other for other, kept in seen.items() if len(rows) > 10 and set(rows) <= set(kept)), None)
        if rows or intro:
            lines += [f"## {path}", ""] + ([intro[:1].upper() + intro[1:], ""] if intro else [])
        if same:
            lines += [f"It has the layout of `{same}`.", ""]
        elif rows:
            lines += ["| name | is | holds |", "|---|---|---|", *rows, ""]
            seen[path] = rows
    return "\n".join(lines)


if __name__ == "__main__":
    print(page())
