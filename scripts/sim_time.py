#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Takes /use_sim_time away when the launch file that set it ends: the next nodes of this master would wait for a clock for ever."""
import rospy


def main():
    rospy.init_node("sim_time")
    rospy.on_shutdown(lambda: rospy.delete_param("/use_sim_time"))
    rospy.spin()


if __name__ == "__main__":
    main()
