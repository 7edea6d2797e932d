#!/usr/bin/python3
# What tables of the pages say of nodes, messages and parameters is what these are.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import sys
import time
import unittest

import ddm_msgs.msg
import ddm_msgs.srv
import rosgraph
import rosunit
import yaml

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import pages  # noqa: E402

LIMIT_S = 60.0  # until all nodes have made their topics
TOPICS = "doc/reference/topics.md"
MANUAL = "doc/reference/parameters.md"
NODES = [("sim_node", ""), ("mpc_node", ""), ("view_node", ""), ("model_node", ""), ("trial_recorder", ""),
         ("robot_node", "/robot")]
ACTION_TOPICS = ("goal", "cancel", "status", "feedback", "result")
# Blocks of parameters in a table, and the manuals whose values are the structs' (tests of each package say so).
PARAMETERS = [("Robot", ["robot"], ["ddm_sim/config/robot.yaml"]),
              ("Plant and camera", ["plant", "camera", "sim", "show"],
               ["ddm_sim/config/moving_tile.yaml", "ddm_sim/config/pendulum.yaml", "ddm_sim/config/sim.yaml"]),
              ("Changed during a run", [], ["ddm_mpc/config/mpc.yaml"])]


def documented(node):
    """Names of topics, services and actions in the tables and the sentences of a node's section."""
    text = pages.section(pages.read(TOPICS), node)
    names, kind = set(), ""
    for table in pages.tables(text):
        if "default" in table[0] or "colour" in table[0] or "status" in table[0] or "state" in table[0]:
            continue
        for row in table[1:]:
            if row[-1].startswith(("real time only", "several motors", "only where joints have limits",
                                   "plants of a model file")):
                continue  # the nodes here are in lock-step and have one motor without limits, a drawn plant
            kind = row[0] or kind
            cell = row[0] if row[0].startswith("`") else row[1] if kind != "parameters" else ""
            names.update(pages.code_spans(cell))
    for sentence in re.findall(r"^(`[^|\n]*), as above\.$", text, re.MULTILINE):
        names.update(pages.code_spans(sentence))
    return names


def offered(node, namespace):
    """The same, as the master knows it; what libraries add to an image or an action is theirs."""
    full = "%s/%s" % (namespace, node)
    publishers, subscribers, services = rosgraph.Master("/page_facts").getSystemState()
    subscribers = [entry for entry in subscribers if entry[0] != "/clock"]  # all nodes hear it in simulated time
    names = {name for kind in (publishers, subscribers, services) for name, nodes in kind if full in nodes}
    names = {re.sub("^" + re.escape(full) + "/", "~", name) for name in names}
    names = {re.sub("^" + re.escape(namespace) + "/", "", name) if namespace else name for name in names}
    names = {name if name in ("/clock", "/diagnostics") else name.lstrip("/") for name in names}
    names -= {"rosout", "~get_loggers", "~set_logger_level"}
    for action in {name[:-len("/goal")] for name in names if name.endswith("/goal")}:
        names -= {"%s/%s" % (action, topic) for topic in ACTION_TOPICS}
        names.add(action)
    return {name for name in names if not re.match("(camera/image_raw|camera_view/image_raw|goal_image)/", name)}


def parameter_rows(heading):
    """(block, key, the rest of the row) of each parameter in the table of a section."""
    for table in pages.tables(pages.section(pages.read(MANUAL), heading)):
        if "default" in table[0]:
            for row in table[1:]:
                for block, key in re.findall(r"`~?(\w+)/(\w+)`", row[0]):
                    yield block, key, dict(zip(table[0], row))


def manual(files):
    """({block: {key: value}}, {block/key: comment}) of YAML files, later ones first to be asked for comments."""
    values, comments = {}, {}
    for path in files:
        text = pages.read(path)
        for block, entries in yaml.safe_load(text).items():
            values.setdefault(block, {}).update(entries)
            body = re.search(r"^%s:.*?(?=^\w|\Z)" % block, text, re.MULTILINE | re.DOTALL).group(0)
            for key in entries:
                comment = re.search(r"^  %s:(.*?)(?=^  \w|\Z)" % key, body, re.MULTILINE | re.DOTALL).group(1)
                comments["%s/%s" % (block, key)] = re.sub(r"\s*\n\s*#\s*", " ", comment)
    return values, comments


def value_in(cell):
    """What a table says a default is; what stands behind : or ; explains it."""
    word = re.split("[:;,]", cell)[0].strip().strip("`")
    return "" if word == "none" else yaml.safe_load(word)


class PageFactsTest(unittest.TestCase):
    maxDiff = None

    def test_topics_services_and_actions_of_each_node_are_those_of_its_section(self):
        deadline = time.monotonic() + LIMIT_S
        for node, namespace in NODES:
            wanted = documented(node)
            self.assertGreater(len(wanted), 2, node)
            while offered(node, namespace) != wanted and time.monotonic() < deadline:
                time.sleep(0.1)
            self.assertEqual(sorted(offered(node, namespace)), sorted(wanted), node)

    def test_defaults_and_units_of_parameters_are_those_of_the_manuals(self):
        for heading, blocks, files in PARAMETERS:
            values, comments = manual(files)
            seen = set()
            for block, key, row in parameter_rows(heading):
                if block == "image":
                    continue  # the same in all nodes: ddm_model/config/model.yaml
                seen.add((block, key))
                self.assertEqual(value_in(row["default"]), values[block][key], (heading, block, key))
                unit = re.split(";| of wall time", row.get("unit", "–"))[0].replace("²", "^2")
                if unit != "–" and "[" in comments["%s/%s" % (block, key)]:
                    self.assertIn("[%s" % unit.split(",")[0], comments["%s/%s" % (block, key)], (heading, block, key))
            self.assertGreater(len(seen), 2, heading)
            for block in blocks:
                self.assertEqual({key for name, key in seen if name == block}, set(values[block]), (heading, block))

    def test_topics_of_the_contract_are_those_of_its_header(self):
        header = pages.read("ddm_msgs/include/ddm_msgs/topics.h")
        names = {name for table in pages.tables(pages.read(TOPICS)) for row in table[1:]
                 for name in pages.code_spans(row[0])}
        constants = re.findall(r'constexpr char k\w+\[\] =\s+"([^"]+)"', header)
        self.assertGreater(len(constants), 15)
        self.assertEqual([name for name in constants if name not in names], [])

    def test_fields_of_messages_are_those_of_the_page(self):
        rows, message = {}, ""
        for row in pages.tables(pages.section(pages.read(TOPICS), "Messages"))[0][1:]:
            message = row[0] or message
            rows.setdefault(message, []).extend(name.split(".")[0] for name in pages.code_spans(row[1]))
        for name, fields in rows.items():
            self.assertEqual(sorted(fields), sorted(getattr(ddm_msgs.msg, name).__slots__), name)
        self.assertEqual(sorted(rows), ["Model", "Plan", "PlanScalars", "Torque"])

    def test_fields_of_services_and_actions_are_those_of_the_page(self):
        text = pages.read(TOPICS)
        for row in pages.tables(pages.section(text, "Services"))[0][1:]:
            if "/" in row[1]:
                continue  # of another package
            service = getattr(ddm_msgs.srv, row[1])
            for part, cell in ((service._request_class, row[2]), (service._response_class, row[3])):
                self.assertEqual(set(part.__slots__) - set(pages.code_spans(cell)), set(), row[1])
        for row in pages.tables(pages.section(text, "Actions"))[0][1:]:
            for part, cell in (("Goal", row[2]), ("Feedback", row[3]), ("Result", row[4])):
                fields = getattr(ddm_msgs.msg, row[1] + part).__slots__
                self.assertEqual(set(fields), set(pages.code_spans(cell)), row[1] + part)


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "page_facts_test", PageFactsTest)
