# A robot with one camera, without ROS: limits, a random trial with small torques, training, predictions, then control.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import signal
import time

import cv2
import numpy as np

import ddm_model
import ddm_mpc

NUM_STEPS = 100  # images in a trial

def send_torque(torque):
    """Fill this in: send the torque of each motor [N m]. Zeros stop the motors. The driver must also stop them by itself
    if no torque arrives for some time."""


def run_trial(camera, controller, args):
    """Returns images [T, H, W] and torques [T, m]. Sends zeros at the end, whatever happens."""
    images, torques = [], []
    try:
        for step in range(NUM_STEPS):
            if args.camera.isdigit():
                camera.grab()  # drops the image that the driver has kept since the last step
            seen, image = camera.read()  # the first image may take seconds
            end = time.monotonic() + args.dt  # of this step
            if not seen:
                raise RuntimeError("the camera gave no image in step %d: check its cable" % step)
            images.append(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY))
            torques.append(controller.act(images[-1]))
            send_torque(torques[-1])
            time.sleep(max(0.0, end - time.monotonic()))
    finally:
        send_torque(np.zeros(len(args.limit)))
    return np.array(images), np.array(torques)


def main():
    parser = argparse.ArgumentParser(description="Run it without --act, look at predictions.png, then run it with --act.")
    parser.add_argument("camera", help="number of the camera, or a video file")
    parser.add_argument("goal", help="image of the goal, taken by the same camera")
    parser.add_argument("--limit", type=float, nargs="+", default=[1.0], help="limit of each motor [N m]")
    parser.add_argument("--dt", type=float, default=0.2, help="time step [s]")
    parser.add_argument("--act", action="store_true", help="control the robot by the model robot.ddm")
    args = parser.parse_args()
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.default_int_handler)  # an exception as by Ctrl-C, so that the motors are stopped
    camera = cv2.VideoCapture(int(args.camera) if args.camera.isdigit() else args.camera)
    camera.set(cv2.CAP_PROP_BUFFERSIZE, 1)  # the driver would keep several images, which get old
    goal = cv2.imread(args.goal, cv2.IMREAD_GRAYSCALE)
    size = camera.get(cv2.CAP_PROP_FRAME_HEIGHT), camera.get(cv2.CAP_PROP_FRAME_WIDTH)
    if goal is None or goal.shape != size:
        parser.error("goal must be an image of %d x %d pixels, as the camera takes them, got %s of size %s" % (
            *size, args.goal, getattr(goal, "shape", "unknown")))
    if args.act:
        controller = ddm_mpc.Controller(ddm_model.Model.load("robot.ddm"), max_torque=args.limit, time_budget=0.5 * args.dt)
        return run_trial(camera, controller, args)
    images, torques = run_trial(camera, ddm_mpc.Controller(None, max_torque=[0.3 * limit for limit in args.limit]), args)
    model = ddm_model.train([(images, torques)], goal, max_torque=args.limit)
    model.save("robot.ddm")
    past = model.options["order"]
    predicted = model.decode(model.roll_out(model.encode(images[:past]), torques[:past + 9]))
    recorded = model.decode(model.encode(images[past:past + 10]))
    cv2.imwrite("predictions.png", np.vstack([np.hstack(recorded), np.hstack(predicted)]))


if __name__ == "__main__":
    main()
