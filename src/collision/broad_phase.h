#pragma once

#include <cstdint>
#include <vector>

#include "collision/collider.h"
#include "core/worker_threads.h"

namespace cradle {

/// Keeps the list of collider pairs that are near each other, by axis-aligned boxes around them (sweep and prune: D.
/// Baraff, 1992). The boxes have a margin (fat AABBs), and the list stays as it is until a body leaves its box.
class BroadPhase {
 public:
  /// Pairs take some 200 MB then. A heap of a hundred thousand bodies has half as many; n bodies that all overlap each
  /// other have n^2 / 2.
  static constexpr std::size_t kMaxPairs = 2'000'000;

  BroadPhase() = default;
  /// Shares the work among `threads`, to which it keeps a reference; the list is the same for any number.
  explicit BroadPhase(WorkerThreads& threads) : threads_(&threads) {}

  /// Sets geometry.pairs to all pairs that may come nearer than `margin` (m) to each other while no point of moving
  /// body i moves by more than `motions[i]` (m) from where it is in `state`; and some others. Against planes first,
  /// then by colliders a < b; pairs of fixed bodies and excluded ones are left out. True if the list is a new one.
  /// Throws Error(limit) if there are more than kMaxPairs. O(n log n) for the usual scene, as long as all that is near
  /// on one axis is not far on the others.
  bool update(const VectorX& state, const std::vector<double>& motions, double margin, ContactGeometry& geometry);

  /// Positions of the bodies, and bounds on their motion until the next update.
  struct PredictedMotion {
    const VectorX& state;
    const std::vector<double>& motions;      // m, by moving body: of its points, beside the displacement
    const std::vector<Vec3>& displacements;  // m, by moving body; empty: none
    double ahead = 1;                        // a new list is made for so many times this motion
  };
  /// Pairs whose swept boxes overlap: the points of body i move by the common displacement displacements[i] (m) and at
  /// most motions[i] (m) beside it.
  bool update(const PredictedMotion& predicted, double margin, ContactGeometry& geometry);

 private:
  struct Interval {
    std::int64_t cell;                                // see cellOf
    double from, to;                                  // m, along the axis of the sweep
    double acrossFrom, acrossTo, thirdFrom, thirdTo;  // m, along the others
    std::size_t collider;
  };

  using Found = std::vector<std::pair<std::size_t, std::size_t>>;

  static Vec3 displacementOf(const PredictedMotion& predicted, std::size_t body);
  bool covers(const PredictedMotion& predicted, double margin) const;
  void enclose(const PredictedMotion& predicted, double margin, const ContactGeometry& geometry);
  void encloseColliders(const ContactGeometry& geometry, const PredictedMotion& predicted);
  void sort(const ContactGeometry& geometry);
  void sweep(ContactGeometry& geometry);
  static void keepNeighbourLists(const std::vector<ColliderPair>& before, ContactGeometry& geometry);
  void compareIntervals(const ContactGeometry& geometry, std::size_t first, std::size_t last, Found& found) const;
  void compareWide(const ContactGeometry& geometry);
  void compare(const ContactGeometry& geometry, std::size_t first, std::size_t second, Found& found) const;
  void sortFound();

  std::vector<RigidTransform> poses_;  // of the moving bodies when they were enclosed
  std::vector<double> radii_;          // m, of the moving bodies about their centres of mass
  std::vector<double> spinRadii_;      // m: how far from there turning moves their surface; 0 for a sphere
  std::vector<double> margins_;        // m: how far any point of a moving body may go beside its displacement
  std::vector<Bounds> centers_;        // m: swept by the moving bodies' centres of mass, with these margins
  std::vector<Bounds> boxes_;
  std::vector<double> roundings_;  // m: of the corners of boxes around spheres; 0 for others
  std::vector<Interval> intervals_;
  double longest_ = 0;             // m, of the intervals
  std::vector<std::size_t> wide_;  // colliders that no cell is wide enough for
  std::vector<Found> found_;       // by each thread
  Found sorted_;
  std::vector<std::size_t> next_;  // scratch
  WorkerThreads* threads_ = nullptr;
};

}  // namespace cradle
