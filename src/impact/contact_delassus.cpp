#include "impact/contact_delassus.h"

#include <cmath>

namespace cradle {
namespace {

std::vector<Mat3> axesOf(const std::vector<Contact>& contacts) {
  std::vector<Mat3> axes;
  for (const Contact& contact : contacts) axes.push_back(contactAxes(contact.normal));
  return axes;
}

std::vector<ConstraintBlock> blocksAlong(const std::vector<Mat3>& axes, const std::vector<Contact>& contacts,
                                         const VectorX& state) {
  std::vector<ConstraintBlock> blocks;
  for (std::size_t i = 0; i < contacts.size(); ++i) blocks.push_back(rowsAlong(axes[i], contacts[i], state));
  return blocks;
}

}  // namespace

Mat3 contactAxes(const Vec3& normal) {
  // Gram-Schmidt on the world's axis that is farthest from the normal.
  int least = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(normal[axis]) < std::abs(normal[least])) least = axis;
  Mat3 axes;
  axes.col(2) = normal;
  axes.col(0) = (Vec3::Unit(least) - normal[least] * normal).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

ContactDelassus::ContactDelassus(const std::vector<Contact>& contacts, const ImpulseResponse& response,
                                 const VectorX& state)
    : axes_(axesOf(contacts)), delassus_(response.delassusOf(blocksAlong(axes_, contacts, state), state)) {}

double ContactDelassus::mobility(std::size_t contact) const {
  const Eigen::Index normal = 3 * static_cast<Eigen::Index>(contact) + 2;
  return matrix()(normal, normal) / delassus_.unconstrainedDiagonal(normal);
}

}  // namespace cradle
