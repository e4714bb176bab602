# SPDX-License-Identifier: BSD-3-Clause
"""Writes a line for each message of a topic: when it came, its stamp, its bytes, and the fields that are named.
Usage: bench_probe.py TOPIC [FIELD...]"""
import sys
import time

import rospy
import rostopic


def value(message, field):
    for name in field.split("."):
        message = getattr(message, name)
    return message


def main():
    topic, fields = sys.argv[1], sys.argv[2:]
    rospy.init_node("probe", anonymous=True, disable_signals=True)
    kind = rostopic.get_topic_class(topic, blocking=True)[0]

    def note(data):
        # Taken apart only where a field is wanted; every message here begins with a header.
        now = time.monotonic()
        raw = data._buff
        stamp = int.from_bytes(raw[4:8], "little") + 1e-9 * int.from_bytes(raw[8:12], "little")
        words = [f"{now:.6f}", f"{stamp:.6f}", str(len(raw))]
        if fields:
            message = kind().deserialize(raw)
            words += [str(value(message, field)) for field in fields]
        print(*words, flush=True)

    rospy.Subscriber(topic, rospy.AnyMsg, note, queue_size=100, tcp_nodelay=True)
    print("ready", flush=True)
    rospy.spin()


if __name__ == "__main__":
    main()
