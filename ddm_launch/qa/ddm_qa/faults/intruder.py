# A second publisher where one is due, as a process of its own; its standard input says when.
# SPDX-License-Identifier: BSD-3-Clause
import sys
import time

import ddm_launch  # noqa: F401  (mends rospy for Python 3.9)
from ddm_msgs.msg import Model, Torque
import rosgraph
import rospy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image

SIZE = 51
# The plant's torques are behind fault_injector: on a robot both names are one topic.
TOPICS = {"torque": ["torque", "plant/torque"], "image": ["camera/image_raw"], "model": ["model"], "clock": ["/clock"]}


def message_for(what, stamp):
    """Looks like the true one, with other content."""
    if what == "clock":
        return Clock(clock=stamp + rospy.Duration(1000.0))
    if what == "model":
        message = Model(id="00000000", data=b"no model at all")
    elif what == "torque":
        message = Torque(torque=[6.0])
    else:
        message = Image(width=SIZE, height=SIZE, encoding="mono8", step=SIZE, data=bytes(SIZE * SIZE))
    message.header.stamp = stamp
    return message


def subscribers_of(topic):
    _, subscribers, _ = rosgraph.Master(rospy.get_name()).getSystemState()
    return len(dict(subscribers).get(rospy.resolve_name(topic), []))


def main():
    what = sys.argv[1]
    rospy.init_node("intruder", disable_signals=True)
    stamps = []
    rospy.Subscriber("plant/image_raw", Image, lambda image: stamps.append(image.header.stamp), queue_size=1)
    print("ready", flush=True)
    sys.stdin.readline()
    message = message_for(what, stamps[-1])
    publishers = {topic: rospy.Publisher(topic, type(message), queue_size=1) for topic in TOPICS[what]}
    for topic, publisher in publishers.items():
        while publisher.get_num_connections() < subscribers_of(topic):
            time.sleep(0.01)
    # Only when every subscriber sees two publishers: fault_injector passes torques on, and the plant would take them.
    for publisher in publishers.values():
        publisher.publish(message)
    print("intruder is there", flush=True)
    sys.stdin.readline()  # stays to the end


if __name__ == "__main__":
    main()
