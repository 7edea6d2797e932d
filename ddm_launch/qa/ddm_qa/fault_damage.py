# Damages files as a full disk, a crash or a broken disk does.
# SPDX-License-Identifier: BSD-3-Clause
import os
import struct

from ddm_qa.run_comparison import read_bytes

# Types of records in a bag: field `op` of their headers.
RECORDS = {"header": 3, "index": 4, "chunk": 5, "chunk_info": 6, "connection": 7}
VERSION_LINE = b"#ROSBAG V2.0\n"


def write(path, content):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as stream:
        stream.write(content)


def find_place(data, name):
    """(begin, end) of a place in a file: its head, its end, its last digit, or the first record of a type in a bag."""
    digit = data.rfind(b",") - 1  # last digit before the last column, which is text
    places = {"": (0, len(data)), "head": (0, 8), "end": (len(data) - 16, len(data)), "digit": (digit, digit + 1),
              "version": (0, len(VERSION_LINE))}
    begin = len(VERSION_LINE)
    while name not in places:
        header_size, = struct.unpack_from("<I", data, begin)
        header = data[begin + 4:begin + 4 + header_size]
        data_size, = struct.unpack_from("<I", data, begin + 4 + header_size)
        end = begin + 8 + header_size + data_size
        if b"op=" + bytes([RECORDS[name]]) in header:
            return begin, end
        begin = end
    return places[name]


def damage(fault, path):
    """Damages a file. fault: `cut|flip|remove [PLACE of] FILE`."""
    verb, *place = fault.split()[:-1]
    place = place[0] if place else ""
    data = read_bytes(path)
    middle = sum(find_place(data, place)) // 2
    if verb == "remove":
        os.remove(path)
    elif verb == "cut":
        write(path, data[:middle])
    else:
        bit = 0x01 if place == "digit" else 0x80  # 0x01 turns a digit into another digit
        write(path, data[:middle] + bytes([data[middle] ^ bit]) + data[middle + 1:])
