#pragma once

#include <optional>
#include <vector>

#include "impact/pairwise.h"
#include "simulate/island_state.h"

namespace cradle {

/// A limit that is reached, or left, inside a step.
struct LimitChange {
  double fraction = 0;  // of the step, 0..1
  std::size_t limit = 0;
  double threshold = 0;  // m: slack that is reached; < 0: of a limit without tension at which the link is
  double latest = 1;     // fraction of the step, > `fraction`, at which another limit changes
};

/// Ropes and the stops of joints over time: nothing while slack; an impulse when the limit is reached; then a bilateral
/// constraint, of a rope a rod, until that would push the wrong way. The constraints of taut limits stand behind the
/// scene's own.
class LimitEvents {
 public:
  /// Keeps a reference to `island`.
  explicit LimitEvents(IslandState& island);

  /// The method's if that is fixed (s), else 0: rebounds that end within about two steps are not resolved.
  void setTimeStep(double timeStep) { timeStep_ = timeStep; }

  /// The first slack limit of a step that is reached, or taut one whose tension ends. The step's end derivative
  /// must be there (prepareInterpolant).
  std::optional<LimitChange> firstChange(const Step& step);

  /// Zero where the change happens, positive before: slack as a part of the length, or tension as a part of the
  /// greater of those at both ends of the step. `state` is that of the step's end.
  double margin(const LimitChange& change, const VectorX& state);

  /// Counts whole turns of hinges up to a state. To be called at the end of each step, before the next one begins.
  void followTurns(double time, const VectorX& state);

  /// What happens at the end of a step: impulses in limits that are reached, new constraints, released limits. True if
  /// anything does.
  bool resolve(double time, VectorX& state);

  /// Impulses and new constraints alone, of limits that are reached and go on. True if there are any.
  bool pullStretched(double time, VectorX& state);

  /// Taut stops of bodies that touch, or are tied to some that do, are no joints any more until they are reached again,
  /// as what strikes these may open them. Nor are taut ropes rods, where what is driven holds or touches those bodies:
  /// it would press them by the ropes onto what they touch.
  void giveWay(const std::vector<Contact>& touching);

  /// Limits that are reached as members of an impact: they lengthen as contacts close, along the line of their ends.
  /// Those that are taut are no constraints until endImpact.
  std::vector<ImpactContact> beginImpact(const VectorX& state);

  /// Limits that are no constraints and may be reached within a step of `length` (s) whose free motion led from
  /// `before` to `state`.
  std::vector<const Limit*> withinReach(const VectorX& before, const VectorX& state, double length) const;

  /// A limit as a contact of the bodies at its ends that may close by what is slack.
  static ImpactContact contactOf(const Limit& limit, const VectorX& state);

  /// Takes the impulses that the same members got. What lengthens no more and shortens is slack now.
  void endImpact(double time, const std::vector<ImpactContact>& members, const VectorX& state);

  bool hasLimits() const { return !assembly_.limits.empty(); }

  /// Which limits are constraints now: to be asked later whether they are the same ones.
  const std::vector<int>& tautRows() const { return tautRow_; }

 private:
  bool isTaut(std::size_t limit) const { return tautRow_[limit] >= 0; }
  bool rests(std::size_t limit) const;
  double lighterMass(std::size_t limit) const;
  double usualTension(std::size_t limit) const;
  double tension(std::size_t limit, double time, const VectorX& state);
  std::optional<double> firstTensionLoss(const Step& step, std::size_t limit);
  std::optional<LimitChange> changeOf(const Step& step, std::size_t limit, double end);
  std::optional<LimitChange> firstReach(const Step& step, std::size_t limit, double end) const;
  /// A limit that is reached and goes on.
  struct Stretch {
    std::size_t limit;
    double speed;         // m/s, of lengthening
    double reboundSpeed;  // m/s, 0: does not rebound
    bool isLoaded;        // forces would lengthen it further
  };
  bool pullStretched(double time, const std::vector<char>& isReleased, VectorX& state);
  double accelerationScale(const Limit& limit, const VectorX& state) const;
  std::vector<Stretch> findStretches(double time, const std::vector<char>& isReleased, const VectorX& state);
  void pull(double time, const std::vector<Stretch>& stretches, VectorX& state);
  void release(double time, std::size_t limit, const VectorX& state);
  void loosen(double time, std::size_t limit, const VectorX& state);
  void rebuildConstraints();
  void record(double time, EventKind kind, std::size_t limit, double impulse, const VectorX& state);

  IslandState& island_;
  Assembly& assembly_;
  EquationsOfMotion& equations_;
  double timeStep_ = 0;
  double followedTime_;           // s: when turns were followed last
  std::size_t sceneConstraints_;  // those that are no limits
  std::vector<int> tautRow_;      // of each limit, among the constraints' rows; or -1: no smooth force pulls at it
  struct Member {
    std::size_t limit;
    bool wasTaut;
  };
  std::vector<Member> members_;    // of the impact under way
  std::vector<char> isStretched_;  // has reached its length and not been slack since
  // N, of each limit when a tension ended last, the greater of both ends of that step: one that contacts keep just
  // above zero is small at the start, and no measure of itself. The usual one since it has gone taut.
  std::vector<double> tensionScales_;
  VectorX derivative_, sample_;
};

}  // namespace cradle
