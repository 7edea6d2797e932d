# What the pages say is so: links lead somewhere, and quoted messages are those of the programs.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import re
import subprocess
import unittest

import pages

TROUBLES = "doc/troubleshooting.md"
DIST = "/usr/lib/python3/dist-packages"
# Messages of others: where they stand.
FOREIGN = {
    "REQUIRED process […] has died!": DIST + "/roslaunch/pmon.py",
    "process has finished cleanly": DIST + "/roslaunch/*.py",
    "exit code …": DIST + "/roslaunch/*.py",
    "Cannot load command parameter […]: command […] returned with code …": DIST + "/roslaunch/loader.py",
    "Unable to contact my own server at […]": DIST + "/roslaunch/server.py",
    "RLException: […] is neither a launch file in package […] nor is […] a launch file name":
        DIST + "/roslaunch/rlutil.py",
    "new node registered with same name": DIST + "/rosmaster/*.py",
    "could not connect to display": "/usr/lib/*/libQt5XcbQpa.so.5"}
NO_ROS = "ModuleNotFoundError: No module named 'rospkg'"


def program_files():
    """Sources of our programs, without tests."""
    for package in pages.PACKAGES:
        for folder, _, names in os.walk(os.path.join(pages.CHECKOUT, package)):
            if re.search(r"/(test|results|testing|__pycache__)(/|$)", folder):
                continue
            for name in names:
                if name.endswith((".cpp", ".h", ".py", ".sh")) or "." not in name:
                    yield os.path.join(folder, name)


def literals(path):
    """A source in which adjacent string literals are joined, so that each message appears as it is printed."""
    with open(path, errors="replace") as stream:
        return re.sub(r'"\s*(?:<<|\+)?\s*"', "", stream.read()).replace("\\\"", "\"")


def stands_in(message, text):
    """The parts of the message between its gaps, in their order."""
    parts = [re.escape(part.strip()) for part in re.split("…", message) if len(part.strip()) >= 4]
    return sum(map(len, parts)) >= 10 and re.search(".*?".join(parts), text, re.DOTALL) is not None


def quoted_messages():
    """First cells of the tables of trouble; what is no message is told without code."""
    return [message for table in pages.tables(pages.read(TROUBLES)) for row in table[1:]
            for message in pages.code_spans(row[0])]


class PagesTest(unittest.TestCase):
    maxDiff = None

    def test_relative_links_lead_to_files_and_headings_that_are_there(self):
        dead, seen = [], 0
        for page in pages.page_paths():
            for link in pages.links(pages.read(page)):
                if re.match("https?://", link):
                    continue
                seen += 1
                path, _, anchor = link.partition("#")
                target = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
                if not os.path.exists(os.path.join(pages.CHECKOUT, target)):
                    dead.append((page, link, "no such file"))
                elif anchor and anchor not in pages.anchors(pages.read(target)):
                    dead.append((page, link, "no such heading"))
        self.assertEqual(dead, [])
        self.assertGreater(seen, 60)

    def test_every_page_is_reached_from_the_first_one(self):
        reached, todo = set(), ["README.md"]
        while todo:
            page = todo.pop()
            if page not in reached:
                reached.add(page)
                targets = [os.path.normpath(os.path.join(os.path.dirname(page), link.partition("#")[0]))
                           for link in pages.links(pages.read(page)) if not re.match("https?://|#", link)]
                todo += [target for target in targets if target.endswith(".md")]
        self.assertEqual(sorted(set(pages.page_paths()) - reached), [])

    def test_pictures_are_files_that_are_committed_beside_their_commands(self):
        for page in pages.page_paths():
            for link in pages.links(pages.read(page)):
                if link.endswith((".png", ".gif")):
                    path = os.path.normpath(os.path.join(os.path.dirname(page), link))
                    self.assertTrue(path.startswith("ddm_launch/results/"), (page, link))

    def test_messages_of_our_programs_are_quoted_as_they_are_printed(self):
        texts = {path: literals(path) for path in program_files()}
        ours = [message for message in quoted_messages() if message not in FOREIGN and message != NO_ROS]
        ours = [message for message in ours if message not in ("roslaunch", "yaml", "catkin_make run_tests")]
        self.assertGreater(len(ours), 40)
        self.assertEqual([message for message in ours
                          if not any(stands_in(message, text) for text in texts.values())], [])

    def test_messages_of_others_are_quoted_as_they_are_printed(self):
        quoted = quoted_messages()
        for message, pattern in FOREIGN.items():
            self.assertIn(message, quoted)
            words = message.replace("RLException: ", "").replace("…", "%s")
            found = []
            for path in glob.glob(pattern):
                with open(path, "rb") as stream:
                    found.append(words.replace("code %s", "code").encode() in stream.read())
            self.assertIn(True, found, message)
        self.assertIn(NO_ROS, quoted)
        done = subprocess.run(["/usr/bin/python3", "-I", "-S", "-c", "import rospkg"], stderr=subprocess.PIPE,
                              universal_newlines=True)
        self.assertIn(NO_ROS, done.stderr)

    def test_a_message_that_nobody_prints_is_noticed(self):
        text = literals(os.path.join(pages.CHECKOUT, "ddm_launch/drivers/ros_driver.cpp"))
        self.assertTrue(stands_in("service … is not offered", text))
        self.assertFalse(stands_in("service … is not granted", text))
        self.assertFalse(stands_in("is not offered … nodes do not find each other:… is not offered now", text))
        self.assertFalse(stands_in("… to …", text))  # so short that it stands anywhere

    def test_the_headings_of_a_page_are_what_links_call_them(self):
        self.assertEqual(pages.anchors("# A b\n```\n# no\n```\n## `c_d`: E (f), [g](h)\n# A b\n"),
                         ["a-b", "c_d-e-f-g", "a-b-1"])
