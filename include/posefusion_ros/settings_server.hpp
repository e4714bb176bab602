// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/node_handle.h>

#include <functional>
#include <mutex>
#include <string>
#include <utility>

#include "posefusion_ros/settings_messages.hpp"

namespace posefusion_ros {

/// A text among the values, for editors, which do not show why a call failed: what became of the
/// last change.
constexpr char kSettingsStatus[] = "settings_status";

/// The topics and the service of dynamic_reconfigure, made from the list of fields that everything
/// else reads settings by (config/fields.hpp), so that no .cfg file can differ from it. A value
/// that is impossible is refused, not clamped: nothing changes, and the log, the failed call and
/// kSettingsStatus say why.
class SettingsTopics {
 public:
  /// Applies a request; throws InputError saying why it does not.
  using Change = std::function<void(const dynamic_reconfigure::Config&)>;

  /// `handle` is private; the topics are relative to it.
  SettingsTopics(const ros::NodeHandle& handle, VisitSettings visit, Change change);

 private:
  dynamic_reconfigure::Config set(dynamic_reconfigure::Config request);
  dynamic_reconfigure::Config tell(const std::string& status);
  void remember(const dynamic_reconfigure::Config& values);

  ros::NodeHandle handle_;
  VisitSettings visit_;
  Change change_;
  std::mutex mutex_;  // of requests
  ros::Publisher descriptions_, updates_;
  ros::ServiceServer service_;
};

/// Settings (a struct with visitFields()) that may change while running.
template <typename Settings>
class SettingsServer {
 public:
  /// `apply` takes them over between two frames, and returns then. Called in the queue of `handle`.
  SettingsServer(const ros::NodeHandle& handle, const Settings& initial,
                 std::function<void(const Settings&)> apply)
      : settings_(initial),
        apply_(std::move(apply)),
        topics_(
            handle, [this](pf::FieldVisitor& visitor) { visitFields(settings_, visitor); },
            [this](const dynamic_reconfigure::Config& request) { change(request); }) {}
  SettingsServer(const SettingsServer&) = delete;
  SettingsServer& operator=(const SettingsServer&) = delete;

 private:
  void change(const dynamic_reconfigure::Config& request) {
    Settings changed = settings_;
    readValues(request, [&](pf::FieldVisitor& visitor) { visitFields(changed, visitor); });
    apply_(changed);
    settings_ = changed;
  }

  Settings settings_;
  std::function<void(const Settings&)> apply_;
  SettingsTopics topics_;  // last: its service uses the rest
};

}  // namespace posefusion_ros
