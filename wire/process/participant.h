// The shell around a role, and the only place where a process of the lab meets socket, clock and signals.
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "wire/bus/bus.h"
#include "wire/protocol/loop_bins.h"
#include "wire/protocol/publishers.h"
#include "wire/protocol/role.h"
#include "wire/schema/guard.h"

namespace lab {

struct ParticipantOptions {
  std::string name;               ///< as in PROCESS
  std::string url;                ///< empty: env LCM_DEFAULT_URL or LCM's default
  std::string prefix;             ///< of channel names
  std::vector<Channel> channels;  ///< to listen to; empty: all
};

/// Runs a role: checks the sender of every message that arrives, guards messages both ways, publishes PROCESS, turns SIGINT and SIGTERM into Role::stop (a second one ends
/// the process at once).
class Participant {
 public:
  /// Opens the bus; throws BusError.
  explicit Participant(ParticipantOptions options);
  /// What the role publishes through. Throws PublishRefused for a message that the guard refuses.
  Publish publish();
  /// Runs until the role has ended. Prints a failure's reason to stderr. Returns the exit code.
  int run(Role& role);

 private:
  void receive(Role& role, const Datagram& datagram);
  void bind(const Role& role);
  void note_neighbour(const Datagram& datagram, Role& role);
  bool is_attributed(Channel channel, const Datagram& datagram, Role& role);
  void note_stranger(Channel channel, const std::string& reason, Role& role);
  void publish_process(Role& role, const std::string& state);
  void note_loop(Micros us);

  ParticipantOptions options_;
  std::unique_ptr<Bus> bus_;
  Guard incoming_, outgoing_;
  Publishers publishers_;
  std::vector<std::string> wire_names_;  ///< by Channel
  int64_t nonce_;
  int64_t newest_state_ = -1;  ///< step of the last ROBOT_STATE that counted
  Micros next_complaint_ = 0;
  int64_t received_ = 0, rejected_ = 0, foreign_ = 0;
  std::string last_rejected_;
  std::vector<float> loops_;                      ///< us, the last few hundred
  std::array<int64_t, kLoopBins> loop_counts_{};  ///< of all since the start
  size_t next_loop_ = 0;
};

struct PublishRefused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// us that a process may wait for messages before it calls the role again. A role with ticks is called from 50 us before each
/// on, without any sleep, because a sleep may end that much late.
Micros time_to_sleep(const Role& role, Micros next_process, Micros now);

/// The nonce of this launch of the group, from env LAB_LAUNCH; 0 if unset.
int64_t launch_nonce();

/// us of the monotonic and of the wall clock.
Micros monotonic_now();
Micros wall_now();

}  // namespace lab
