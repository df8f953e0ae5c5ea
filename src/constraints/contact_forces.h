#pragma once

#include <array>
#include <optional>
#include <vector>

#include "constraints/constraint_forces.h"
#include "constraints/contact_groups.h"
#include "constraints/minimum_norm.h"

namespace cradle {

/// What acts at a contact, and how it moves, at one instant. Where the rows of several contacts depend on each other (a
/// box on its four corners) the motion is determined and the forces are not: these are the shortest of all multipliers
/// that give the motion. They tell that friction holds, if they lie in the cones; not that it does not, if they don't.
struct ContactForce {
  double normal = 0;                       // N, of the multiplier: < 0 pulls
  Vec3 tangential = Vec3::Zero();          // N, on A, world
  Vec3 direction = Vec3::Zero();           // of the normal force on A, unit, world
  Vec3 point = Vec3::Zero();               // m, world
  Vec3 tangentialVelocity = Vec3::Zero();  // m/s, of A relative to B, world
  Vec3 slidingDirection = Vec3::Zero();    // unit, world; zero unless sliding: friction on A is against it
  // m/s^2, where rows depend on each other: the acceleration against a row that they leave, as they contradict each
  // other, and the largest that those of the group were to take out
  double left = 0, asked = 0;
};

/// Forces of active contacts, of bodies whose constraints respond to them: the rows of a group of contacts have the
/// Delassus operator W = J (M^-1 - M^-1 B^T (B M^-1 B^T)^-1 B M^-1) J^T, B the constraints' rows, which
/// ConstraintSolver solves. The cost is cubic in the rows of the contacts of each group, linear in the groups and in
/// the constraints of chains and trees (for each row once). Redundant rows are allowed; where they contradict each
/// other, the contradiction is left as small as it can be. Allocates only when bodies are joined in another way than in
/// the call before.
class ContactSolver {
 public:
  /// Keeps references to all.
  ContactSolver(const std::vector<ContactConstraint>& contacts, const Constraints& constraints,
                const std::vector<RigidBody>& bodies);

  /// Takes the rows in `state` at `time` (s), in which the bodies have `frames`, and factorises. `resting` bodies act
  /// as fixed.
  void factorize(double time, const VectorX& state, const std::vector<BodyFrame>& frames,
                 const std::vector<char>& resting);

  /// Adds to the accelerations in `derivative` what contacts and constraints give, and to the energy of friction what
  /// sliding takes. The accelerations of resting bodies must be zero; they stay so.
  void constrainAccelerations(VectorX& derivative);

  /// Of each contact, after constrainAccelerations.
  const std::vector<ContactForce>& forces() const { return forces_; }

  /// Of the constraints' rows, after constrainAccelerations, as ConstraintSolver gives them.
  const VectorX& bilateralMultipliers() const { return bilateralMultipliers_; }

  /// Takes out of the velocities what would change gaps and constraints, and what makes sticking contacts slide, by the
  /// least change of kinetic energy.
  void constrainVelocities(VectorX& state);

  /// Moves the bodies by the least (mass-weighted) motion until no contact has a gap and all constraints hold, to
  /// rounding; then constrains the velocities. Returns the largest error that was found, in m or rad. `resting` bodies
  /// stay.
  double project(VectorX& state, const std::vector<char>& resting);

 private:
  /// Rows, what bodies make of their multipliers, and in groups with constraints, whose bodies all respond, the
  /// velocities that 1 of each gives, in the layout of a state.
  struct Response {
    ConstraintBlock block;
    BlockResponse alone;
    std::array<VectorX, 3> constrained;
  };
  struct ActiveBlock {
    int firstRow = 0;  // in its group
    Response rows;     // of the gap, and of a contact that sticks two before it
    Response push;     // of one that slides: its normal force with the friction that goes with it
  };
  struct Group {
    ContactGroup members;
    std::optional<ConstraintSolver> constraints = {};  // if it has any
    int rows = 0;
    bool slides = false;
    bool hasNoLoop = false;  // few contacts, which join bodies without a loop
    bool isPlaced = false;   // by project, as well as it can be
    double error = 0;        // m or rad, that project found last
    double asked = 0;        // the largest rate that was to be taken out last
    MinimumNormSolver solver = {};
  };
  /// How a contact or a constraint joined two bodies when groups were found: `kind` is the motion of a contact, or the
  /// number of rows of a constraint.
  struct Joint {
    int bodyA, bodyB, kind;
    bool operator==(const Joint&) const = default;
  };

  static Joint jointOf(const ContactConstraint& contact);
  static Joint jointOf(const Constraint& constraint);
  bool hasKnownStructure(const std::vector<char>& resting) const;
  void analyze(const std::vector<char>& resting);
  void sizeRows();
  int movingBody(int body) const;

  void place(const VectorX& state, const std::vector<BodyFrame>& frames, const std::vector<char>& resting);
  void findBlocks(const std::vector<BodyFrame>& frames, bool withTangents);
  void findResponse(Group& group, const std::vector<BodyFrame>& frames, Response& response);
  template <int rows, int columns>
  static Eigen::Matrix<double, rows, columns> entriesOf(const Group& group, const ConstraintBlock& seen,
                                                        const Response& of);
  void couple(Group& group);
  void findDiagonal(Group& group);
  void coupleFriction(Group& group, const std::vector<BodyFrame>& frames, double time);
  void addFriction(Group& group, std::size_t contact, const std::vector<BodyFrame>& frames, double time);

  template <class Constrain, class Asked>
  void solve(Group& group, const Constrain& constrain, const Asked& asked, VectorX& motion);
  void takeForces(const Group& group, VectorX& derivative);
  void takeContradictions(const Group& group, const VectorX& derivative);

  void constrainGroupVelocities(VectorX& state);
  void placeGaps(const VectorX& state, const std::vector<char>& resting);
  bool sharesLoads(const Group& group) const;
  double errorOf(const Group& group) const;
  bool isRounding(const Group& group) const;
  void displace(Group& group, VectorX& state);
  bool judge(Group& group, VectorX& state) const;

  const std::vector<ContactConstraint>& contacts_;
  const Constraints& constraints_;
  const std::vector<RigidBody>& bodies_;
  ConstraintSolver constraintSolver_;  // of bodies without a contact
  bool hasFreeConstraints_ = false;

  std::vector<Joint> contactJoints_, constraintJoints_;
  std::vector<char> resting_;
  std::vector<Group> groups_;

  std::vector<ContactKinematics> kinematics_;
  std::vector<ContactForce> forces_;
  std::vector<ActiveBlock> blocks_;
  std::vector<double> multipliers_;  // of the group that was solved last
  VectorX bilateralMultipliers_, free_, undisplaced_, displacement_;
  std::vector<BodyFrame> frames_;
};

}  // namespace cradle
