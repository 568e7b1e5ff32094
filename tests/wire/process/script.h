// A role that says what a test tells it to, and remembers what it was given.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "wire/protocol/lateness.h"
#include "wire/protocol/role.h"

namespace lab {

inline constexpr int64_t kRun = 77, kStep = 10;  ///< the run that a Script takes part in, and where it is

/// A role of a running lab that sends what it is told, until `done` says so or ten seconds are over.
class Script : public Role {
 public:
  void receive(Channel channel, std::span<const uint8_t> bytes, Micros) override {
    heard.emplace_back(channel, Bytes(bytes.begin(), bytes.end()));
  }
  void tick(Micros now) override {
    if (begun_ == 0) {
      begun_ = now;
      send();
    }
    if (done() || now - begun_ > 10'000'000) outcome_.ended = true;
  }
  Micros wake() const override { return due; }
  int urgency() const override { return rank; }
  const Lateness* lateness() const override { return late ? &*late : nullptr; }
  int64_t overruns() const override { return late ? 3 : 0; }
  void stop(Micros) override { outcome_.ended = true; }
  void stranger(Channel channel, const std::string& reason, Micros) override {
    strangers.push_back(std::string(row(channel).name) + ": " + reason);
  }
  void refused(const Refusal& refusal, Micros) override { refusals.push_back(refusal); }
  void neighbour(Micros) override { ++neighbours; }
  const Outcome& outcome() const override { return outcome_; }
  std::string state() const override { return "RUNNING"; }
  int64_t step() const override { return at; }
  int64_t run() const override { return kRun; }
  int64_t model_hash() const override { return 5; }
  int nq() const override { return 1; }
  int nv() const override { return 1; }

  std::function<void()> send = [] {};
  std::function<bool()> done = [] { return true; };
  std::vector<std::pair<Channel, Bytes>> heard;
  std::vector<std::string> strangers;
  std::vector<Refusal> refusals;
  int neighbours = 0;
  int64_t at = kStep;            ///< step()
  Micros due = INT64_MAX;        ///< wake()
  int rank = 0;                  ///< urgency()
  std::optional<Lateness> late;  ///< with it, the role has ticks

 private:
  Outcome outcome_;
  Micros begun_ = 0;
};

}  // namespace lab
