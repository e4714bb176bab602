// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>

#include <functional>
#include <string>
#include <vector>

#include "posefusion/config/fields.hpp"

namespace posefusion_ros {

/// Shows settings to a visitor: a visitFields() with its struct.
using VisitSettings = std::function<void(pf::FieldVisitor&)>;

/// Names, types, limits, words and help of those that may change while running, as
/// dynamic_reconfigure says it; the values are the defaults. A setting of a group is named as its
/// private parameter: "tracking/max_distance_m".
dynamic_reconfigure::ConfigDescription describe(const VisitSettings& visit);

/// Their values.
dynamic_reconfigure::Config valuesOf(const VisitSettings& visit);

/// Sets those that `request` names. Throws InputError naming setting, value and what was expected:
/// one out of its limits (which are not silently applied), of another type, unknown, or read at the
/// start alone. Settings may have changed in part then.
void readValues(const dynamic_reconfigure::Config& request, const VisitSettings& visit);

}  // namespace posefusion_ros
