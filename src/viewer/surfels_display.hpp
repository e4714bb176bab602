// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rviz/message_filter_display.h>
#include <sensor_msgs/PointCloud2.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "fluid_limit.hpp"
#include "room_fit.hpp"
#include "surfel_discs.hpp"

namespace rviz {
class BoolProperty;
class Grid;
class IntProperty;
}  // namespace rviz

namespace posefusion_ros {

/// Shows a map of posefusion in rviz: surfels as discs of their radius, a grid on the floor, and,
/// until the user moves it elsewhere, the orbit view so far away that the whole room is in it.
class SurfelsDisplay : public rviz::MessageFilterDisplay<sensor_msgs::PointCloud2> {
 public:
  SurfelsDisplay();
  ~SurfelsDisplay() override;

 protected:
  void onInitialize() override;
  void reset() override;
  void processMessage(const sensor_msgs::PointCloud2::ConstPtr& cloud) override;
  void update(float wall_dt, float ros_dt) override;

 private:
  void show();
  void placeGrid(const Eigen::AlignedBox3f& box, const pf::Levels& floor);
  void fitView(const Eigen::AlignedBox3f& box);

  rviz::BoolProperty* hide_backs_;
  rviz::BoolProperty* floor_grid_;
  rviz::BoolProperty* fit_view_;
  rviz::BoolProperty* keep_fluid_;
  rviz::IntProperty* max_discs_;
  std::unique_ptr<SurfelDiscs> discs_;
  std::unique_ptr<rviz::Grid> grid_;
  sensor_msgs::PointCloud2::ConstPtr cloud_;
  FluidLimit fluid_;
  std::size_t shown_ = 0;  ///< discs
  /// Of the view, as it was fitted last: another one is the user's.
  struct Fitted {
    float distance = 0;
    Ogre::Vector3 focus = Ogre::Vector3::ZERO;
  };
  std::optional<Fitted> fitted_;
};

}  // namespace posefusion_ros
