// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/features/place_index.h"
#include "core/map/map.h"

namespace semantic_vslam {

/// The sparse map as a BinaryFormat file "SVSLAMAP"; its payload, in this order:
///     origin; next ids; cameras; keyframes by id (stamp, pose, camera, parent, loop edges, features, descriptors);
///     landmarks by id (position, view direction, distance range, descriptor, counts, observations).
/// Covisibility and the keyframes' matches follow from the observations and are not stored; neither is the place index.
/// The same map always gives the same bytes, and a loaded map saves as the file it came from.

/// Writes a map so that a reader sees the old file or the whole new one. @throws FileError naming path and cause.
void saveMap(const std::string& path, const Map& map);

/// Reads a map in the place of `map`, which is untouched if this throws.
/// @throws FileError, one line, if the file is missing, no map file, of another format version, truncated or damaged.
void loadMap(const std::string& path, Map& map);

/// The content of a map file, and back. @param name  of the file, for the message of the FileError
std::string serializeMap(const Map& map);
void parseMap(const std::string& content, const std::string& name, Map& map);

/// Enters all keyframes of a map into an index, in the order of their ids.
void indexKeyframes(const Map& map, PlaceIndex& index);

}  // namespace semantic_vslam
