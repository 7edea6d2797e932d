# Files that Python writes as a whole: the twin of plain_file_test.cpp.
# SPDX-License-Identifier: BSD-3-Clause
import errno
import multiprocessing
import os
import resource

import pytest

from ddm_model.plain_file import remove_unfinished, write_file

NUM_WRITES = 40
CONTENTS = [b"a" * 300000, b"b" * 500000]


def write_often(path, content):
    for _ in range(NUM_WRITES):
        write_file(path, content)


def test_of_writers_at_the_same_time_each_reader_sees_one_whole(tmp_path):
    path = tmp_path / "a.txt"
    write_file(str(path), CONTENTS[0])
    writers = [multiprocessing.Process(target=write_often, args=(str(path), content)) for content in CONTENTS]
    for writer in writers:
        writer.start()
    while any(writer.is_alive() for writer in writers):
        assert path.read_bytes() in CONTENTS
    for writer in writers:
        writer.join()
    assert [writer.exitcode for writer in writers] == [0, 0]
    assert os.listdir(str(tmp_path)) == ["a.txt"]


def test_a_write_that_fails_leaves_the_old_file_and_nothing_else(tmp_path):
    path = tmp_path / "a.txt"
    write_file(str(path), "old")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1, limits[1]))  # as on a full disk
    try:
        with pytest.raises(OSError, match="%s.*%s" % (path, os.strerror(errno.EFBIG))):
            write_file(str(path), "new")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert path.read_text() == "old" and os.listdir(str(tmp_path)) == ["a.txt"]


def test_what_killed_writers_left_behind_is_removed_on_request(tmp_path):
    for name in (".unfinished.0f", ".unfinished", ".unfinished.txt"):
        write_file(str(tmp_path / ("a.txt" + name)), "half")
    remove_unfinished(str(tmp_path))
    assert sorted(os.listdir(str(tmp_path))) == ["a.txt.unfinished", "a.txt.unfinished.txt"]
