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
#include "core/worker_threads.h"
#include "simulate/clusters.h"
#include "simulate/conservation_record.h"
#include "simulate/island_solver.h"
#include "simulate/twins.h"

namespace cradle {

/// The bodies of an island of the plan, which may all touch each other some time, in motion as islands in time: those
/// that are tied or near now, each with a solver and a clock of its own, so that an event of one stops no other
/// (Timewarp: B. Mirtich, SIGGRAPH 2000).
///
/// Time goes on in windows. Each island moves through the window by itself, and notes what its bodies sweep. Where
/// bodies of two islands may have met, both are taken back to the window's start, and go through it as one. The motion
/// in the window counts from then on, when no bodies can have met in it. At the start of a window islands merge that
/// are about to meet, and part where their bodies stay apart. No step is cut by a window: only a new island begins at
/// one, and one whose step has come to its end beyond it goes there again. Parts whose events are at one instant but
/// for rounding, as those of a mirror image, are one island for good.
class IslandGroup {
 public:
  /// Whether an island of the plan may be moved as several: its steps are as long as the error allows, and some
  /// of its bodies are not tied to each other.
  static bool mayDivide(const Scene& scene, const IslandPlan& plan);

  /// Keeps references to all but `all`, which is that island at time 0. The islands share the threads; the motion is
  /// the same for any number of them.
  IslandGroup(const Scene& scene, const IslandPlan& plan, Assembly all, WorkerThreads& threads);

  /// One that goes on from a frame (s).
  IslandGroup(const Scene& scene, const IslandPlan& plan, Assembly all, WorkerThreads& threads,
              const GroupRecord& record, long frame, double time);

  /// As IslandSolver::stateAt, for the time of a frame, in the order of the frames.
  const VectorX& stateAt(double time, const std::function<void(double time)>& reached = {});

  /// As IslandSolver::finish.
  void finish();

  /// As those of IslandSolver, of all bodies.
  const Assembly& assembly() const { return all_; }
  const std::vector<JointState>& jointStates() const { return frames_.front().joints; }
  /// Of frames after a call of tellContacts.
  const std::vector<ContactWrench>& contactWrenches() const { return frames_.front().contacts; }
  void tellContacts() { tellsContacts_ = true; }
  long evaluations() const;
  std::vector<Event> takeEvents() { return std::exchange(events_, {}); }
  std::vector<std::string> takeWarnings() { return std::exchange(warnings_, {}); }
  Corrections& corrections() { return corrections_; }
  const std::optional<PromiseEnd>& promiseEnd() const { return promiseEnd_; }

  /// As IslandSolver's, up to the end of the last window.
  BumpCounts bumpCounts() const;

  /// s: the latest of its clocks.
  double clock() const;

  /// As IslandSolver::stopAt; not before clock().
  void stopAt(double time);

  /// To go on from, at a frame at which all islands end a step.
  GroupRecord record() const;

  /// As IslandSolver's, of all.
  long work() const;

  /// How many islands there are now.
  std::size_t islandCount() const { return islands_.size(); }

 private:
  using Ledger = Eigen::Vector<double, kLedgerSize>;
  /// A state of all bodies, or of those of one island, with its joints and contacts.
  struct Snapshot {
    double time = 0;  // s
    VectorX state;
    std::vector<JointState> joints;
    std::vector<ContactWrench> contacts;
  };
  struct Island {
    std::vector<int> clusters;  // ascending
    std::unique_ptr<IslandSolver> solver;
    std::vector<int> bodies;          // indices into all moving bodies
    std::vector<std::size_t> joints;  // indices into all joints
    std::vector<Snapshot> snapshots;  // at the frames in the window, then at its end
    std::vector<Event> events;        // since the window's start
    IslandHistory historyAtStart;
    Ledger startLedger = Ledger::Zero();                  // J, at the window's start
    long evaluationsBefore = 0, evaluationsOfWindow = 0;  // by the last window's start, and in it
    std::exception_ptr fault;                             // of a step that other bodies may have ended
    std::exception_ptr failure;                           // of the run: interrupted, or out of memory
    bool hasMoved = false;                                // through the window
    bool stops = false;                                   // at its end: no step goes beyond
  };

  void addWindow(double length, const std::function<void(double time)>& reached);
  double windowLength() const;
  double longestWindow() const;
  void regroupFor(double window);
  bool mayPart() const;
  bool isWorthParting(const Island& island) const;
  DisjointSets nearWithinIslands(double horizon) const;
  DisjointSets islandsNow() const;
  std::size_t islandIndexOf(int cluster) const { return islandOfCluster_[static_cast<std::size_t>(cluster)]; }
  Island& islandAt(int cluster) { return islands_[islandIndexOf(cluster)]; }
  void visitNear(double horizon, double margin, const std::function<bool(int clusterA, int clusterB)>& visit) const;
  bool stayApart(double horizon) const;
  std::vector<std::vector<int>> setsOf(DisjointSets joined) const;
  std::optional<std::size_t> islandOf(const std::vector<int>& set) const;
  void stepToStart(Island& island);
  static void place(const Island& island, const VectorX& part, VectorX& all);
  void regroup(const std::vector<std::vector<int>>& sets);
  std::vector<const Island*> formerOf(const std::vector<int>& clusters, const std::vector<Island>& before) const;
  std::vector<StartedPush> startedPushes(const std::vector<int>& clusters,
                                         const std::vector<const Island*>& former) const;
  IslandHistory historyOf(const std::vector<int>& clusters, const std::vector<const Island*>& former) const;
  Island makeIsland(const std::vector<int>& clusters, const std::vector<Island>& before);
  Island makeIsland(const PartRecord& part);
  void settle(const Island& island);
  void moveAll(double end, const std::function<void(double time)>& reached);
  std::vector<double> timesUntil(double end) const;
  void move(Island& island, const std::vector<double>& times, const std::function<void(double time)>& reached) const;
  bool mergeThoseThatMet();
  bool takeBackWhatEndsBeyond(double end);
  static bool endsBeyond(const Island& island, double end);
  bool joinTwins(DisjointSets& joined);
  int clusterOf(const Event& event) const;
  void accept();
  void noteFault();
  void takeReportsUntil(double time);
  void takeEventsUntil(double time);
  std::vector<Snapshot> gather();

  const Scene& scene_;
  const IslandPlan& plan_;
  WorkerThreads& threads_;
  Assembly all_;
  ConservationRecord record_;
  const Clusters clusters_;
  std::vector<int> clusterOfBody_;  // by moving body; -1: driven
  std::vector<std::size_t> islandOfCluster_;
  Twins twins_;
  double stretch_ = 1;               // of the last window, over windowLength
  double lastStepEnd_;               // s: no step goes beyond
  std::vector<Island> islands_;      // in the order of their first clusters
  Snapshot start_;                   // of the window under way
  bool tellsContacts_ = true;        // of frames; of the first one in any case
  Ledger settled_ = Ledger::Zero();  // J: ledgers of islands that are no more
  std::deque<Snapshot> frames_;      // that were not asked for yet; the first is the last one that was
  long nextFrame_ = 0;
  std::exception_ptr fault_;  // after those frames
  std::vector<Event> events_;
  std::vector<char> isToldResting_;  // by scene body: by the events so far
  std::vector<std::string> warnings_;
  Corrections corrections_;
  std::optional<PromiseEnd> promiseEnd_;
  long evaluations_ = 0, work_ = 0;                       // of islands that are no more
  long evaluationsBefore_ = 0, evaluationsOfWindow_ = 0;  // by the last window's start, and in it
};

}  // namespace cradle
