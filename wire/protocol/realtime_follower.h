// The planner or the controller in real time: answers only the newest state, and skips those that it missed.
#pragma once
#include "wire/protocol/follower.h"

namespace lab {

class RealtimeFollower : public FollowerRun {
 public:
  using FollowerRun::FollowerRun;

  void start(const ReadLog& read_log, Micros now) override;
  void receive(Channel channel, std::span<const uint8_t> bytes, Micros now) override;
  void on_simulator_state(const std::string& state) override { held_ = state != "RUNNING"; }
  void tick(Micros now) override;
  Micros wake() const override { return newest_.empty() ? INT64_MAX : retry_timer_.due(); }
  Micros batch() const override { return kNoSpin; }
  std::string state() const override;

 protected:
  /// Answers the newest state; false if it cannot, such as without a reference.
  virtual bool answer(const robot_state_t& state, std::span<const Action> actions) = 0;
  /// Takes a message on any other channel than ROBOT_STATE and INPUT.
  virtual void receive_other(Channel, std::span<const uint8_t>) {}
  /// True if the simulator holds the robot, as its PROCESS says.
  bool held() const { return held_; }

 private:
  Bytes newest_;  ///< the newest ROBOT_STATE, until it is answered
  Micros answered_at_ = 0;
  static constexpr int kAsks = 6;  ///< 63 ms in all
  int asked_ = 0;                  ///< times that missing INPUTs were asked for
  bool held_ = true;
  bool unanswered_ = true;  ///< the newest state could not be answered, or none has come for `timeout` steps
};

}  // namespace lab
