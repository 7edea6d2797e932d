# feature_space: writes the features of all images of an experiment and the plan at one step.
# SPDX-License-Identifier: BSD-3-Clause
import os

import numpy as np
import pandas

import ddm_model
import ddm_mpc
import ddm_sim
from ddm_launch.command import Failure, number, program_parser, run_program
from ddm_launch.run_folder import read_images, read_torques, read_yaml
from ddm_model.plain_file import write_file

ABOUT = """\
Writes the features of a run: of all frames recorded up to a trial, and of one step of the greedy evaluation after it, with
the plan made there. The evaluation is run again from its seed and must give the torques that were recorded: use the machine
and build of the run."""
EPILOG = "Output: kind,step,z_1,z_2,... with kind experience, current, goal or plan"
TOLERANCE = 1e-9  # largest difference of a repeated torque [N m]


def plan_at(run, trial, step, model):
    """Repeats the evaluation after a trial up to a step. Returns (features of the plan made there, goal feature). Raises
    Failure if there is no such step or plan, or if the repeated torques differ from the recorded ones."""
    folder = os.path.join(run, "evaluation_%03d" % trial)
    path, recorded = os.path.join(folder, "torques.csv"), read_torques(folder).values
    blocks = read_yaml(run, "config.yaml")
    experiment = blocks["experiment"]
    if step >= len(recorded):
        raise Failure("--step must be less than the %d steps of %s, got %d" % (len(recorded), path, step))
    env = ddm_sim.make(experiment["plant"], plant=blocks["plant"], camera=blocks["camera"])
    controller = ddm_mpc.Controller(model, experiment["preset"], env, mpc=blocks["mpc"])
    image, info = env.reset(seed=experiment["seed"], options={"trial": trial, "evaluation": True})
    controller.reset(seed=experiment["seed"], trial=trial)
    controller.set_goal(info["goal_image"])
    for number_of_image in range(step + 1):
        torque = controller.act(image)
        if np.abs(torque - recorded[number_of_image]).max() > TOLERANCE:
            raise Failure("%s: the torque of step %d is another here: use the machine and build that made the run" % (
                path, number_of_image))
        if number_of_image < step:
            time_s = info["time"]
            image, _, _, _, info = env.step(torque)
            if info["time"] - time_s > 1.5 * env.dt:  # the camera has lost an image
                controller.start_segment()
    if controller.plan_features is None:
        raise Failure("%s: the plan of step %d has failed, so that it has no features: give another --step" % (path, step))
    return controller.plan_features, model.encode(info["goal_image"][None])


def work(options):
    model = ddm_model.Model.load(os.path.join(options.run, "trial_%03d" % options.trial, "model.ddm"))
    experience = model.encode(read_images(options.run, options.trial, model.image_size))
    plan, goal = plan_at(options.run, options.trial, options.step, model)
    names = ["z_%d" % (i + 1) for i in range(plan.shape[1])]
    parts = [pandas.DataFrame(features, columns=names).assign(kind=kind, step=np.arange(first, first + len(features)))
             for kind, first, features in (("experience", 0, experience), ("current", options.step, plan[:1]), ("goal", 0, goal),
                                           ("plan", options.step + 1, plan[1:]))]
    table = pandas.concat(parts)[["kind", "step", *names]]
    write_file(options.out, table.to_csv(index=False, float_format="%.17g"))
    print("wrote %s" % options.out)


def main():
    parser = program_parser("feature_space", ABOUT, EPILOG)
    parser.add_argument("run", metavar="RUN_DIR", help="run folder")
    parser.add_argument("--trial", type=number(int, 0), required=True, metavar="K",
                        help="the model trained after this trial, and its greedy evaluation")
    parser.add_argument("--step", type=number(int, 0), required=True, metavar="S",
                        help="step of the evaluation whose plan is wanted, from 0")
    parser.add_argument("--out", required=True, metavar="FILE.csv", help="CSV file to write")
    options = parser.parse_args()
    return run_program("feature_space", lambda: work(options))
