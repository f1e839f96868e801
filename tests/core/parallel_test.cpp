// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "core/hash.h"

namespace vrc {
namespace {

class ParallelTest : public ::testing::Test {
 protected:
  void TearDown() override { set_thread_count(0); }
};

TEST_F(ParallelTest, CoversEachIndexOnce) {
  for (const int threads : {1, 2, 4}) {
    EXPECT_EQ(set_thread_count(threads), threads);
    EXPECT_EQ(thread_count(), threads);
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{10007}}) {
      std::vector<std::atomic<int>> visits(count);
      parallel_for(count, [&](std::size_t i) { ++visits.at(i); });
      for (std::size_t i = 0; i < count; ++i)
        ASSERT_EQ(visits[i].load(), 1) << "index " << i << " of " << count;
    }
  }
}

TEST_F(ParallelTest, ZeroThreadsUsesEveryProcessor) {
  set_thread_count(1);
  EXPECT_GE(set_thread_count(0), 1);
  EXPECT_EQ(set_thread_count(-3), set_thread_count(0));
}

TEST_F(ParallelTest, SameBytesAtOneAndTwoThreads) {
  const auto compute = [](int threads) {
    set_thread_count(threads);
    std::vector<float> values(4096);
    parallel_for(values.size(), [&](std::size_t i) {
      float sum = 0.0f;
      for (std::uint64_t k = 0; k < 64; ++k) sum += std::sin(static_cast<float>(hash(i, k) >> 40)) * 1e-3f;
      values[i] = sum;
    });
    return values;
  };
  const auto one = compute(1), two = compute(2);
  EXPECT_EQ(std::memcmp(one.data(), two.data(), one.size() * sizeof(float)), 0);
}

TEST_F(ParallelTest, FlushesDenormalsOnEveryThread) {
  set_thread_count(2);
  std::vector<float> products(1000, 1.0f);
  parallel_for(products.size(), [&](std::size_t i) {
    volatile float tiny = 1e-30f;
    products[i] = tiny * 1e-10f;
  });
  for (const float p : products) ASSERT_EQ(p, 0.0f);
}

TEST_F(ParallelTest, PassesExceptionsOn) {
  set_thread_count(2);
  EXPECT_THROW(parallel_for(1000,
                            [](std::size_t i) {
                              if (i == 617) throw std::runtime_error("617");
                            }),
               std::runtime_error);
}

}  // namespace
}  // namespace vrc
