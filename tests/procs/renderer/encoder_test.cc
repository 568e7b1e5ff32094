#include "procs/renderer/encoder.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <stdexcept>
#include <vector>

namespace lab::renderer {
namespace {

TEST(Encoder, DoesJobsInOrderOnAnotherThread) {
  std::vector<int> seen;
  std::vector<std::thread::id> threads;
  Encoder encoder;
  for (int i = 0; i < 50; ++i)
    encoder.push([&, i] { seen.push_back(i), threads.push_back(std::this_thread::get_id()); });
  encoder.finish();
  ASSERT_EQ(seen.size(), 50u);
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(seen[i], i);
    EXPECT_NE(threads[i], std::this_thread::get_id());
  }
  EXPECT_EQ(encoder.done(), 50);
}

TEST(Encoder, KeepsAFewJobsAndThenMakesThePusherWait) {
  std::promise<void> gate;
  const std::shared_future<void> open = gate.get_future().share();
  std::atomic<int> pushed = 0;
  Encoder encoder;
  std::thread pusher([&] {
    for (int i = 0; i < 10; ++i) encoder.push([open] { open.wait(); }), ++pushed;
  });
  while (pushed < static_cast<int>(Encoder::kMaxWaiting)) std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // time to do wrong
  EXPECT_EQ(pushed, static_cast<int>(Encoder::kMaxWaiting));
  EXPECT_EQ(encoder.done(), 0);
  gate.set_value();
  pusher.join();
  encoder.finish();
  EXPECT_EQ(encoder.done(), 10);
}

TEST(Encoder, ErrorsReachTheNextCallAndEndTheWork) {
  Encoder encoder;
  std::atomic<bool> later = false;
  encoder.push([] { throw std::runtime_error("the disk is full"); });
  EXPECT_THROW(encoder.finish(), std::runtime_error);
  EXPECT_THROW(encoder.push([&] { later = true; }), std::runtime_error);
  try {
    encoder.finish();
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "the disk is full");
  }
  EXPECT_FALSE(later);
  EXPECT_EQ(encoder.done(), 0);
}

TEST(Encoder, WhatWaitsIsDoneBeforeItGoes) {
  std::atomic<int> done = 0;
  {
    Encoder encoder;
    for (int i = 0; i < 3; ++i) encoder.push([&] { ++done; });
  }
  EXPECT_EQ(done, 3);
}

}  // namespace
}  // namespace lab::renderer
