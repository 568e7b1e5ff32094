// INPUTs that come in any order, again, or too many at once.
#include "wire/protocol/input_queue.h"

#include <gtest/gtest.h>

#include <lab/input_t.hpp>

#include "wire/schema/codec.h"

namespace lab {
namespace {

Bytes input(int64_t seq) {
  input_t m{};
  m.input_seq = seq;
  m.action.verb = std::to_string(seq);
  return encode(m);
}
std::string taken(InputQueue& queue, int64_t seq) {
  std::string verbs;
  for (const Action& action : queue.take_to(seq)) verbs += action.verb + " ";
  return verbs;
}

TEST(InputQueue, EachIsTakenOnceAndInOrder) {
  InputQueue queue;
  for (int64_t seq : {3, 1, 3}) queue.add(input(seq));
  EXPECT_TRUE(queue.complete_to(1));
  EXPECT_FALSE(queue.complete_to(3)) << "2 is missing";
  queue.add(input(2));
  EXPECT_TRUE(queue.complete_to(3));
  EXPECT_EQ(taken(queue, 2), "1 2 ");
  for (int64_t seq : {1, 2}) queue.add(input(seq));  // sent again for another process
  EXPECT_TRUE(queue.complete_to(3));
  EXPECT_EQ(taken(queue, 3), "3 ");
}

TEST(InputQueue, IsBounded) {
  InputQueue queue;
  const auto many = static_cast<int64_t>(InputQueue::kMaxWaiting);
  for (int64_t seq = 1; seq <= many + 1; ++seq) queue.add(input(seq));
  EXPECT_TRUE(queue.complete_to(many));
  EXPECT_FALSE(queue.complete_to(many + 1));
  queue.take_to(many);
  queue.add(input(many + 1));  // it was asked for again
  EXPECT_TRUE(queue.complete_to(many + 1));
}

}  // namespace
}  // namespace lab
