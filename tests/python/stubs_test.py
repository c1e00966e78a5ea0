"""Stubs name exactly the module's content, and every public object has a docstring."""
import ast
import inspect
import pathlib
import unittest

import modebank
from modebank import _modebank

STUBS = ast.parse(pathlib.Path(modebank.__file__).with_name("_modebank.pyi").read_text(encoding="utf-8"))


def names_of(body):
    names = {node.name for node in body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    return names | {node.target.id for node in body if isinstance(node, ast.AnnAssign)}


def public(names):
    return {name for name in names if not name.startswith("_")}


class Stubs(unittest.TestCase):
    def test_the_module_has_these_names(self):
        self.assertEqual(public(names_of(STUBS.body)), public(vars(_modebank)))

    def test_classes_have_these_members(self):
        for stub in (node for node in STUBS.body if isinstance(node, ast.ClassDef)):
            members = vars(getattr(_modebank, stub.name))
            self.assertEqual(public(names_of(stub.body)), public(members), stub.name)
            for member in stub.body:
                if isinstance(member, ast.FunctionDef) and member.decorator_list:
                    decorator = member.decorator_list[0].id
                    self.assertEqual(isinstance(members[member.name], property), decorator == "property", member.name)

    def test_arguments_have_these_names(self):
        classes = {node.name: node for node in STUBS.body if isinstance(node, ast.ClassDef)}
        functions = [(getattr(_modebank, node.name), node) for node in STUBS.body if isinstance(node, ast.FunctionDef)]
        functions += [(getattr(getattr(_modebank, name), member.name), member) for name, node in classes.items()
                      for member in node.body if isinstance(member, ast.FunctionDef) and not member.decorator_list
                      and member.name != "__len__"]
        for function, stub in functions:
            said = function.__doc__.splitlines()[0]
            for argument in stub.args.args + stub.args.kwonlyargs:
                self.assertIn(argument.arg + ":", said.replace("self: ", "self: "), f"{stub.name}: {said}")

    def test_everything_is_documented(self):
        for name in modebank.__all__:
            item = getattr(modebank, name)
            if inspect.isclass(item) and issubclass(item, Exception):
                continue
            self.assertTrue(item.__doc__, name)
            if inspect.isclass(item):
                for member, value in vars(item).items():
                    if isinstance(value, property) and member not in ("state_names", "input_names"):
                        self.assertTrue(value.__doc__, f"{name}.{member}")

    def test_what_is_exported_is_there(self):
        self.assertEqual(sorted(modebank.__all__), sorted(set(modebank.__all__)))
        self.assertTrue(pathlib.Path(modebank.__file__).with_name("py.typed").exists())
        for function in (modebank.run, modebank.identify, modebank.simulate, modebank.fit_mixture, modebank.read):
            self.assertTrue(inspect.signature(function).return_annotation, function.__name__)


if __name__ == "__main__":
    unittest.main()
