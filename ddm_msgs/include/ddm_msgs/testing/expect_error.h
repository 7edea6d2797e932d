// Texts and errors that name what a user can act on, in whatever words.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <exception>
#include <functional>
#include <string>
#include <vector>

namespace ddm {
namespace testing {

/// Whether a text has all the parts.
inline ::testing::AssertionResult names(const std::string& text,
                                        const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    if (text.find(part) == std::string::npos) {
      return ::testing::AssertionFailure() << "no '" << part << "' in: " << text;
    }
  }
  return ::testing::AssertionSuccess();
}

/// Whether `action` throws this type, with all the parts in its message.
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
