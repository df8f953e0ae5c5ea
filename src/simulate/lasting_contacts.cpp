#include "simulate/lasting_contacts.h"

#include <algorithm>

namespace cradle {

LastingContact& LastingContacts::begin(const Bodies& bodies, double time) {
  const LastingContact contact{count_++, bodies.first, bodies.second, time};
  changed_[contact.id] = contact;
  return lasting_[bodies] = contact;
}

void LastingContacts::end(const Bodies& bodies, double time) {
  const auto found = lasting_.find(bodies);
  found->second.end = time;
  changed_[found->second.id] = found->second;
  lasting_.erase(found);
}

void LastingContacts::note(const Event& event) {
  const Bodies bodies{event.bodyA, event.bodyB};
  if (event.kind == EventKind::impact) impacts_[bodies] = event.time;
  if (event.kind == EventKind::contactBegin && !lasting_.contains(bodies)) begin(bodies, event.time);
  if (event.kind == EventKind::contactEnd && lasting_.contains(bodies)) end(bodies, event.time);
}

void LastingContacts::note(Frame& frame) {
  const double before = lastFrame_.value_or(frame.time);
  std::vector<Bodies> gone;
  auto next = frame.contacts.begin();  // ascending, as `lasting_` is
  for (const auto& [bodies, contact] : lasting_) {
    while (next != frame.contacts.end() && Bodies{next->bodyA, next->bodyB} < bodies) ++next;
    if (next == frame.contacts.end() || Bodies{next->bodyA, next->bodyB} != bodies) gone.push_back(bodies);
  }
  for (const Bodies& bodies : gone) end(bodies, std::max(before, lasting_[bodies].begin));
  for (ContactWrench& wrench : frame.contacts) {
    const Bodies bodies{wrench.bodyA, wrench.bodyB};
    const auto known = lasting_.find(bodies);
    const auto impact = impacts_.find(bodies);
    wrench.contact = known != lasting_.end() ? known->second.id
                                             : begin(bodies, impact != impacts_.end() ? impact->second : before).id;
  }
  impacts_.clear();
  lastFrame_ = frame.time;
}

void LastingContacts::finish() {
  while (!lasting_.empty() && lastFrame_)
    end(lasting_.begin()->first, std::max(*lastFrame_, lasting_.begin()->second.begin));
}

std::vector<long> LastingContacts::goingOn() const {
  std::vector<long> numbers;
  for (const auto& [bodies, contact] : lasting_) numbers.push_back(contact.id);
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

std::vector<LastingContact> LastingContacts::takeChanged() {
  std::vector<LastingContact> changed;
  for (const auto& [id, contact] : changed_) changed.push_back(contact);
  changed_.clear();
  return changed;
}

}  // namespace cradle
