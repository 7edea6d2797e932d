# A short `qa soak` of both loops finds nothing, and it counts an image that is removed from a bag as lost.
# SPDX-License-Identifier: BSD-3-Clause
import rosbag

from ddm_qa import soak
from processes import call, find_program
from run_files import read_rows

NODES = {"experiment_node", "master", "model_node", "mpc_node", "rosout", "sim_node", "trial_recorder"}


def test_both_runs_leave_tables_and_a_lost_frame_is_noticed(tmp_path):
    code, output = call([find_program("qa"), "soak", "--trials", "3", "--minutes", "0.2", "--steps", "10", "--out", tmp_path],
                        limit_s=200.0)
    targets = read_rows(tmp_path, "targets.csv")[1:]
    assert code == (0 if all(row[3] == "1" for row in targets) else 1), output
    for run in ("lockstep", "real_time"):
        assert {row[1] for row in targets if row[0] == run} == {"lost frames"} | {
            target + node for target in ("resident memory of ", "open files of ") for node in NODES}, output
    assert ["lockstep", "lost frames", "0 of 160", "1"] in targets, output

    folder = tmp_path / "lockstep" / "run"
    path = str(folder / "trial_003" / "trial.bag")
    with rosbag.Bag(path) as bag:
        messages = list(bag.read_messages())
    del messages[[number for number, message in enumerate(messages) if message.topic == "camera/image_raw"][8]]
    with rosbag.Bag(path, "w") as bag:
        for topic, message, stamp in messages:
            bag.write(topic, message, stamp)
    frames = soak.count_frames("lockstep", str(folder), 4)
    assert frames[frames.lost > 0][["trial", "part"]].values.tolist() == [[3, "trial"]]
