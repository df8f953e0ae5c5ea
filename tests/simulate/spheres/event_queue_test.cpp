#include "simulate/spheres/event_queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace cradle {
namespace {

TEST(EventQueue, HasTheEarliestTimeWhateverChanged) {
  std::mt19937 random(1);
  for (const int parts : {1, 2, 3, 8, 13}) {
    EventQueue queue(parts);
    std::vector<double> times(static_cast<std::size_t>(parts), std::numeric_limits<double>::infinity());
    for (int change = 0; change < 200; ++change) {
      const std::size_t part = random() % times.size();
      times[part] = static_cast<double>(random() % 7);  // many are equal
      queue.set(static_cast<int>(part), times[part]);
      const auto first = std::min_element(times.begin(), times.end());  // the first of equals
      EXPECT_EQ(queue.first(), static_cast<int>(first - times.begin()));
      EXPECT_EQ(queue.firstTime(), *first);
    }
  }
}

}  // namespace
}  // namespace cradle
