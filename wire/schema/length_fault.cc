#include "wire/schema/length_fault.h"

namespace lab {

std::string length_text(const char* type, const char* member, size_t length, const Length& wanted) {
  const std::string rule = *wanted.member ? std::string(wanted.member) + " is " : "must have ";
  return std::string(type) + ": " + member + " has " + std::to_string(length) + " elements, " + rule +
         std::to_string(wanted.size);
}

}  // namespace lab
