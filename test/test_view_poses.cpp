// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/view_poses.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "calibration_room.hpp"
#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

constexpr std::size_t kViews = 12;

std::vector<ViewSurface> ring() {
  std::vector<ViewSurface> surfaces;
  for (std::size_t i = 0; i < kViews; ++i) {
    CalibrationView view;
    view.id = static_cast<int>(i);
    view.camera = test::roomCamera(16);
    view.depth_mm = cv::Mat(view.camera.height, view.camera.width, CV_16UC1, cv::Scalar(0));
    const double angle = 2.0 * M_PI * static_cast<double>(i) / kViews;
    view.T_map_camera.translate(Eigen::Vector3d(std::cos(angle), 0, std::sin(angle)));
    view.T_map_camera.rotate(Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitY()));
    surfaces.emplace_back(view);
  }
  return surfaces;
}

/// Pairs of neighbours at their true poses; the last pair closes the circle where `is_closed`.
std::vector<ViewPair> neighbours(const std::vector<ViewSurface>& views, bool is_closed) {
  std::vector<ViewPair> pairs;
  const auto add = [&](std::size_t from, std::size_t to) {
    pairs.push_back(
        {from, to, views[to].T_map_camera().inverse() * views[from].T_map_camera(), 1.0});
  };
  for (std::size_t i = 0; i + 1 < kViews; ++i) add(i, i + 1);
  if (is_closed) add(0, kViews - 1);
  return pairs;
}

/// A camera whose field is one number, d. The pose of a pair is measured as exp(d turn) T where T
/// is true: each step from `from` to `to` turns by a part of d too far.
struct Measured {
  std::vector<ViewPair> truth;
  Eigen::MatrixXd turns;  ///< 6 x pairs
  double d = 0;
  Matrix6d P = independentCovariance(0.002, 0.001).inverse();
  Matrix6d W = independentCovariance(0.003, 0.002).inverse();

  explicit Measured(std::vector<ViewPair> pairs) : truth(std::move(pairs)) {
    turns = Eigen::MatrixXd::Zero(6, static_cast<Eigen::Index>(truth.size()));
    for (std::size_t k = 0; k < truth.size(); ++k) {
      // The closing pair goes the other way.
      const double sign = truth[k].to == truth[k].from + 1 ? 1.0 : -1.0;
      turns(4, static_cast<Eigen::Index>(k)) = sign;
    }
  }

  /// The equations of d, as addPair() makes them, for estimates of the pairs and of d.
  FieldEquations equations(const ViewPoses& views, const std::vector<ViewPair>& pairs, double found,
                           std::vector<PairStep>& steps) const {
    FieldEquations sum;
    sum.H.setZero(1, 1);
    sum.g.setZero(1);
    steps.assign(pairs.size(), {});
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const Vector6d turn = turns.col(static_cast<Eigen::Index>(k));
      // The pair's own cost is r' P r with r = x - e - turn (step of d).
      const Vector6d e =
          logSe3(expSe3((found - d) * turn) * truth[k].T_to_from * pairs[k].T_to_from.inverse());
      const Vector6d c = views.apart(pairs[k]);
      const Matrix6d inverse = (P + W).inverse();
      PairStep& step = steps[k];
      step.own = inverse * (P * e + W * c);
      step.by_field = inverse * P * turn;
      step.by_views = inverse * W;
      step.H_views = W - W * step.by_views;
      step.g_views = W * (c - step.own);
      step.H_views_field = -W * step.by_field;
      step.g = turn.transpose() * P * (e - step.own);
      sum.H += turn.transpose() * P * turn - turn.transpose() * P * step.by_field;
      sum.g += step.g;
    }
    return sum;
  }
};

/// The estimate of d from a prior on its size alone.
double found(const Measured& measured, std::vector<ViewPair> pairs, ViewPoses& views) {
  constexpr double kPrior = 1.0 / (0.01 * 0.01);
  double d = 0;
  std::vector<PairStep> steps;
  for (int i = 0; i < 8; ++i) {
    FieldEquations sum = measured.equations(views, pairs, d, steps);
    sum.H(0, 0) += kPrior;
    sum.g[0] += kPrior * d;
    views.eliminate(pairs, steps, sum);
    const Eigen::VectorXd step = -sum.H.ldlt().solve(sum.g);
    d += step[0];
    views.move(step, steps, pairs);
  }
  return d;
}

TEST(ViewPoses, aCircleThatClosesShowsWhatNoPairShows) {
  const std::vector<ViewSurface> views = ring();
  Measured open(neighbours(views, false)), closed(neighbours(views, true));
  open.d = closed.d = 0.01;
  ViewPoses of_open(views), of_closed(views);
  EXPECT_NEAR(found(open, open.truth, of_open), 0.0, 1e-4);
  EXPECT_NEAR(found(closed, closed.truth, of_closed), 0.01, 1e-4);
  for (const ViewPair& pair : closed.truth) {
    EXPECT_TRUE(of_closed.T_to_from(pair).isApprox(pair.T_to_from, 1e-3));
  }
}

TEST(ViewPoses, anErrorOfTheMapIsNoErrorOfThePairs) {
  std::vector<ViewSurface> bent = ring();
  const Measured measured(neighbours(bent, true));
  for (std::size_t i = 0; i < kViews; ++i) {
    MapPose pose{kFirstFragment, bent[i].T_map_camera()};
    Vector6d off;
    off << 0.02, 0.01, -0.02, 0.01, 0.03, 0.02;
    pose.T_map_camera = pose.T_map_camera * expSe3(Vector6d(off * std::sin(0.7 * double(i))));
    bent[i].setPose(pose);
  }
  ViewPoses views(bent);
  EXPECT_NEAR(found(measured, measured.truth, views), 0.0, 1e-5);
  for (const ViewPair& pair : measured.truth) EXPECT_LT(views.apart(pair).norm(), 1e-4);
}

TEST(ViewPoses, eliminatedIsTheSameAsSolvedTogether) {
  const std::vector<ViewSurface> views = ring();
  Measured measured(neighbours(views, true));
  measured.d = 0.01;
  ViewPoses poses(views);
  std::vector<PairStep> steps;
  FieldEquations sum = measured.equations(poses, measured.truth, 0, steps);
  sum.H(0, 0) += 1.0;
  // All unknowns at once: d first.
  const Eigen::Index size = 1 + 6 * static_cast<Eigen::Index>(kViews);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(size);
  H.topLeftCorner<1, 1>() = sum.H;
  g[0] = sum.g[0];
  H.diagonal().tail(size - 1) +=
      Matrix6d(independentCovariance(3.0, 1.5).inverse()).diagonal().replicate(kViews, 1);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    Eigen::MatrixXd v = Eigen::MatrixXd::Zero(6, size);
    v.middleCols<6>(1 + 6 * static_cast<Eigen::Index>(measured.truth[k].from)) =
        adjoint(measured.truth[k].T_to_from);
    v.middleCols<6>(1 + 6 * static_cast<Eigen::Index>(measured.truth[k].to)) =
        -Matrix6d::Identity();
    H += v.transpose() * steps[k].H_views * v;
    H.col(0) += v.transpose() * steps[k].H_views_field;
    H.row(0) += steps[k].H_views_field.transpose() * v;
    g += v.transpose() * steps[k].g_views;
  }
  const double together = -H.ldlt().solve(g)[0];
  poses.eliminate(measured.truth, steps, sum);
  EXPECT_NEAR(-sum.g[0] / sum.H(0, 0), together, 1e-9);
  double score = 0;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    score += poses.scoreOf(measured.truth[k], steps[k])[0];
  }
  EXPECT_NEAR(score, sum.g[0], 1e-6 * std::abs(sum.g[0]));
}

}  // namespace
}  // namespace pf
