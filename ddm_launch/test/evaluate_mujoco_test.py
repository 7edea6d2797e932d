# evaluate on a plant of a model file: the rows do not depend on the number of parallel evaluations.
# SPDX-License-Identifier: BSD-3-Clause
import pytest

from processes import call, find_program, has_mujoco, run_experiment
from run_files import read_rows, read_yaml

SEEDS = 3
PLANT = ["--preset", "debug", "--plant", "suite_reacher_hard",  # this plant draws goals and has a reward
         "--set", "training/num_starts=1", "--set", "training/max_iterations=20", "--set", "plant/episode_frames=150"]


@pytest.mark.skipif(not has_mujoco(), reason="ddm_sim was built without MuJoCo")
def test_jobs_change_nothing_and_the_configuration_names_the_renderer(tmp_path):
    code, output = run_experiment(*PLANT, "--trials", "0", "--out", tmp_path / "run")
    assert code == 0, output
    assert "llvmpipe" in read_yaml(tmp_path, "run", "config.yaml")["renderer"]
    tables = []
    for jobs in (1, SEEDS):
        folder = tmp_path / ("jobs_%d" % jobs)
        code, output = call([find_program("evaluate"), "--model", tmp_path / "run" / "trial_000" / "model.ddm", "--seeds",
                             "0:%d" % SEEDS, "--jobs", jobs, "--out", folder, *PLANT])
        assert code == 0, output
        header, *rows = read_rows(folder, "evaluation.csv")
        tables.append([{name: value for name, value in zip(header, row) if not name.startswith("plan_ms")} for row in rows])
    assert tables[0] == tables[1]
    assert len({row["final_error"] for row in tables[0]}) == SEEDS  # each seed has other torques
    assert all(0.0 <= float(row["return"]) <= 150.0 for row in tables[0])
