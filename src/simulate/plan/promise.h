#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace cradle {

struct IslandPlan;
class ReachablePairs;

/// Times the accuracy, of the largest energy or momentum: beyond it, what changes these without a cause shows that the
/// accuracy was not kept.
/// Accepted steps have errors of the accuracy, and some tens of them, each a tenth of it, add up.
constexpr double kMaxNumericalRatio = 10;

/// A condition of a promise, and the bodies that it is about.
struct PromiseCondition {
  std::string what;         // behind "while", with names of at most a few bodies
  std::vector<int> bodies;  // of the scene, ascending
};

/// Whether an island keeps the accuracy asked: always, as long as conditions hold, or not at all.
struct Promise {
  enum class Kind { kept, conditional, none };
  Kind kind = Kind::kept;
  std::vector<PromiseCondition> conditions;  // of a conditional one
  std::string reason;                        // why there is none
  bool eventsServe = false;                  // events serve all contacts that may come, unless friction jams
};

/// When and why a run gave up the accuracy asked, and the bodies that were the reason.
struct PromiseEnd {
  double time = 0;  // s
  std::string reason;
  std::vector<int> bodies;  // of the scene
  std::string warning;      // a sentence about it
};

/// The promise of an island whose method is chosen, by the shapes and reaches of its bodies: events serve contacts of
/// spheres, corners and faces, as long as there are few of them.
Promise promiseOf(const Scene& scene, const IslandPlan& island, const ReachablePairs& reachable);

/// "promised", "promised while ...", "not promised, because ...".
std::string describe(const Promise& promise);

/// The outcome of a promise: "kept", "given up at 0.2 s, because ..."; empty if there was none.
std::string outcomeOf(const Promise& promise, const std::optional<PromiseEnd>& end, const Scene& scene);

/// `a, b, c, d and 3 more`.
std::string namesOfBodies(const std::vector<int>& bodies, const Scene& scene);

}  // namespace cradle
