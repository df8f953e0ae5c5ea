#pragma once

#include <string_view>

namespace cradle {

constexpr int kMaxRedundant = 12;    // rows of contacts that hold each other: with more, contact steps cost less
constexpr int kMaxIndependent = 40;  // the same

/// How many events are too many.
struct EventRateLimit {
  int most = 0, ofAFailure = 0;  // in a window; events that a failure of redundant contacts counts for
  double window = 0;             // s
  std::string_view limit, reason;
};

// A failure of redundant contacts takes as long to find as 50 events. Where a look is enough, what chatters costs less
// in steps; a burst, as at the end of bounces, does not.
constexpr EventRateLimit kEventRateLimit{500, 50, 1.0 / 60, "contacts change at most 500 times in 1/60 s",
                                         "contacts change more than 500 times in 1/60 s, or redundant ones 10 times"};
constexpr EventRateLimit kVisualEventRateLimit{60, 50, 0.25, "contacts change at most 60 times in 1/4 s",
                                               "contacts change more than 60 times in 1/4 s"};

/// Once the promise is given up: what chatters again costs less in steps.
constexpr EventRateLimit kTrialEventRateLimit{60, 50, 1.0 / 60, kEventRateLimit.limit, kEventRateLimit.reason};

/// With bodies whose promise holds whatever comes: some 0.2 s of computing.
constexpr EventRateLimit kLongEventRateLimit{20000, 50, 1.0 / 60, "", ""};

}  // namespace cradle
