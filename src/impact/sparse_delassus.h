#pragma once

#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "impact/block_lu.h"
#include "impact/contact_impulse.h"
#include "impact/delassus_operator.h"

namespace cradle {

/// The Delassus operator W = J M^-1 J^T of contacts by its factors: it is never formed. Linear in the number of
/// contacts and constraints for stacks and chains.
class SparseDelassus {
 public:
  /// Contacts, and bodies without constraints at their places in `state`, as they are now. Keeps what `analyze` found
  /// for the calls after, as long as the same bodies touch.
  void set(const std::vector<Contact>& contacts, const std::vector<RigidBody>& bodies, const VectorX& state);

  /// The same of bodies whose constraints, which must be factorised for `state`, respond within the same impulse. Keeps
  /// a reference to them.
  void set(const std::vector<Contact>& contacts, const std::vector<RigidBody>& bodies, ConstraintSolver& constraints,
           const VectorX& state);

  /// World from the axes of a contact.
  const Mat3& axes(std::size_t contact) const { return contacts_[contact].axes; }

  /// Velocities (m/s) of all contacts for the velocities in a state.
  VectorX velocitiesIn(const VectorX& velocities) const;

  /// Adds to the velocities in `state` what the impulses give.
  void apply(const VectorX& impulses, VectorX& state) const;

  /// In 1/kg, dense; of bodies without constraints.
  MatrixX matrix() const;

  /// Ratio of the inverse mass along a contact's normal to that without constraints.
  double mobility(std::size_t contact) const;

  /// For solvers; valid as long as this stays where it is, until the next `set`.
  DelassusOperator scaledOperator();

 private:
  using Mat36 = Eigen::Matrix<double, 3, 6>;
  struct Row {
    Mat3 axes;                // world from (t1, t2, n)
    std::array<int, 2> body;  // index of A and of B in bodies_; -1: no force moves it
    std::array<Mat36, 2> j;   // rows of J = D J0 M^-1/2 (sparse_delassus.cpp) for A and for B
    double scale = 1;         // sqrt(kg), the contact's entry of D: its scaled inverse mass is 1
  };
  /// A constraint among the bodies: its rows B M^-1/2, each of length 1; those that are none of its rows are zero.
  struct Tie {
    std::array<int, 2> body;  // as of a Row
    std::array<Mat6, 2> b;
    int rows;
  };
  /// A driven body of a contact: it has a velocity, and no response.
  struct DrivenSide {
    std::size_t contact;
    int body;
    Mat36 j;  // rows of J0
  };
  struct BodyRoot {
    Eigen::Index index;   // in the state
    double inverseMass;   // 1/sqrt(kg): square root of the inverse mass
    Mat3 inverseInertia;  // Cholesky factor (lower) of the inverse inertia tensor, world axes
  };
  void setContacts(const std::vector<Contact>& contacts, const std::vector<RigidBody>& bodies, const VectorX& state);
  void setTies(const std::vector<RigidBody>& bodies, const VectorX& state);
  void analyze();
  int localOf(int body, const std::vector<RigidBody>& bodies, const VectorX& state);
  void placeTies();
  void applyAlone(const VectorX& impulses, VectorX& state) const;
  void factorize(const std::vector<ContactEquation>& equations);
  VectorX solve(const VectorX& sides, VectorX* velocities);
  VectorX multiply(const VectorX& z);
  VectorX multiplyTied(const VectorX& z) const;
  double magnitude(const VectorX& z);
  Tie tieOf(const ConstraintBlock& block, const std::array<int, 2>& bodies) const;
  static Mat36 rowsAt(const Contact& contact, int body, const VectorX& state);
  Row rowOf(const Contact& contact, const std::array<int, 2>& bodies, const VectorX& state) const;
  void removeCompliance();
  void gather(const VectorX& impulses);
  Vec3 velocityOfBodies(std::size_t contact) const;

  ConstraintSolver* constraints_ = nullptr;  // null: there are none
  std::vector<Row> contacts_;
  std::vector<BodyRoot> bodies_;
  std::vector<DrivenSide> drivenSides_;
  std::vector<Tie> ties_;
  std::map<int, int> known_;                // index in bodies_ of each body
  std::vector<std::pair<int, int>> pairs_;  // of bodies that touch, then of ties and their bodies
  std::vector<std::size_t> pairOf_;         // of each contact
  std::size_t firstTiePair_ = 0;
  BlockLu factor_;
  std::vector<std::pair<int, int>> analyzed_;
  std::size_t analyzedBodies_ = 0, analyzedTies_ = 0;
  std::vector<Mat3> inverses_, stiffnesses_;  // A^-1 and A^-1 B of the equations A dz + B du = side
  Eigen::Index stateSize_ = 0;
  VectorX bodyWork_, correction_;
};

}  // namespace cradle
