#include "impact/dense_contact_problem.h"

#include <cmath>

namespace cradle {

using Index = Eigen::Index;

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

DenseContactProblem::DenseContactProblem(const std::vector<Contact>& contacts, const ImpulseResponse& response,
                                         const VectorX& state)
    : contacts_(contacts), places_(state), delassus_(3 * contacts.size(), 3 * contacts.size()) {
  for (const Contact& contact : contacts) {
    axes_.push_back(contactAxes(contact.normal));
    for (int axis = 0; axis < 3; ++axis)
      impulseResponses_.push_back(response.responseTo(contact, axes_.back().col(axis), state));
  }
  for (std::size_t column = 0; column < impulseResponses_.size(); ++column)
    delassus_.col(static_cast<Index>(column)) = velocitiesIn(impulseResponses_[column]);
  delassus_ = (0.5 * (delassus_ + delassus_.transpose())).eval();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Index normal = 3 * static_cast<Index>(i) + 2;
    isImmobile_.push_back(cradle::isImmobile(contacts[i], response, state, delassus_(normal, normal)));
    const Mat3 untied = response.unconstrainedDelassusAt(contacts[i], state);
    leverages_.push_back(delassus_(normal, normal) / contacts[i].normal.dot(untied * contacts[i].normal));
  }
}

VectorX DenseContactProblem::velocitiesIn(const VectorX& velocities) const {
  VectorX all(3 * contacts_.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    all.segment<3>(3 * static_cast<Index>(i)) =
        axes_[i].transpose() * relativeVelocity(contacts_[i], places_, velocities);
  return all;
}

void DenseContactProblem::apply(const VectorX& impulses, VectorX& state) const {
  const Index size = bodyCount(state) * kVelocitySize, from = poseComponents(state);
  for (std::size_t column = 0; column < impulseResponses_.size(); ++column)
    state.segment(from, size) += impulses[static_cast<Index>(column)] * impulseResponses_[column].segment(from, size);
}

}  // namespace cradle
