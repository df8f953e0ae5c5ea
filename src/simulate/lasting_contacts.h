#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/byte_archive.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Which contacts last, and from when until when, from what happens and from the frames, in the order of time. Event-
/// driven motion tells the instants. Elsewhere a contact begins with the last impact of its bodies, or else at the
/// frame before the first that has it, and ends at the last that has it.
class LastingContacts {
 public:
  void note(const Event& event);

  /// Gives the frame's contacts their numbers.
  void note(Frame& frame);

  /// After the last frame: contacts that go on then end there.
  void finish();

  /// How many there have been.
  long count() const { return count_; }

  /// Those that go on, by number.
  std::vector<long> goingOn() const;

  /// Contacts that have begun or ended since the last call, by number.
  std::vector<LastingContact> takeChanged();

  /// Between frames, when those that have changed were taken.
  template <class Archive>
  friend void visit(Archive& archive, Visited<Archive, LastingContacts>& contacts) {
    archive(contacts.lasting_, contacts.impacts_, contacts.lastFrame_, contacts.count_);
  }

 private:
  using Bodies = std::pair<int, int>;
  LastingContact& begin(const Bodies& bodies, double time);
  void end(const Bodies& bodies, double time);

  std::map<Bodies, LastingContact> lasting_;
  std::map<Bodies, double> impacts_;  // s: the last one of each pair since the last frame
  std::map<long, LastingContact> changed_;
  std::optional<double> lastFrame_;  // s
  long count_ = 0;
};

}  // namespace cradle
