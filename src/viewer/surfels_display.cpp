// SPDX-License-Identifier: BSD-3-Clause
#include "surfels_display.hpp"

#include <rviz/display_context.h>
#include <rviz/frame_manager.h>
#include <rviz/ogre_helpers/grid.h>
#include <rviz/properties/bool_property.h>
#include <rviz/properties/int_property.h>
#include <rviz/properties/vector_property.h>
#include <rviz/render_panel.h>
#include <rviz/view_controller.h>
#include <rviz/view_manager.h>
#include <pluginlib/class_list_macros.hpp>

#include <algorithm>
#include <cmath>

namespace posefusion_ros {
namespace {

constexpr float kHalfView_rad = 0.39F;  // of rviz's orbit view, upwards and downwards
constexpr float kMargin = 1.05F;
constexpr std::size_t kSample = 50000;  // surfels that room and floor are estimated from

/// Evenly many are left out; the others grow, so that no holes open.
std::vector<SurfelPoint> thinned(const sensor_msgs::PointCloud2& cloud, std::size_t most) {
  const SurfelPoint* all = surfelsOf(cloud);
  const std::size_t step = std::max<std::size_t>(1, (cloud.width + most - 1) / most);
  const float growth = std::sqrt(static_cast<float>(step));
  std::vector<SurfelPoint> some;
  some.reserve(cloud.width / step + 1);
  for (std::size_t i = 0; i < cloud.width; i += step) {
    some.push_back(all[i]);
    some.back().radius *= growth;
  }
  return some;
}

Ogre::Vector3 toOgre(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

SurfelsDisplay::SurfelsDisplay() {
  const auto again = [this] { show(); };
  hide_backs_ = new rviz::BoolProperty(
      "Hide Backs", true, "Leave out what is seen from behind: look into the room from outside.",
      this);
  floor_grid_ = new rviz::BoolProperty("Floor Grid", true, "A grid of metres on the floor.", this);
  fit_view_ = new rviz::BoolProperty(
      "Fit View", true, "Keep the whole room in the orbit view, until it is moved by hand.", this);
  keep_fluid_ = new rviz::BoolProperty("Keep Fluid", true,
                                       "Fewer and larger discs where drawing is slow.", this);
  max_discs_ = new rviz::IntProperty(
      "Max Discs", 1000000, "More surfels than that: evenly many are left out, the others grow.",
      this);
  max_discs_->setMin(1);
  for (rviz::Property* property : std::initializer_list<rviz::Property*>{
           hide_backs_, floor_grid_, fit_view_, keep_fluid_, max_discs_}) {
    connect(property, &rviz::Property::changed, this, again);
  }
}

SurfelsDisplay::~SurfelsDisplay() {
  if (discs_) scene_node_->detachObject(discs_.get());
}

void SurfelsDisplay::onInitialize() {
  MFDClass::onInitialize();
  discs_ = std::make_unique<SurfelDiscs>();
  scene_node_->attachObject(discs_.get());
  grid_ = std::make_unique<rviz::Grid>(scene_manager_, scene_node_, rviz::Grid::Lines, 1, 1.0F,
                                       0.01F, Ogre::ColourValue(0.45F, 0.45F, 0.48F));
  grid_->getSceneNode()->setVisible(false);
}

void SurfelsDisplay::reset() {
  MFDClass::reset();
  cloud_.reset();
  fluid_ = {};
  if (discs_) discs_->set({});
  if (grid_) grid_->getSceneNode()->setVisible(false);
}

void SurfelsDisplay::processMessage(const sensor_msgs::PointCloud2::ConstPtr& cloud) {
  if (surfelsOf(*cloud) == nullptr) {
    setStatus(rviz::StatusProperty::Error, "Message", "not a cloud of posefusion's surfels");
    return;
  }
  Ogre::Vector3 position;
  Ogre::Quaternion orientation;
  if (!context_->getFrameManager()->getTransform(cloud->header.frame_id, ros::Time(), position,
                                                 orientation)) {
    setStatus(rviz::StatusProperty::Error, "Message",
              "no transform from " + QString::fromStdString(cloud->header.frame_id));
    return;
  }
  scene_node_->setPosition(position);
  scene_node_->setOrientation(orientation);
  cloud_ = cloud;
  show();
}

void SurfelsDisplay::update(float wall_dt, float ros_dt) {
  MFDClass::update(wall_dt, ros_dt);
  if (!cloud_ || !keep_fluid_->getBool()) return;
  const std::size_t all =
      std::min(std::size_t{cloud_->width}, static_cast<std::size_t>(max_discs_->getInt()));
  if (fluid_.drawn(wall_dt, shown_, all)) show();
}

void SurfelsDisplay::show() {
  if (!cloud_ || !discs_) return;
  discs_->hideBacks(hide_backs_->getBool());
  const auto most = static_cast<std::size_t>(max_discs_->getInt());
  const auto shown =
      thinned(*cloud_, keep_fluid_->getBool() ? std::min(most, fluid_.discs()) : most);
  discs_->set(shown);
  shown_ = shown.size();
  setStatus(rviz::StatusProperty::Ok, "Message",
            QString("%1 of %2 surfels shown").arg(shown.size()).arg(cloud_->width));
  const auto sample = thinned(*cloud_, kSample);
  const Eigen::AlignedBox3f box = boundsOf(sample);
  grid_->getSceneNode()->setVisible(false);
  if (!box.isEmpty()) {
    const auto floor = floor_grid_->getBool() ? floorOf(sample) : std::nullopt;
    if (floor) placeGrid(box, *floor);
    if (fit_view_->getBool()) fitView(box);
  }
  context_->queueRender();
}

/// Lines at whole metres of the map, under the whole room.
void SurfelsDisplay::placeGrid(const Eigen::AlignedBox3f& box, const pf::Levels& floor) {
  const Eigen::Vector3f middle = box.center().array().round();
  const Eigen::Vector3f half = (box.max() - middle).cwiseMax(middle - box.min());
  const auto cells = static_cast<std::uint32_t>(2 * std::ceil(std::max(half.x(), half.y())));
  grid_->setCellCount(std::max(2U, cells));
  const Eigen::Vector3f up = floor.up.cast<float>();
  const Eigen::Vector3f on_floor =
      middle + up * (static_cast<float>(floor.lowest_m) - up.dot(middle));
  grid_->getSceneNode()->setPosition(toOgre(on_floor));
  // rviz draws it in the plane of x and z.
  grid_->getSceneNode()->setOrientation(Ogre::Vector3::UNIT_Y.getRotationTo(toOgre(up)));
  grid_->getSceneNode()->setVisible(true);
}

void SurfelsDisplay::fitView(const Eigen::AlignedBox3f& box) {
  rviz::ViewController* view = context_->getViewManager()->getCurrent();
  if (view == nullptr || view->getClassId() != "rviz/Orbit") return;
  auto* focus = qobject_cast<rviz::VectorProperty*>(view->subProp("Focal Point"));
  rviz::Property* distance = view->subProp("Distance");
  if (focus == nullptr) return;
  if (fitted_ && (fitted_->distance != distance->getValue().toFloat() ||
                  !fitted_->focus.positionEquals(focus->getVector(), 1e-3F))) {
    return;
  }
  const rviz::RenderPanel* panel = context_->getViewManager()->getRenderPanel();
  const float aspect =
      static_cast<float>(panel->width()) / static_cast<float>(std::max(1, panel->height()));
  const float radius = 0.5F * box.diagonal().norm() * kMargin;
  const Ogre::Vector3 middle = scene_node_->convertLocalToWorldPosition(toOgre(box.center()));
  distance->setValue(radius / (std::sin(kHalfView_rad) * std::min(1.0F, aspect)));
  focus->setVector(middle);
  fitted_ = Fitted{distance->getValue().toFloat(), focus->getVector()};
}

}  // namespace posefusion_ros

PLUGINLIB_EXPORT_CLASS(posefusion_ros::SurfelsDisplay, rviz::Display)
