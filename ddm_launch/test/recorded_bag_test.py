# Trains a model from a bag with JPEG images at 30 Hz and torques at 50 Hz: 300 samples suffice to reach the goal.
# SPDX-License-Identifier: BSD-3-Clause
import io
import os
import random
import re
import subprocess

from PIL import Image
import rosbag
import rospy
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Float64

from processes import find_program, output_of, roslaunch, run_experiment
from rooms import PRESETS
from run_files import read_rows

DT, NUM_FRAMES = 0.2, 300
CAMERA_HZ, MOTOR_HZ, TICK_HZ = 30, 50, 150
HELD_S = 3 * DT
START_S = 1.0e9
IMAGE_TOPIC, TORQUE_TOPIC = "eye/image_raw/compressed", "motor/command"
NAMES = ["--image-topic", IMAGE_TOPIC, "--torque-topic", TORQUE_TOPIC, "--dt", str(DT)]


def simulate(folder, torques, *options):
    """JPEG files of a simulated pendulum at the rate of the camera, one per torque."""
    folder.mkdir()
    (folder / "camera.yaml").write_text("plant: {dt: %.17g, image_size: 102}\n" % (1.0 / CAMERA_HZ))
    (folder / "torques.csv").write_text("torque_nm\n" + "".join("%r\n" % torque for torque in torques))
    with open(folder / "torques.csv") as stream:
        subprocess.run([find_program("simulate", "ddm_sim"), "--plant", "pendulum", "--config", folder / "camera.yaml", "--frames",
                        folder / "frames", *options], stdin=stream, stdout=subprocess.DEVNULL, check=True)
    images = []
    for name in sorted(os.listdir(folder / "frames"))[:len(torques)]:
        jpeg = io.BytesIO()
        Image.open(folder / "frames" / name).save(jpeg, "JPEG", quality=85)
        images.append(jpeg.getvalue())
    return images


def record(folder, path):
    """Records random torques, each held for a while. Messages arrive a few milliseconds after they were sent."""
    rng = random.Random(1)
    num_images, held = NUM_FRAMES * round(DT * CAMERA_HZ) + 1, round(HELD_S * CAMERA_HZ)
    changes = [rng.uniform(-6.0, 6.0) for _ in range(num_images // held + 1)]
    torques = [changes[image // held] for image in range(num_images)]
    images = simulate(folder, torques)
    with rosbag.Bag(path, "w") as bag:
        for tick in range(num_images * TICK_HZ // CAMERA_HZ):
            image, sent = tick * CAMERA_HZ // TICK_HZ, START_S + tick / TICK_HZ
            arrival = rospy.Time.from_sec(sent + rng.uniform(0.001, 0.004))
            if tick % (TICK_HZ // CAMERA_HZ) == 0:
                message = CompressedImage(format="jpeg", data=images[image])
                message.header.stamp = rospy.Time.from_sec(sent)
                bag.write("/" + IMAGE_TOPIC, message, arrival)
            if tick % (TICK_HZ // MOTOR_HZ) == 0:
                bag.write("/" + TORQUE_TOPIC, Float64(torques[image]), arrival)


def run(program, package, *arguments):
    return output_of([find_program(program, package), *arguments])


def test_it_trains_a_model_that_passes_all_checks_reaches_the_goal_learns_further_and_is_replayed(tmp_path):
    bag, model, goal = str(tmp_path / "robot.bag"), str(tmp_path / "model.ddm"), tmp_path / "goal.jpg"
    record(tmp_path / "recorded", bag)
    goal.write_bytes(simulate(tmp_path / "at_goal", [0.0], "--start", "3.141592653589793,0")[0])
    output = run("train_from_bags", "ddm_model", "--config", PRESETS + "/efficient.yaml", *NAMES, "--goal", goal, "--seed", "1",
                 "--out", model, bag)
    num_frames = int(re.search(r"(?m)^frames: (\d+)$", output).group(1))
    assert 298 <= num_frames <= 301 and re.search(r"(?m)^segments: 1$", output), output
    output = run("inspect", "ddm_model", "--model", model, *NAMES, "--out", tmp_path / "report", bag)
    assert "checks passed" in output and "FAILED" not in output
    run("evaluate", "ddm_launch", "--preset", "efficient", "--plant", "pendulum", "--model", model, "--seeds", "0:5", "--out",
        tmp_path / "evaluated")
    header, *rows = read_rows(tmp_path, "evaluated", "evaluation.csv")
    assert sum(row[header.index("success")] == "1" for row in rows) >= 4, rows

    names, table = tmp_path / "names.yaml", str(tmp_path / "replay.csv")
    names.write_text("data_set: {image_topic: %s, torque_topic: %s, dt: %s}\ntraining: {num_starts: 1, max_iterations: 20}\n" % (
        IMAGE_TOPIC, TORQUE_TOPIC, DT))
    run_experiment("--preset", "efficient", "--plant", "pendulum", "--seed", 1, "--trials", 0, "--config", names,
                   "--model", model, "--bags", bag, "--out", tmp_path / "further")
    header, row = read_rows(tmp_path, "further", "trials.csv")
    assert int(row[header.index("frames")]) == 100 + num_frames
    output = roslaunch(str(tmp_path / "ros"), "replay.launch", "bag:=" + bag, "model:=" + model, "config:=%s" % names,
                       "preset:=efficient", "rate:=0", "out:=" + table)
    assert len(read_rows(table)) - 1 == num_frames, output
