# study: differences of variants and schedules, collected and compared tables, and the rules that make the results.
# SPDX-License-Identifier: BSD-3-Clause
import math
import os
import re

import numpy as np
import pytest

from processes import call, find_program, has_mujoco, output_of, output_of_main, run_experiment
from rooms import PACKAGE
from ddm_launch.command import Failure
from ddm_launch.plant import Joints
from ddm_study import collect, diagnosis, pages, results
from ddm_study.study import main
from run_files import read_rows

STUDY = os.path.join(PACKAGE, "study", "scripts", "study")


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return str(path)


def write_trials(path, success, seeds=4, trials=3):
    """Writes a trials.csv with success(seed, trial)."""
    return write(path, "seed,trial,frames,success,final_error\n" + "".join(
        "%d,%d,%d,%d,1\n" % (seed, trial, 100 * (trial + 1), success(seed, trial))
        for seed in range(seeds) for trial in range(trials)))


def test_variants_are_compared_with_the_preset_by_seed_and_the_worst_comes_first(tmp_path):
    reference = write_trials(tmp_path / "efficient/ablation/preset/trials.csv", lambda seed, trial: True)
    write_trials(tmp_path / "efficient/ablation/blur/trials.csv", lambda seed, trial: seed > 0)
    write_trials(tmp_path / "efficient/ablation/steps/trials.csv", lambda seed, trial: False, seeds=3)
    table = results.differences(str(tmp_path / "efficient/ablation"), reference)
    assert list(dict.fromkeys(table.frames)) == ["100", "200", "300", "100 to 300", "200 to 300"]
    steps, blur = (table[(table.variant == name) & (table.frames == "200 to 300")].iloc[0] for name in ("steps", "blur"))
    assert (steps.seeds, steps.difference, steps.se) == (3, -1.0, 0.0)
    assert (steps.p, steps.p_holm) == (0.25, 0.5)  # three of three pairs differ; there are two variants
    assert blur.difference == -0.25 and blur.se == pytest.approx(0.25)
    rows = pages.Functions(str(tmp_path)).variants("200 to 300").split("\n")
    assert rows == ["| no multi-step loss | −1.000 ± 0.000 | 0.500 |", "| no blur | −0.250 ± 0.250 | 1.000 |"]


def test_variants_without_common_frames_are_refused(tmp_path):
    reference = write_trials(tmp_path / "tried/preset/trials.csv", lambda seed, trial: True, trials=1)
    with pytest.raises(Failure, match="must hold trials.csv of variants"):
        results.differences(str(tmp_path / "tried"), reference)


def test_schedules_are_compared_on_the_seeds_that_all_have(tmp_path):
    for k, name in enumerate(results.SCHEDULES):
        write_trials(tmp_path / ("" if name == "joint" else name) / "trials.csv", lambda seed, trial: trial == 8 + seed,
                     seeds=2 + k, trials=16)
        rows = ["%d,8,%g,0.1,0.9\n" % (seed, 0.02 * (k + 1)) for seed in range(3 - (k > 0))]
        write(tmp_path / "tile_predictions" / name / "predictions.csv",
              "seed,steps,rmse,rmse_repeat,position_r2\n" + "".join(rows))
    late = results.late_success(str(tmp_path))  # means over 900 to 1500 frames
    assert list(late.index) == [0, 1] and late.joint[0] == pytest.approx(1 / 7)
    ratio = results.predictions(str(tmp_path), "tile")["ratio"].loc[8]
    assert list(ratio.index) == [0, 1] and ratio.sequential[0] == pytest.approx(0.4)


def test_returns_are_means_of_the_seeds_after_each_number_of_images(tmp_path):
    path = write(tmp_path / "trials.csv", "seed,frames,return\n0,400,300\n1,400,500\n0,800,700\n")
    table = results.returns(path)
    assert list(table["mean"]) == [400, 700] and list(table.index) == [400, 800]
    assert list(table.se) == pytest.approx([100, 0])


@pytest.mark.parametrize("again, code, part", [
    ("300,0,1.5,0.2,1.0.1\n300,1,2.5,0.2,1.0.1\n", 0, "equal    trials.csv: 2 rows"),
    ("300,0,1.5,0.2,1.0.1\n300,1,2.25,0.2,1.0.1\n", 1, "row 2, seed 300: v_r is 2.5 in the committed file, and 2.25"),
    ("300,0,1.5,0.2,1.0.1\n", 1, "2 rows of these seeds are committed, and 1 were made"),
    (None, 1, "has no table of seeds")])
def test_rows_of_seeds_made_again_are_equal_but_for_times_and_versions(again, code, part, tmp_path):
    header = "seed,trial,v_r,train_s,version\n"
    write(tmp_path / "old/trials.csv", header + "300,0,1.5,0.1,1.0.0\n300,1,2.5,0.1,1.0.0\n301,0,3.5,0.1,1.0.0\n")
    write(tmp_path / "old/times.csv", "seed,train_s\n300,1\n")
    write(tmp_path / "new/times.csv", "seed,train_s\n300,2\n")  # computing times are not compared
    if again:
        write(tmp_path / "new/trials.csv", header + again)
    assert "times" not in output_of_main(main, ["compare", tmp_path / "old", tmp_path / "new"], code, [part])


def write_pilco_run(folder, trials=2):
    write(folder / "trials.csv", "seed,trial,frames,success,final_error\n" + "".join(
        "7,%d,%d,1,1\n" % (k, 125 * (k + 1)) for k in range(trials)))
    for k in range(trials):
        write(folder / ("trial_%03d" % k) / "pilco.yaml", "".join("%s: %d\n" % (key, k) for key in collect.SEARCH_KEYS))
        write(folder / ("evaluation_%03d" % k) / "trajectory.csv", "time_s,angle_rad,rate_rad_per_s\n3,2,0\n")


def test_runs_of_pilco_are_collected(tmp_path):
    write_pilco_run(tmp_path / "seed_0007")
    for kind, expected in (
            ("policies", [["7", "0", "125"] + 9 * ["0"], ["7", "1", "250"] + 9 * ["1"]]),
            ("angles", [["7", "125", "1", "0", "0.000", "2.0000"], ["7", "250", "1", "0", "0.000", "2.0000"]])):
        out = str(tmp_path / (kind + ".csv"))
        assert output_of_main(main, ["collect", kind, tmp_path, "--out", out]) == ""
        assert read_rows(out)[1:] == expected


def test_folders_that_are_no_sweep_or_not_of_pilco_are_named(tmp_path):
    words = [tmp_path, "--out", tmp_path / "a.csv"]
    output_of_main(main, ["collect", "angles", *words], 1, ["%s must hold folders seed_NNNN" % tmp_path])
    write_pilco_run(tmp_path / "seed_0007")
    (tmp_path / "seed_0007/trial_001/pilco.yaml").unlink()
    output_of_main(main, ["collect", "policies", *words], 1, ["trial_001/pilco.yaml must have the keys gp_s"])


def test_a_run_has_rows_for_features_predictions_and_goal_and_damage_is_named(tmp_path):
    run, table = tmp_path / "run", str(tmp_path / "diagnosis.csv")
    run_experiment("--preset", "debug", "--plant", "two_link", "--seed", 3, "--trials", 1, "--out", str(run))
    output_of_main(main, ["diagnose", run, "--out", table])
    rows = [dict(zip(diagnosis.COLUMNS, row)) for row in read_rows(table)[1:]]
    assert [(row["part"], row["steps"], row["joint"]) for row in rows] == [
        ("features", "0", "shoulder"), ("features", "0", "elbow"),
        *(("prediction", steps, joint) for steps in ("1", "5", "15") for joint in ("shoulder", "elbow")), ("goal", "", "all")]
    assert all(0.0 <= float(row["median"]) <= float(row["quantile_90"]) <= 180.0 for row in rows[:-1])
    assert float(rows[0]["median"]) < 45.0  # features without information would have a median of 90
    bag = run / "trial_001" / "trial.bag"
    os.truncate(str(bag), os.path.getsize(str(bag)) // 2)
    assert str(bag) in output_of([STUDY, "diagnose", str(run), "--out", table], code=1)


def test_angles_are_compared_around_the_circle_and_the_goal_counts_where_all_joints_are_near_it():
    joints = Joints("two_link")
    np.testing.assert_allclose(joints.goal, [math.pi, 0.0])
    np.testing.assert_allclose(joints.distances(np.array([[3.0, 0.1]]), np.array([-3.0, 4 * math.pi])),
                               [[2.0 * math.pi - 6.0, 0.1]])
    near, far = math.radians(19.0), math.radians(21.0)
    assert diagnosis.share_near_goal(joints, np.array([[math.pi - near, near], [-math.pi + near, -near],
                                            [math.pi - far, 0.0], [math.pi, far]])) == 0.5


@pytest.fixture(name="plan", scope="module")
def dry_run(tmp_path_factory):
    """All commands of all rules."""
    out = str(tmp_path_factory.mktemp("plan"))
    output = output_of([STUDY, "reproduce", "-n", "--out", out, "paper", "efficient"])
    return output


def test_the_rules_make_every_committed_table_and_figure(plan):
    made = set(re.findall(r"(?:--out |\S+/sweep.csv |> )((?:paper|efficient)/\S+)", plan))
    committed = {os.path.relpath(os.path.join(folder, name), os.path.join(PACKAGE, "results"))
                 for part in ("paper", "efficient") for folder, _, names in os.walk(os.path.join(PACKAGE, "results", part))
                 for name in names if name.endswith((".csv", ".png"))}
    copied = {"features.csv", "strip.csv"}
    once = {"machine.csv", "unused_seeds.csv", "unused_seeds_trials.csv"}
    assert {name for name in committed - made if os.path.basename(name) not in copied | once} == set()


def test_programs_accept_the_options_of_every_sweep(plan):
    programs = {name: find_program(name) for name in ("run_experiment", "prediction_experiment")}
    for words in sorted(set(re.findall(r"sweep --seeds \S+ \+ .*?--out \S+ +(.*)", plan))):
        words, _, more = words.partition(" -- ")
        name = "prediction_experiment" if "--program" in words else "run_experiment"
        words = re.sub(r"--program \S+", "", words)
        code, output = call(["bash", "-c", "%s %s %s --out /dev/null" % (programs[name], words, more)])
        if "needs MuJoCo" not in output or has_mujoco():
            # exit code 2 would mean invalid options
            assert code == 1 and "/dev/null" in output, "%s: %s" % (words, output)


def test_results_are_made_and_the_same_command_resumes(tmp_path):
    words = [STUDY, "reproduce", "--out", str(tmp_path), "--jobs", "2", "efficient/success_rate.png",
             "efficient/config.yaml", "SEEDS=2", "EFFICIENT=debug"]
    output_of(words, 200.0)
    assert len(read_rows(str(tmp_path), "efficient", "trials.csv")) == 1 + 2 * 16
    assert str(tmp_path) not in (tmp_path / "efficient/config.yaml").read_text()
    (tmp_path / "efficient/success_rate.png").unlink()
    output = output_of(words, 60.0)
    assert "sweep" not in output and "figure success_rate" in output
