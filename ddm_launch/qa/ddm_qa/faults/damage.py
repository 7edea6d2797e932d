# Damage to the files of a run folder that nobody is using.
# SPDX-License-Identifier: BSD-3-Clause
import os
import struct

# Kinds of records in a bag, by the field `op` of their headers.
RECORDS = {"header": 3, "index": 4, "chunk": 5, "chunk_info": 6, "connection": 7}
VERSION_LINE = b"#ROSBAG V2.0\n"


def find_record(data, name):
    """(begin, end) of the first record of a kind in a bag."""
    if name == "version":
        return 0, len(VERSION_LINE)
    begin = len(VERSION_LINE)
    while begin < len(data):
        header_size, = struct.unpack_from("<I", data, begin)
        header = data[begin + 4:begin + 4 + header_size]
        data_size, = struct.unpack_from("<I", data, begin + 4 + header_size)
        end = begin + 8 + header_size + data_size
        if b"op=" + bytes([RECORDS[name]]) in header:
            return begin, end
        begin = end
    raise ValueError("the bag has no record " + name)


def damage(fault, folder):
    """Does what the fault says, `cut|flip|remove [PLACE of] FILE`. Returns the path of the file and what it held."""
    verb, *place, name = fault.split()
    path = os.path.join(folder, name if name in os.listdir(folder) else os.path.join("trial_000", name))
    with open(path, "rb") as stream:
        data = stream.read()
    begin, end = 0, len(data)
    if place:
        digit = data.rfind(b",") - 1  # the last one of a table: its last column is text
        places = {"head": (0, 8), "end": (end - 16, end), "digit": (digit, digit + 1)}
        begin, end = places.get(place[0]) or find_record(data, place[0])
    middle = (begin + end) // 2
    if verb == "remove":
        os.remove(path)
        return path, data
    bit = 0x01 if place == ["digit", "of"] else 0x80  # which makes another digit of one
    after = data[:middle] if verb == "cut" else data[:middle] + bytes([data[middle] ^ bit]) + data[middle + 1:]
    with open(path, "wb") as stream:
        stream.write(after)
    return path, data
