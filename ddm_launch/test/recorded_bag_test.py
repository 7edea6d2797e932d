# A bag of a JPEG camera of 30 Hz and torques of 50 Hz: its 300 frames train a model that reaches the goal.
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

import pages
from processes import call, find_program, roslaunch, run_experiment
from run_files import read_rows
from scratch_case import ScratchCase

DT, NUM_FRAMES = 0.2, 300
CAMERA_HZ, MOTOR_HZ, TICK_HZ = 30, 50, 150
HELD_S = 3 * DT
START_S = 1.0e9
IMAGE_TOPIC, TORQUE_TOPIC = "eye/image_raw/compressed", "motor/command"
PRESET = os.path.join(pages.CHECKOUT, "ddm_launch", "config", "presets", "efficient.yaml")
NAMES = ["--image-topic", IMAGE_TOPIC, "--torque-topic", TORQUE_TOPIC, "--dt", str(DT)]


class RecordedBagTest(ScratchCase):
    def simulate(self, torques, folder, *options):
        """JPEG files of a simulated pendulum at the camera's rate, one for each torque."""
        config = self.write("camera.yaml", "plant: {dt: %.17g, picture_size: 102}\n" % (1.0 / CAMERA_HZ))
        text = self.write("torques.csv", "torque_nm\n" + "".join("%r\n" % torque for torque in torques))
        frames = self.file(folder)
        with open(text) as stream:
            subprocess.run([find_program("simulate", "ddm_sim"), "--plant", "pendulum", "--config", config, "--frames",
                            frames, *options], stdin=stream, stdout=subprocess.DEVNULL, check=True)
        images = []
        for name in sorted(os.listdir(frames))[:len(torques)]:
            jpeg = io.BytesIO()
            Image.open(os.path.join(frames, name)).save(jpeg, "JPEG", quality=85)
            images.append(jpeg.getvalue())
        return images

    def record(self):
        """A bag of random torques, held for a while each, whose messages arrive a few milliseconds after they were sent."""
        rng = random.Random(1)
        num_images, held = NUM_FRAMES * round(DT * CAMERA_HZ) + 1, round(HELD_S * CAMERA_HZ)
        changes = [rng.uniform(-6.0, 6.0) for _ in range(num_images // held + 1)]
        torques = [changes[image // held] for image in range(num_images)]
        images = self.simulate(torques, "frames")
        path = self.file("robot.bag")
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
        return path

    def assertRuns(self, *command):
        code, output = call(command)
        self.assertEqual(code, 0, output)
        return output

    def test_it_trains_a_model_that_passes_all_checks_and_reaches_the_goal(self):
        bag, goal, model = self.record(), self.file("goal.jpg"), self.file("model.ddm")
        with open(goal, "wb") as stream:
            stream.write(self.simulate([0.0], "goal", "--start", "3.141592653589793,0")[0])
        output = self.assertRuns(find_program("train_from_bags", "ddm_model"), "--config", PRESET, *NAMES, "--goal", goal,
                                 "--seed", "1", "--out", model, bag)
        num_frames = int(re.search(r"(?m)^frames: (\d+)$", output).group(1))
        self.assertIn(num_frames, range(298, 302), output)
        self.assertRegex(output, r"(?m)^segments: 1$")
        output = self.assertRuns(find_program("inspect", "ddm_model"), "--model", model, *NAMES, "--out",
                                 self.file("report"), bag)
        self.assertIn("checks passed", output)
        self.assertNotIn("FAILED", output)
        self.assertRuns(find_program("evaluate"), "--preset", "efficient", "--plant", "pendulum", "--model", model,
                        "--seeds", "0:5", "--out", self.out)
        rows = read_rows(self.out, "evaluation.csv")
        successes = [row[rows[0].index("success")] for row in rows[1:]]
        self.assertGreaterEqual(successes.count("1"), 4, rows)
        self.assertLearnedFurtherAndReplayed(model, bag, num_frames)

    def assertLearnedFurtherAndReplayed(self, model, bag, num_frames):
        names = self.write("names.yaml", "data_set: {image_topic: %s, torque_topic: %s, dt: %s}\n"
                           "training: {num_starts: 1, max_iterations: 20}\n" % (IMAGE_TOPIC, TORQUE_TOPIC, DT))
        code, output = run_experiment("--preset", "efficient", "--plant", "pendulum", "--seed", 1, "--trials", 0, "--config", names,
                                      "--model", model, "--bags", bag, "--out", self.file("further"))
        self.assertEqual(code, 0, output)
        rows = read_rows(self.file("further"), "trials.csv")
        self.assertEqual(int(rows[1][rows[0].index("frames")]), 100 + num_frames)
        table = self.file("replay.csv")
        code, output = roslaunch(self.file("ros"), "replay.launch", "bag:=" + bag, "model:=" + model, "config:=" + names,
                                 "preset:=efficient", "rate:=0", "out:=" + table)
        self.assertEqual(code, 0, output)
        self.assertEqual(len(read_rows(table)) - 1, num_frames, output)
