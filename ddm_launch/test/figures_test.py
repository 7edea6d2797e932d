# Figures: each is drawn from committed tables; the numbers behind them, and what they refuse.
# SPDX-License-Identifier: BSD-3-Clause
import math
import os

from PIL import Image
import pytest

from processes import call_main  # noqa: F401  finds the packages that are not installed
from rooms import PACKAGE
from ddm_launch import figure, figure_style, film_strip, learning_curve, success_rate
from ddm_launch.command import Failure
from ddm_launch.run_folder import read_goal, read_trials
from ddm_study import program

RESULTS = os.path.join(PACKAGE, "results")
PUBLISHED = os.path.join(RESULTS, "published", "success_rate.csv")
HEADER = "seed,trial,frames,success,final_error\n"
SWEEP = HEADER + "0,0,100,0,90\n0,1,200,1,2\n1,0,100,1,3\n1,1,200,1,1\n2,0,100,0,50\n3,0,100,1,4\n"
# Of each figure, its words; paths are relative to the committed results.
FIGURES = [
    (figure.main, "film_strip first_run --trial 3"),
    (figure.main, "learning_curve first_run"),
    (figure.main, "success_rate DDM=paper/trials.csv oracle=paper/oracle/trials.csv --published published/success_rate.csv"),
    (figure.main, "success_rate efficient=efficient/trials.csv --wilson"),
    (program.main, "figure ablation efficient/ablation --reference efficient/ablation/preset/trials.csv"),
    (program.main, "figure angle_trajectories paper/angle_trajectories.csv"),
    (program.main, "figure feature_plane joint=paper/tile sequential=paper/tile_predictions/sequential"),
    (program.main, "figure nuisances efficient"),
    (program.main, "figure pendulum_feature_space paper/pendulum/feature_space.csv --model paper/pendulum/model.ddm"),
    (program.main, "figure prediction_strip paper/tile"),
    (program.main, "figure schedules paper"),
    (program.main, "figure task efficient/tasks/suite_pendulum/trials.csv --task suite_pendulum"),
    (program.main, "figure trajectory_distributions paper/trajectory_distributions.csv --seconds 3")]


@pytest.fixture(name="sweep")
def write_sweep(tmp_path):
    (tmp_path / "sweep.csv").write_text(SWEEP)
    return str(tmp_path / "sweep.csv")


@pytest.mark.parametrize("main, words", FIGURES)
def test_each_figure_is_drawn_from_committed_results(main, words, tmp_path, monkeypatch):
    monkeypatch.chdir(RESULTS)
    out = tmp_path / "figure.png"
    code, output = call_main(main, words.split() + ["--out", str(out)])
    assert (code, output.strip().split("\n")[-1]) == (0, "wrote %s" % out)
    with Image.open(str(out)) as picture:
        assert len(set(picture.convert("L").tobytes())) > 10  # not blank


def test_the_tests_draw_every_figure():
    drawn = {words.replace("figure ", "").split()[0] for _, words in FIGURES}
    assert drawn | {"film"} == set(figure.FIGURES) | set(program.FIGURES)  # film_test draws the film


@pytest.mark.parametrize("words, parts", [
    (["success_rate", "x=SWEEP", "x=SWEEP"], ["'x' twice"]),
    (["success_rate", "DDM=SWEEP", *("%d=SWEEP" % k for k in range(5))], ["at most 4 curves", "got 6"]),
    (["success_rate", "x=missing.csv"], ["missing.csv cannot be read", "sweep.csv"]),
    (["success_rate", "x=SWEEP", "--published", "no.csv"], ["no.csv", "results/published/success_rate.csv"]),
    (["learning_curve", "."], ["trials.csv cannot be read"]),
    (["film_strip", "."], ["trials.csv cannot be read"])])
def test_what_cannot_be_drawn_is_refused_and_nothing_is_written(words, parts, sweep, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, output = call_main(figure.main, [word.replace("SWEEP", sweep) for word in words] + ["--out", "figure.png"])
    assert code == 1
    assert all(part in output for part in parts), output
    assert not (tmp_path / "figure.png").exists()


@pytest.mark.parametrize("word", ["sweep.csv", "=sweep.csv", "mine="])
def test_a_curve_without_label_or_file_is_refused(word):
    code, output = call_main(figure.main, ["success_rate", word])
    assert code == 2 and "must be LABEL=FILE.csv, got '%s'" % word in output


def test_a_curve_is_the_rate_over_all_seeds_of_a_file(sweep):
    curve = success_rate.read_curve("mine", sweep)
    assert (curve.label, curve.frames, curve.rates) == ("mine (4 seeds)", [100, 200], [0.5, 1.0])
    assert curve.highs[0] - curve.rates[0] == pytest.approx((0.25 / 3.0) ** 0.5)
    curve = success_rate.read_curve("mine", sweep, wilson=True)
    assert curve.lows[0] + curve.highs[0] == pytest.approx(1.0)  # 2 of 4 seeds
    assert curve.lows[1] == pytest.approx(1.0 / (1.0 + 1.959964 ** 2 / 2.0))  # 2 of 2


def test_the_published_curve_is_the_papers():
    paper, *others = success_rate.read_published(PUBLISHED)
    assert paper.frames == [100.0 * k for k in range(16)]
    assert paper.rates[1:4] + paper.rates[-1:] == [0.08, 0.22, 0.5, 0.86]
    for rate, high in zip(paper.rates, paper.highs):  # 50 seeds
        assert high - rate == pytest.approx((rate * (1.0 - rate) / 49.0) ** 0.5, abs=1e-5)
    assert [curve.rates[1] for curve in others] == [0.91, 0.0, 0.0]


def test_without_learning_the_curve_is_level_and_what_is_mostly_zero_is_told_in_words():
    oracle = success_rate.Curve("oracle", "oracle (2 seeds)", [0], [0.5], None, None)._replace(lows=[0.4], highs=[0.6])
    assert success_rate.level_line(oracle, 1500)[2:] == ([0, 1500], [0.5, 0.5], [0.4, 0.4], [0.6, 0.6])
    for last, expected in ((0.4, True), (0.5, False)):
        slow = success_rate.Curve("slow", "slow (1 seed)", [1, 2, 3], [0.0, 0.0, last], None, None)
        assert success_rate.is_mostly_zero(slow) is expected
    assert success_rate.in_words(slow) == "slow (1 seed): mostly 0, at most 0.5"


@pytest.mark.parametrize("rows, part", [("7,0,100,0,90\n7,0,100,1,2\n", "seed 7, trial 0"), ("7,0,100,,\n", "not known"),
                                        ("7,0,100,maybe,1\n", "maybe"), ("", "no row")])
def test_tables_that_say_nothing_of_success_are_refused(rows, part, tmp_path):
    (tmp_path / "trials.csv").write_text(HEADER + rows)
    with pytest.raises(Failure, match=part):
        success_rate.read_curve("x", str(tmp_path / "trials.csv"))


def test_errors_are_in_the_unit_of_the_run_and_a_run_must_tell_its_goal(tmp_path):
    (tmp_path / "trials.csv").write_text(HEADER + "0,0,100,1,-0.04\n")
    config = tmp_path / "config.yaml"
    config.write_text("goal: {tolerance: 0.05, error_unit: m}\n")
    assert read_goal(str(tmp_path)) == ("m", 0.05)
    assert read_trials(str(tmp_path))[0].final_error == 0.04
    with figure_style.new_screen_figure(7.0, 4.2) as drawn:
        axes = drawn.subplots()
        learning_curve.draw_one(axes, read_trials(str(tmp_path)), read_goal(str(tmp_path)))
        assert "[m]" in axes.get_ylabel()
    for text in ("goal: [\n", "plant: {dt: 0.1}\n", "goal: {tolerance: 0.05}\n", "7\n"):
        config.write_text(text)
        with pytest.raises(Failure, match="config.yaml"):
            read_goal(str(tmp_path))


def test_the_film_strip_ends_a_little_after_the_target_is_reached_for_good():
    angles = [math.pi * min(1.0, k / 16.0) for k in range(100)]
    assert film_strip.swing_up_end(angles, math.pi, math.radians(10.0)) == 21  # within 10 degrees from step 16 on
    passing = angles[:30] + [1.0] + [-math.pi] * 69  # overshoots once, then stays: the arrival is step 31
    assert film_strip.swing_up_end(passing, math.pi, math.radians(10.0)) == 38
    assert film_strip.swing_up_end([0.01 * k for k in range(50)], math.pi, 0.1) == 49  # never arrives
    assert film_strip.steps_to_show(21, 100) == list(range(0, 23, 2))
    assert film_strip.steps_to_show(3, 4) == [0, 1, 2, 3]


def test_the_film_strip_shows_the_last_success_or_the_last_trial(tmp_path):
    for successes, expected in (("010", 1), ("000", 2)):
        (tmp_path / "trials.csv").write_text(HEADER + "".join(
            "0,%d,%d,%s,1\n" % (trial, 100 * trial + 100, success) for trial, success in enumerate(successes)))
        assert film_strip.default_trial(read_trials(str(tmp_path))) == expected


def test_the_same_figure_gives_the_same_bytes_and_only_a_png(tmp_path):
    for name in ("a.png", "b.png", "c.pdf"):
        with figure_style.new_figure(2.0, 1.0) as drawn:
            drawn.add_subplot().plot([0, 1], [0, 1])
            if name == "c.pdf":
                with pytest.raises(Failure, match=r"\.png.*c\.pdf"):
                    figure_style.save(drawn, str(tmp_path / name))
            else:
                figure_style.save(drawn, str(tmp_path / name))
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
