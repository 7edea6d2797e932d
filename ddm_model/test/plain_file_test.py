#!/usr/bin/python3
# Tests of files that Python writes as a whole: the twin of plain_file_test.cpp.
# SPDX-License-Identifier: BSD-3-Clause
import errno
import multiprocessing
import os
import resource
import tempfile
import unittest

import rosunit

from ddm_model.plain_file import remove_unfinished, write_file

NUM_WRITES = 40
CONTENTS = [b"a" * 300000, b"b" * 500000]


def write_often(path, content):
    for _ in range(NUM_WRITES):
        write_file(path, content)


class PlainFileTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder, self.path = folder.name, os.path.join(folder.name, "a.txt")

    def read(self):
        with open(self.path, "rb") as stream:
            return stream.read()

    def test_of_writers_at_the_same_time_each_reader_sees_one_whole(self):
        write_file(self.path, CONTENTS[0])
        writers = [multiprocessing.Process(target=write_often, args=(self.path, content)) for content in CONTENTS]
        for writer in writers:
            writer.start()
        torn = 0
        while any(writer.is_alive() for writer in writers):
            torn += self.read() not in CONTENTS
        for writer in writers:
            writer.join()
        self.assertEqual([writer.exitcode for writer in writers], [0, 0])
        self.assertEqual(torn, 0)
        self.assertEqual(os.listdir(self.folder), ["a.txt"])

    def test_a_write_that_fails_leaves_the_old_file_and_nothing_else(self):
        write_file(self.path, "old")
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        self.addCleanup(resource.setrlimit, resource.RLIMIT_FSIZE, limits)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1, limits[1]))
        with self.assertRaises(OSError) as caught:
            write_file(self.path, "new")
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        for part in (self.path, os.strerror(errno.EFBIG)):
            self.assertIn(part, str(caught.exception))
        self.assertEqual(self.read(), b"old")
        self.assertEqual(os.listdir(self.folder), ["a.txt"])

    def test_what_killed_writers_left_behind_is_removed_on_request(self):
        for name in (".unfinished.0f", ".unfinished", ".unfinished.txt"):
            write_file(self.path + name, "half")
        remove_unfinished(self.folder)
        self.assertEqual(sorted(os.listdir(self.folder)), ["a.txt.unfinished", "a.txt.unfinished.txt"])

if __name__ == "__main__":
    rosunit.unitrun("ddm_model", "plain_file_test", PlainFileTest)
