# The version of the code that a build records, for all kinds of checkouts.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil
import subprocess

import pytest

from rooms import PACKAGE

pytestmark = pytest.mark.skipif(not shutil.which("git"), reason="needs git")


def git(checkout, *arguments):
    return subprocess.check_output(["git", "-C", checkout, *arguments], universal_newlines=True).strip()


def version(checkout, **environment):
    """The version that a build would record. Fails if the checkout changes."""
    before, out = sorted(os.walk(checkout)), checkout.parent / "version.h"
    subprocess.run([shutil.which("cmake"), "-DSOURCE=%s" % (checkout / "ddm_launch"), "-DOUT=%s" % out, "-DPACKAGE_VERSION=1.2.3",
                    "-P", os.path.join(PACKAGE, "cmake", "write_version.cmake")], check=True, env=dict(os.environ, **environment))
    assert sorted(os.walk(checkout)) == before
    return out.read_text().split('"')[1]


def test_a_checkout_has_its_commit_and_tells_changes_as_far_as_git_knows_them(tmp_path):
    checkout, nothing = tmp_path / "checkout", {"PATH": str(tmp_path / "no" / "programs")}
    (checkout / "ddm_launch").mkdir(parents=True)
    (checkout / "ddm_launch" / "code").write_text("1")
    git(checkout, "init", "--quiet")
    git(checkout, "add", ".")
    git(checkout, "-c", "user.name=n", "-c", "user.email=e", "commit", "--quiet", "-m", "m")
    commit = git(checkout, "rev-parse", "HEAD")[:7]
    assert version(checkout) == "1.2.3 (%s)" % commit
    unknown = "1.2.3 (%s, changes unknown)" % commit
    assert version(checkout, **nothing) == unknown
    (checkout / "ddm_launch" / "code").write_text("2")
    assert version(checkout) == "1.2.3 (%s-dirty)" % commit
    (checkout / "ddm_launch" / "code").write_text("1")
    if os.geteuid() == 0:  # a checkout that belongs to another user
        for folder, _, files in os.walk(checkout):
            for name in [""] + files:
                os.chown(os.path.join(folder, name), 12345, 12345)
        assert version(checkout) == "1.2.3 (%s)" % commit
    shutil.move(str(checkout / ".git" / "objects"), str(tmp_path / "objects"))
    assert version(checkout) == unknown
    (checkout / ".git" / "HEAD").write_text(commit + "0" * 33 + "\n")
    assert version(checkout, **nothing) == unknown
    shutil.rmtree(checkout / ".git")
    assert version(checkout) == "1.2.3 (unknown commit)"
