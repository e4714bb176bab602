// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace posefusion_ros {

/// Name and type of a published topic.
using NamedType = std::pair<std::string, std::string>;

/// For a topic that nothing came on: "; of its type there are /a, /b", those with the most like
/// names first, at most `most`; "; no topic of type ... is published" where there is none; and
/// "; it is published as a ..." where it has another type. Topics below `own` (a namespace) are
/// left out.
std::string topicHint(const NamedType& wanted, const std::vector<NamedType>& published,
                      const std::string& own, std::size_t most = 4);

/// As above, of the topics that the master knows; empty where it does not answer.
std::string topicHint(const NamedType& wanted, const std::string& own);

}  // namespace posefusion_ros
