// Checks that a text or an error contains given parts, whatever the rest of its wording.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <exception>
#include <functional>
#include <string>
#include <vector>

namespace ddm {
namespace testing {

/// Succeeds if the text contains all parts.
inline ::testing::AssertionResult names(const std::string& text,
                                        const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    if (text.find(part) == std::string::npos) {
      return ::testing::AssertionFailure() << "no '" << part << "' in: " << text;
    }
  }
  return ::testing::AssertionSuccess();
}

/// Succeeds if `action` throws an error of this type whose message contains all parts.
template <class Error>
::testing::AssertionResult throwsNaming(const std::function<void()>& action,
                                        const std::vector<std::string>& parts) {
  try {
    action();
  } catch (const Error& e) {
    return names(e.what(), parts);
  } catch (const std::exception& e) {
    return ::testing::AssertionFailure() << "another type of error: " << e.what();
  }
  return ::testing::AssertionFailure() << "nothing was thrown";
}

}  // namespace testing
}  // namespace ddm
