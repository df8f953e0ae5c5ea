// A body that lands on one end while another end still carries it loses what the impact takes from it, at an instant.
// An impact that is spread over a step, in which the end that will leave is still kept on its support, takes more: by a
// fraction of the step's length over the time between landings. So a step ends at the next impact inside it.

#include "simulate/steps/next_impact.h"

#include <algorithm>

namespace cradle {
namespace {

/// Marks the contacts of a group that are apart and that free motion closes by the step's end. Whether there are any.
bool markClosing(const StepGroup& group, const StepMotion& motion, const ContactSet& contacts, double minSpeed,
                 std::vector<char>& strikesInside) {
  bool isFound = false;
  for (std::size_t i = 0; i < group.contacts.size(); ++i) {
    const Eigen::Index normal = 3 * static_cast<Eigen::Index>(i) + 2;
    const double gap = group.contacts[i].separation;
    const double closing = motion.closing(normal), fastest = closing + motion.pressing(normal);
    const bool strikes = gap > contacts.tolerances().overlap && closing > minSpeed && gap < motion.timeStep * fastest;
    strikesInside[group.members[i]] = strikes ? 1 : 0;
    isFound = isFound || strikes;
  }
  return isFound;
}

/// The first root theta of s - v h theta + (v - u) h theta^2 / 2 for the marked contacts of a group, s the gap, v and u
/// its closing speeds at the ends of the step. `end` has -u. Contacts without a root in (0, 1] lose their mark.
double firstRootOf(const StepGroup& group, const StepMotion& motion, const VectorX& end,
                   std::vector<char>& strikesInside) {
  double first = INFINITY;
  for (std::size_t i = 0; i < group.contacts.size(); ++i) {
    char& strikes = strikesInside[group.members[i]];
    if (!strikes) continue;
    const Eigen::Index normal = 3 * static_cast<Eigen::Index>(i) + 2;
    const double gap = group.contacts[i].separation / motion.timeStep, closing = motion.closing(normal);
    const double root = closing * closing - 2 * gap * (end[normal] + closing);
    const double fraction = root < 0 ? INFINITY : 2 * gap / (closing + std::sqrt(root));
    strikes = fraction <= 1 ? 1 : 0;
    if (strikes) first = std::min(first, fraction);
  }
  return first;
}

}  // namespace

NextImpact findNextImpact(const ContactSet& contacts, const FreeStep& step, double minSpeed, GroupProblem& problem) {
  NextImpact next{INFINITY, std::vector<char>(contacts.size(), 0)};
  std::vector<SteppingFault> faults;  // of a trial: nobody is told
  for (const StepGroup& group : contacts.findGroups()) {
    const StepMotion motion = stepMotionOf(group, contacts, step, problem);
    if (!markClosing(group, motion, contacts, minSpeed, next.strikesInside)) continue;
    VectorX end = step.end;
    problem.apply(problem.solve(group, posedStep(group, contacts, motion, next.strikesInside, 1), faults), end);
    next.fraction =
        std::min(next.fraction,
                 firstRootOf(group, motion, problem.velocitiesIn(end) + motion.velocityProduct, next.strikesInside));
  }
  return next;
}

}  // namespace cradle
