# Reading run folders with pandas: the README's example, every step of every episode, and invalid folders.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re

import numpy as np
import pytest

import ddm_model
from processes import run_experiment
from rooms import CHECKOUT
from run_files import read_rows

EPISODES, STEPS = 2, 30


def test_a_run_has_a_row_for_each_model_and_step_as_in_its_tables(tmp_path):
    folder = str(tmp_path / "run")
    run_experiment("--preset", "debug", "--set", "trial/episodes=%d" % EPISODES, "--trials", "1", "--out", folder)
    run = ddm_model.read_run(folder)
    assert run.trials.index.tolist() == [0, 1]
    assert run.trials.frames.tolist() == [EPISODES * STEPS, 2 * EPISODES * STEPS]
    assert run.config["trial"]["episodes"] == EPISODES
    assert run.steps.index.is_unique
    counts = run.steps.groupby(level=["kind", "trial", "episode"]).size()
    assert counts.loc["trial"].to_dict() == {(k, e): STEPS for k in (0, 1) for e in (0, 1)}
    assert sorted(counts.loc["evaluation"].index) == [(0, 0), (1, 0)]
    part = run.steps.loc[("trial", 1, 1)]
    for name, column in (("torques.csv", "torque_nm"), ("trajectory.csv", "angle_rad")):
        header, *rows = read_rows(folder, "trial_001", "episode_001", name)
        truth = [float(row[header.index(column)]) for row in rows]
        np.testing.assert_array_equal(part[column][:len(truth)], truth)
    with open(os.path.join(CHECKOUT, "ddm_model", "README.md")) as stream:
        block = next(text for text in re.findall(r"```python\n(.*?)```", stream.read(), re.DOTALL) if "read_run" in text)
    names = {"ddm_model": ddm_model}
    exec(block.replace('"runs/one"', repr(folder)), names)  # pylint: disable=exec-used
    last = [float(read_rows(folder, "evaluation_%03d" % k, "trajectory.csv")[-1][2]) for k in (0, 1)]
    np.testing.assert_array_equal(names["errors"], last)


@pytest.mark.parametrize("trials, config, words", [
    (None, "", "cannot read .*trials.csv: No such file"), ("", "", "No columns"),
    ("a,b\n1,2\n", "", "has no column 'trial', 'frames', only a, b"), ("trial,frames\n1,2\n3,4,5,6\n", "", "cannot read"),
    ("trial,frames\n0,100\n", "just words\n", "config.yaml must hold the blocks .* 'just words'")])
def test_a_folder_that_is_none_and_damaged_files_are_refused_by_name(tmp_path, trials, config, words):
    if trials is not None:
        (tmp_path / "trials.csv").write_text(trials)
        (tmp_path / "config.yaml").write_text(config)
    with pytest.raises(ddm_model.RunFolderError, match=words):
        ddm_model.read_run(str(tmp_path))
