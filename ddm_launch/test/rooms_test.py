#!/usr/bin/python3
# Imports between the rooms: study and qa use the product, never the other way round or each other; none is circular.
# SPDX-License-Identifier: BSD-3-Clause
import ast
import os
import sys
import unittest

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import rooms  # noqa: E402

MAY_USE = {"ddm_launch": {"ddm_launch"}, "ddm_study": {"ddm_study", "ddm_launch"}, "ddm_qa": {"ddm_qa", "ddm_launch"}}


def modules():
    """{name of a module: its path} of all rooms."""
    found = {}
    for room, folder in rooms.ROOMS.items():
        for parent, _, names in os.walk(os.path.join(folder, room)):
            for name in names:
                path = os.path.join(parent, name)
                if name.endswith(".py"):
                    found[os.path.relpath(path, folder)[:-len(".py")].replace("/", ".")] = path
    return {name.replace(".__init__", ""): path for name, path in found.items()}


def imports(path, known):
    """The known modules that a file imports, wherever in it."""
    with open(path) as stream:
        nodes = list(ast.walk(ast.parse(stream.read(), path)))
    names = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    for node in nodes:
        if isinstance(node, ast.ImportFrom):
            names.update("%s.%s" % (node.module, alias.name) for alias in node.names)
    return {module for name in names for module in (name, name.rpartition(".")[0]) if module in known and
            not (module in rooms.ROOMS and name in known)}


def cycle(graph):
    """Names of modules that import each other in a circle; empty if there are none."""
    graph = {name: set(uses) for name, uses in graph.items()}
    while graph:
        leaves = {name for name, uses in graph.items() if not uses & set(graph)}
        if not leaves:
            return sorted(graph)
        graph = {name: uses for name, uses in graph.items() if name not in leaves}
    return []


class RoomsTest(unittest.TestCase):
    def setUp(self):
        self.modules = modules()
        self.graph = {name: imports(path, self.modules) for name, path in self.modules.items()}

    def test_each_room_uses_only_itself_and_the_product(self):
        self.assertIn("ddm_launch.tables", self.graph["ddm_study.paper_tables"])
        self.assertIn("ddm_qa.faults.cases", self.graph["ddm_qa.fault_table"])
        wrong = [(name, used) for name, uses in self.graph.items() for used in uses
                 if used.split(".")[0] not in MAY_USE[name.split(".")[0]]]
        self.assertEqual(wrong, [])

    def test_no_import_is_circular(self):
        self.assertEqual(cycle(self.graph), [])
        self.assertEqual(cycle({"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": set()}), ["a", "b", "c"])

    def test_every_program_of_a_room_has_a_module(self):
        for room in ("study", "qa"):
            for name in os.listdir(os.path.join(rooms.PACKAGE, room, "scripts")):
                self.assertIn("ddm_%s.%s" % (room, name), self.modules)


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "rooms_test", RoomsTest)
