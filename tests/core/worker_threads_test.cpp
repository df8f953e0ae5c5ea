#include "core/worker_threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>

namespace cradle {
namespace {

TEST(WorkerThreads, ShareAllOfALoop) {
  for (const int count : {1, 2, 5}) {
    WorkerThreads threads(count);
    std::vector<int> visits(17, 0);
    threads.run([&](int thread) {
      const auto [first, last] = threads.partOf(visits.size(), thread);
      for (std::size_t i = first; i < last; ++i) ++visits[i];
    });
    EXPECT_EQ(visits, std::vector<int>(17, 1)) << count;
  }
}

TEST(WorkerThreads, HandOutEveryPartOnce) {
  for (const int count : {1, 2, 5}) {
    WorkerThreads threads(count);
    for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{1000}}) {
      std::vector<int> visits(size, 0);
      threads.share(size, 7, [&](int, std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) ++visits[i];
      });
      EXPECT_EQ(visits, std::vector<int>(size, 1)) << count;
    }
  }
}

// Each round reads what the other thread wrote in the round before.
TEST(WorkerThreads, SeeWhatOthersDidBeforeTheyMet) {
  WorkerThreads threads(2);
  std::vector<long> values(2, 1), next(2);
  threads.run([&](int thread) {
    const std::size_t mine = static_cast<std::size_t>(thread);
    for (int round = 0; round < 40; ++round) {
      next[mine] = values[0] + values[1];
      threads.meet();
      values[mine] = next[mine];
      threads.meet();
    }
  });
  EXPECT_EQ(values[0], 1L << 40);
  EXPECT_EQ(values[1], 1L << 40);
}

// Whoever throws, before or behind meetings of the others, is told, and the next task finds the threads as new.
TEST(WorkerThreads, TellWhatATaskThrows) {
  for (const int count : {1, 2, 5}) {
    WorkerThreads threads(count);
    for (int thrower = 0; thrower < count; ++thrower)
      for (int meetings = 0; meetings < 4; ++meetings) {
        EXPECT_THROW(threads.run([&](int thread) {
          for (int meeting = 0; meeting < 5; ++meeting) {
            if (thread == thrower && meeting == meetings) throw std::runtime_error("one");
            threads.meet();
          }
        }),
                     std::runtime_error);
        std::atomic<int> visits = 0;
        threads.run([&](int) {
          threads.meet();
          ++visits;
        });
        EXPECT_EQ(visits, threads.count());
      }
  }
}

}  // namespace
}  // namespace cradle
