#pragma once

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "impact/block_lu.h"
#include "impact/contact_admm.h"
#include "impact/contact_impulse.h"
#include "impact/frictional_contact.h"

namespace cradle {

/// A warm start: where an iteration begins, and where it ended: impulses (N s) and velocities (m/s) of the contacts by
/// components (t1, t2, n), De Saxce's correction included, and the penalty (in scaled units; 0: none known).
struct WarmStart {
  VectorX impulses, velocities;
  double penalty = 0;
};

/// Contacts of bodies without constraints as a frictional contact problem (frictional_contact.h), whose Delassus
/// operator J M^-1 J^T is never formed: it is applied by its factors. Linear in the number of contacts for stacks and
/// chains.
class SparseContactProblem {
 public:
  /// Contacts, and bodies at their places in `state`, as they are now. Keeps what `analyze` found for the calls after,
  /// as long as the same bodies touch.
  void set(const std::vector<Contact>& contacts, const std::vector<RigidBody>& bodies, const VectorX& state);

  /// World from the axes of a contact.
  const Mat3& axes(std::size_t contact) const { return contacts_[contact].axes; }

  /// Velocities (m/s) of all contacts for the velocities in a state.
  VectorX velocitiesIn(const VectorX& velocities) const;

  /// Adds to the velocities in `state` what the impulses give.
  void apply(const VectorX& impulses, VectorX& state) const;

  /// The Delassus operator, in 1/kg, dense.
  MatrixX delassus() const;

  /// By Newton's method from `start`, to `tolerance` (m/s); if that does not lead there, from where ADMM or an interior
  /// point method do, and then ten times the tolerance is enough. If nothing does, the best that was found. Leaves in
  /// `start` where it ended, and adds to `iterations` those of the last two.
  ContactSolution solve(const VectorX& free, const std::vector<double>& frictions, double tolerance, WarmStart& start,
                        long& iterations);

 private:
  using Mat36 = Eigen::Matrix<double, 3, 6>;
  struct Row {
    Mat3 axes;                // world from (t1, t2, n)
    std::array<int, 2> body;  // of A and B among bodies_, or -1
    std::array<Mat36, 2> j;   // of A and B: velocity of the contact from velocities times root of mass
    double scale = 1;         // of its impulses: inverse mass 1
  };
  struct BodyRoot {
    Eigen::Index index;   // in the state
    double inverseMass;   // 1/kg, square root of
    Mat3 inverseInertia;  // world, lower root of
  };
  struct Found {
    VectorX impulses, velocities;  // scaled
    double residual = INFINITY;    // m/s
  };
  void assemble(double shift, const std::vector<Mat3>& scalingBlocks);
  Row rowOf(const Contact& contact, const std::array<int, 2>& bodies, const VectorX& state) const;
  void factorize(double shift);
  void stepByNewton(VectorX& z, VectorX& u);
  void approachByAdmm(int iterations, AdmmIterate& at);
  long approachFromInside(double tolerance, AdmmIterate& at);
  bool polish(VectorX& z, VectorX& u, double tolerance);
  void multiply(const VectorX& impulses, VectorX& velocities);
  void gather(const VectorX& impulses);
  Vec3 velocityOfBodies(std::size_t contact) const;
  void solveShifted(VectorX& b);
  double residual(const VectorX& z, const VectorX& u) const;
  bool accept(const VectorX& impulses, double tolerance, Found& found);
  bool search(double tolerance, AdmmIterate& at, Found& found, long& iterations);
  AdmmIterate scaled(const WarmStart& start) const;
  void takeVelocities(const VectorX& u, AdmmIterate& at) const;

  std::vector<Row> contacts_;
  std::vector<BodyRoot> bodies_;
  std::vector<std::pair<int, int>> pairs_;  // of bodies that touch
  std::vector<std::size_t> pairOf_;         // of each contact
  BlockLu factor_;
  std::vector<std::pair<int, int>> analyzed_;
  std::size_t analyzedBodies_ = 0;
  ScaledContacts cones_;
  double shift_ = 0;                 // of what is factorised, 0 if that is something else
  std::vector<Mat3> scalingBlocks_;  // work
  VectorX bodyWork_;
};

}  // namespace cradle
