// The message types that a spy can decode.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "wire/schema/schema.h"

namespace lab::spy {

/// The types that a spy knows: the lab's own, those of .lcm files, those that TYPE messages bring.
class Types {
 public:
  /// `paths`: .lcm files, and folders that are searched for them with their subfolders. What cannot be used is left out:
  /// warn(`FILE:LINE: what is wrong`).
  Types(const std::vector<std::string>& paths, const std::function<void(const std::string&)>& warn);
  /// Takes the text of a TYPE message; what cannot be parsed beside the others is left out.
  void learn(const std::string& source);
  /// The type of a message: by its channel if the lab has that, else by its fingerprint; null if it is not known.
  const Type* of(std::string_view channel, std::span<const uint8_t> bytes) const;
  /// Its name; of structs with equal fingerprints all names, a.pose_t|b.pose_t; `? FINGERPRINT` if it is not known.
  std::string name_of(std::string_view channel, std::span<const uint8_t> bytes) const;
  const Schema& schema() const { return schema_; }

 private:
  Schema schema_;
};

/// First eight bytes as a number; 0 if there are fewer.
int64_t fingerprint(std::span<const uint8_t> bytes);

}  // namespace lab::spy
