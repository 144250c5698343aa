"""The bridge with its parameters: ros2 launch odoless_ros2 odoless.launch.py [parameters:=FILE]"""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    built_in = os.path.join(get_package_share_directory("odoless_ros2"), "config", "bridge.yaml")
    return LaunchDescription([
        DeclareLaunchArgument("parameters", default_value=built_in, description="File of the bridge's parameters"),
        Node(package="odoless_ros2", executable="bridge", name="odoless", output="screen",
             parameters=[LaunchConfiguration("parameters")]),
    ])
