# Faults that change the messages of a topic.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import copy
import time

import rospy

# Changed fields of an altered image, torque or joint state.
ALTERED = {
    "nan": lambda torque: {"torque": [float("nan")]}, "inf": lambda torque: {"torque": [float("inf")]},
    "1e300": lambda torque: {"torque": [1e300]}, "none": lambda torque: {"torque": []},
    "twice": lambda torque: {"torque": list(torque.torque) * 2},
    "size": lambda image: dict(dict.fromkeys(("width", "height", "step"), image.width // 2),
                               data=image.data[:(image.width // 2) ** 2]),
    "encoding": lambda image: {"encoding": "rgb8", "step": 3 * image.step, "data": 3 * image.data},
    "unknown": lambda image: {"encoding": "smell"},
    "cut": lambda image: {"data": image.data[:len(image.data) // 2]},
    "unstamped": lambda image: {"header": type(image.header)(frame_id=image.header.frame_id)},
    "upper half": lambda image: {"height": image.height // 2, "data": image.data[:image.step * (image.height // 2)]},
    "position": lambda joints: {"position": [1.0e4]}, "speed": lambda joints: {"velocity": [1.0e4]}}


def altered(message, how):
    result = copy.deepcopy(message)
    for field, value in ALTERED[how](message).items():
        setattr(result, field, value)
    return result


def shifted(message, seconds):
    result = copy.deepcopy(message)
    result.header.stamp += rospy.Duration(seconds)
    return result


def late(message):
    time.sleep(1.0)
    return [message]


# messages: function that returns the messages to relay in place of a message, from the message, its predecessor and the
# last word of the fault. lasts: time during which messages are changed [s]; 0: one message. topic: changed topic; None:
# the second word of the fault.
Change = collections.namedtuple("Change", "messages lasts topic")
CHANGES = {
    "drop": Change(lambda message, before, how: [], 0, None),
    "double": Change(lambda message, before, how: [message, message], 0, None),
    "late": Change(lambda message, before, how: late(message), 0, None),
    "repeat": Change(lambda message, before, how: [before, message], 0, None),
    "alter": Change(lambda message, before, how: [altered(message, how)], 0, None),
    "mute": Change(lambda message, before, how: [], float("inf"), None),
    # Faults on a robot.
    "future": Change(lambda message, before, how: [shifted(message, 3600.0)], 0, None),  # no further image follows
    "set": Change(lambda message, before, how: [shifted(message, 3600.0 if how == "forward" else -3600.0)], 1.5, "image"),
    "resize": Change(lambda message, before, how: [altered(message, "upper half")], float("inf"), None),
    "age": Change(lambda message, before, how: [shifted(message, -2.0)], 1.5, None),
    "exceed": Change(lambda message, before, how: [altered(message, how)], 0, "joints")}
