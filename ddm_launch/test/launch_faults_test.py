# What is wrong in the arguments or files of a launch is named on the terminal, and leaves no folder.
# SPDX-License-Identifier: BSD-3-Clause
import os

import pytest

from processes import roslaunch


# resolve_test.py and configuration_test.cpp have more mistakes; here a launch shows them, of each kind one.
@pytest.mark.parametrize("words, arguments, config, before_any_node", [
    (["unknown plant 'windmill'", "pendulum_gravity"], ["plant:=windmill"], None, True),
    (["no/such.yaml"], ["config:=no/such.yaml"], None, True),
    (["experiment/seed", "one"], ["seed:=one"], None, True),
    (["controller/timeot", "timeout"], [], "controller: {timeot: 1.0}\n", False),
    (["experiment/method", "oracle"], [], "experiment: {method: oracle}\n", False)])
def test_a_mistake_is_named_and_leaves_no_folder(tmp_path, words, arguments, config, before_any_node):
    if config:
        (tmp_path / "differs.yaml").write_text(config)
        arguments = arguments + ["config:=%s" % (tmp_path / "differs.yaml")]
    _, output = roslaunch(str(tmp_path), "experiment.launch", "preset:=debug", "trials:=0",
                          "runs:=%s" % (tmp_path / "out"), *arguments, limit_s=40.0)
    for word in words:
        assert word in output
    if before_any_node:
        assert "process[" not in output
    assert not os.path.exists(tmp_path / "out")


def test_a_missing_folder_argument_is_named(tmp_path):
    code, output = roslaunch(str(tmp_path), "experiment.launch", "preset:=debug", limit_s=40.0)
    assert code == 1
    assert "'runs'" in output
