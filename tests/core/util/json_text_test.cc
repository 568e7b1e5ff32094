#include "core/util/json_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace lab {
namespace {

TEST(JsonText, KeepsTheOrderOfAnOrderedObjectAndSortsTheOther) {
  EXPECT_EQ(json_text(nlohmann::ordered_json{{"b", 1}, {"a", 2}}), R"({"b":1,"a":2})");
  EXPECT_EQ(json_text(nlohmann::json{{"b", 1}, {"a", 2}}), R"({"a":2,"b":1})");
  EXPECT_EQ(json_text(nlohmann::json{{"a", 1}}, 2), "{\n  \"a\": 1\n}");
}

TEST(JsonText, ShowsBytesThatAreNotUtf8InStringsAndKeys) {
  EXPECT_EQ(json_text(nlohmann::json("Ger\xe4t \x1b")), R"("Ger\\xe4t \u001b")");
  EXPECT_EQ(json_text(nlohmann::ordered_json{{"b\xff", {1, "\xfe", nullptr}}, {"a", {{"k", "\xfd"}}}}),
            R"({"b\\xff":[1,"\\xfe",null],"a":{"k":"\\xfd"}})");
}

TEST(JsonText, ReadsWhatItWrote) {
  const nlohmann::json value{{"x", {1, 2.5, nullptr}}, {"y", "\u00e4"}};
  EXPECT_EQ(parse_json(json_text(value, 2)), value);
}

TEST(JsonText, SaysWhereTextIsNotJson) {
  EXPECT_THROW(parse_json("{\"a\": }"), nlohmann::json::parse_error);
  EXPECT_TRUE(try_parse_json("{\"a\": }").is_discarded());
  EXPECT_FALSE(try_parse_json("null").is_discarded());
}

}  // namespace
}  // namespace lab
