# Figures: each is drawn from committed tables. The tests check the numbers and the invalid inputs.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil

import numpy as np
from PIL import Image
import pytest

from processes import output_of_main, run_experiment
from rooms import PACKAGE
from ddm_launch import figure, figure_style, film, learning_curve, success_rate
from ddm_launch.command import Failure
from ddm_launch.plant import draw_evaluation
from ddm_launch.run_folder import read_images, read_trials
from ddm_model.model import load
from ddm_study import study

RESULTS = os.path.join(PACKAGE, "results")
PUBLISHED = os.path.join(RESULTS, "published", "success_rate.csv")
HEADER = "seed,trial,frames,success,final_error\n"
SWEEP = HEADER + "0,0,100,0,90\n0,1,200,1,2\n1,0,100,1,3\n1,1,200,1,1\n2,0,100,0,50\n3,0,100,1,4\n"
# Arguments of each figure. Paths are relative to the committed results.
FIGURES = [
    (figure.main, "film_strip first_run --trial 3"),
    (figure.main, "learning_curve first_run"),
    (figure.main, "success_rate DDM=paper/trials.csv oracle=paper/oracle/trials.csv --published published/success_rate.csv"),
    (figure.main, "success_rate efficient=efficient/trials.csv --wilson"),
    (study.main, "figure angle_trajectories paper/angle_trajectories.csv"),
    (study.main, "figure feature_plane joint=paper/tile sequential=paper/tile_predictions/sequential"),
    (study.main, "figure pendulum_feature_space paper/pendulum/feature_space.csv --model paper/pendulum/model.ddm"),
    (study.main, "figure prediction_strip paper/tile"),
    (study.main, "figure task efficient/tasks/suite_pendulum/trials.csv --task suite_pendulum")]


@pytest.fixture(name="sweep")
def write_sweep(tmp_path):
    (tmp_path / "sweep.csv").write_text(SWEEP)
    return str(tmp_path / "sweep.csv")


@pytest.mark.parametrize("main, words", FIGURES)
def test_each_figure_is_drawn_from_committed_results(main, words, tmp_path, monkeypatch):
    monkeypatch.chdir(RESULTS)
    out = tmp_path / "figure.png"
    output_of_main(main, words.split() + ["--out", out], words=["wrote %s" % out])
    with Image.open(str(out)) as image:
        assert len(set(image.convert("L").tobytes())) > 10  # not blank


@pytest.mark.parametrize("words, parts", [
    (["success_rate", "x=missing.csv"], ["missing.csv cannot be read", "sweep.csv"]),
    (["success_rate", "x=/dev/null"], ["/dev/null cannot be read"]),
    (["success_rate", "x=SWEEP", "--published", "no.csv"], ["no.csv", "results/published/success_rate.csv"]),
    (["film_strip", "."], ["trials.csv cannot be read"])])
def test_what_cannot_be_drawn_is_refused_and_nothing_is_written(words, parts, sweep, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    output_of_main(figure.main, [word.replace("SWEEP", sweep) for word in words] + ["--out", "figure.png"], code=1, words=parts)
    assert not (tmp_path / "figure.png").exists()


@pytest.mark.parametrize("word", ["sweep.csv", "=sweep.csv", "mine="])
def test_a_curve_without_label_or_file_is_refused(word):
    output_of_main(figure.main, ["success_rate", word], code=2, words=["must be LABEL=PATH, got '%s'" % word])


def test_a_curve_is_the_rate_over_all_seeds_of_a_file(sweep):
    curve = success_rate.read_curve("mine", sweep)
    assert (curve.label, curve.rates.rate.to_dict()) == ("mine (4 seeds)", {100: 0.5, 200: 1.0})
    assert curve.rates.high[100] - curve.rates.rate[100] == pytest.approx((0.25 / 3.0) ** 0.5)
    assert success_rate.read_curve("mine", sweep, wilson=True).rates.low[200] == pytest.approx(1.0 / (1.0 + 1.959964 ** 2 / 2.0))


def test_the_published_curve_is_the_papers():
    paper, *others = success_rate.read_published(PUBLISHED)
    assert list(paper.rates.index) == [100.0 * k for k in range(16)]
    assert list(paper.rates.rate.loc[[100, 200, 300, 1500]]) == [0.08, 0.22, 0.5, 0.86]
    np.testing.assert_allclose(paper.rates.high - paper.rates.rate, (paper.rates.rate * (1.0 - paper.rates.rate) / 49.0) ** 0.5,
                               atol=1e-5)  # 50 seeds
    assert [curve.rates.rate[100] for curve in others] == [0.91, 0.0, 0.0]


@pytest.mark.parametrize("rows, part", [("7,0,100,0,90\n7,0,100,1,2\n", "seed 7, trial 0"), ("7,0,100,,\n", "not known"),
                                        ("7,0,100,maybe,1\n", "maybe"), ("", "no row")])
def test_tables_that_say_nothing_of_success_are_refused(rows, part, tmp_path):
    (tmp_path / "trials.csv").write_text(HEADER + rows)
    with pytest.raises(Failure, match=part):
        success_rate.read_curve("x", str(tmp_path / "trials.csv"))


def test_errors_are_in_the_unit_of_the_run_and_a_run_must_tell_its_goal(tmp_path):
    (tmp_path / "trials.csv").write_text(HEADER + "0,0,100,1,-0.04\n")
    config = tmp_path / "config.yaml"
    with figure_style.new_figure(7.0, 4.2) as drawn:
        axes = drawn.subplots()
        learning_curve.draw_one(axes, read_trials(str(tmp_path / "trials.csv")), "m", 0.05)
        assert "[m]" in axes.get_ylabel()
        assert axes.lines[0].get_ydata().tolist() == [0.04]
    for text in ("goal: [\n", "plant: {dt: 0.1}\n", "goal: {tolerance: 0.05}\n", "7\n"):
        config.write_text(text)
        output_of_main(figure.main, ["learning_curve", tmp_path, "--out", tmp_path / "figure.png"], code=1, words=["config.yaml"])


@pytest.fixture(name="run", scope="module")
def make_run(tmp_path_factory):
    folder = str(tmp_path_factory.mktemp("film") / "run")
    run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--out", folder)
    return folder


def test_a_film_shows_evaluations_one_after_the_other_in_real_time(run, tmp_path):
    out = str(tmp_path / "film.webp")
    evaluations = [os.path.join(run, "evaluation_%03d" % trial) for trial in (0, 1)]
    output_of_main(figure.main, ["film", *evaluations, "--seconds", 2, "--out", out])
    durations = []
    with Image.open(out) as image:
        for frame in range(image.n_frames):
            image.seek(frame)
            image.load()
            durations.append(image.info["duration"])
    assert durations == 2 * (10 * [200] + [film.LAST_MS])


def test_what_a_film_expects_is_what_the_model_says_a_second_before(run):
    now, steps = 20, 5
    clip = film.read_clip(os.path.join(run, "evaluation_001"))
    assert clip.title == "pendulum, after 60 images (12 s)"
    model = load(os.path.join(run, "trial_001", "model.ddm"))
    episode = draw_evaluation(run, 1, with_views=True)
    images, torques = episode.images, episode.torques
    assert len(episode.views) == len(images) == len(torques)
    # each prediction starts from two images and looks one second ahead
    assert list(torques) == ["torque_nm"] and clip.expected[:1 + steps] == (1 + steps) * [None]
    then = now - steps
    ahead = model.roll_out(model.encode(images[then - 1:then + 1]), torques.values[then - 1:now])
    known = read_images(run, 1, model.image_size)
    assert len(known) == 60
    nearest = np.argmin(np.linalg.norm(model.encode(known) - ahead[-1], axis=1))
    np.testing.assert_array_equal(clip.expected[now], known[nearest])
    assert len(clip.paths[then]) == 1 + steps
    assert clip.support_states.shape == (len(model.support_states), 2)


def test_a_film_of_other_folders_is_refused_and_no_file_is_written(run, tmp_path):
    broken, lost = str(tmp_path / "broken"), str(tmp_path / "lost")
    shutil.copytree(run, broken)
    os.remove(os.path.join(broken, "trial_001", "model.ddm"))
    run_experiment("--preset", "debug", "--seed", 1, "--trials", 0, "--nuisance", "drops", "--out", lost)
    for words, part in (([run], "evaluation_NNN"), ([broken + "/evaluation_001"], "trial_001/model.ddm"),
                        ([lost + "/evaluation_000"], "lost frames"),
                        ([run + "/evaluation_000", "--out", str(tmp_path / "film.png")], ".webp")):
        output_of_main(figure.main, ["film", "--out", tmp_path / "film.webp", *words], code=1, words=[part])
    assert not os.path.exists(str(tmp_path / "film.webp"))


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
