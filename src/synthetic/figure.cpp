// SPDX-License-Identifier: BSD-3-Clause
#include "figure.hpp"

#include <algorithm>
#include <cmath>

#include "random.hpp"

namespace pf::synthetic {
namespace {

using Vec3 = Eigen::Vector3f;

constexpr float kPi = 3.14159265F;
constexpr float kThigh = 0.44F, kShank = 0.42F, kAnkle = 0.08F;  // metres
constexpr float kUpperArm = 0.29F, kForearm = 0.26F;
constexpr float kSpeed = 0.8F;    // metres per second
constexpr float kStride = 1.35F;  // metres, two steps

Material cloth(Surface kind) { return {kind, {1.6F, 1.6F}, {0.2F, 0.1F}}; }

Shape personShape(ShapeKind kind, const Vec3& half, const Material& material) {
  Shape shape;
  shape.kind = kind;
  shape.half = half;
  shape.materials.fill(material);
  shape.is_person = true;
  return shape;
}

Shape capsule(const Vec3& from, const Vec3& to, float radius, Surface surface) {
  const Vec3 axis = to - from;
  Shape shape = personShape(ShapeKind::capsule, {radius, radius, axis.norm() / 2}, cloth(surface));
  shape.T_room_shape.translate((from + to) / 2);
  shape.T_room_shape.rotate(Eigen::Quaternionf::FromTwoVectors(Vec3::UnitZ(), axis));
  return shape;
}

Shape ellipsoid(const Vec3& centre, const Vec3& half, Surface surface) {
  Shape shape = personShape(ShapeKind::ellipsoid, half, cloth(surface));
  shape.T_room_shape.translate(centre);
  return shape;
}

/// Downward direction swung forwards by an angle, in the walking plane.
Vec3 swung(float angle) { return {std::sin(angle), 0, -std::cos(angle)}; }

struct Limb {
  Vec3 root, middle, end;
};

/// Angles of one leg at a phase of the stride: thigh forwards, knee backwards (rad).
Limb leg(float phase, const Vec3& hip) {
  const float thigh = 0.05F + 0.40F * std::sin(phase);
  const float knee = 0.12F + 0.75F * std::pow(std::max(0.0F, std::cos(phase + 0.35F)), 2.0F);
  Limb limb{hip, hip + kThigh * swung(thigh), {}};
  limb.end = limb.middle + kShank * swung(thigh - knee);
  return limb;
}

Limb arm(float phase, const Vec3& shoulder) {
  const float upper = -0.38F * std::sin(phase), elbow = 0.35F + 0.15F * std::sin(phase + kPi);
  const float outwards = shoulder.y() > 0 ? 0.05F : -0.05F;
  Limb limb{shoulder, shoulder + kUpperArm * swung(upper) + Vec3(0, outwards, 0), {}};
  limb.end = limb.middle + kForearm * swung(upper + elbow);
  return limb;
}

/// The figure walking along +x, pelvis above the origin, z up from the floor.
struct Body {
  Limb left_leg, right_leg, left_arm, right_arm;
  Vec3 pelvis;

  explicit Body(float phase) {
    const auto lowest = [](const Limb& a, const Limb& b) {
      return -std::min(a.end.z(), b.end.z());
    };
    const Vec3 left(0, 0.10F, 0), right(0, -0.10F, 0);
    const float height = kAnkle + lowest(leg(phase, left), leg(phase + kPi, right));
    pelvis = {0, 0, height};
    left_leg = leg(phase, pelvis + left);
    right_leg = leg(phase + kPi, pelvis + right);
    left_arm = arm(phase, at(0, 0.19F, 0.50F));
    right_arm = arm(phase + kPi, at(0, -0.19F, 0.50F));
  }

  Vec3 at(float x, float y, float z) const { return pelvis + Vec3(x, y, z); }
};

void addLeg(std::vector<Shape>& shapes, const Limb& limb) {
  shapes.push_back(capsule(limb.root, limb.middle, 0.085F, Surface::trousers));
  shapes.push_back(capsule(limb.middle, limb.end, 0.062F, Surface::trousers));
  const Vec3 sole = limb.end - Vec3(0, 0, 0.035F);
  shapes.push_back(capsule(sole, sole + Vec3(0.15F, 0, 0), 0.045F, Surface::hair));
}

void addArm(std::vector<Shape>& shapes, const Limb& limb) {
  shapes.push_back(capsule(limb.root, limb.middle, 0.052F, Surface::shirt));
  shapes.push_back(capsule(limb.middle, limb.end, 0.042F, Surface::shirt));
  const Vec3 reach = (limb.end - limb.middle).normalized();
  shapes.push_back(ellipsoid(limb.end + 0.07F * reach, {0.045F, 0.035F, 0.075F}, Surface::skin));
}

std::vector<Shape> shapesOf(const Body& b) {
  std::vector<Shape> shapes;
  for (const Limb* limb : {&b.left_leg, &b.right_leg}) addLeg(shapes, *limb);
  for (const Limb* limb : {&b.left_arm, &b.right_arm}) addArm(shapes, *limb);
  shapes.push_back(ellipsoid(b.at(0, 0, 0.02F), {0.13F, 0.18F, 0.15F}, Surface::trousers));
  shapes.push_back(ellipsoid(b.at(0, 0, 0.30F), {0.125F, 0.185F, 0.30F}, Surface::shirt));
  shapes.push_back(capsule(b.at(0, -0.14F, 0.49F), b.at(0, 0.14F, 0.49F), 0.07F, Surface::shirt));
  shapes.push_back(capsule(b.at(0, 0, 0.50F), b.at(0.01F, 0, 0.62F), 0.055F, Surface::skin));
  shapes.push_back(ellipsoid(b.at(0.02F, 0, 0.70F), {0.095F, 0.075F, 0.12F}, Surface::skin));
  shapes.push_back(ellipsoid(b.at(-0.005F, 0, 0.73F), {0.1F, 0.082F, 0.105F}, Surface::hair));
  return shapes;
}

std::array<Vec3, kJointCount> jointsOf(const Body& b) {
  std::array<Vec3, kJointCount> joints;
  const auto set = [&](Joint joint, const Vec3& p) { joints[static_cast<std::size_t>(joint)] = p; };
  set(Joint::nose, b.at(0.115F, 0, 0.69F));
  set(Joint::neck, b.at(0, 0, 0.51F));
  set(Joint::right_shoulder, b.right_arm.root);
  set(Joint::right_elbow, b.right_arm.middle);
  set(Joint::right_wrist, b.right_arm.end);
  set(Joint::left_shoulder, b.left_arm.root);
  set(Joint::left_elbow, b.left_arm.middle);
  set(Joint::left_wrist, b.left_arm.end);
  set(Joint::right_hip, b.right_leg.root);
  set(Joint::right_knee, b.right_leg.middle);
  set(Joint::right_ankle, b.right_leg.end);
  set(Joint::left_hip, b.left_leg.root);
  set(Joint::left_knee, b.left_leg.middle);
  set(Joint::left_ankle, b.left_leg.end);
  set(Joint::right_eye, b.at(0.1F, -0.032F, 0.725F));
  set(Joint::left_eye, b.at(0.1F, 0.032F, 0.725F));
  set(Joint::right_ear, b.at(0.01F, -0.08F, 0.70F));
  set(Joint::left_ear, b.at(0.01F, 0.08F, 0.70F));
  return joints;
}

}  // namespace

Figure figureAt(double time_s, std::uint32_t seed) {
  // An ellipse round the carpet; its mean circumference sets the angular speed.
  constexpr float kRadiusX = 1.25F, kRadiusY = 0.45F;
  const float mean_radius = std::sqrt((kRadiusX * kRadiusX + kRadiusY * kRadiusY) / 2);
  const float time = static_cast<float>(time_s);
  const float start = 0.5F + 0.6F * uniform(randomBits(std::uint64_t{seed} * 7919), 12);
  const float angle = -(start + time * kSpeed / mean_radius);
  const Vec3 foot(2.6F + kRadiusX * std::cos(angle), 2.65F + kRadiusY * std::sin(angle), 0.012F);
  const float heading = std::atan2(-kRadiusY * std::cos(angle), kRadiusX * std::sin(angle));
  const Body body(2 * kPi * kSpeed * time / kStride);

  Eigen::Isometry3f T_room_body = Eigen::Isometry3f::Identity();
  T_room_body.translate(foot);
  T_room_body.rotate(Eigen::AngleAxisf(heading, Vec3::UnitZ()));
  Figure figure{shapesOf(body), jointsOf(body)};
  for (Shape& shape : figure.shapes) shape.T_room_shape = T_room_body * shape.T_room_shape;
  for (Vec3& joint : figure.joints) joint = T_room_body * joint;
  return figure;
}

}  // namespace pf::synthetic
