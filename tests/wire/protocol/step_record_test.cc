// The bytes of one step: which channels have a place in it.
#include "wire/protocol/step_record.h"

#include <gtest/gtest.h>

#include <lab/event_t.hpp>
#include <lab/input_t.hpp>

#include "wire/schema/codec.h"

namespace lab::test {
namespace {

// A channel whose row says that it is logged, and that no record of a step keeps, would be missing in log and digest.
TEST(StepRecord, KeepsEveryLoggedChannelOfAStep) {
  for (const ChannelRow& channel : kChannelTable) {
    if (channel.log_file != LogFile::Log || channel.id == Channel::Run || channel.id == Channel::Type ||
        channel.id == Channel::End || channel.id == Channel::Check)
      continue;
    StepRecord record;
    const Bytes bytes = channel.id == Channel::Input   ? encode(input_t{})
                        : channel.id == Channel::Event ? encode(event_t{})
                                                       : Bytes(40);
    EXPECT_TRUE(record.store(channel.id, bytes, false)) << channel.name;
  }
}

}  // namespace
}  // namespace lab::test
