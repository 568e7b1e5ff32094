#include "wire/schema/codec.h"

namespace lab::fields {

const Type& type_named(const char* short_name, size_t members) {
  const Type* type = lab_schema().find(std::string("lab.") + short_name);
  if (!type || type->fields.size() != members) {
    throw std::logic_error(std::string("codec: lab.") + short_name + " is not as lcmtypes/ has it; rebuild");
  }
  return *type;
}

std::string length_fault(const Type& type, const Field& field, size_t dim, size_t length, int64_t count) {
  const Dim& d = field.dims[dim];
  return type.name + ": " + field.name + " has " + std::to_string(length) + " elements, " +
         (d.member < 0 ? "must have " : d.text + " is ") + std::to_string(count);
}

}  // namespace lab::fields
