// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "posefusion/graph/config.hpp"
#include "posefusion/graph/constraint.hpp"
#include "posefusion/graph/deformation.hpp"
#include "posefusion/graph/keyframe.hpp"

namespace pf {

/// What one optimisation did.
struct GraphResult {
  struct Error {
    PoseConstraint constraint;
    double before = 0, after = 0;  ///< chi-square
  };
  struct Refusal {
    PoseConstraint constraint;
    std::string reason;
  };

  bool accepted = false;         ///< new loops hold, the poses have changed
  std::string reason;            ///< why not; empty when accepted
  std::vector<Refusal> refused;  ///< loops taken out, as they do not fit with the others
  std::vector<Error> errors;     ///< of all constraints, when accepted
  Deformation deformation;       ///< identity unless accepted
};

/// What became of some loops.
struct ClosedLoops {
  std::vector<Deformation> deformations;  ///< what the map is to follow, in this order
  std::size_t accepted = 0;               ///< corrections
  std::size_t refused = 0;                ///< loops inconsistent with the others
  std::size_t joined = 0;                 ///< fragments whose place was found
  std::size_t withdrawn = 0;              ///< loops accepted earlier, since rejected
};

/// Keyframes and what is measured between them. Loops wait until optimise() has proved them: either
/// all that holds is met afterwards within what the covariances promise, or nothing changes.
/// Results are the same to the bit on every run. Not thread safe.
class PoseGraph {
 public:
  explicit PoseGraph(const GraphConfig& config) : config_(config) {}

  /// Takes up a graph that was saved. Throws InputError saying what does not fit together.
  PoseGraph(const GraphConfig& config, std::vector<Keyframe> keyframes,
            std::vector<PoseConstraint> constraints, int version);

  /// Adds the first keyframe of a piece that was not tracked from the one before: the map's first,
  /// the first of a fragment, or found again after a loss. Returns its id (keyframe.id is ignored).
  int addKeyframe(Keyframe keyframe);

  /// Adds a keyframe tracked from keyframe `from`; both poses say what was measured. The covariance
  /// is that of tracking over the step (twist in the new camera); drift is added to it.
  int addKeyframe(Keyframe keyframe, int from, const Matrix6d& covariance);

  /// Adds the first keyframe of a fragment, which dead reckoning leads to from a keyframe whose
  /// place is known (`to` is not looked at): loops to where it cannot be do not join it.
  int addFragment(Keyframe first, PoseConstraint reckoned);

  /// A loop between keyframes of one fragment, for the next optimise(); the error that any loop has
  /// is added to its covariance. Throws std::invalid_argument for unknown or equal keyframes, other
  /// fragments, or numbers that are not finite.
  void addLoop(const PoseConstraint& loop);

  /// Fits the poses to all constraints (Levenberg-Marquardt on SE(3), Cauchy loss on loops). The
  /// first keyframe of each connected part keeps its pose. While a constraint is missed by more
  /// than max_chi_square, or the new loops bend odometry more than they promise, the new loop that
  /// fits worst is taken out and the rest tried again from where it began. Where no pose would move
  /// further than the error that any loop has, the new loops only confirm what is there: they hold
  /// from now on, and nothing moves until later loops want more.
  GraphResult optimise();

  /// Two fragments by a loop between them: the later moves rigidly to where the loop wants it, in
  /// the other's coordinates, and takes the other's number, then all is optimised. Refused like any
  /// loop, and where dead reckoning does not admit it (see ExpectedPlace): nothing changes then.
  /// Throws like addLoop(), and when both are of one fragment.
  GraphResult joinFragment(const PoseConstraint& loop);

  /// Loops between any keyframes, and those that wait: fragments that they lead between are joined.
  /// Where a loop is refused, all are weighed against each other; see reconsider().
  ClosedLoops close(const std::vector<PoseConstraint>& loops);

  /// What if loops that hold are wrong, and those that were refused are right? All loops and
  /// returns are solved with a loss that is cut off at max_chi_square (graduated non-convexity:
  /// Yang et al., "Graduated Non-Convexity for Robust Spatial Perception", RA-L 2020). Where the
  /// sum of all errors, each loop that is left out counting as much, is less than it is now, those
  /// that fit hold from now on, and the others (`refused` has those that held) are doubted. Steps
  /// of tracking always hold, and count in full.
  GraphResult reconsider();

  /// Constraints that hold, measured anew (same keyframes, same kind): they replace the old ones,
  /// and all is optimised. Nothing changes where one of all would then be missed by more than
  /// max_chi_square. What does not hold, or is no more, is left out.
  GraphResult remeasure(const std::vector<PoseConstraint>& constraints);

  /// A step of tracking, measured anew by the pictures of its two keyframes, replaces what tracking
  /// said, and what hangs on the step alone moves rigidly with it: there is nothing to solve.
  /// Nothing changes where the two contradict each other by more than max_chi_square, or where
  /// loops lead past the step.
  GraphResult retrack(const PoseConstraint& step);

  /// Bounds the graph of a camera that walks the same rounds for hours: a keyframe (not of the
  /// latest) with config().keyframes_at_a_place others as near as two frames of which one becomes
  /// none is retired. It then follows the older one of them that it is best tied to, which its
  /// constraints are handed on to; no pose changes. After Johannsson et al., "Temporally scalable
  /// visual SLAM using a reduced pose graph", ICRA 2013. Returns those retired now, ascending.
  std::vector<int> retire();

  /// Counts a correction that moves no keyframe.
  void countCorrection() { ++version_; }

  /// A copy to be corrected in another thread. The loops that wait go with it. Until takeUp()
  /// nothing but addKeyframe() and addLoop() may be called here.
  PoseGraph handOver();

  /// The copy is corrected by these deformations, and takes the place of what is here, which is
  /// left in the copy: any thread may free it. What was added here meanwhile follows: a keyframe
  /// goes with the one that it was tracked from. Returns the deformations with those keyframes.
  std::vector<Deformation> takeUp(PoseGraph&& corrected,
                                  const std::vector<Deformation>& deformations);

  Eigen::Isometry3d poseOf(const RelativePose& pose) const { return pf::poseOf(pose, keyframes_); }

  const std::vector<Keyframe>& keyframes() const { return keyframes_; }
  const std::vector<PoseConstraint>& constraints() const { return constraints_; }  ///< that hold
  /// With the keyframes all that must be kept to go on later: constraints(), and where fragments
  /// are by dead reckoning.
  std::vector<PoseConstraint> keptConstraints() const;
  /// Loops that contradict what holds, the last of them: kept, as they may be right.
  const std::vector<PoseConstraint>& doubted() const { return doubted_; }
  int version() const { return version_; }  ///< number of accepted corrections

  const GraphConfig& config() const { return config_; }

 private:
  struct Attempt;
  int fragmentOf(int keyframe) const {
    return keyframes_.at(static_cast<std::size_t>(keyframe)).fragment;
  }
  PoseConstraint checkedLoop(const PoseConstraint& loop) const;
  std::optional<PoseConstraint> reckonedTo(int fragment, int in) const;
  std::string unexpected(const PoseConstraint& loop, const std::vector<Keyframe>& joined) const;
  Attempt attempt(const std::vector<Keyframe>& from,
                  const std::vector<PoseConstraint>& loops) const;
  Attempt attemptAll() const;
  Attempt solve(const std::vector<Keyframe>& from, const std::vector<PoseConstraint>& all,
                const std::vector<std::size_t>& first, const std::set<std::size_t>& parts) const;
  /// What stands against accepting these errors, the last of them of new loops; empty: nothing.
  std::string objection(const std::vector<GraphResult::Error>& errors, std::size_t new_loops) const;
  GraphResult prove(const std::vector<Keyframe>& start, std::vector<PoseConstraint> loops);
  void doubt(const PoseConstraint& loop);
  const PoseConstraint* bestTie(int keyframe) const;
  void retire(int keyframe, const PoseConstraint& tie);
  /// The same between keyframes in use; nothing where both ends are then one.
  std::optional<PoseConstraint> inUse(PoseConstraint constraint) const;
  void moveRetired(const std::vector<Keyframe>& before, std::vector<Keyframe>& after) const;
  /// The poses where those of these constraints that count fit best, by graduated non-convexity,
  /// with those of the others that fit there too; empty: the solver failed.
  std::vector<Eigen::Isometry3d> graduallySolved(const std::vector<PoseConstraint>& all,
                                                 const std::vector<char>& counts) const;
  /// The best of three: as the poses are; where all count (soft odometry may bend so far that
  /// contradicting loops all fit); where loops that hold do not count, but doubted ones do.
  std::vector<Eigen::Isometry3d> bestOf(const std::vector<PoseConstraint>& all) const;
  bool isMet(const PoseConstraint& loop) const;
  bool isOnlyWay(const PoseConstraint& step) const;
  bool isWorthMoving(const std::vector<Keyframe>& corrected) const;
  void accept(Attempt& attempt, GraphResult& result);
  Deformation deformationTo(const std::vector<Keyframe>& corrected) const;

  GraphConfig config_;
  std::vector<Keyframe> keyframes_;
  std::vector<PoseConstraint> constraints_, waiting_, doubted_;
  std::vector<PoseConstraint> reckoned_;  ///< to the first keyframes of fragments
  std::size_t handed_over_ = 0;           ///< constraints when this was copied by handOver()
  int version_ = 0;
};

}  // namespace pf
