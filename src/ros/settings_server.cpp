// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/settings_server.hpp"

#include <ros/advertise_service_options.h>
#include <ros/console.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <exception>

namespace posefusion_ros {
namespace {

using dynamic_reconfigure::Config;
using dynamic_reconfigure::ConfigDescription;
using dynamic_reconfigure::Reconfigure;
namespace serialization = ros::serialization;

/// In place of roscpp's own way to answer, which informs a caller of the refusal, but not of its
/// reason: the protocol has a text for it.
class Answerer : public ros::ServiceCallbackHelper {
 public:
  /// Returns the values in force; throws to refuse.
  using Answer = std::function<Config(Config)>;

  explicit Answerer(Answer answer) : answer_(std::move(answer)) {}

  bool call(ros::ServiceCallbackHelperCallParams& params) override {
    try {
      Reconfigure::Request request;
      Reconfigure::Response response;
      serialization::deserializeMessage(params.request, request);
      response.config = answer_(request.config);
      params.response = serialization::serializeServiceResponse(true, response);
    } catch (const std::exception& error) {
      params.response = serialization::serializeServiceResponse(false, std::string(error.what()));
    }
    return true;  // it is answered, if with a refusal
  }

 private:
  Answer answer_;
};

ros::AdvertiseServiceOptions serviceOf(Answerer::Answer answer) {
  namespace traits = ros::service_traits;
  ros::AdvertiseServiceOptions options;
  options.service = "set_parameters";
  options.md5sum = traits::md5sum<Reconfigure>();
  options.datatype = traits::datatype<Reconfigure>();
  options.req_datatype = ros::message_traits::datatype<Reconfigure::Request>();
  options.res_datatype = ros::message_traits::datatype<Reconfigure::Response>();
  options.helper = boost::make_shared<Answerer>(std::move(answer));
  return options;
}

void addStatus(Config& values, const std::string& text) {
  values.strs.emplace_back();
  values.strs.back().name = kSettingsStatus;
  values.strs.back().value = text;
}

ConfigDescription withStatus(ConfigDescription all) {
  dynamic_reconfigure::ParamDescription status;
  status.name = kSettingsStatus;
  status.type = "str";
  status.description = "what became of the last change; setting it has no effect";
  all.groups.front().parameters.push_back(status);
  addStatus(all.min, "");
  addStatus(all.max, "");
  addStatus(all.dflt, "");
  return all;
}

}  // namespace

SettingsTopics::SettingsTopics(const ros::NodeHandle& handle, VisitSettings visit, Change change)
    : handle_(handle), visit_(std::move(visit)), change_(std::move(change)) {
  descriptions_ = handle_.advertise<ConfigDescription>("parameter_descriptions", 1, true);
  updates_ = handle_.advertise<Config>("parameter_updates", 1, true);
  descriptions_.publish(withStatus(describe(visit_)));
  tell("");
  auto service = serviceOf([this](Config request) { return set(std::move(request)); });
  service_ = handle_.advertiseService(service);
}

/// Publishes the values to all editors, with the result of the last change. Returns the message.
Config SettingsTopics::tell(const std::string& status) {
  Config values = valuesOf(visit_);
  addStatus(values, status);
  updates_.publish(values);
  return values;
}

/// Throws where the change is refused.
Config SettingsTopics::set(Config request) {
  const std::lock_guard<std::mutex> lock(mutex_);
  // An editor that sends all values sends this one too.
  auto& texts = request.strs;
  texts.erase(std::remove_if(texts.begin(), texts.end(),
                             [](const auto& each) { return each.name == kSettingsStatus; }),
              texts.end());
  try {
    change_(request);
  } catch (const std::exception& error) {
    ROS_ERROR("%s: nothing is changed: %s", handle_.getNamespace().c_str(), error.what());
    // An editor shows the refused value until it receives the one in force.
    tell(std::string("nothing is changed: ") + error.what());
    throw;
  }
  remember(request);
  return tell("changed");
}

/// On the parameter server, as dynamic_reconfigure does it.
void SettingsTopics::remember(const Config& values) {
  for (const auto& each : values.bools) handle_.setParam(each.name, each.value != 0);
  for (const auto& each : values.ints) handle_.setParam(each.name, each.value);
  for (const auto& each : values.doubles) handle_.setParam(each.name, each.value);
  for (const auto& each : values.strs) handle_.setParam(each.name, each.value);
}

}  // namespace posefusion_ros
