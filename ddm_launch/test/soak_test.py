# A short `qa soak` of both loops finds nothing.
# SPDX-License-Identifier: BSD-3-Clause
from processes import call, find_program
from run_files import read_rows

NODES = {"experiment_node", "master", "model_node", "mpc_node", "rosout", "sim_node", "trial_recorder"}


def test_both_runs_leave_tables_and_lose_no_frame(tmp_path):
    code, output = call([find_program("qa"), "soak", "--trials", "3", "--minutes", "0.2", "--steps", "10", "--out", tmp_path],
                        limit_s=200.0)
    targets = read_rows(tmp_path, "targets.csv")[1:]
    assert code == (0 if all(row[3] == "1" for row in targets) else 1), output
    for run in ("lockstep", "real_time"):
        assert {row[1] for row in targets if row[0] == run} == {"lost frames"} | {
            target + node for target in ("resident memory of ", "open files of ") for node in NODES}, output
    assert ["lockstep", "lost frames", "0 of 160", "1"] in targets, output
