#pragma once

#include <string_view>

namespace cradle {

constexpr int kMaxRedundant = 24;    // dependent rows of active contacts: with more, time stepping costs less
constexpr int kMaxIndependent = 80;  // independent rows: the same

/// The largest rate of events: beyond, time stepping costs less.
struct EventRateLimit {
  int most = 0, ofAFailure = 0;  // in a window; events that a failure of redundant contacts counts for
  double window = 0;             // s
  std::string_view limit, reason;
};

// A failure of redundant contacts takes as long to find as 15 events. At visual accuracies chattering contacts cost
// less with time stepping; a burst of events, as at the end of bounces, does not.
constexpr EventRateLimit kEventRateLimit{500, 15, 1.0 / 60,
                                         "contacts change at most 500 times in 1/60 s, redundant ones 33 times",
                                         "contacts change more than 500 times in 1/60 s, or redundant ones 33 times"};
constexpr EventRateLimit kVisualEventRateLimit{
    60, 15, 0.25, "contacts change at most 60 times in 1/4 s, redundant ones 4 times",
    "contacts change more than 60 times in 1/4 s, or redundant ones 4 times"};

/// Of a trial, after the promise was given up: contacts that chatter again cost less with time stepping.
constexpr EventRateLimit kTrialEventRateLimit{60, 15, 1.0 / 60, kEventRateLimit.limit, kEventRateLimit.reason};

/// Of islands with a promise without conditions: some 0.2 s of computing.
constexpr EventRateLimit kLongEventRateLimit{20000, 15, 1.0 / 60, "", ""};

}  // namespace cradle
