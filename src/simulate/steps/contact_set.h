#pragma once

#include <vector>

#include "collision/separation.h"
#include "simulate/assembly.h"
#include "simulate/steps/contact_energy.h"
#include "simulate/steps/step_tolerances.h"

namespace cradle {

/// Contacts of a step whose bodies touch or are joined: they are one frictional contact problem.
struct StepGroup {
  std::vector<std::size_t> members;  // of the ContactSet, ascending
  std::vector<Contact> contacts;     // the same
  MovedBodies moved;
  int firstBody = 0;
  bool isConstrained = false;  // constraints act on a body of it
};

/// The contacts of a step: those of bodies, then ropes, as contacts of the bodies at their ends that may close by their
/// slack.
class ContactSet {
 public:
  /// Keeps references to `assembly` and `tolerances`. `contacts` and `ropes` (none of them a rod) are those at the
  /// state `before`. Without contacts, ropes are none of its members.
  ContactSet(const Assembly& assembly, const StepTolerances& tolerances, const std::vector<Contact>& contacts,
             const std::vector<const Limit*>& ropes, const VectorX& before);

  std::size_t size() const { return contacts_.size(); }
  const Contact& operator[](std::size_t member) const { return contacts_[member]; }
  const Assembly& assembly() const { return assembly_; }

  /// The rope that a member is; null if it is a contact of bodies.
  const Limit* ropeOf(std::size_t member) const {
    return member < firstRope() ? nullptr : ropes_[member - firstRope()];
  }
  const ContactMaterial& materialOf(std::size_t member) const;

  const StepTolerances& tolerances() const { return tolerances_; }

  /// The groups of its members, in the order of their first bodies.
  std::vector<StepGroup> findGroups() const;

 private:
  std::size_t firstRope() const { return contacts_.size() - ropes_.size(); }
  bool isOnSmoothPlane(std::size_t member) const;

  const Assembly& assembly_;
  const StepTolerances& tolerances_;
  std::vector<Contact> contacts_;               // ropes are the last
  std::vector<const Limit*> ropes_;             // of the last contacts
  std::vector<ContactMaterial> ropeMaterials_;  // theirs
};

}  // namespace cradle
