#include "constraints/block_response.h"

namespace cradle {

void findResponse(const ConstraintBlock& block, const std::vector<RigidBody>& bodies,
                  const std::vector<BodyFrame>& frames, BlockResponse& response) {
  const auto inverseMassOf = [&bodies](int body) {
    return body == kFixed ? 0 : bodies[static_cast<std::size_t>(body)].inverseMass;
  };
  response.inverseMassA = inverseMassOf(block.bodyA), response.inverseMassB = inverseMassOf(block.bodyB);
  const auto findTurn = [&](int body, const ConstraintBlock::Jacobian& angular, ConstraintBlock::Jacobian& turn) {
    const std::size_t index = static_cast<std::size_t>(body);
    const Mat3 inverseInertia = bodies[index].hasConstantSpin ? Mat3::Zero() : frames[index].inverseInertia;
    withRows(block.rows, [&](auto rows) {
      for (int k = 0; k < 3; ++k)
        for (int i = 0; i < rows; ++i) turn(i, k) = dotOf(angular, i, inverseInertia.col(k));
    });
  };
  if (block.turnsA) findTurn(block.bodyA, block.angularA, response.turnA);
  if (block.turnsB) findTurn(block.bodyB, block.angularB, response.turnB);
}

double mobilityOf(const ConstraintBlock& row, const std::vector<RigidBody>& bodies,
                  const std::vector<BodyFrame>& frames) {
  BlockResponse response;
  findResponse(row, bodies, frames, response);
  double mobility;
  putDelassus<1, 1>(row, row, response, &mobility, 1);
  return mobility;
}

}  // namespace cradle
