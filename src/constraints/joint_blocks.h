#pragma once

#include <utility>
#include <vector>

#include "constraints/constraint.h"

namespace cradle {

/// J M^-1 J^T of ball joints alone, by blocks of 3 x 3: one for each joint, and one for each two that share a body.
/// Three to four times as cheap as the same rows one by one. Allocates only when bodies are joined in another
/// way than in the call before.
class JointBlocks {
 public:
  /// Takes the joints, ball joints all, in `state`, in which the bodies have `frames`, and factorises. Returns the
  /// smallest pivot as a part of its diagonal entry: near 0 the rows depend on each other, and the solution is not to
  /// be trusted.
  double factorize(const Constraints& joints, const std::vector<RigidBody>& bodies, const VectorX& state,
                   const std::vector<BodyFrame>& frames);

  /// Overwrites a right-hand side, three entries a joint, with the solution.
  void solve(VectorX& x) const;

  std::size_t size() const { return joints_.size(); }
  Vec3 value(std::size_t joint) const { return joints_[joint].a.position - joints_[joint].b.position; }  // C, m

  /// (dJ/dt) v, m/s^2
  Vec3 velocityProduct(std::size_t joint) const { return joints_[joint].a.centripetal - joints_[joint].b.centripetal; }

  /// m: an error of a joint that arithmetic alone explains.
  double rounding(std::size_t joint) const;

  /// J v of a joint for the velocities, or accelerations, in `state`.
  Vec3 rateOf(std::size_t joint, const VectorX& state) const;

  /// Calls add(body, linear, angular) with the parts of M^-1 J^T multipliers, joint by joint.
  template <class Add>
  void addResponse(const VectorX& multipliers, const Add& add) const {
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const Vec3 force = multipliers.segment<3>(static_cast<Eigen::Index>(3 * i));
      const JointSides& joint = joints_[i];
      if (joint.a.body != kFixed) add(joint.a.body, joint.a.inverseMass * force, joint.a.turned(force));
      if (joint.b.body != kFixed) add(joint.b.body, -joint.b.inverseMass * force, Vec3(-joint.b.turned(force)));
    }
  }

 private:
  /// A joint as one of its bodies has it.
  struct Side {
    int body = kFixed;
    bool turns = false;  // it is off the centre of mass
    double inverseMass = 0;
    Vec3 position = Vec3::Zero();     // m, world
    Vec3 arm = Vec3::Zero();          // m, from the centre of mass, world
    Vec3 centripetal = Vec3::Zero();  // m/s^2: acceleration of the point by the spin alone
    Mat3 turn = Mat3::Zero();         // angular acceleration of a force: I^-1 [arm x]
    Vec3 turned(const Vec3& force) const { return turns ? Vec3(turn * force) : Vec3::Zero(); }
  };
  struct JointSides {
    Side a, b;
  };
  /// Two joints of a body: what they have in common there goes to a block below the diagonal.
  struct Coupling {
    std::size_t row, column;  // joints
    bool rowIsA, columnIsA;   // on which of its sides
    std::size_t block = 0;
  };
  struct Below {
    std::size_t block, joint;  // of its row
  };
  struct Update {
    std::size_t target, left, right;  // blocks: target -= left right^T, by what `eliminate` makes of them
  };
  /// A joint in the order of elimination.
  struct Column {
    std::size_t joint;
    std::vector<Below> below;
    std::vector<Update> updates;
  };
  /// Of a diagonal block: L below its diagonal, and the inverses of D.
  struct Pivot {
    double l10 = 0, l20 = 0, l21 = 0;
    Vec3 inverse = Vec3::Zero();
    Vec3 before = Vec3::Zero();  // the diagonal, before others were eliminated
  };
  bool hasKnownStructure(const Constraints& joints) const;
  void analyze(const Constraints& joints);
  void findCouplings();
  void findFill();
  static void place(const Attachment& anchor, const std::vector<RigidBody>& bodies, const VectorX& state,
                    const std::vector<BodyFrame>& frames, Side& side);
  void fill();
  double eliminate();
  double findPivot(std::size_t joint);

  std::vector<JointSides> joints_;
  std::vector<std::pair<int, int>> structure_;  // bodies of each joint, when the couplings were found
  std::vector<Coupling> couplings_;
  std::vector<Column> columns_;
  std::vector<Mat3> blocks_;    // those of the diagonal first, by joint
  std::vector<Mat3> unscaled_;  // L D of those below the diagonal
  std::vector<Pivot> pivots_;   // by joint
};

}  // namespace cradle
