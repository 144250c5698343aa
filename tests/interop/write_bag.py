#!/usr/bin/python3
"""Scans (JSON) to a ROS 1 bag, by ROS's own rosbag: write_bag.py SCANS.json OUT.bag none|bz2|lz4"""

import json
import pathlib
import sys

import rosbag
import rospy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

scans = json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="ascii"))
with rosbag.Bag(sys.argv[2], "w", compression=sys.argv[3], chunk_threshold=30_000) as bag:
    for scan in scans:
        stamp = rospy.Time(*divmod(scan["stamp_ns"], 10**9))
        message = LaserScan()
        message.header.stamp = stamp
        message.header.frame_id = "laser"
        message.angle_min = scan["start_rad"]
        message.angle_increment = scan["step_rad"]
        message.angle_max = scan["start_rad"] + (len(scan["ranges_m"]) - 1) * scan["step_rad"]
        message.time_increment = scan["increment_s"]
        message.range_min = scan["range_min_m"]
        message.range_max = scan["range_max_m"]
        message.ranges = scan["ranges_m"]
        message.intensities = [47.0] * len(message.ranges)
        bag.write("/rosout_text", String(data="a message that is no scan"), stamp)
        bag.write("/scan", message, stamp)
