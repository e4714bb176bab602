// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace posefusion_ros {

/// True where a node of this (whole) name is registered and answers. Needs a master.
bool isNodeUp(const std::string& name);

/// Asks nodes to end in order, as Ctrl-C does (on other machines as `rosnode kill`): each is waited
/// for before the next, so that what it does at its end (a map that is saved) is done. Names that
/// are relative are resolved, empty ones are left out. Gives up on a node that is still there after
/// `patience_s`.
void endNodes(const std::vector<std::string>& names, double patience_s);

/// Waits until a node has come up, but not longer than `patience_s` (wall), and then until it has
/// ended, or this one is to end.
void outwait(const std::string& name, double patience_s);

/// The command line of the process that started this one; none where it is not known.
std::vector<std::string> parentCommand();

/// Where roslaunch has started this process: ends it as Ctrl-C does.
void endRoslaunch();

}  // namespace posefusion_ros
