# prediction_experiment: measures how well a model predicts held-out images (paper, Sec. 4.1).
# SPDX-License-Identifier: BSD-3-Clause
import os
import subprocess
import time

import numpy as np
import pandas
import yaml

import ddm_model
import ddm_mpc
import ddm_sim
from ddm_launch.command import BadOptions, Failure, find_program, number, program_parser, run_program
from ddm_launch.plant import Joints
from ddm_launch.run_folder import differences, read_yaml
from ddm_model.plain_file import write_file

ABOUT = """\
Records one long random trial of 601 samples, trains on the first 501 and predicts the rest, 1 to 8 steps ahead. Writes
config.yaml, model.ddm, predictions.csv (errors by steps ahead), features.csv (of every image), strip.csv (one prediction,
step by step) and, last, summary.yaml. Takes all options of `experiment_node resolve`, such as --preset, --plant and --set."""
NUM_TRAINING, NUM_HELD_OUT = 501, 100  # the paper has 601 samples in total
MAX_STEPS = 8  # longest prediction [steps]


def configuration(words, seed):
    """The configuration that these options make up, as YAML. Raises BadOptions."""
    done = subprocess.run([find_program("experiment_node"), "resolve", *words, "--set", "experiment/seed=%d" % seed],
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
    if done.returncode != 0:
        raise BadOptions(done.stderr.strip())
    return done.stdout


def record(env, controller, seed):
    """Records a trial with random torques. Returns (images [N x size x size], torques [N x m], true states)."""
    image, info = env.reset(seed=seed)
    controller.reset(seed=seed)
    images, torques, states = [], [], []
    for _ in range(NUM_TRAINING + NUM_HELD_OUT):
        images.append(image)
        states.append(info["state"])
        torques.append(controller.act(image, explore=True))
        image, _, _, _, info = env.step(torques[-1])
    return np.array(images), np.array(torques), np.array(states)


def rollouts(model, features, torques):
    """Predicts MAX_STEPS steps from each held-out image that has enough others before and after it. Returns (indices of
    these images [S], features of these images and predicted features [S x MAX_STEPS + 1 x d])."""
    n = model.options["order"]
    starts = np.arange(n - 1, NUM_HELD_OUT - MAX_STEPS)
    ahead = [model.roll_out(features[now - n + 1:now + 1], torques[now - n + 1:now + MAX_STEPS]) for now in starts]
    return starts, np.concatenate([features[starts, None], ahead], axis=1)


def rmse(images, truth):
    """Error over all pixels of all images [grey]."""
    squares = np.sum((images - truth.astype(float)) ** 2, axis=(1, 2)) / 255.0 ** 2
    return np.sqrt(np.cumsum(squares)[-1] / images.size)  # cumsum always adds in this order


def monomials(x):
    """Monomials up to degree two of each sample: [1, x_i, x_i x_j (i <= j)]."""
    return np.hstack([np.ones((len(x), 1)), x, *(x[:, i:i + 1] * x[:, i:] for i in range(x.shape[1]))])


def position_r2(features, positions):
    """Measures how well the features determine the position, up to a quadratic map that is fitted to the training
    samples. The result is computed on the held-out samples; 1 is perfect:

      R^2 = 1 - sum |y - fit(x)|^2 / sum |y - mean(y)|^2
    """
    fit = np.linalg.lstsq(monomials(features[:NUM_TRAINING]), positions[:NUM_TRAINING], rcond=None)[0]
    held_out = positions[NUM_TRAINING:]
    errors = held_out - monomials(features[NUM_TRAINING:]) @ fit
    return 1.0 - np.sum(errors ** 2) / np.sum((held_out - held_out.mean(axis=0)) ** 2)


def positions_of(states, units):
    """Positions of all joints, with sine and cosine in place of an angle."""
    columns = [(np.sin(q), np.cos(q)) if unit == "rad" else (q,) for unit, q in zip(units, states.T)]
    return np.stack([column for of_joint in columns for column in of_joint], axis=1)


def make_environment(blocks):
    """Raises BadOptions if the environment loses images, or if its images are not those that the model learns from."""
    env = ddm_sim.make(blocks["experiment"]["plant"], plant=blocks["plant"], camera=blocks["camera"])
    for key, value, wanted in (("camera/drop_rate", blocks["camera"]["drop_rate"], 0.0),
                               ("image/size", blocks["image"]["size"], env.observation_space.shape[0])):
        if value != wanted:
            raise BadOptions("%s must be %g in this experiment, got %g" % (key, wanted, value))
    return env


def measure(blocks, env):
    """Runs the experiment. Returns (model, {file name: table})."""
    names, seed = blocks["experiment"], blocks["experiment"]["seed"]
    joints = Joints(names["plant"])
    controller = ddm_mpc.Controller(None, names["preset"], env, mpc=blocks["mpc"])
    images, torques, states = record(env, controller, seed)
    begin = time.monotonic()
    model = ddm_model.train([(images[:NUM_TRAINING], torques[:NUM_TRAINING])], None, names["preset"], env, seed=seed,
                            **{name: blocks[name] for name in ("image", "model", "training", "data_set")})
    train_s = time.monotonic() - begin
    features, held_out = model.encode(images), images[NUM_TRAINING:]
    starts, paths = rollouts(model, features[NUM_TRAINING:], torques[NUM_TRAINING:])
    feature_names = ["z_%d" % (i + 1) for i in range(features.shape[1])]
    predictions = pandas.DataFrame([{
        "seed": seed, "steps": k, "num_predictions": len(starts), "rmse": rmse(model.decode(paths[:, k]), held_out[starts + k]),
        "rmse_repeat": rmse(held_out[starts], held_out[starts + k])} for k in range(1, MAX_STEPS + 1)])
    predictions = predictions.assign(position_r2=position_r2(features, positions_of(states, joints.units)),
                                     v_r=model.info["v_r"], v_p=model.info["v_p"], train_s=train_s)
    all_features = pandas.DataFrame(np.hstack([states, features]), columns=joints.facts["state"] + feature_names)
    all_features.insert(0, "set", ["training"] * NUM_TRAINING + ["held_out"] * NUM_HELD_OUT)
    middle = len(starts) // 2
    true_states = states[NUM_TRAINING + starts[middle]:][:MAX_STEPS + 1]
    strip = pandas.DataFrame(np.hstack([true_states, paths[middle]]), columns=joints.facts["state"] + feature_names)
    return model, {"features.csv": all_features.rename_axis("frame"), "strip.csv": strip.rename_axis("steps"),
                   "predictions.csv": predictions.set_index("seed")}


def work(options, words):
    config = configuration(words, options.seed)
    blocks, path = yaml.safe_load(config), os.path.join(options.out, "config.yaml")
    env = make_environment(blocks)
    os.makedirs(options.out, exist_ok=True)
    found = differences(read_yaml(path), blocks) if os.path.exists(path) else []
    if found:
        raise Failure("the folder %s holds another experiment, use another folder:\n - %s" % (options.out, "\n - ".join(found)))
    write_file(path, config)
    model, tables = measure(blocks, env)
    model.save(os.path.join(options.out, "model.ddm"))
    for name, table in tables.items():
        write_file(os.path.join(options.out, name), table.to_csv())
    last = tables["predictions.csv"].iloc[-1]
    summary = {"finished": True, "plant": blocks["experiment"]["plant"], "seed": options.seed,
               "schedule": blocks["training"]["schedule"],
               **{name: float(last[name]) for name in ("rmse", "rmse_repeat", "position_r2", "train_s")}}
    write_file(os.path.join(options.out, "summary.yaml"), yaml.safe_dump(summary, sort_keys=False))
    print("%sresults, up to %d steps ahead: %s" % (yaml.safe_dump(summary, sort_keys=False), MAX_STEPS, options.out))


def main():
    parser = program_parser("prediction_experiment", ABOUT, allow_abbrev=False)
    parser.add_argument("--seed", type=number(int, 0), default=0, help="fixes every random draw; default %(default)s")
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for the results")
    options, words = parser.parse_known_args()
    return run_program("prediction_experiment", lambda: work(options, words))
