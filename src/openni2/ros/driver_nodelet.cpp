// SPDX-License-Identifier: BSD-3-Clause
#include <dynamic_reconfigure/server.h>
#include <nodelet/nodelet.h>
#include <posefusion/OpenNi2DriverConfig.h>
#include <std_srvs/SetBool.h>
#include <pluginlib/class_list_macros.hpp>

#include "driver.hpp"
#include "posefusion_ros/queue_keeper.hpp"

namespace pf::openni2 {

/// posefusion/openni2_driver: parameters, services and dynamic_reconfigure of the driver.
class DriverNodelet : public nodelet::Nodelet {
 public:
  ~DriverNodelet() override { close(); }

 private:
  void onInit() override {
    try {
      queues_.keep(getNodeHandle());
      queues_.keep(getMTNodeHandle());
      auto& own = getMTPrivateNodeHandle();
      driver_ = std::make_unique<Driver>(getNodeHandle(), getPrivateNodeHandle(), getName());
      record_ = own.advertiseService("record", &DriverNodelet::record, this);
      reconfigure_ = std::make_unique<Reconfigure>(own);
      reconfigure_->setCallback(
          [this](const posefusion::OpenNi2DriverConfig& config, std::uint32_t) { apply(config); });
      driver_->start();
    } catch (const std::exception& error) {
      NODELET_FATAL("The OpenNI2 driver stays idle: %s", error.what());
      close();
    }
  }

  void close() {
    // No request may come any more when the driver goes.
    record_.shutdown();
    reconfigure_.reset();
    driver_.reset();
  }

  void apply(const posefusion::OpenNi2DriverConfig& config) {
    ExposureSettings exposure;
    exposure.auto_exposure = config.auto_exposure;
    exposure.auto_white_balance = config.auto_white_balance;
    exposure.exposure = config.exposure;
    exposure.gain = config.gain;
    exposure.max_exposure = config.max_exposure;
    driver_->setExposure(exposure);
    driver_->setTimeOffsets(config.color_time_offset, config.depth_time_offset);
  }

  bool record(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
    const auto [success, message] = driver_->record(request.data);
    response.success = success;
    response.message = message;
    return true;
  }

  using Reconfigure = dynamic_reconfigure::Server<posefusion::OpenNi2DriverConfig>;

  posefusion_ros::QueueKeeper queues_;
  std::unique_ptr<Driver> driver_;
  std::unique_ptr<Reconfigure> reconfigure_;
  ros::ServiceServer record_;
};

}  // namespace pf::openni2

PLUGINLIB_EXPORT_CLASS(pf::openni2::DriverNodelet, nodelet::Nodelet)
