#include "simulate/steps/step_impact.h"

#include <algorithm>

#include "impact/impact_energy.h"

namespace cradle {
namespace {

/// J: what impulses take between velocities of the contacts before and after.
double energyTakenBy(const VectorX& impulses, const VectorX& before, const VectorX& after) {
  double taken = 0;
  for (Eigen::Index at = 0; at < impulses.size(); at += 3)
    taken += energyTaken(impulses.segment<3>(at), before.segment<3>(at), after.segment<3>(at));
  return taken;
}

/// Contacts that close faster than accelerations explain rebound with the fraction `restitutionFraction` of their
/// restitution; all friction is static. `start`: velocities of the contacts before the impact.
ContactProblem posedImpact(const StepGroup& group, const ContactSet& contacts, const VectorX& start, double timeStep,
                           double restitutionFraction) {
  const double slowest = contacts.tolerances().maxRestSpeed(0, timeStep);
  ContactProblem problem{start, {}};
  for (std::size_t i = 0; i < group.contacts.size(); ++i) {
    const ContactMaterial& material = contacts.materialOf(group.members[i]);
    problem.frictions.push_back(material.staticFriction);
    const Eigen::Index normal = 3 * static_cast<Eigen::Index>(i) + 2;
    const double rebound = -restitutionFraction * material.restitution * start[normal];
    if (rebound <= slowest) continue;
    problem.free[normal] -= rebound;
    problem.hasRebounds = true;
  }
  return problem;
}

/// Sets dynamic friction where the velocities `end` of the contacts slide. Whether that changes the problem.
bool setDynamicFriction(const StepGroup& group, const ContactSet& contacts, const VectorX& end,
                        ContactProblem& problem) {
  bool isOther = false;
  for (std::size_t i = 0; i < group.contacts.size(); ++i) {
    const ContactMaterial& material = contacts.materialOf(group.members[i]);
    if (material.dynamicFriction == material.staticFriction) continue;
    if (end.segment<2>(3 * static_cast<Eigen::Index>(i)).norm() <= kSlowestSliding) continue;
    problem.frictions[i] = material.dynamicFriction;
    isOther = true;
  }
  return isOther;
}

/// The impacts to be resolved: contacts, the state before them, and the length (s) of the steps.
struct ImpactInput {
  const ContactSet& contacts;
  const VectorX& approach;
  double timeStep;
};

/// The impact of one group.
VectorX resolveGroupImpact(const StepGroup& group, const ImpactInput& input, GroupProblem& problem, VectorX& state,
                           std::vector<SteppingFault>& faults) {
  problem.set(group, state);
  const Mechanism& mechanism = input.contacts.assembly().mechanism;
  const VectorX start = problem.velocitiesIn(state);
  const double most = energyOf(group.moved.bodies, mechanism, state);
  ContactProblem posed;
  VectorX impulses;
  // m/s, of the contacts: what drives bodies works against impulses with these.
  const VectorX led = mechanism.driven.empty()
                          ? VectorX::Zero(start.size())
                          : problem.velocitiesIn(ledVelocities(mechanism.bodies, problem.constraints(), state));
  double work = 0;  // J
  const auto solveAndApply = [&] {
    copyBodies(group.moved.bodies, input.approach, state);
    impulses = problem.solve(group, posed, faults);
    problem.apply(impulses, state);
    work = -impulses.dot(led);
  };
  const std::size_t kept = faults.size();
  const auto lossWith = [&](double fraction) {
    faults.erase(faults.begin() + static_cast<std::ptrdiff_t>(kept), faults.end());
    posed = posedImpact(group, input.contacts, start, input.timeStep, fraction);
    solveAndApply();
    if (setDynamicFriction(group, input.contacts, problem.velocitiesIn(state), posed)) solveAndApply();
    return most + work - energyOf(group.moved.bodies, mechanism, state);
  };
  const double loss = lossWith(1);
  if (posed.hasRebounds && isGain(most + work - loss, most + work)) lossWith(fractionWithoutGain(lossWith, loss));
  impactEnergy(state) += std::max(0.0, energyTakenBy(impulses, start, problem.velocitiesIn(state)));
  clampEnergyWithFault(group.moved, most + work, mechanism, state, faults);
  pushWork(state) += work;
  return impulses;
}

}  // namespace

std::vector<Vec3> resolveStepImpact(const ContactSet& contacts, double timeStep, GroupProblem& problem, VectorX& state,
                                    std::vector<SteppingFault>& faults) {
  std::vector<Vec3> impulses(contacts.size(), Vec3::Zero());
  const VectorX approach = state;
  const double constant = energyConstant(contacts.assembly().mechanism, state);
  for (const StepGroup& group : contacts.findGroups()) {
    const VectorX found = resolveGroupImpact(group, {contacts, approach, timeStep}, problem, state, faults);
    for (std::size_t i = 0; i < group.members.size(); ++i)
      impulses[group.members[i]] = problem.axes(i) * found.segment<3>(3 * static_cast<Eigen::Index>(i));
  }
  bookNumerical(constant, contacts.assembly().mechanism, state);
  return impulses;
}

}  // namespace cradle
