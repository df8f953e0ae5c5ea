#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "constraints/block_ldlt.h"
#include "constraints/block_response.h"
#include "constraints/constraint.h"

namespace cradle {

/// How fast velocities violate a constraint.
struct ConstraintRate {
  double rate = 0;        // m/s or rad/s
  std::size_t block = 0;  // among the blocks
};

/// Solves W lambda = b, with the Delassus operator W = J M^-1 J^T of the rows of a set of bilateral constraints, and
/// applies the impulse response M^-1 J^T lambda, by a direct factorisation (D. Baraff, "Linear-time dynamics using
/// Lagrange multipliers", SIGGRAPH 1996): exact at any mass ratio, linear in the length of a chain. Redundant rows are
/// allowed; where they contradict each other, the contradiction stays as it is. Allocates only when bodies are joined
/// in another way than in the call before.
class ConstraintSolver {
 public:
  /// Keeps a reference to both; constraints may be added and taken away later.
  ConstraintSolver(const Constraints& constraints, const std::vector<RigidBody>& bodies)
      : constraints_(constraints), bodies_(bodies) {}

  bool hasConstraints() const { return !constraints_.empty(); }

  /// The rows of the last factorize or project: of the constraints that are not excluded.
  const std::vector<ConstraintBlock>& blocks() const { return blocks_; }

  /// From the next factorize or project on, leaves out the rows of some bodies, and those of bodies that act as `fixed`
  /// (none if empty) alone; to others these do not move.
  void exclude(const std::vector<char>& bodies, const std::vector<char>& fixed = {});
  bool isExcluded(const Constraint& constraint) const;

  /// Takes the rows in `state`, in which the bodies have `frames`, and factorises.
  void factorize(const VectorX& state, const std::vector<BodyFrame>& frames);
  void factorize(const VectorX& state);

  /// Adds to the accelerations in `derivative` what keeps d^2C/dt^2 = 0. Returns the multipliers: a rod pushes its ends
  /// apart with the force (N) multiplier x length.
  const VectorX& constrainAccelerations(VectorX& derivative);

  /// Puts the multipliers of the last constrainAccelerations where they belong among the rows of all constraints; those
  /// of excluded ones stay as they are.
  void putMultipliers(VectorX& all) const;

  /// Adds to displacements, in the place of velocities in `displacement`, the least that takes out the errors: J d =
  /// -C.
  void constrainDisplacements(VectorX& displacement);

  /// Takes out of the velocities what would change C, by the least change of kinetic energy.
  void constrainVelocities(VectorX& state);

  /// Moves the bodies by the least (mass-weighted) motion until all constraints hold to rounding, then constrains the
  /// velocities. Returns the largest error that was found, in m or rad.
  double project(VectorX& state);

  /// The largest error, in m or rad, that factorize or project left.
  double largestError() const;

  /// Whether these errors are rounding.
  bool holdToRounding() const { return holdWithin(0, 1); }

  /// Whether the constraints leave no motion where they are, in the state of the last project: it left one of them off
  /// by more than `error` (m or rad) and rounding, and no force can give the accelerations that the velocities ask for.
  /// Where motion only passes a place at which it could take another way, forces can.
  bool leaveNoMotion(const VectorX& state, double error);

  /// How far the velocities are from keeping the constraints: max |J v| / scale.
  ConstraintRate largestRate(const VectorX& state) const;

 private:
  /// Two blocks that share a body, which puts a block beside the diagonal of the matrix.
  struct Coupling {
    std::size_t row, column;
    SharedBodies shared;
  };
  bool moves(int body) const;
  bool hasKnownStructure() const;
  void analyze();
  void findBlocks(const VectorX& state, const std::vector<BodyFrame>& frames);
  void assemble();
  void assembleWithEqualMasses();
  bool areRowsIndependent();
  void opposeVelocities(const VectorX& state);
  void opposeAccelerations(const VectorX& derivative);
  void ignoreEmptyRows();
  void solve();
  template <class Add>
  void addResponses(Add&& add) const;
  template <class Visit>
  void forEachRow(const Visit& visit) const;
  double displace(bool inSum, VectorX& state);
  bool holdWithin(double error, double roundings) const;
  double contradiction(const VectorX& state);

  const Constraints& constraints_;
  const std::vector<RigidBody>& bodies_;
  std::vector<char> excluded_, fixed_;  // by body, or none
  std::vector<BodyFrame> frames_;
  std::vector<ConstraintBlock> blocks_;  // of the constraints that are not excluded
  std::vector<BlockResponse> responses_;
  std::vector<BlockResponse> ownResponses_;    // scratch
  std::vector<std::array<int, 3>> structure_;  // bodies and rows of each, when the couplings were found
  std::vector<Coupling> couplings_;            // in the order of their places in factor_
  std::unique_ptr<BlockLdlt> factor_;          // none before factorize
  bool isRegular_ = true;
  VectorX multipliers_, rightHandSide_, residual_, undisplaced_, sum_;
};

}  // namespace cradle
