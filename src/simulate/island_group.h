#pragma once

#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "constraints/disjoint_sets.h"
#include "simulate/conservation_record.h"
#include "simulate/island_solver.h"

namespace cradle {

/// The bodies of an island of the plan, which may all touch each other some time, in motion as islands in time: those
/// that are tied or near now, each with a solver and a clock of its own, so that an event of one stops no other
/// (Timewarp: B. Mirtich, SIGGRAPH 2000).
///
/// Time goes on in windows. Each island moves through the window by itself, and notes what its bodies sweep. Where
/// bodies of two islands may have met, both are taken back to the window's start, and go through it as one. The motion
/// in the window counts from then on, when no bodies can have met in it. At the start of a window islands merge that
/// are about to meet. No step is cut by a window: only a new island begins at one. Islands do not part again: events on
/// both sides of a mirror image, once in contact, stay at one instant.
class IslandGroup {
 public:
  /// Whether an island of the plan may be moved as several: its steps are as long as the error allows, some of its
  /// bodies are not tied to each other, and no push acts on any.
  static bool mayDivide(const Scene& scene, const IslandPlan& plan);

  /// Keeps references to `scene` and `plan`. `all` is that island at time 0.
  IslandGroup(const Scene& scene, const IslandPlan& plan, Assembly all);

  /// As IslandSolver::stateAt, for the time of a frame, in the order of the frames.
  const VectorX& stateAt(double time, const std::function<void(double time)>& reached = {});

  /// As IslandSolver::finish.
  void finish();

  /// As those of IslandSolver, of all bodies.
  const Assembly& assembly() const { return all_; }
  const std::vector<JointState>& jointStates() const { return frames_.front().joints; }
  long evaluations() const;
  std::vector<Event> takeEvents() { return std::exchange(events_, {}); }
  std::vector<std::string> takeWarnings() { return std::exchange(warnings_, {}); }
  Corrections& corrections() { return corrections_; }
  const std::optional<PromiseEnd>& promiseEnd() const { return promiseEnd_; }

  /// How many islands there are now.
  std::size_t islandCount() const { return islands_.size(); }

 private:
  using Ledger = Eigen::Vector<double, kLedgerSize>;
  /// A state of all bodies, or of those of one island, with its joints.
  struct Snapshot {
    double time = 0;  // s
    VectorX state;
    std::vector<JointState> joints;
  };
  struct Island {
    std::vector<int> clusters;  // ascending
    std::unique_ptr<IslandSolver> solver;
    std::vector<int> bodies;          // indices into all moving bodies
    std::vector<std::size_t> joints;  // indices into all joints
    std::vector<Snapshot> snapshots;  // at the frames in the window, then at its end
    std::vector<Event> events;        // since the window's start
    std::optional<PromiseEnd> promiseEndAtStart;
    Ledger startLedger = Ledger::Zero();
    std::exception_ptr fault;
    bool hasMoved = false;  // through the window
  };

  void findClusters();
  void addWindow(double length, const std::function<void(double time)>& reached);
  double windowLength() const;
  void mergeThoseThatComeNear(double window);
  DisjointSets islandsNow() const;
  Island& islandAt(int cluster) { return islands_[islandOfCluster_[static_cast<std::size_t>(cluster)]]; }
  void visitNear(double horizon, double margin, const std::function<void(int clusterA, int clusterB)>& visit) const;
  std::vector<std::vector<int>> setsOf(DisjointSets joined) const;
  std::optional<std::size_t> islandOf(const std::vector<int>& set) const;
  void stepToStart(Island& island);
  static void place(const Island& island, const VectorX& part, VectorX& all);
  void regroup(const std::vector<std::vector<int>>& sets);
  Island makeIsland(const std::vector<int>& clusters, const std::vector<Island>& before);
  IslandPlan planOf(const std::vector<int>& clusters) const;
  void move(Island& island, double end, const std::function<void(double time)>& reached) const;
  bool mergeThoseThatMet();
  void accept();
  Snapshot gather(std::size_t number) const;

  const Scene& scene_;
  const IslandPlan& plan_;
  Assembly all_;
  ConservationRecord record_;
  std::vector<std::vector<int>> clusters_;                // scene bodies that are tied to each other, ascending
  std::vector<int> clusterOfBody_;                        // by moving body; -1: driven
  std::vector<std::vector<std::size_t>> linksOfCluster_;  // indices into the plan's
  std::vector<int> fixed_;                                // scene bodies that may be touched, ascending
  std::vector<std::size_t> islandOfCluster_;
  std::vector<Island> islands_;      // in the order of their first clusters
  Snapshot start_;                   // of the window under way
  Ledger settled_ = Ledger::Zero();  // J: ledgers of islands that are no more
  std::deque<Snapshot> frames_;      // that were not asked for yet; the first is the last one that was
  long nextFrame_ = 0;
  std::vector<Event> events_;
  std::vector<std::string> warnings_;
  Corrections corrections_;
  std::optional<PromiseEnd> promiseEnd_;
  long evaluations_ = 0;  // of islands that are no more
};

}  // namespace cradle
