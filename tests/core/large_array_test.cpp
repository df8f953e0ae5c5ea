#include "core/large_array.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace cradle {
namespace {

TEST(LargeArray, IsAlignedForCachesAndForHugePages) {
  for (const std::size_t count : {std::size_t{1}, std::size_t{1000}, std::size_t{1} << 18, std::size_t{300000}}) {
    LargeArray<double> array(count, 1.5);
    const std::uintptr_t alignment = count * sizeof(double) < (2 << 20) ? 64 : 2 << 20;
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.data()) % alignment, 0u) << count;
  }
}

TEST(LargeArray, KeepsItsContentAsItGrowsPastAHugePage) {
  LargeArray<int> array;
  for (int i = 0; i < 1 << 20; ++i) array.push_back(i);
  int wrong = 0;
  for (int i = 0; i < 1 << 20; ++i) wrong += array[static_cast<std::size_t>(i)] != i;
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace cradle
