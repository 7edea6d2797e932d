# The surroundings of robot_node for tests: a camera, a controller, a motor and a user in one process.
# SPDX-License-Identifier: BSD-3-Clause
import os
import tempfile
import threading
import time
import unittest

from actionlib_msgs.msg import GoalID
from ddm_msgs.msg import RunTrialActionResult, Torque
from ddm_msgs.srv import Reset
import rospy
from sensor_msgs.msg import Image
from std_msgs.msg import Bool, Float64, Float64MultiArray, UInt32
from std_srvs.srv import SetBool, Trigger

from process import Process, find_program

LIMIT_S = 15.0
DT = 0.25
WIDTH, HEIGHT = 48, 40
CROP = [8, 0, 32, 32]


def wait_until(condition, what="the condition"):
    """Calls the condition until its result is true, and returns the result."""
    end = time.time() + LIMIT_S
    while time.time() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.005)
    raise AssertionError("%s did not come about within %g s" % (what, LIMIT_S))


def in_background(function, *arguments):
    """Calls a function in a thread. Returns a function that waits for the end of the call and returns its result."""
    box = []
    thread = threading.Thread(target=lambda: box.append(function(*arguments)), daemon=True)
    thread.start()

    def result():
        thread.join(LIMIT_S)
        if not box:
            raise AssertionError("no answer within %g s" % LIMIT_S)
        return box[0]

    return result


class Camera:
    """Publishes 30 images per second; the left half has the grey value `left`, the right half is black."""

    def __init__(self, topic):
        self.restore()
        self.shown_at = 0.0  # monotonic time of the last image
        self._ended = False
        self._lock = threading.Lock()
        self._publisher = rospy.Publisher(topic, Image, queue_size=2)
        self._thread = threading.Thread(target=self._show, daemon=True)
        self._thread.start()

    def restore(self):
        self.left, self.width, self.showing, self.age_s = 255, WIDTH, True, 0.0

    def end(self):
        self._ended = True
        self._thread.join()
        self._publisher.unregister()

    def _show(self):
        while not self._ended:
            with self._lock:
                if self.showing:
                    self.shown_at = time.monotonic()
                    self._publish(self.age_s)
            time.sleep(1.0 / 30.0)

    def _publish(self, age_s):
        image = Image(width=self.width, height=HEIGHT, step=3 * self.width, encoding="rgb8")
        image.header.stamp = rospy.Time.now() - rospy.Duration(age_s)
        image.data = bytes([self.left] * 3 * (WIDTH // 2) + [0] * 3 * (self.width - WIDTH // 2)) * HEIGHT
        self._publisher.publish(image)

    def end_with_image(self, age_s):
        """Publishes one more image and then none. Returns the monotonic time of the image before."""
        with self._lock:
            self.showing = False
            self._publish(age_s)
            return self.shown_at


class Listener:
    def __init__(self, topic, kind):
        self.messages = []
        self.times = []  # monotonic time of each arrival
        self._subscriber = rospy.Subscriber(topic, kind, self._take, queue_size=1000, tcp_nodelay=True)

    def _take(self, message):
        self.times.append(time.monotonic())
        self.messages.append(message)

    def end(self):
        self._subscriber.unregister()

    def connected(self):
        """Whether all connections are complete. rospy counts a connection before its header has arrived, and messages
        can be lost until then."""
        connections = self._subscriber.impl.connections
        return bool(connections) and all(connection.header for connection in connections)

    def next(self):
        """Waits for the next message and returns it."""
        seen = len(self.messages)
        wait_until(lambda: len(self.messages) > seen, "a message on " + self._subscriber.name)
        return self.messages[seen]


class Robot:
    """robot_node and its surroundings."""

    def __init__(self, num_motors, *arguments, started_by=(), **kwargs):
        self.camera = Camera("camera/source")
        self.images = Listener("camera/image_raw", Image)
        self.goals = Listener("goal_image", Image)
        self.efforts = (Listener("effort_command", Float64) if num_motors == 1 else
                        Listener("group_effort_command", Float64MultiArray))
        self.latencies = Listener("latency", Float64)
        self.applied = Listener("applied_torque", Torque)
        self.misses = Listener("deadline_misses", UInt32)
        self.cancels = Listener("run_trial/cancel", GoalID)
        self.enabled = Listener("motors_enabled", Bool)
        self.torques = rospy.Publisher("torque", Torque, queue_size=10, tcp_nodelay=True)
        self.trial_ends = rospy.Publisher("run_trial/result", RunTrialActionResult, queue_size=1)
        self.controller = None
        self.process = Process([*started_by, find_program("ddm_sim", "robot_node"), *arguments], **kwargs)
        rospy.wait_for_service("reset", LIMIT_S)
        wait_until(lambda: self.torques.get_num_connections() and self.trial_ends.get_num_connections(), "robot_node")
        for listener in self.listeners():  # otherwise a message that is sent once could be lost
            wait_until(listener.connected, "a connection of each topic")

    def end(self):
        """Ends the node and its surroundings, so that the next test can use the topics."""
        self.process.stop()
        self.camera.end()
        self.stopAnswering()
        self.torques.unregister()
        self.trial_ends.unregister()
        for listener in self.listeners():
            listener.end()

    def listeners(self):
        return (self.images, self.goals, self.efforts, self.applied, self.latencies, self.misses, self.cancels,
                self.enabled)

    def settle(self):
        """Ends the episode and restores everything that a test has changed."""
        self.stopAnswering()
        self.camera.restore()
        self.enable(False)
        # Motors that are switched off announce it, and cancel the trial. Both messages may still be on their way.
        wait_until(lambda: not self.enabled.messages[-1].data, "the end of the permission")
        enabled = [message.data for message in self.enabled.messages]
        num_ends = sum(before and not after for before, after in zip(enabled, enabled[1:]))
        wait_until(lambda: len(self.cancels.times) >= num_ends, "the cancelled trial")
        del self.cancels.messages[:]
        self.images.next()

    def enable(self, on):
        return rospy.ServiceProxy("enable", SetBool)(on)

    @staticmethod
    def takeGoal():
        return rospy.ServiceProxy("take_goal", Trigger)()

    @staticmethod
    def resetDone():
        return rospy.ServiceProxy("reset_done", Trigger)()

    @staticmethod
    def reset():
        """Calls the service reset in a thread. Returns a function that waits for the answer."""
        return in_background(rospy.ServiceProxy("reset", Reset))

    def answer(self, *torque, delay_s=0.0):
        """Publishes a torque for the next image. Returns the stamp of the image."""
        now = rospy.Time.now()  # an image from before the motors were enabled may still arrive
        image = wait_until(lambda: next((each for each in self.images.messages if each.header.stamp > now), None), "an image")
        time.sleep(delay_s)
        self.publishTorque(image, *torque)
        return image.header.stamp

    def appliedAt(self, stamp):
        """Returns the applied torque of an image."""
        def found():
            return [message for message in self.applied.messages if message.header.stamp == stamp]
        return list(wait_until(found, "what acted")[0].torque)

    def answerAll(self, torque):
        """Publishes this torque for each image from now on."""
        self.controller = rospy.Subscriber("camera/image_raw", Image, lambda image: self.publishTorque(image, torque), tcp_nodelay=True)

    def stopAnswering(self):
        if self.controller is not None:
            self.controller.unregister()
        self.controller = None

    def publishTorque(self, image, *torque):
        message = Torque(torque=list(torque))
        message.header.stamp = image.header.stamp
        self.torques.publish(message)

    def waitForEffort(self, effort):
        """Waits for a new message with this effort: a number, or a tuple for several motors."""
        seen = len(self.efforts.messages)
        try:
            wait_until(lambda: any(message.data == effort for message in self.efforts.messages[seen:]),
                       "effort %s" % (effort,))
        except AssertionError as e:
            raise AssertionError("%s; robot_node says:\n%s" % (e, self.process.output))

    def effort(self):
        """Returns the effort in the next message."""
        return self.efforts.next().data

    def numMisses(self):
        return self.misses.messages[-1].data


def start_robot(*arguments, dt=DT, max_torque=4.0, robot=None, **kwargs):
    """Starts a robot_node with its surroundings; `robot` contains the parameters that are lists."""
    if rospy.has_param("/robot_node"):
        rospy.delete_param("/robot_node")
    rospy.set_param("/robot_node/robot", dict(robot or {}, dt=dt, max_torque=max_torque, crop=CROP))
    num_motors = len(max_torque) if isinstance(max_torque, list) else 1
    return Robot(num_motors, "_image/size:=4", *arguments, **kwargs)


class RobotCase(unittest.TestCase):
    """Base class of tests that start a robot_node of their own."""

    def file(self, name):
        """Returns a path in a temporary folder of this test."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        return os.path.join(folder.name, name)

    def start(self, *arguments, **kwargs):
        """Starts a robot_node that ends with the test."""
        robot = start_robot(*arguments, **kwargs)
        self.addCleanup(robot.end)
        return robot


class SharedRobotCase(unittest.TestCase):
    """Base class of tests that share a robot_node. Each test begins with a working camera and with the motors off."""
    ROBOT = {}  # parameters of the block robot

    @classmethod
    def setUpClass(cls):
        cls.robot = start_robot(robot=cls.ROBOT)
        cls.addClassCleanup(cls.robot.end)

    def setUp(self):
        self.robot.settle()

    def enterTrial(self, torque=2.0):
        self.follow(torque)  # on a busy machine the first torque may be late
        del self.robot.cancels.messages[:]  # on a busy machine the trial may have begun more than once
        self.robot.stopAnswering()

    def assertNotEnabled(self, *words):
        refused = self.robot.enable(True)
        self.assertFalse(refused.success)
        for word in words:
            self.assertIn(word, refused.message)

    def follow(self, torque=2.0):
        """Enables the motors, and publishes this torque for each image from now on."""
        wait_until(lambda: self.robot.enable(True).success, "permission")
        self.robot.answerAll(torque)
        self.robot.waitForEffort(torque)

    def assertCancelled(self):
        wait_until(lambda: self.robot.cancels.messages, "the trial is cancelled")
