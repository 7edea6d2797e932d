# Whether the bag of a trial in real time pairs an image with the torque that acted after it, or with none.
# SPDX-License-Identifier: BSD-3-Clause
import bisect

import rosbag

FEWEST = 5  # pairs that a bag must have, and images without a pair that a fault must have left


def verdict(bag_path, acted):
    """`learned what acted`, or what was seen instead. acted: (stamp of an image [ns], torque that acted before it) of all
    frames, in order."""
    stamps = [stamp for stamp, _ in acted]
    images, torques = set(), {}
    with rosbag.Bag(bag_path) as bag:
        for topic, message, _ in bag.read_messages(["camera/image_raw", "torque"]):
            if topic == "torque":
                torques[message.header.stamp.to_nsec()] = message.torque[0]
            else:
                images.add(message.header.stamp.to_nsec())
    pairs = images & set(torques)
    wrong = []
    for stamp in sorted(pairs):
        after = bisect.bisect_right(stamps, stamp)
        if after == len(stamps) or acted[after][1] != torques[stamp]:
            wrong.append(stamp)
    if wrong:
        return "%d of %d pairs have a torque that did not act" % (len(wrong), len(pairs))
    if len(pairs) < FEWEST:
        return "only %d pairs" % len(pairs)
    return "learned what acted" if pairs != images else "no image is without a torque"
