// Tests of untrusted YAML: documents that would overflow the stack of yaml-cpp are refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/yaml_text.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "ddm_msgs/testing/expect_error.h"

namespace ddm {
namespace {

std::string refusalOf(const std::string& text) {
  try {
    parseYaml(text, "FILE");
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "accepted";
}

std::string lists(int levels) {
  return "a: " + std::string(levels, '[') + std::string(levels, ']');
}

TEST(YamlText, ADocumentIsRead) {
  EXPECT_EQ(parseYaml("a: {b: [1, 2]}", "FILE")["a"]["b"][1].as<int>(), 2);
  EXPECT_EQ(parseYaml("a: &x [1]\nb: *x\nc: *x\n", "FILE")["c"][0].as<int>(), 1);
  EXPECT_TRUE(parseYaml("# nothing\n", "FILE").IsNull());
  EXPECT_TRUE(parseYaml("", "FILE").IsNull());
}

TEST(YamlText, MoreThanTwentyLevelsAreRefused) {
  EXPECT_EQ(refusalOf(lists(19)), "accepted");  // the map is the twentieth level
  EXPECT_TRUE(testing::names(refusalOf(lists(20)), {"FILE:1: ", " 20 "}));
  for (const std::string level : {"[", "{a: ", "- ", "? "}) {
    std::string text;
    for (int i = 0; i < 10000; ++i) text += level;
    EXPECT_NE(refusalOf(text), "accepted") << level;
  }
}

TEST(YamlText, AColonBeforeTheEndOfAListIsRefused) {
  for (const std::string text :
       {"[a :]", "{b: x 'y, c: [x, a:]}", "[a:#b:]", "{a:\"b:]\"}", "[:]"}) {
    EXPECT_TRUE(testing::names(refusalOf("# a\n" + text), {"FILE:2: ", "':'", "']'"})) << text;
  }
  for (const std::string text : {"[a: ]", "[a:b, 1]", "[{a:}]", "[\"a:\"]"}) {
    EXPECT_EQ(refusalOf(text), "accepted") << text;
  }
}

TEST(YamlText, AListThatEndsWithAColonIsRefused) {
  for (const std::string text : {"{a:", "[a:", "[\"a\" :", "[a:\4]", "{a: [b:"}) {
    EXPECT_TRUE(testing::names(refusalOf(text), {"FILE:"})) << text;
  }
  EXPECT_TRUE(parseYaml("a:", "FILE")["a"].IsNull());
}

TEST(YamlText, WhatContainsItselfIsRefused) {
  EXPECT_TRUE(testing::names(refusalOf("a:\n  &x [1, *x]\n"), {"FILE:2: ", "itself"}));
  EXPECT_TRUE(testing::names(refusalOf("a: &x {b: [*x]}\n"), {"FILE:1: ", "itself"}));
}

TEST(YamlText, TextThatWouldNotBeWrittenAsItWasReadIsRefused) {
  for (const std::string text : {"caf\xc3\xa9", "\xe2\x82\xac", "\xf0\x9f\xa4\x96", "\\u0005\\0"}) {
    const YAML::Node node = parseYaml("a: \"" + text + "\"", "FILE");
    EXPECT_EQ(parseYaml(YAML::Dump(node), "FILE")["a"].Scalar(), node["a"].Scalar()) << text;
  }
  EXPECT_EQ(refusalOf("# caf\xe9\na: 1\n"), "accepted");  // comments are not checked
  for (const std::string text :
       {"caf\xe9", "\xbf\xbf", "\xc3", "\xc0\x80", "\xe0\x80\x80", "\xed\xa0\x80", "\xef\xbf\xbe",
        "\xf4\x90\x80\x80", "\xf8\x88\x80\x80\x80", "\\uFDD0"}) {
    for (const std::string& yaml : {"a: \"" + text + "\"", "\"" + text + "\": 1"}) {
      EXPECT_TRUE(testing::names(refusalOf("b: 1\n" + yaml), {"FILE:2: ", "UTF-8"}));
    }
  }
}

}  // namespace
}  // namespace ddm
