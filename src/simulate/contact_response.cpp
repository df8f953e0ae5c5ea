#include "simulate/contact_response.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

Mat3 frameOf(const Vec3& normal) {
  Mat3 frame;
  frame.col(0) = normal.unitOrthogonal();
  frame.col(1) = normal.cross(frame.col(0));
  frame.col(2) = normal;
  return frame;
}

}  // namespace

ContactResponse::ContactResponse(const std::vector<Contact>& contacts, const ImpulseResponse& response,
                                 const VectorX& state)
    : contacts_(contacts), places_(state), inverseMass_(3 * contacts.size(), 3 * contacts.size()) {
  for (const Contact& contact : contacts) frames_.push_back(frameOf(contact.normal));
  for (std::size_t i = 0; i < contacts.size(); ++i)
    for (Index k = 0; k < 3; ++k) {
      answers_.push_back(response.answerTo(contacts[i], frames_[i].col(k), state));
      inverseMass_.col(std::ssize(answers_) - 1) = relative(answers_.back());
    }
  inverseMass_ = (0.5 * (inverseMass_ + inverseMass_.transpose())).eval();
}

VectorX ContactResponse::relative(const VectorX& velocities) const {
  VectorX result(3 * contacts_.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    result.segment<3>(3 * static_cast<Index>(i)) =
        frames_[i].transpose() * relativeVelocity(contacts_[i], places_, velocities);
  return result;
}

void ContactResponse::apply(const VectorX& impulses, VectorX& velocities) const {
  const Index count = velocities.size() - poseComponents(velocities);
  for (std::size_t i = 0; i < answers_.size(); ++i)
    velocities.tail(count) += impulses[static_cast<Index>(i)] * answers_[i].tail(count);
}

Vec3 ContactResponse::vectorOf(std::size_t contact, const VectorX& impulses) const {
  return frames_[contact] * impulses.segment<3>(3 * static_cast<Index>(contact));
}

}  // namespace cradle
