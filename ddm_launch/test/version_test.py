# The version of the code that a build records, wherever the checkout comes from.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil
import subprocess
import unittest

from scratch_case import ScratchCase

SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cmake", "write_version.cmake")


@unittest.skipUnless(shutil.which("git"), "needs git")
class VersionTest(ScratchCase):
    def setUp(self):
        super().setUp()
        self.source = self.file("checkout", "ddm_launch")
        self.write("checkout/ddm_launch/code", "1")
        self.git("init", "--quiet")
        self.git("add", ".")
        self.git("-c", "user.name=n", "-c", "user.email=e", "commit", "--quiet", "-m", "m")
        self.commit = self.git("rev-parse", "HEAD")[:7]

    def git(self, *arguments):
        done = subprocess.run(["git", "-C", self.file("checkout"), *arguments], stdout=subprocess.PIPE, check=True,
                              universal_newlines=True)
        return done.stdout.strip()

    def version(self, **environment):
        """Returns the version that a build would record, and checks that the checkout does not change."""
        before = sorted(os.walk(self.file("checkout")))
        out = self.file("version.h")
        subprocess.run([shutil.which("cmake"), "-DSOURCE=" + self.source, "-DOUT=" + out, "-DPACKAGE_VERSION=1.2.3", "-P",
                        SCRIPT], check=True, env=dict(os.environ, **environment))
        self.assertEqual(sorted(os.walk(self.file("checkout"))), before)
        self.assertEqual(sorted(os.listdir(self.scratch)), ["checkout", "version.h"])
        with open(out) as stream:
            return stream.read().split('"')[1]

    def test_a_checkout_has_its_commit_and_tells_changes(self):
        self.assertEqual(self.version(), "1.2.3 (%s)" % self.commit)
        self.write("checkout/ddm_launch/code", "2")
        self.assertEqual(self.version(), "1.2.3 (%s-dirty)" % self.commit)

    @unittest.skipUnless(os.geteuid() == 0, "only root can give a checkout away")
    def test_a_checkout_of_another_user_has_its_commit(self):
        for folder, _, files in os.walk(self.file("checkout")):
            for name in [""] + files:
                os.chown(os.path.join(folder, name), 12345, 12345)
        self.assertEqual(self.version(), "1.2.3 (%s)" % self.commit)

    def test_a_machine_without_git_reads_the_commit_only(self):
        path = {"PATH": self.file("no", "programs")}
        expected = "1.2.3 (%s, changes unknown)" % self.commit
        self.assertEqual(self.version(**path), expected)
        self.git("pack-refs", "--all")
        self.assertEqual(self.version(**path), expected)
        shutil.rmtree(self.file("checkout", ".git", "objects"))
        self.assertEqual(self.version(), expected)
        self.write("checkout/.git/HEAD", self.commit + "0" * 33 + "\n")
        self.assertEqual(self.version(**path), expected)
        shutil.rmtree(self.file("checkout", ".git"))
        self.assertEqual(self.version(), "1.2.3 (unknown commit)")
