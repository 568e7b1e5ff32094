// Who may publish what in a run: each process of a lab asks here before anything in a message counts. The bus is not
// authenticated, but the kernel tells the address that a packet was sent from, and a program without raw sockets cannot
// send from another's. docs/safety.md, "Whose message".
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "wire/protocol/role.h"
#include "wire/schema/channels.h"

namespace lab {

/// What is known about the owner of an address beside what it says of itself.
enum class Claim : uint8_t {
  Ours,      ///< the address belongs to the process that the supervisor started under that name
  Unknown,   ///< there is no record to compare with
  Stranger,  ///< the address belongs to another process
};

/// The publishers of a launch, pinned by sender address. PROCESS with the launch's nonce pins the address of its name; a
/// process that was restarted, and so sends from another address, takes its name over at once where the supervisor's record
/// says so, otherwise when the old address has been silent for kSilence; the simulator not even then: when it restarts,
/// the whole launch does.
class Publishers {
 public:
  static constexpr Micros kSilence = 300'000;
  static constexpr size_t kMaxNames = 64;

  /// Tells whose an address is; asked only before a name is pinned to it, at most every kAskAgain for each address.
  using Check = std::function<Claim(const std::string& name, uint64_t address)>;
  static constexpr Micros kAskAgain = 50'000;
  static constexpr size_t kMaxAsked = 64;

  /// `own` as in PROCESS; `nonce` of this launch. A name in `guests` may also be taken by the first PROCESS without a nonce,
  /// and from such a guest, once it has been silent for kSilence, by the next one.
  Publishers(std::string own, int64_t nonce, std::vector<std::string> guests, Check check = {});

  /// This process hears itself where it listens to all channels: from this address.
  void set_own_address(uint64_t address) { pins_[own_].address = address; }

  /// The process that alone may publish on the channel, whatever is in the message; empty for Named and Anybody.
  static std::string_view owner_of(Channel channel);

  /// Takes a PROCESS of `name`. Empty when it counts; otherwise the reason why not. With an address of 0 (the
  /// back end cannot tell senders) only the nonce is compared.
  std::string process(const std::string& name, int64_t nonce, uint64_t address, Micros now);

  /// Takes any other message that only `name` may publish. REFERENCE, COMMAND and EVENT count from the simulator too, which
  /// re-sends them, except to the simulator itself.
  std::string message(Channel channel, std::string_view name, uint64_t address, Micros now);

 private:
  struct Pin {
    uint64_t address = 0;
    Micros heard = 0;
    bool guest = false;  ///< came without the nonce
  };
  Claim claim(const std::string& name, uint64_t address, Micros now);
  bool is_pinned(std::string_view name, uint64_t address, Micros now);

  std::string own_;
  int64_t nonce_;
  std::vector<std::string> guests_;
  Check check_;
  std::map<uint64_t, Micros> asked_;  ///< addresses found to be strangers', and when
  std::map<std::string, Pin, std::less<>> pins_;
};

/// An address as text: 127.0.0.1:40123.
std::string address_text(uint64_t address);

}  // namespace lab
