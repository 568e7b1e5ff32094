// Templates, and how pages write numbers and bytes.
#include "lab/page/page.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "lab/page/template.h"

namespace lab::page {
namespace {

using nlohmann::json;

std::string filled(std::string_view text, const json& values) {
  return fill({{"t", text}, {"row", "<{{name}}>"}}, "t", values);
}

// The rules and their examples are those of mustache(5).
TEST(Template, ValuesAreEscapedUnlessRaw) {
  EXPECT_EQ(filled("a {{x}} {{{x}}} b", {{"x", "<i>\"&\""}}), "a &lt;i&gt;&quot;&amp;&quot; <i>\"&\" b");
  EXPECT_EQ(filled("{{n}} {{yes}}", {{"n", 42}, {"yes", true}}), "42 true");
}

TEST(Template, SectionsRepeatNestAndInvert) {
  EXPECT_EQ(filled("{{#list}}{{.}},{{/list}}{{^list}}none{{/list}}", {{"list", {"a", "b"}}}), "a,b,");
  EXPECT_EQ(filled("{{#list}}{{.}},{{/list}}{{^list}}none{{/list}}", {{"list", json::array()}}), "none");
  for (const json& nothing : {json(), json(false), json(""), json(nullptr)})
    EXPECT_EQ(filled("{{#x}}yes{{/x}}{{^x}}no{{/x}}", {{"x", nothing}}), "no");
  EXPECT_EQ(filled("{{#x}}yes{{/x}}{{^x}}no{{/x}}", json::object()), "no");
  // the inner name hides the outer one; a section of the same name inside closes first
  EXPECT_EQ(filled("{{n}}{{#a}}{{n}}{{#b}}{{n}}{{/b}}{{/a}}", {{"n", "1"}, {"a", {{"n", "2"}, {"b", true}}}}),
            "122");
  EXPECT_EQ(filled("{{#a}}[{{#a}}x{{/a}}]{{/a}}", {{"a", true}}), "[x]");
}

TEST(Template, OtherTemplatesAreFilledInPlace) {
  EXPECT_EQ(filled("{{#rows}}{{>row}}{{/rows}}.", {{"rows", {{{"name", "a&"}}, {{"name", "b"}}}}}),
            "<a&amp;><b>.");
}

TEST(Template, TagsAloneOnALineTakeTheLineWithThem) {
  EXPECT_EQ(filled("one\n  {{#x}}\ntwo\n{{/x}}\nthree\n", {{"x", true}}), "one\ntwo\nthree\n");
  EXPECT_EQ(filled("one\n{{#x}}two{{/x}}\nthree", {{"x", true}}), "one\ntwo\nthree");
  EXPECT_EQ(filled("{{#x}}\nlast\n{{/x}}", {{"x", false}}), "");
}

TEST(Template, FaultsAreNotSwallowed) {
  for (const char* text :
       {"{{missing}}", "{{#x}}open", "{{/x}}", "{{x", "{{>nowhere}}", "{{number}}", "{{list}}"})
    EXPECT_THROW(filled(text, {{"x", true}, {"number", 0.5}, {"list", {1, 2}}}), std::logic_error) << text;
}

TEST(Page, NothingComesFromElsewhere) {
  const std::string page = document("a <title>", "<p>body</p>\n");
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
  EXPECT_NE(page.find("<title>a &lt;title&gt;</title>"), std::string::npos);
  EXPECT_NE(page.find("<p>body</p>"), std::string::npos);
  for (const char* word : {"http", "@import", "url(", "<script", "<link", "{{"})
    EXPECT_EQ(page.find(word), std::string::npos) << word;
}

TEST(Page, NumbersAndBytes) {
  EXPECT_EQ(figure(-0.0), "0");
  EXPECT_EQ(figure(NAN), "–");
  EXPECT_EQ(figure(-0.123456), "−0.1235");
  EXPECT_EQ(figure(2000, 3), "2000");  // not 2e+03
  EXPECT_EQ(figure(-123456.7), "−123457");
  EXPECT_EQ(figure(9999.4), "9999");
  EXPECT_EQ(figure(1.5e7), "1.5e+07");
  EXPECT_EQ(short_figure("3.8977"), "3.898");
  EXPECT_EQ(short_figure("quintic"), "quintic");
  const std::pair<const char*, const char*> rfc4648[] = {{"", ""},
                                                         {"f", "Zg=="},
                                                         {"fo", "Zm8="},
                                                         {"foo", "Zm9v"},
                                                         {"foob", "Zm9vYg=="},
                                                         {"fooba", "Zm9vYmE="},
                                                         {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, coded] : rfc4648) EXPECT_EQ(base64(plain), coded);
  EXPECT_EQ(base64(std::string("\xff\xfe\x00", 3)), "//4A");
}

TEST(Page, LongNamesBreakAfterTheirParts) {
  EXPECT_EQ(breakable("joint2_shoulder"), "joint2_shoulder");
  EXPECT_EQ(breakable("max_error.left_arm_<elbow>"),
            "max_<wbr/>error.<wbr/>left_<wbr/>arm_<wbr/>&lt;elbow&gt;");
}

}  // namespace
}  // namespace lab::page
