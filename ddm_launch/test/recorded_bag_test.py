#!/usr/bin/python3
# A JPEG camera of 30 Hz and torques of 50 Hz, recorded by rosbag record: 300 frames train a model that reaches the goal.
# SPDX-License-Identifier: BSD-3-Clause
import io
import os
import random
import re
import subprocess
import sys
import threading

from PIL import Image
import rospy
import rosunit
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Float64

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import pages  # noqa: E402
from processes import Process, call, find_program, roslaunch, run_experiment  # noqa: E402
from run_files import read_rows  # noqa: E402
from scratch_case import ScratchCase  # noqa: E402

DT, NUM_FRAMES = 0.2, 300
CAMERA_HZ, MOTOR_HZ, TICK_HZ = 30, 50, 150
HELD_S = 3 * DT
IMAGE_TOPIC, TORQUE_TOPIC = "eye/image_raw/compressed", "motor/command"
PRESET = os.path.join(pages.CHECKOUT, "ddm_launch", "config", "presets", "efficient.yaml")


def random_torques():
    """One for each image of the camera [N m]."""
    rng = random.Random(1)
    num_images, held = NUM_FRAMES * round(DT * CAMERA_HZ) + 1, round(HELD_S * CAMERA_HZ)
    changes = [rng.uniform(-6.0, 6.0) for _ in range(num_images // held + 1)]
    return [changes[image // held] for image in range(num_images)]


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

    def record(self, images, torques):
        """Plays both in real time while rosbag records. Returns the bag's path."""
        camera = rospy.Publisher(IMAGE_TOPIC, CompressedImage, queue_size=10)
        motor = rospy.Publisher(TORQUE_TOPIC, Float64, queue_size=10)
        path = self.file("robot.bag")
        recorder = Process([find_program("record", "rosbag"), "-O", path, "/" + IMAGE_TOPIC, "/" + TORQUE_TOPIC])
        self.addCleanup(recorder.stop)
        listening = threading.Event()
        watch = rospy.Timer(rospy.Duration(0.05), lambda _: listening.set() if min(
            camera.get_num_connections(), motor.get_num_connections()) > 0 else None)
        self.assertTrue(listening.wait(20.0), recorder.output)
        watch.shutdown()
        images_every, torques_every = TICK_HZ // CAMERA_HZ, TICK_HZ // MOTOR_HZ
        start = rospy.get_time()
        for tick in range(len(images) * images_every):
            image, due = tick // images_every, start + tick / TICK_HZ
            rospy.sleep(max(0.0, due - rospy.get_time()))  # a camera keeps its times, whatever else runs
            if tick % images_every == 0:
                message = CompressedImage(format="jpeg", data=images[image])
                message.header.stamp = rospy.Time.from_sec(due)
                camera.publish(message)
            if tick % torques_every == 0:
                motor.publish(torques[image])
        recorder.stop()
        self.assertTrue(os.path.exists(path), recorder.output)
        return path

    def test_it_trains_a_model_that_passes_all_checks_and_reaches_the_goal(self):
        rospy.init_node("recorded_bag_test", disable_signals=True)
        torques = random_torques()
        bag = self.record(self.simulate(torques, "frames"), torques)
        goal = self.write("goal.jpg", "")
        with open(goal, "wb") as stream:
            stream.write(self.simulate([0.0], "goal", "--start", "3.141592653589793,0")[0])
        model = self.file("model.ddm")
        names = ["--image-topic", IMAGE_TOPIC, "--torque-topic", TORQUE_TOPIC, "--dt", str(DT)]
        code, output = call([find_program("train_from_bags", "ddm_model"), "--config", PRESET, *names, "--goal", goal,
                             "--seed", "1", "--out", model, bag])
        self.assertEqual(code, 0, output)
        num_frames = int(re.search(r"(?m)^frames: (\d+)$", output).group(1))
        self.assertIn(num_frames, range(290, 302), output)
        self.assertIn(int(re.search(r"(?m)^segments: (\d+)$", output).group(1)), range(1, 4), output)  # 1 where nobody is held up
        code, output = call([find_program("inspect", "ddm_model"), "--model", model, *names, "--out", self.file("report"), bag])
        self.assertEqual(code, 0, output)
        self.assertIn("checks passed", output)
        self.assertNotIn("FAILED", output)
        code, output = call([find_program("evaluate"), "--preset", "efficient", "--plant", "pendulum",
                             "--model", model, "--seeds", "0:5", "--out", self.out])
        self.assertEqual(code, 0, output)
        rows = read_rows(self.out, "evaluation.csv")
        successes = [row[rows[0].index("success")] for row in rows[1:]]
        self.assertGreaterEqual(successes.count("1"), 4, rows)
        names = self.write("names.yaml", "data_set: {image_topic: %s, torque_topic: %s, dt: %s}\n" % (
            IMAGE_TOPIC, TORQUE_TOPIC, DT))
        self.assertLearnedFurther(model, bag, names, num_frames)
        self.assertReplayed(model, bag, names, num_frames)

    def assertLearnedFurther(self, model, bag, names, num_frames):
        code, output = run_experiment("--preset", "efficient", "--plant", "pendulum", "--seed", 1, "--trials", 0, "--config", names,
                                      "--model", model, "--bags", bag, "--out", self.file("further"))
        self.assertEqual(code, 0, output)
        rows = read_rows(self.file("further"), "trials.csv")
        self.assertEqual(int(rows[1][rows[0].index("frames")]), 100 + num_frames)

    def assertReplayed(self, model, bag, names, num_frames):
        table = self.file("replay.csv")
        code, output = roslaunch(self.file("ros"), "replay.launch", "bag:=" + bag, "model:=" + model, "config:=" + names,
                                 "preset:=efficient", "rate:=0", "out:=" + table, port=0)
        self.assertEqual(code, 0, output)
        self.assertEqual(len(read_rows(table)) - 1, num_frames, output)


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "recorded_bag", RecordedBagTest)
