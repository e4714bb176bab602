// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pf::simulator {

/// The scene file of a scenario of the package. Throws InputError for an unknown name.
std::string scenarioText(const std::string& name);

/// All names, for messages.
std::string joinedNames();

}  // namespace pf::simulator
