// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rosbag/bag.h>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace semantic_vslam {

/// Walks over the records of a bag (format 2.0) before rosbag does, which trusts every length it reads and takes as
/// much memory as they say. @throws FileError in one line if one leads out of the file or asks for more than 1 GB
void checkBagRecords(const std::string& path);

/// Calls back for all messages of these topics, in order of time. Those in a damaged chunk are left out: what visit()
/// throws that is no Error is counted.
/// @return number of messages left out
std::size_t forEachMessage(const rosbag::Bag& bag, const std::vector<std::string>& topics,
                           const std::function<void(const rosbag::MessageInstance&)>& visit);

}  // namespace semantic_vslam
