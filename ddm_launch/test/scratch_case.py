# Base of the tests that write files: a folder for each test and, where asked for, one for all tests of a class.
# SPDX-License-Identifier: BSD-3-Clause
import os
import resource
import tempfile
import unittest


def new_folder(add_cleanup):
    """A new folder, which goes when the test or class of `add_cleanup` has ended. Returns its real path: programs tell
    that one."""
    folder = tempfile.TemporaryDirectory()
    add_cleanup(folder.cleanup)
    return os.path.realpath(folder.name)


class ScratchCase(unittest.TestCase):
    """scratch: a folder of each test. out: a path in it for what is asked for with --out; nothing is there yet."""

    maxDiff = None  # lists of files and rows of tables are long

    def setUp(self):
        self.scratch = new_folder(self.addCleanup)
        self.out = self.file("out")

    def file(self, *names):
        """A path in the folder of this test."""
        return os.path.join(self.scratch, *names)

    def limitFiles(self, size):
        """Until the end of the test no file that this process writes may grow beyond this size [bytes]: as on a full
        disk, but without root."""
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
    """class_scratch: a folder of all tests of the class, also gone after a setUpClass that failed."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.class_scratch = new_folder(cls.addClassCleanup)
