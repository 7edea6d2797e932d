# What is in a run folder at some moment, to see later that nothing of it was lost or changed.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import hashlib
import os

from ddm_qa.run_comparison import files_in, read_bytes
from ddm_launch.run_folder import num_finished

TABLE = "trials.csv"


def digest(content):
    return hashlib.sha256(content).hexdigest()


def digests(folder):
    """{name: digest} of all files."""
    return {name: digest(read_bytes(folder, name)) for name in files_in(folder)}


def head_of_table(folder, num_rows):
    """Digest of the header and the first rows of the table of trials; None if there is none."""
    if not os.path.exists(os.path.join(folder, TABLE)):
        return None
    return digest(b"".join(read_bytes(folder, TABLE).splitlines(keepends=True)[:num_rows + 1]))


class Finished(collections.namedtuple("Finished", "num_trials files")):
    """All files of finished trials, and their rows in the table of trials."""

    @classmethod
    def of(cls, folder):
        count = num_finished(folder)
        folders = tuple("%s_%03d/" % (kind, k) for kind in ("trial", "evaluation") for k in range(count))
        files = {name: value for name, value in digests(folder).items() if name.startswith(folders)}
        return cls(count, dict(files, **{TABLE: head_of_table(folder, count)}) if count else {})

    def lost(self, folder):
        """Names of what is not there any more, or not as it was."""
        now = dict(digests(folder), **{TABLE: head_of_table(folder, self.num_trials)})
        return sorted(name for name, value in self.files.items() if now.get(name) != value)
