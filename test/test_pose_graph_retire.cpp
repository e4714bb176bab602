// SPDX-License-Identifier: BSD-3-Clause
// Keyframes that others represent: a graph of circles walked again and again.
#include <set>

#include "graph_scene.hpp"
#include "posefusion/core/error.hpp"

namespace pf {
namespace {

constexpr int kOfRound = 40;

/// Place i of a circle that is walked again and again, each time a little beside.
Eigen::Isometry3d onTheWay(int i) {
  const double angle = 2 * M_PI * (i % kOfRound) / kOfRound;
  const double beside = 0.02 * std::sin(1.7 * i);
  return motion(0, 0, 0, angle) * motion(2 + beside, 0, 0, 0);
}

GraphConfig configOf(int keyframes_at_a_place) {
  GraphConfig config;
  config.keyframes_at_a_place = keyframes_at_a_place;
  return config;
}

/// Circles tracked with a drift, and closed by the pictures of each place.
class Rounds {
 public:
  explicit Rounds(int keyframes_at_a_place) : graph_(configOf(keyframes_at_a_place)) {}

  void walk(int rounds) {
    for (int k = 0; k < rounds * kOfRound; ++k) step();
  }

  void step() {
    const auto i = static_cast<int>(truth_.size());
    truth_.push_back(onTheWay(i));
    if (i == 0) {
      graph_.addKeyframe(keyframeAt(truth_[0], 0));
      return;
    }
    const auto at = static_cast<std::size_t>(i);
    const Eigen::Isometry3d drift = motion(0, 0, 1e-4, 1e-4);
    const Eigen::Isometry3d T =
        graph_.keyframes().back().T_map_camera * truth_[at - 1].inverse() * truth_[at] * drift;
    graph_.addKeyframe(keyframeAt(T, at), i - 1, kTracking);
    std::vector<PoseConstraint> loops;
    for (int older = i - kOfRound; older >= 0 && loops.size() < 2; older -= kOfRound) {
      if (!graph_.keyframes()[static_cast<std::size_t>(older)].isRetired())
        loops.push_back(loopOf(truth_, older, i));
    }
    if (loops.empty() && i >= kOfRound) loops.push_back(loopOf(truth_, i % kOfRound, i));
    EXPECT_EQ(graph_.close(loops).refused, 0U) << i;
    if (i % 20 == 0) graph_.retire();
  }

  PoseGraph& graph() { return graph_; }
  const Poses& truth() const { return truth_; }

  std::size_t inUse() const {
    const auto& all = graph_.keyframes();
    return static_cast<std::size_t>(
        std::count_if(all.begin(), all.end(), [](const Keyframe& k) { return !k.isRetired(); }));
  }

 private:
  PoseGraph graph_;
  Poses truth_;
};

TEST(PoseGraphRetire, RoundsWithoutEndKeepTheGraphBounded) {
  Rounds rounds(3);
  rounds.walk(8);
  const std::size_t keyframes = rounds.inUse(), constraints = rounds.graph().constraints().size();
  rounds.walk(22);
  EXPECT_EQ(rounds.graph().keyframes().size(), 30U * kOfRound);
  EXPECT_LE(rounds.inUse(), keyframes + 20) << "that many wait for the next time";
  EXPECT_LE(rounds.graph().constraints().size(), constraints + 60);
  EXPECT_LT(worstDistance(rounds.graph(), rounds.truth()), 0.02);
}

TEST(PoseGraphRetire, NoPoseChangesAndNoConstraintIsMissedByMore) {
  Rounds rounds(0);
  rounds.walk(6);
  PoseGraph graph(configOf(4), rounds.graph().keyframes(), rounds.graph().constraints(),
                  rounds.graph().version());
  const PoseGraph before = graph;
  const auto retired = graph.retire();
  ASSERT_GT(retired.size(), 20U);
  EXPECT_TRUE(std::is_sorted(retired.begin(), retired.end()));
  double worst_before = 0, worst = 0;
  const auto worstOf = [](const PoseGraph& g) {
    double most = 0;
    for (const auto& c : g.constraints()) {
      most =
          std::max(most, chiSquare(c, g.keyframes()[static_cast<std::size_t>(c.from)].T_map_camera,
                                   g.keyframes()[static_cast<std::size_t>(c.to)].T_map_camera));
    }
    return most;
  };
  worst_before = worstOf(before);
  worst = worstOf(graph);
  EXPECT_LE(worst, worst_before * (1 + 1e-6));
  for (std::size_t i = 0; i < before.keyframes().size(); ++i) {
    EXPECT_EQ(graph.keyframes()[i].T_map_camera.matrix(),
              before.keyframes()[i].T_map_camera.matrix());
  }
  EXPECT_EQ(graph.version(), before.version());
  for (const int i : retired) {
    const Keyframe& k = graph.keyframes()[static_cast<std::size_t>(i)];
    ASSERT_TRUE(k.isRetired());
    EXPECT_LT(k.follows, i) << "an older one";
    const Keyframe& carrier = graph.keyframes()[static_cast<std::size_t>(k.follows)];
    EXPECT_FALSE(carrier.isRetired());
    EXPECT_LT(distance(k.T_map_camera, carrier.T_map_camera), 0.6);
  }
  for (const auto& c : graph.constraints()) {
    EXPECT_FALSE(graph.keyframes()[static_cast<std::size_t>(c.from)].isRetired());
    EXPECT_FALSE(graph.keyframes()[static_cast<std::size_t>(c.to)].isRetired());
  }
  // The constructor that reads a file accepts it.
  EXPECT_NO_THROW(
      PoseGraph(GraphConfig(), graph.keyframes(), graph.constraints(), graph.version()));
}

TEST(PoseGraphRetire, TheLatestAndTheFirstStay) {
  Rounds rounds(0);
  rounds.walk(5);
  PoseGraph graph(configOf(4), rounds.graph().keyframes(), rounds.graph().constraints(), 0);
  graph.retire();
  EXPECT_FALSE(graph.keyframes()[0].isRetired());
  for (std::size_t i = graph.keyframes().size() - 100; i < graph.keyframes().size(); ++i) {
    EXPECT_FALSE(graph.keyframes()[i].isRetired()) << i;
  }
}

TEST(PoseGraphRetire, NoneIsRetiredWhereNothingTiesIt) {
  PoseGraph graph = graphOf(Poses(300, motion(1, 2, 3, 0.5)));  // stands still, by tracking alone
  Poses far;
  for (int i = 0; i < 300; ++i) far.push_back(motion(0.35 * i, 0, 0, 0));
  PoseGraph straight = graphOf(far);
  EXPECT_TRUE(straight.retire().empty());
  EXPECT_FALSE(graph.retire().empty()) << "tracking ties these";
}

/// What was retired, and what is tied to it later, moves with its carrier.
TEST(PoseGraphRetire, FollowsItsCarrierThroughCorrections) {
  Rounds rounds(3);
  rounds.walk(6);
  PoseGraph& graph = rounds.graph();
  // The end of the last circle is wrong by 4 cm: tracked on without loops, then closed.
  Poses truth = rounds.truth();
  const auto last = static_cast<int>(truth.size()) - 1;
  const Eigen::Isometry3d off = motion(0, 0, 0.04, 0);
  truth.push_back(onTheWay(last + 1));
  graph.addKeyframe(keyframeAt(graph.keyframes().back().T_map_camera *
                                   truth[truth.size() - 2].inverse() * truth.back() * off,
                               truth.size() - 1),
                    last, kTracking);
  const std::vector<Keyframe> before = graph.keyframes();
  const ClosedLoops closed = graph.close({loopOf(truth, 0, last + 1), loopOf(truth, 1, last)});
  ASSERT_EQ(closed.accepted, 1U);
  std::size_t followers = 0;
  for (const Keyframe& k : graph.keyframes()) {
    if (!k.isRetired()) continue;
    const auto a = static_cast<std::size_t>(k.follows), i = static_cast<std::size_t>(k.id);
    const Eigen::Isometry3d was = before[a].T_map_camera.inverse() * before[i].T_map_camera;
    EXPECT_TRUE((graph.keyframes()[a].T_map_camera.inverse() * k.T_map_camera).isApprox(was, 1e-9));
    EXPECT_TRUE((closed.deformations[0].at(k.map_frame) * before[i].T_map_camera)
                    .isApprox(k.T_map_camera, 1e-9))
        << "surfels go with it";
    ++followers;
  }
  EXPECT_GT(followers, 20U);
}

TEST(PoseGraphRetire, LoopsToARetiredOneLeadToItsCarrier) {
  Rounds rounds(3);
  rounds.walk(6);
  PoseGraph& graph = rounds.graph();
  const auto& all = graph.keyframes();
  const auto retired =
      std::find_if(all.begin(), all.end(), [](const auto& k) { return k.isRetired(); });
  ASSERT_NE(retired, all.end());
  const auto last = static_cast<int>(all.size()) - 1;
  const int carrier = retired->follows;
  const std::size_t constraints = graph.constraints().size();
  const ClosedLoops closed = graph.close({loopOf(rounds.truth(), retired->id, last)});
  EXPECT_EQ(closed.refused, 0U);
  ASSERT_EQ(graph.constraints().size(), constraints + 1);
  EXPECT_EQ(graph.constraints().back().from, carrier);
  EXPECT_EQ(graph.close({loopOf(rounds.truth(), retired->id, carrier)}).refused, 0U);
  EXPECT_EQ(graph.constraints().size(), constraints + 1) << "both ends are one";
}

TEST(PoseGraphRetire, BesideMappingWhatCameMeanwhileIsTiedToTheCarrier) {
  Rounds rounds(0);
  rounds.walk(5);
  PoseGraph graph(configOf(4), rounds.graph().keyframes(), rounds.graph().constraints(), 0);
  PoseGraph copy = graph.handOver();
  const auto retired = copy.retire();
  ASSERT_FALSE(retired.empty());
  const Keyframe& k = graph.keyframes()[static_cast<std::size_t>(retired.back())];
  const int back = graph.addKeyframe(
      keyframeAt(k.T_map_camera * motion(0.01, 0, 0, 0), graph.keyframes().size()), k.id,
      kTracking);
  graph.addLoop(loopOf(rounds.truth(), retired.front(), 3 * kOfRound + 7));
  graph.takeUp(std::move(copy), {});
  for (const auto& c : graph.constraints()) {
    EXPECT_FALSE(graph.keyframes()[static_cast<std::size_t>(c.from)].isRetired());
  }
  const PoseConstraint& tie = graph.constraints().back();
  EXPECT_EQ(tie.to, back);
  EXPECT_LT(chiSquare(tie, graph.keyframes()[static_cast<std::size_t>(tie.from)].T_map_camera,
                      graph.keyframes()[static_cast<std::size_t>(back)].T_map_camera),
            1e-6);
  EXPECT_EQ(graph.close({}).refused, 0U) << "the loop that waited";
}

TEST(PoseGraphRetire, ASavedGraphWithImpossibleCarriersIsRefused) {
  Rounds rounds(3);
  rounds.walk(6);
  const auto& constraints = rounds.graph().constraints();
  const auto tryWith = [&](int follows) {
    std::vector<Keyframe> keyframes = rounds.graph().keyframes();
    keyframes.push_back(keyframeAt(motion(0, 0, 0, 0), keyframes.size()));
    keyframes.back().id = static_cast<int>(keyframes.size()) - 1;
    keyframes.back().follows = follows;
    PoseGraph(GraphConfig(), keyframes, constraints, 0);
  };
  const auto& all = rounds.graph().keyframes();
  const auto retired =
      std::find_if(all.begin(), all.end(), [](const auto& k) { return k.isRetired(); });
  EXPECT_NO_THROW(tryWith(0));
  EXPECT_THROW(tryWith(retired->id), InputError) << "retired itself";
  EXPECT_THROW(tryWith(static_cast<int>(all.size())), InputError) << "itself";
  EXPECT_THROW(tryWith(1 << 20), InputError);
  std::vector<Keyframe> keyframes = all;
  keyframes[static_cast<std::size_t>(constraints.front().to)].follows = 0;
  EXPECT_THROW(PoseGraph(GraphConfig(), keyframes, constraints, 0), InputError)
      << "a constraint ends there";
}

}  // namespace
}  // namespace pf
