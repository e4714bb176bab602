// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/pair_residual.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration_room.hpp"

namespace pf {
namespace {

struct Pair {
  ViewSurface from, to;
  Eigen::Isometry3d T_to_from;
};

Pair makePair(const DepthField& field, double noise) {
  test::RoomView like;
  like.field = field;
  like.noise = noise;
  const auto views = test::roomViews(2, like);
  return {ViewSurface(views[0]), ViewSurface(views[1]),
          views[1].T_map_camera.inverse() * views[0].T_map_camera};
}

TEST(PairResidual, isNoneWhereDepthIsRightOrCorrected) {
  for (const DepthField& field : {DepthField(), test::roomField()}) {
    const Pair pair = makePair(field, 0);
    int count = 0;
    for (const SurfacePatch& patch : pair.from.patches()) {
      const auto r = pairResidual(patch, pair.from, pair.to, pair.T_to_from, field);
      if (!r || std::abs(r->e) * r->metres > 0.02) continue;  // a rim of a box
      EXPECT_LT(std::abs(r->e), 0.0012) << patch.u << " " << patch.v;
      ++count;
    }
    EXPECT_GT(count, 500);
  }
}

TEST(PairResidual, hasTheDerivativesThatDifferencesGive) {
  const DepthField field = test::roomField();
  const Pair pair = makePair(field, 1.0);
  int checked = 0;
  for (const SurfacePatch& patch : pair.from.patches()) {
    const auto at = [&](const DepthField& f, const Vector6d& x) {
      return pairResidual(patch, pair.from, pair.to, expSe3(x) * pair.T_to_from, f);
    };
    const auto r = at(field, Vector6d::Zero());
    if (!r || ++checked % 97 != 0) continue;
    const double h = 1e-7;
    for (int k = 0; k < 6; ++k) {
      const Vector6d x = h * Vector6d::Unit(k);
      EXPECT_NEAR(r->by_pose[k], (at(field, x)->e - at(field, -x)->e) / (2 * h), 1e-5);
    }
    Eigen::VectorXd by_node = Eigen::VectorXd::Zero(static_cast<int>(field.nodes().size()));
    for (int k = 0; k < FieldWeights::kNodes; ++k) {
      by_node[r->at_from.node(k)] += r->by_from * r->at_from.weight(k);
      by_node[r->at_to.node(k)] += r->by_to * r->at_to.weight(k);
    }
    for (int n = 0; n < by_node.size(); ++n) {
      const auto with = [&](double step) {
        auto nodes = field.nodes();
        nodes[static_cast<std::size_t>(n)] += step;
        return at(DepthField(field.columns(), field.rows(), nodes), Vector6d::Zero())->e;
      };
      EXPECT_NEAR(by_node[n], (with(h) - with(-h)) / (2 * h), 1e-5) << n;
    }
  }
  EXPECT_GT(checked, 500);
}

TEST(ViewSurface, coversAnImageOfAnySizeAlike) {
  test::RoomView small, large;
  small.noise = large.noise = 0;
  large.camera = test::roomCamera(320);
  const ViewSurface a(test::roomView(small)), b(test::roomView(large));
  EXPECT_GT(a.patches().size(), 1500U);
  EXPECT_NEAR(static_cast<double>(a.patches().size()), static_cast<double>(b.patches().size()),
              0.15 * static_cast<double>(a.patches().size()));
  for (const SurfacePatch& patch : a.patches()) {
    const SurfacePatch* same = b.near(2 * patch.u + 0.5, 2 * patch.v + 0.5);
    if (same == nullptr || std::abs(same->w - patch.w) > 0.02) continue;
    EXPECT_NEAR(same->w + same->by_u * (2 * patch.u + 0.5F - same->u) +
                    same->by_v * (2 * patch.v + 0.5F - same->v),
                patch.w, 0.002);
  }
}

}  // namespace
}  // namespace pf
