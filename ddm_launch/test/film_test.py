# The film: what it shows of a run that both programs made, how long, and what it refuses.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil

import numpy as np
from PIL import Image
import pytest

from ddm_launch import figure, film
from ddm_model.model import load
from processes import call_main, run_experiment

STEPS = 5  # a second of the pendulum


@pytest.fixture(name="run", scope="module")
def make_run(tmp_path_factory):
    folder = str(tmp_path_factory.mktemp("film") / "run")
    code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--out", folder)
    assert code == 0, output
    return folder


def test_evaluations_are_shown_one_after_the_other_in_real_time(run, tmp_path):
    out = str(tmp_path / "film.webp")
    evaluations = [os.path.join(run, "evaluation_%03d" % trial) for trial in (0, 1)]
    code, output = call_main(figure.main, ["film", *evaluations, "--seconds", "2", "--out", out])
    assert code == 0, output
    durations = []
    with Image.open(out) as picture:
        for frame in range(picture.n_frames):
            picture.seek(frame)
            picture.load()
            durations.append(picture.info["duration"])
    assert durations == 2 * (10 * [200] + [film.LAST_MS])


def test_what_was_expected_is_what_the_model_says_a_second_before(run):
    evaluation, now = os.path.join(run, "evaluation_001"), 20
    clip = film.read_clip(evaluation)
    assert clip.title == "pendulum, after 60 images (12 s)"
    model = load(os.path.join(run, "trial_001", "model.ddm"))
    images, torques = film.simulate(run, evaluation)
    assert clip.expected[:1 + STEPS] == (1 + STEPS) * [None]  # two images are needed, and a second
    then = now - STEPS
    ahead = model.roll_out(model.encode(images[then - 1:then + 1]), torques[then - 1:now])
    np.testing.assert_allclose(clip.expected[now], np.clip(255.0 * model.decode(ahead[-1:])[0], 0, 255))
    assert len(clip.paths[then]) == 1 + STEPS
    assert clip.support_states.shape == (len(model.support_states), 2)


def test_other_folders_and_files_are_refused(run, tmp_path):
    broken, lost = str(tmp_path / "broken"), str(tmp_path / "lost")
    shutil.copytree(run, broken)
    os.remove(os.path.join(broken, "trial_001", "model.ddm"))
    code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 0, "--nuisance", "drops", "--out", lost)
    assert code == 0, output
    for words, part in (([run], "evaluation_NNN"), ([broken + "/evaluation_001"], "trial_001/model.ddm"),
                        ([lost + "/evaluation_000"], "lost frames"),
                        ([run + "/evaluation_000", "--out", str(tmp_path / "film.png")], ".webp")):
        code, output = call_main(figure.main, ["film", "--out", str(tmp_path / "film.webp"), *words])
        assert code == 1 and part in output, output
    assert not os.path.exists(str(tmp_path / "film.webp"))
