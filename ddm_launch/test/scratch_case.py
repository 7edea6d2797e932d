# Base classes for tests that write files: one folder per test, or one folder for all tests of a class.
# SPDX-License-Identifier: BSD-3-Clause
import os
import resource
import tempfile
import unittest


def new_folder(add_cleanup):
    """Makes a folder that is deleted after the test or class of `add_cleanup`. Returns its real path, because
    programs print the real path."""
    folder = tempfile.TemporaryDirectory()
    add_cleanup(folder.cleanup)
    return os.path.realpath(folder.name)


class ScratchCase(unittest.TestCase):
    """scratch: folder of the test. out: a path in this folder for --out; no file is there yet."""

    maxDiff = None  # differences of file lists and tables are long

    def setUp(self):
        self.scratch = new_folder(self.addCleanup)
        self.out = self.file("out")

    def file(self, *names):
        """A path in the folder of this test."""
        return os.path.join(self.scratch, *names)

    def limitFiles(self, size):
        """Limits the size of all files that this process writes until the end of the test [bytes]. The effect is
        that of a full disk, but needs no root."""
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        self.addCleanup(resource.setrlimit, resource.RLIMIT_FSIZE, limits)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, limits[1]))

    def write(self, name, text):
        """Writes a text file into the folder of this test. Returns its path."""
        path = self.file(name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w") as stream:
            stream.write(text)
        return path


class SharedScratchCase(ScratchCase):
    """class_scratch: a folder for all tests of the class, which is also deleted if setUpClass fails."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.class_scratch = new_folder(cls.addClassCleanup)
