// The bus within one process: who is given what.
#include "procs/solo/memory_bus.h"

#include <gtest/gtest.h>

namespace lab::solo {
namespace {

/// A role that only writes down what it is given.
class Ear : public Role {
 public:
  void receive(Channel, std::span<const uint8_t> bytes, Micros) override { heard.push_back(bytes[0]); }
  void tick(Micros) override {}
  Micros wake() const override { return INT64_MAX; }
  void stop(Micros) override {}
  const Outcome& outcome() const override { return outcome_; }
  std::string state() const override { return "RUNNING"; }
  int64_t step() const override { return 0; }
  int64_t run() const override { return 0; }
  int64_t model_hash() const override { return 0; }
  int nq() const override { return 0; }
  int nv() const override { return 0; }

  std::vector<int> heard;

 private:
  Outcome outcome_;
};

TEST(MemoryBus, GivesEachMessageToAllOthersInOrder) {
  MemoryBus bus;
  std::vector<Ear> roles(3);
  std::vector<Publish> publish;
  for (Ear& role : roles) {
    publish.push_back(bus.publish());
    bus.add(role);
  }
  EXPECT_TRUE(bus.idle());
  for (const auto& [from, what] : {std::pair<size_t, uint8_t>{0, 10}, {2, 20}, {1, 30}})
    publish[from](Channel::Event, std::vector<uint8_t>{what});
  bus.deliver(roles[0], 0, 2);
  EXPECT_FALSE(bus.idle()) << "the third is beyond the limit";
  bus.deliver(roles[0], 0, 10);
  EXPECT_TRUE(bus.idle());
  EXPECT_EQ(roles[0].heard, (std::vector<int>{20, 30}));
  EXPECT_EQ(roles[1].heard, (std::vector<int>{10, 20}));
  EXPECT_EQ(roles[2].heard, (std::vector<int>{10, 30}));
}

}  // namespace
}  // namespace lab::solo
