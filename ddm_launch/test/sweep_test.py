# Sweeps with GNU parallel: their files, interruptions, and invalid inputs.
# SPDX-License-Identifier: BSD-3-Clause
import errno
import os
import platform
import shutil
import signal
import subprocess

import pytest

from processes import find_program, output_of_main, run_experiment
from run_files import differences, expected_files, files_in, read_bytes, read_rows, read_yaml
from sweeps import (Sweep, assert_ends, assert_nothing_runs, assert_table, debug, is_finished, programs_of, seed_folder, snapshot,
                    wait_for)
from ddm_launch.command import run_program
from ddm_launch.sweep import main

LONG = 12  # trials, enough to observe a seed while it runs


@pytest.fixture(name="reference", scope="module")
def make_reference(tmp_path_factory):
    """Returns (folder, output) of a sweep of seeds 0 ... 3 with one trial."""
    out = str(tmp_path_factory.mktemp("sweep") / "reference")
    return out, assert_ends(0, [], *debug(out))


@pytest.fixture(name="out")
def out_folder(tmp_path):
    """A path at which no file exists yet. After the test, no process that uses the path may run."""
    out = str(tmp_path / "out")
    yield out
    assert_nothing_runs(out)


@pytest.fixture(name="copy")
def copy_reference(reference, out):
    return shutil.copytree(reference[0], out)


def assert_same_as_run_experiment(out, seed, trials, tmp_path):
    single = str(tmp_path / "single")
    run_experiment("--preset", "debug", "--seed", seed, "--trials", trials, "--out", single)
    assert differences(single, seed_folder(out, seed), expected_files(trials)) == []


def test_all_seeds_are_run_and_their_rows_collected(reference, tmp_path):
    out, output = reference
    assert_table(out, range(4))
    assert "4 of 4 seeds finished" in output and os.path.join(out, "sweep.csv") in output
    lines = [line for line in output.splitlines() if line.startswith("seed ")]
    assert sorted(line.split(" (")[0] for line in lines) == ["seed %d finished" % k for k in range(4)]
    assert [line.split(" (")[1] for line in lines] == ["%d of 4)" % k for k in range(1, 5)]
    own = [name for name in files_in(out) if not name.startswith(("seed_", "logs/"))]
    assert own == ["joblog.tsv", "run_seed.sh", "sweep.csv", "sweep.yaml"]
    jobs = [line.split("\t") for line in read_bytes(out, "joblog.tsv").decode().splitlines()]
    assert [job[6] for job in jobs] == ["Exitval"] + ["0"] * 4
    assert "preset debug, plant pendulum, seed 2, 1 trials" in read_bytes(out, "logs", "seed_0002.log").decode()
    assert files_in(seed_folder(out, 2)) == expected_files(1)
    assert_same_as_run_experiment(out, 2, 1, tmp_path)


def test_the_same_command_runs_nothing_again_and_seeds_and_trials_may_grow(copy, tmp_path):
    before = snapshot(copy)
    assert_ends(0, ["0 of 4 seeds to run", "4 of 4 seeds finished"], *debug(copy))
    assert {name: value for name, value in snapshot(copy).items() if name != "sweep.csv"} == {
        name: value for name, value in before.items() if name != "sweep.csv"}
    assert_ends(0, ["1 of 2 seeds to run"], *debug(copy, "3:5"))
    assert_table(copy, [3, 4])
    assert_ends(0, ["2 of 2 seeds to run"], *debug(copy, "0:2", 3))
    assert_table(copy, [0, 1], 3)
    assert_same_as_run_experiment(copy, 1, 3, tmp_path)
    assert_ends(0, ["0 of 4 seeds to run"], *debug(copy, "0:4", 1))
    assert_table(copy, range(4), 1)


def test_a_sweep_that_was_killed_resumes_as_if_nothing_had_happened(out, tmp_path):
    with Sweep(*debug(out, "0:3", LONG), "--jobs", 1) as process:
        trials_csv = os.path.join(seed_folder(out, 1), "trials.csv")
        wait_for(lambda: is_finished(out, 0) and os.path.exists(trials_csv), "the middle of the sweep")
        process.kill_group()
    assert not is_finished(out, 1)
    assert_nothing_runs(out)
    before = snapshot(seed_folder(out, 0))
    assert_ends(0, ["2 of 3 seeds to run", "3 of 3 seeds finished"], *debug(out, "0:3", LONG))
    assert snapshot(seed_folder(out, 0)) == before
    assert "after trial" in read_bytes(out, "logs", "seed_0001.log").decode()
    assert_table(out, range(3), LONG)
    assert_same_as_run_experiment(out, 1, LONG, tmp_path)


def test_a_seed_that_was_killed_is_named_and_the_others_are_collected(out):
    with Sweep(*debug(out, "0:3", LONG)) as process:
        os.kill(wait_for(lambda: programs_of(seed_folder(out, 1)), "the program of seed 1")[0], signal.SIGKILL)
        assert process.waitForEnd(60.0) == 1
    for words in ("2 of 3 seeds finished", "seed 1: ", "signal KILL", "logs/seed_0001.log"):
        assert words in process.output
    assert_table(out, [0, 2], LONG)
    assert_ends(0, ["1 of 3 seeds to run", "3 of 3 seeds finished"], *debug(out, "0:3", LONG))


@pytest.mark.parametrize("number, code", [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_ends_all_seeds_and_a_second_sweep_in_the_folder_is_refused(number, code, out):
    with Sweep(*debug(out, "0:2", 999), "--jobs", 1) as process:
        wait_for(lambda: programs_of(seed_folder(out, 0)), "the program of seed 0")
        assert_ends(1, ["is running", out], *debug(out, "1:2"))
        process.send_signal(number)
        assert process.waitForEnd(20.0) == code, process.output
    assert "SIG" in process.output and "seed 1: " in process.output


def test_only_the_lock_of_a_sweep_that_has_ended_on_this_machine_is_replaced(copy):
    lock = os.path.join(copy, ".lock")
    for owner, words in (("%s 4194305" % platform.node(), []), ("node17 4194305", ["process 4194305 on node17"]), ("", ["?"])):
        with open(lock, "w") as stream:
            stream.write(owner)
        assert_ends(1 if words else 0, words and words + ["is running", "delete " + lock], *debug(copy))
        assert os.path.exists(lock) == bool(words)


def test_a_folder_of_another_sweep_is_refused_and_left_as_it_is(copy):
    before = snapshot(copy)
    for words, arguments in ((["options: ['--preset', 'debug'] there", "gravity"], debug(copy) + ["--plant", "pendulum_gravity"]),
                             (["'debug'] there, [] here"], debug(copy)[2:]),
                             (["'debug'] there", "epsilon"], debug(copy) + ["--set", "mpc/epsilon=0.4"])):
        assert_ends(1, words + ["another sweep", copy], *arguments)
    assert snapshot(copy) == before


def test_seeds_of_another_experiment_are_named_and_not_mixed_in(out, tmp_path):
    config = tmp_path / "more.yaml"
    words = ["--", "--config", str(config)]
    config.write_text("mpc: {epsilon: 0.4}\n")
    assert_ends(0, ["1 of 1 seeds finished"], *debug(out, "0:1", 0), *words)
    config.write_text("mpc: {epsilon: 0.3}\n")
    assert_ends(1, ["1 of 2 seeds finished", "seed_0001", "mpc/epsilon: 0.4 there, 0.3 here"], *debug(out, "0:2", 0), *words)
    run_experiment("--preset", "debug", "--seed", 2, "--trials", 0, "--out", seed_folder(out, 2))
    assert_ends(1, ["seed 2: ", "seed_0002 is not the experiment of seed 0"], *debug(out, "0:3", 0), *words)
    assert_table(out, [0], 0)


def test_seeds_of_other_versions_are_collected_and_told(copy):
    here = read_yaml(seed_folder(copy, 0), "config.yaml")["version"]
    path = os.path.join(seed_folder(copy, 1), "trials.csv")
    text = read_bytes(path).decode().replace(here, "0.0.1 (old)")
    with open(path, "w") as stream:
        stream.write(text)
    assert_ends(0, ["4 of 4 seeds finished", "2 versions", "0.0.1 (old)"], *debug(copy))


def test_a_table_that_makes_no_sense_is_named(copy):
    path = os.path.join(seed_folder(copy, 2), "trials.csv")
    rows = read_bytes(path).decode().splitlines()
    for damaged in (rows[:2], [row.replace("2,", "3,", 1) for row in rows], []):
        with open(path, "w") as stream:
            stream.write("\n".join(damaged) + "\n")
        assert_ends(1, ["3 of 4 seeds finished", path, "2 rows of seed 2"], *debug(copy))
        assert_table(copy, [0, 1, 3])


@pytest.mark.parametrize("words, arguments", [
    (["--seeds"], ["--out", "x"]), (["--out"], ["--seeds", "0:4"]),
    *((["must be A:B", "'%s'" % seeds], ["--out", "x", "--seeds=" + seeds]) for seeds in ("4:4", "4:2", "-1:2", "4", "0:1000000")),
    (["--seed", "2147483648"], debug("x", "2147483648:2147483649")),
    (["--trials", "'x'"], debug("x", trials="x")),
    (["--jobs", "whole number >= 1, got '0'"], debug("x") + ["--jobs", 0]),
    (["--hosts", "/no/hosts"], debug("x") + ["--hosts", "/no/hosts"]),
    (["--hosts and --slurm"], debug("x") + ["--hosts", __file__, "--slurm"]),
    (["unknown preset 'papier'", "efficient, paper, underactuated"], ["--seeds", "0:4", "--out", "x", "--preset", "papier"]),
    (["nonsense"], debug("x") + ["--nonsense"]), (["nonsense"], debug("x") + ["--", "--nonsense"]),
    (["--seed"], debug("x") + ["--", "--seed=3"]), (["runs no experiment"], debug("x") + ["--", "--help"]),
    (["invalid choice: 'simulate'"], debug("x") + ["--program", "simulate"]),
    (["option of run_experiment"], debug("x") + ["--program", "prediction_experiment"])])
def test_bad_options_are_refused_by_name_before_anything_is_made(words, arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    output_of_main(main, arguments, 2, words)
    assert os.listdir(str(tmp_path)) == []


def test_folders_and_files_that_cannot_be_written_are_named(out, tmp_path):
    (tmp_path / "plain_file").write_text("")
    for folder in (str(tmp_path / "plain_file"), "/proc/ddm"):
        assert_ends(1, ["cannot write", folder], *debug(folder))
    done = subprocess.run(["prlimit", "--fsize=10", find_program("sweep"), *map(str, debug(out))],  # simulates a full disk
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
    assert done.returncode == 1 and all(word in done.stdout for word in ("sweep: ", out, os.strerror(errno.EFBIG))), done.stdout
    assert files_in(out) == []


def test_a_missing_engine_is_named_with_its_package(out, tmp_path):
    assert_ends(1, ["not installed", "apt-get install parallel"], *debug(out), environment={"PATH": str(tmp_path)})
    (tmp_path / "parallel").write_text("#!/bin/sh\necho another\n")
    (tmp_path / "parallel").chmod(0o755)
    assert_ends(1, ["not GNU", "apt-get install parallel"], *debug(out), environment={"PATH": "%s:/usr/bin:/bin" % tmp_path})
    assert_ends(1, ["sbatch", "apt-get install slurm-client"], *debug(out), "--slurm", environment={"PATH": str(tmp_path)})


def test_folders_with_odd_names_and_relative_ones_will_do_and_single_values_are_those_of_all_seeds(tmp_path):
    out = tmp_path / "it's a \"sweep\" of 100%"
    values = ["--set", "mpc/epsilon=0.3", "--set", "model/encoder_widths=[30, 12]"]
    assert_ends(0, [], *debug(out.name, "7:8", 0), *values, folder=str(tmp_path))
    assert_table(str(out), [7], 0)
    config = read_yaml(seed_folder(str(out), 7), "config.yaml")
    assert (config["mpc"]["epsilon"], config["model"]["encoder_widths"]) == (0.3, [30, 12])


def test_predictions_are_collected_too(out):
    arguments = ["--program", "prediction_experiment", "--preset", "debug", "--seeds", "0:2", "--out", out,
                 "--set", "training/max_iterations=5"]
    assert_ends(0, ["prediction_experiment", "2 of 2 seeds finished"], *arguments)
    rows = read_rows(out, "sweep.csv")
    assert rows[0][:3] == ["seed", "steps", "num_predictions"]
    assert [row[:2] for row in rows[1:]] == [[str(seed), str(k)] for seed in (0, 1) for k in range(1, 9)]
    assert_ends(0, ["0 of 2 seeds to run"], *arguments)


def test_an_interruption_within_a_destructor_ends_the_program(capsys):
    class Handle:  # like subprocess.Popen, in whose destructor Python drops exceptions
        def __del__(self):
            os.kill(os.getpid(), signal.SIGINT)
            self.ended = True  # the handler runs before this statement

    def work():
        handle = Handle()
        del handle
        wait_for(lambda: False, "the signal")

    assert run_program("sweep", work) == 128 + signal.SIGINT
    assert capsys.readouterr().err == "sweep: interrupted by SIGINT\n"
